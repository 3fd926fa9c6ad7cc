"""Findings as a maker reads them: true faults first, and each kind once, with its count."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from wrinkle_cad.errors import Finding, Severity

_ORDER: Final[dict[Severity, int]] = {"error": 0, "warning": 1, "info": 2}


def grouped(findings: Iterable[Finding]) -> tuple[tuple[Finding, int], ...]:
    """Returns one finding of each kind, the first that was found, with how many there were.

    Errors come first, then warnings, then what is no fault; each in the order of its finding.
    """
    groups: dict[tuple[str, Severity], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.code, finding.severity), []).append(finding)
    ordered = sorted(groups.values(), key=lambda group: _ORDER[group[0].severity])
    return tuple((_told(group), len(group)) for group in ordered)


def _told(group: list[Finding]) -> Finding:
    first, others = group[0], len(group) - 1
    if not others:
        return first
    more = "There is one more like it." if others == 1 else f"There are {others:,} more like it."
    return replace(first, message=f"{first.message} {more}")

"""One strip against the limits: a sentence for each that it misses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from .limits import Limits

_SOFTER: Final = "Make the rails' waves lower or longer."
_STRAIGHTER: Final = "Let the rails run more alike."
_BAND: Final = "It is a band: change --margin, --height, --fade or --phase."


@dataclass(frozen=True, slots=True)
class Missed:
    """A limit that a strip misses."""

    found: str
    """What was found and what is allowed, a sentence."""
    action: str
    """What to do, a sentence."""


def missed_limits(
    entry: Mapping[str, Any], limits: Limits, invalid_percent: float
) -> tuple[Missed, ...]:
    """Compares one strip with the limits.

    Args:
        entry: an entry of ``strips`` in the JSON.
        limits: what may not be exceeded.
        invalid_percent: share of the rails under invalid bridges.

    Returns:
        One for each limit that the strip misses.
    """
    is_band = entry.get("role") == "band"
    lines = [*_too_much(entry, limits, invalid_percent), *_too_sharp(entry, limits)]
    return tuple(
        Missed(f"{entry['name']} has {found}.", _BAND if is_band else action)
        for found, action in lines
    )


def _too_much(
    entry: Mapping[str, Any], limits: Limits, invalid_percent: float
) -> Iterator[tuple[str, str]]:
    crease = max((float(crease["angle_deg"]) for crease in entry["creases"]), default=0.0)
    for value, limit, what, unit, action in (
        (entry["max_strain_percent"], limits.max_strain_percent, "a strain", "%", _STRAIGHTER),
        (crease, limits.max_crease_deg, "a crease", "°", "Round the rails' corners."),
        (entry["max_twist_deg"], limits.max_twist_deg, "a twist", "°", _STRAIGHTER),
        (entry["max_fold_deg"], limits.max_fold_deg, "a fold", "°", _SOFTER),
        (
            invalid_percent,
            limits.max_invalid_percent,
            "invalid bridges on",
            "% of its rails",
            "Change the rails where the gap list says.",
        ),
    ):
        if limit is not None and float(value) > limit:
            joined = "" if what.endswith(" on") else " of"
            yield f"{what}{joined} {figure(value)}{unit}, and {limit:g} is allowed", action


def _too_sharp(entry: Mapping[str, Any], limits: Limits) -> Iterator[tuple[str, str]]:
    across = limits.min_radius_across_grain_mm
    along_key = "inner_bend_radius_mm" if across is None else "bend_radius_along_grain_mm"
    where = "" if across is None else " along the grain"
    for key, least, words in (
        (along_key, limits.min_radius_mm, where),
        ("bend_radius_across_grain_mm", across, " across the grain"),
    ):
        radius = None if least is None else entry[key]
        if radius is not None and radius < least:
            yield (
                f"a bend radius of {figure(radius)} mm{words}, and {least:g} is the least",
                _SOFTER,
            )


def figure(value: float) -> str:
    """Three significant digits, no more than four decimals; round-off reads 0.

    >>> figure(0.12476), figure(3.8108), figure(31234.5), figure(1e-9)
    ('0.125', '3.81', '31,234', '0')
    """
    if abs(value) < 5e-5:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{min(digits, 4)}f}"

"""What is unsure about a strip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, Severity
from wrinkle_cad.strip.crossings import self_crossings
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.end_bridges import end_crossings
from wrinkle_cad.strip.places import outstanding, place_text
from wrinkle_cad.strip.triangulation import Triangulation
from wrinkle_cad.strip.ways import unused_text

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.rulings.surface import RuledStrip


FOLDED: Final = ("folded-back", "passes-through-itself")
"""Codes of what no sheet can do."""


def shape_findings(name: str, triangulation: Triangulation) -> tuple[Finding, ...]:
    """Returns where a strip folds back on itself and where it passes through itself."""
    return (*_fold_backs(name, triangulation), *_crossings(name, triangulation))


def _fold_backs(name: str, triangulation: Triangulation) -> Iterator[Finding]:
    (at,) = np.nonzero(triangulation.folded_back)
    if not len(at):
        return
    i, j = triangulation.bridges[at].T
    ends = triangulation.p[i], triangulation.q[j]
    middles = (ends[0] + ends[1]) / 2.0
    k = outstanding(row_lengths(ends[1] - ends[0]), middles)
    size = _size(triangulation)
    ways = [
        f"Its {one.end} bridge, between the {'starts' if one.end == 'first' else 'ends'} of P and"
        f" Q, runs into {one.rail} at {place_text(one.point, size)}: trim the rails there."
        for one in end_crossings(triangulation)
    ]
    yield Finding(
        "folded-back",
        "warning",
        f"{name} folds back on itself at {place_text(middles[k], size)}{_more(len(at) - 1)}:"
        " between these rails there is no strip that does not."
        f" {' '.join(ways) or 'Move them apart there, or sample them more finely.'}",
    )


def _crossings(name: str, triangulation: Triangulation) -> Iterator[Finding]:
    found = self_crossings(triangulation)
    if found.count:
        yield Finding(
            "passes-through-itself",
            "warning",
            f"{name} passes through itself at {place_text(found.place, _size(triangulation))}:"
            f" {found.count} of its {len(triangulation.triangles)} triangles cut others. It can be"
            " made only if the rails are moved apart there.",
        )


def _more(count: int) -> str:
    return f" and at {count} more place{'s' if count > 1 else ''}" if count else ""


def _size(triangulation: Triangulation) -> float:
    extent = np.ptp(np.vstack((triangulation.p, triangulation.q)), axis=0).tolist()
    return math.hypot(*extent)


def sheet_findings(name: str, ruled: RuledStrip, *, is_band: bool) -> tuple[Finding, ...]:
    """Returns whether a sheet must crease or give to take a strip's shape.

    Args:
        name: of the strip.
        ruled: its exact surface.
        is_band: whether the program made it: then it is worth knowing, and no warning.
    """
    severity: Severity = "info" if is_band else "warning"
    found = []
    sharpest = max(ruled.creases, key=lambda crease: crease.angle, default=None)
    if sharpest is not None and math.degrees(sharpest.angle) >= settings.CREASE_DEG:
        is_corner = sharpest.cause == "corner"
        why = "a rail has a corner" if is_corner else "no rail has a corner"
        message = (
            f"{name} is creased by {math.degrees(sharpest.angle):.1f} degrees at"
            f" {sharpest.p_arc:.1f} mm of P and {sharpest.q_arc:.1f} mm of Q, where {why}."
        )
        found.append(Finding("creased", severity, message))
    strain = 100.0 * ruled.strain.largest
    if strain > settings.STRETCH_PERCENT:
        length = ruled.strain.length_above(settings.STRETCH_PERCENT / 100.0)
        message = (
            f"{name} stretches a flat sheet by at most {strain:.3g}%, over {length:.1f} mm: the"
            " rails turn against each other there."
        )
        found.append(Finding("stretched", severity, message))
    return tuple(found)


def flat_findings(name: str, unrolling: Unrolling) -> tuple[Finding, ...]:
    """Returns what is unsure about a strip laid flat."""
    findings = []
    if unrolling.overlaps:
        message = (
            f"{name} covers itself when laid flat: its pattern is split at bridges into several"
            " pieces."
        )
        findings.append(Finding("flat-overlaps", "warning", message))
    if unrolling.turned_back_count:
        message = (
            f"{unrolling.turned_back_count} faces of {name} stand on a curve that turns back as"
            " seen from their apex; in space they are folded there. Take a finer tolerance."
        )
        findings.append(Finding("turned-back", "warning", message))
    return tuple(findings)


def unused_findings(name: str, unused: tuple[float, float, float, float]) -> tuple[Finding, ...]:
    """Returns which rail a strip with free ends left.

    Args:
        name: of the strip.
        unused: mm of P before and behind it, of Q before and behind it.
    """
    left = unused_text(unused)
    if not left:
        return ()
    message = f"{name} leaves {left}: its ends are free, and so it bends less."
    return (Finding("rail-unused", "info", message),)


def area_findings(name: str, error: float) -> tuple[Finding, ...]:
    """Returns whether a strip's area is unsure.

    Args:
        name: of the strip.
        error: relative; to which its area was integrated.
    """
    if error <= settings.AREA_SURE:
        return ()
    message = (
        f"The area of {name} is known to {error:.0e} of it only, not to"
        f" {settings.AREA_RELATIVE_ERROR:.0e} as that of a smooth strip. Look for kinks in its"
        " rails."
    )
    return (Finding("area-uncertain", "warning", message),)

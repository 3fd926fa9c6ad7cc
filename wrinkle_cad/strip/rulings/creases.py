"""Creases: rulings at which the sheet's tangent plane jumps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from .rail_curve import RailCurve
from .sheet import SHORTEST_IN_NODES, Sheet, turns_between

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

SMALLEST: Final = math.radians(1.0)
"""rad; a smaller jump is no crease: edges that CAD joined smoothly differ by as much."""

NEAR_PER_WIDTH: Final = 0.05
"""Jumps so close to each other, in shares of the ruling, are one crease."""


@dataclass(frozen=True, slots=True)
class Crease:
    """A ruling at which the sheet is folded."""

    angle: float
    """rad, above 0; the larger of the jumps at both ends of the ruling."""
    p_arc: float
    """mm along P from its start."""
    q_arc: float
    """mm along Q from its start."""
    cause: Literal["corner", "strip"]
    """A corner of a rail, or the strip's own: none lies there."""
    ruling: int
    """Number of the ruling."""


def creases_of(sheet: Sheet, p: RailCurve, q: RailCurve, spacing: float) -> tuple[Crease, ...]:
    """Returns the creases in order along the strip.

    Args:
        sheet: the strip's tangent planes.
        p: the curve.
        q: the curve.
        spacing: mm between the nodes that the rulings were found on.
    """
    jump = _jumps(sheet, np.arange(1, len(sheet.p_arc) - 1))
    long = sheet.reach[1:-1] > SHORTEST_IN_NODES * spacing
    found = np.flatnonzero((jump > SMALLEST) & long) + 1
    corners = [rail.arc_at(rail.edges[1:-1]) for rail in (p, q)]
    creases = []
    for group in _groups(sheet, found, spacing):
        angle = float(_jump(sheet, group[0], group[-1]))
        at = int(group[int(np.argmax(jump[group - 1]))])
        if angle > SMALLEST:
            places = (float(sheet.p_arc[at]), float(sheet.q_arc[at]))
            is_corner = any(
                len(arcs) and float(np.abs(arcs - place).min()) <= spacing
                for arcs, place in zip(corners, places, strict=True)
            )
            cause: Literal["corner", "strip"] = "corner" if is_corner else "strip"
            creases.append(Crease(angle, *places, cause, at))
    return tuple(creases)


def _groups(sheet: Sheet, found: Ints, spacing: float) -> list[Ints]:
    """Jumps that follow each other closely on both rails, together.

    Closely across the rulings: where a rail runs along one of them there is no sheet between, and
    what looks like a plane of its own has no side.
    """
    if not found.size:
        return []
    near = np.maximum(2.0 * spacing, NEAR_PER_WIDTH * sheet.reach[found[:-1]])
    far = np.zeros(len(found) - 1, dtype=np.bool_)
    for across in (sheet.p_across, sheet.q_across):
        moved = np.concatenate(([0.0], np.cumsum(np.abs(across))))
        far |= np.diff(moved[found]) > near
    return list(np.split(found, np.flatnonzero(far) + 1))


def _jumps(sheet: Sheet, at: Ints) -> Floats:
    """(k,) rad: the larger of the jumps at both ends of rulings inside the strip."""
    return np.maximum(
        turns_between(sheet.p_normal[at - 1, 1], sheet.p_normal[at, 0]),
        turns_between(sheet.q_normal[at - 1, 1], sheet.q_normal[at, 0]),
    )


def _jump(sheet: Sheet, first: int, last: int) -> float:
    """rad: the turn from before one ruling to after another."""
    turns = [
        turns_between(normal[first - 1, 1][None], normal[last, 0][None])
        for normal in (sheet.p_normal, sheet.q_normal)
    ]
    return float(np.max(turns))

"""A rail that was given as points: the curve they were taken from, as far as they tell.

Points on a curve turn a little at each and much alike from one to the next; a corner turns much, or
alone. Between corners a cubic runs through the points; at each it has the tangent of the parabola
through the point and its neighbours.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from .rail_curve import RailCurve
from .vectors import angles, crosses, dots, lengths

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

SMOOTH_TURN: Final = math.radians(4.0)
"""rad; a point that turns by less is no corner: a crease counts from 5 degrees ..."""
LARGEST_TURN: Final = math.radians(30.0)
"""... and one that turns by more is one ..."""
ALIKE: Final = 3.0
"""... as is one in between that turns by more than so many times as much as a neighbour."""


def rail_through(points: Floats) -> RailCurve:
    """Returns the rail through points; its parameter is the length of the chords between them.

    Args:
        points: (k, 3) float64, mm, k >= 2; no two in a row the same.

    >>> rail = rail_through(np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0], [40.0, 30.0, 0.0]]))
    >>> rail.breaks, rail.length
    ((40.0,), 70.0)
    """
    chord = np.diff(points, axis=0)
    width = lengths(chord)
    slope = chord / width[:, None]
    at = np.concatenate(([0.0], np.cumsum(width)))
    corner = _corners(slope)
    start, end = _tangents(slope, width, corner)

    def place(u: Floats) -> tuple[npt.NDArray[np.int64], Floats, Floats]:
        cell = np.clip(np.searchsorted(at, u, side="right") - 1, 0, len(width) - 1)
        return cell, width[cell][:, None], ((u - at[cell]) / width[cell])[:, None]

    def point_at(u: Floats) -> Floats:
        cell, h, x = place(u)
        low, rise, a, b = points[cell], chord[cell], start[cell] * h, end[cell] * h
        found: Floats = low + x * (a + x * (3 * rise - 2 * a - b + x * (a + b - 2 * rise)))
        return found

    def velocity_at(u: Floats) -> Floats:
        cell, h, x = place(u)
        rise, a, b = chord[cell], start[cell] * h, end[cell] * h
        found: Floats = (a + x * (2 * (3 * rise - 2 * a - b) + 3 * x * (a + b - 2 * rise))) / h
        return found

    breaks = tuple(float(place) for place in at[1:-1][corner])
    return RailCurve(point_at, velocity_at, (0.0, float(at[-1])), breaks)


def _corners(slope: Floats) -> Bools:
    """(k - 2,) bool: the inner points that are corners."""
    turn = angles(lengths(crosses(slope[:-1], slope[1:])), dots(slope[:-1], slope[1:]))
    beside = np.full(len(turn), math.inf)
    if len(turn) > 1:
        beside[:-1] = turn[1:]
        beside[1:] = np.minimum(beside[1:], turn[:-1])
    elif len(turn):
        beside[:] = 0.0
    return (turn > SMOOTH_TURN) & ((turn > LARGEST_TURN) | (turn > ALIKE * beside))


def _tangents(slope: Floats, width: Floats, corner: Bools) -> tuple[Floats, Floats]:
    """Derivatives at both ends of each chord, (k - 1, 3) each."""
    before, after = width[:-1, None], width[1:, None]
    inner = (slope[:-1] * after + slope[1:] * before) / (before + after)
    start, end = slope.copy(), slope.copy()
    start[1:], end[:-1] = inner, inner
    first = np.concatenate(([True], corner))
    last = np.concatenate((corner, [True]))
    # The end of a run has the tangent of the parabola of its last three points.
    start[first & ~last] = 2.0 * slope[first & ~last] - end[first & ~last]
    end[last & ~first] = 2.0 * slope[last & ~first] - start[last & ~first]
    alone = first & last
    start[alone], end[alone] = slope[alone], slope[alone]
    return start, end

"""Where on a rail the nearest point to a place in space is."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.portable import dot

from .directrix import Directrix

Floats = NDArray[np.float64]

LOOKED_AT: Final = 721
"""Points of a rail among which the nearest one is looked for first."""

FOOT_STEPS: Final = 60
"""Steps towards a foot, or from foot to foot; each gains digits, and the last changes nothing."""


def foot_on(point: Floats, rail: Directrix) -> float:
    """Returns the parameter of the point of a rail that is nearest to (3,) mm."""
    grid = np.union1d(np.linspace(*rail.interval, LOOKED_AT), rail.breaks)
    found = nearest_on_polyline(point[None], rail.point_at(grid))
    k, share = int(found.segment[0]), float(found.share[0])
    return settled_foot(point, rail, float((1.0 - share) * grid[k] + share * grid[k + 1]))


def settled_foot(point: Floats, rail: Directrix, start: float) -> float:
    """Walks to the foot of a point: the tangent's foot, taken as far as it comes nearer.

    Args:
        point: (3,) mm.
        rail: the rail; of a closed one the walk may go past its end.
        start: the parameter where the walk begins.
    """
    at, gap = start, _gap(point, rail, start)
    for _ in range(FOOT_STEPS):
        place = np.array([at])
        velocity = rail.velocity_at(place)
        speed2 = float(dot(velocity, velocity)[0])
        if speed2 == 0.0:
            break
        step = float(dot(point[None] - rail.point_at(place), velocity)[0]) / speed2
        while True:
            there = within(rail, at + step)
            nearer = _gap(point, rail, there)
            if nearer < gap or abs(step) <= settings.KNOT_GAP:
                break
            step /= 2.0
        if nearer >= gap:
            break
        at, gap = there, nearer
    return _squared_foot(point, rail, at)


def _squared_foot(point: Floats, rail: Directrix, at: float) -> float:
    """The place where the way to the point stands square on the rail, to the last digits.

    A distance has its least value to half of the digits only.
    """
    best = np.inf
    for _ in range(FOOT_STEPS):
        place = np.array([at])
        velocity = rail.velocity_at(place)
        speed2 = float(dot(velocity, velocity)[0])
        along = float(dot(point[None] - rail.point_at(place), velocity)[0])
        if speed2 == 0.0 or abs(along) >= best:
            break
        best, found = abs(along), at
        at = within(rail, at + along / speed2)
    return found if best < np.inf else at


def within(rail: Directrix, at: float) -> float:
    """Returns a parameter within a rail's interval: around a closed rail, else its nearest end."""
    first, last = rail.interval
    if rail.is_closed:
        return first + (at - first) % (last - first)
    return min(max(at, first), last)


def _gap(point: Floats, rail: Directrix, at: float) -> float:
    return float(row_lengths(rail.point_at(np.array([at])) - point)[0])

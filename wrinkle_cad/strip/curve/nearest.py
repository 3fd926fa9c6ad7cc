"""The points of a polyline that are nearest to others.

Each product and each sum is an operation of its own, in the order of the coordinates, so that the
last bit is the same on any processor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wrinkle_cad.strip.compiled import compiled

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

BLOCK: Final = 16
"""So many segments share one enclosing ball: far ones are passed over together."""
TIE: Final = 1e-9
"""Distances closer than this share of themselves are equal but for round-off."""


@dataclass(frozen=True, slots=True, eq=False)
class NearestPoints:
    """Where on a polyline the nearest points to others are."""

    segment: Indices
    """(k,) which segment each lies on; of equally near places the one with the
    smallest x, then y, then z, whichever way the polyline runs."""

    share: Floats
    """(k,) where on it, from 0 at its start to 1 at its end."""

    distance: Floats
    """(k,) mm: how far it is from the point that it is nearest to."""


def nearest_on_polyline(points: ArrayLike, line: ArrayLike) -> NearestPoints:
    """Returns where on a polyline in space the nearest points to others are.

    Args:
        points: (k, 3) float64, mm.
        line: (l, 3) float64, mm; l at least 2. Segments may be points.

    O(k l) time at worst; blocks of segments that are too far are passed over.

    Example:
        >>> found = nearest_on_polyline([[1.0, 2.0, 0.0]], [[0.0, 0, 0], [4.0, 0, 0], [4.0, 9, 0]])
        >>> found.segment.tolist(), found.share.tolist(), found.distance.tolist()
        ([0], [0.25], [2.0])
    """
    return NearestPoints(
        *_nearest(
            np.ascontiguousarray(points, dtype=np.float64),
            np.ascontiguousarray(line, dtype=np.float64),
        )
    )


@compiled
def _nearest(points: Floats, line: Floats) -> tuple[Indices, Floats, Floats]:
    count = points.shape[0]
    segment = np.zeros(count, dtype=np.int64)
    share, distance = np.zeros(count), np.zeros(count)
    balls = _balls(line)
    place = np.zeros(3)
    k = 0
    for i in range(count):
        along, place[0], place[1], place[2], least = _foot(points[i], line, k)
        for block in range(balls.shape[0]):
            x = points[i, 0] - balls[block, 0]
            y = points[i, 1] - balls[block, 1]
            z = points[i, 2] - balls[block, 2]
            reach = least * (1.0 + TIE) + balls[block, 3]
            if x * x + y * y + z * z > reach * reach:
                continue
            for j in range(block * BLOCK, min((block + 1) * BLOCK, line.shape[0] - 1)):
                there, x, y, z, away = _foot(points[i], line, j)
                slack = TIE * (least + away)
                if away > least + slack:
                    continue
                if away < least - slack or _comes_first(x, y, z, place, slack):
                    k, along, least = j, there, away
                    place[0], place[1], place[2] = x, y, z
        segment[i], share[i], distance[i] = k, along, least
    return segment, share, distance


@compiled
def _balls(line: Floats) -> Floats:
    """(b, 4) centre and radius: balls around blocks of segments."""
    segments = line.shape[0] - 1
    balls = np.zeros(((segments + BLOCK - 1) // BLOCK, 4))
    for block in range(balls.shape[0]):
        first, last = block * BLOCK, min((block + 1) * BLOCK, segments)
        square = 0.0
        for axis in range(3):
            low = high = line[first, axis]
            for k in range(first, last + 1):
                low, high = min(low, line[k, axis]), max(high, line[k, axis])
            balls[block, axis] = 0.5 * (low + high)
            square += 0.25 * (high - low) * (high - low)
        balls[block, 3] = np.sqrt(square) * (1.0 + TIE)
    return balls


@compiled
def _foot(point: Floats, line: Floats, k: int) -> tuple[float, float, float, float, float]:
    """Share of segment k that lies before its nearest point, that point, and its distance."""
    ux, uy, uz = (
        line[k + 1, 0] - line[k, 0],
        line[k + 1, 1] - line[k, 1],
        line[k + 1, 2] - line[k, 2],
    )
    vx, vy, vz = point[0] - line[k, 0], point[1] - line[k, 1], point[2] - line[k, 2]
    square = ux * ux + uy * uy + uz * uz
    share = 0.0 if square == 0.0 else min(1.0, max(0.0, (ux * vx + uy * vy + uz * vz) / square))
    vx, vy, vz = vx - share * ux, vy - share * uy, vz - share * uz
    away = np.sqrt(vx * vx + vy * vy + vz * vz)
    return share, point[0] - vx, point[1] - vy, point[2] - vz, away


@compiled
def _comes_first(x: float, y: float, z: float, other: Floats, slack: float) -> bool:
    """Whether a place comes before another by the first coordinate in which they differ."""
    if abs(x - other[0]) > slack:
        return bool(x < other[0])
    if abs(y - other[1]) > slack:
        return bool(y < other[1])
    return bool(z < other[2] - slack)


@compiled
def gap_from_segment(ux: float, uy: float, vx: float, vy: float) -> float:
    """Returns mm: how far the point (vx, vy) is from the segment from the origin to (ux, uy).

    Example:
        >>> gap_from_segment(4.0, 0.0, 7.0, 4.0)
        5.0
    """
    square = ux * ux + uy * uy
    share = 0.0 if square == 0.0 else min(1.0, max(0.0, (ux * vx + uy * vy) / square))
    x, y = vx - share * ux, vy - share * uy
    return float(np.sqrt(x * x + y * y))

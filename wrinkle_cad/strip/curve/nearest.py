"""The points of a polyline that are nearest to others.

Each product and each sum is an operation of its own, in the order of the coordinates, so that the
last bit is the same on any processor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wrinkle_cad.strip.compiled import compiled

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class NearestPoints:
    """Where on a polyline the nearest points to others are."""

    segment: Indices
    """(k,) which segment each lies on; of equally near ones the first."""

    share: Floats
    """(k,) where on it, from 0 at its start to 1 at its end."""

    distance: Floats
    """(k,) mm: how far it is from the point that it is nearest to."""


def nearest_on_polyline(points: ArrayLike, line: ArrayLike) -> NearestPoints:
    """Returns where on a polyline in space the nearest points to others are.

    Args:
        points: (k, 3) float64, mm.
        line: (l, 3) float64, mm; l at least 2. Segments may be points.

    O(k l) time.

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
    share, distance = np.zeros(count), np.empty(count)
    bank = line[1:] - line[:-1]
    square = np.empty(bank.shape[0])
    for j in range(bank.shape[0]):
        square[j] = bank[j, 0] * bank[j, 0] + bank[j, 1] * bank[j, 1] + bank[j, 2] * bank[j, 2]
    for i in range(count):
        least = np.inf
        for j in range(bank.shape[0]):
            x = points[i, 0] - line[j, 0]
            y = points[i, 1] - line[j, 1]
            z = points[i, 2] - line[j, 2]
            along = 0.0
            if square[j] > 0.0:
                along = (x * bank[j, 0] + y * bank[j, 1] + z * bank[j, 2]) / square[j]
                along = min(max(along, 0.0), 1.0)
            x -= along * bank[j, 0]
            y -= along * bank[j, 1]
            z -= along * bank[j, 2]
            away = x * x + y * y + z * z
            if away < least:
                least, segment[i], share[i] = away, j, along
        distance[i] = np.sqrt(least)
    return segment, share, distance


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

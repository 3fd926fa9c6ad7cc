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

BLOCK: Final = 8
"""So many segments have one chord; stretches that are far from theirs are passed over together."""
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

    O((k + l) log l) time where each point is clearly nearer to some stretch than to the others; at
    worst, as from the middle of a circle to it, O(k l).

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
    ends, widths = _stretches(line)
    leaves, segments = ends.shape[0] // 2, line.shape[0] - 1
    place = np.zeros(3)
    k = 0
    for i in range(count):
        along, place[0], place[1], place[2], least = _foot(points[i], line, k, k + 1)
        block = 0
        while block * BLOCK < segments:
            node, size = leaves + block, 1
            if _is_far(points[i], line, ends[node], widths[node], least):
                # Pass over all that is far together with this block.
                while node > 1 and node % 2 == 0:
                    node //= 2
                    if not _is_far(points[i], line, ends[node], widths[node], least):
                        break
                    size *= 2
                block += size
                continue
            for j in range(ends[node, 0], ends[node, 1]):
                there, x, y, z, away = _foot(points[i], line, j, j + 1)
                slack = TIE * (least + away)
                if away > least + slack:
                    continue
                if away < least - slack or _comes_first(x, y, z, place, slack):
                    k, along, least = j, there, away
                    place[0], place[1], place[2] = x, y, z
            block += 1
        segment[i], share[i], distance[i] = k, along, least
    return segment, share, distance


@compiled
def _stretches(line: Floats) -> tuple[Indices, Floats]:
    """Blocks of segments, and what they join to: node k + i is block i, node j is 2 j and 2 j + 1.

    Returns:
        (2 k, 2) first and last vertex of each; (2 k,) mm: how far it is off its chord.
    """
    segments, leaves = line.shape[0] - 1, 1
    while leaves * BLOCK < segments:
        leaves *= 2
    ends, widths = np.zeros((2 * leaves, 2), dtype=np.int64), np.zeros(2 * leaves)
    for node in range(2 * leaves - 1, 0, -1):
        if node >= leaves:
            ends[node, 0] = min(segments, (node - leaves) * BLOCK)
            ends[node, 1] = min(segments, (node - leaves + 1) * BLOCK)
        else:
            ends[node, 0], ends[node, 1] = ends[2 * node, 0], ends[2 * node + 1, 1]
        for k in range(ends[node, 0] + 1, ends[node, 1]):
            _, _, _, _, away = _foot(line[k], line, ends[node, 0], ends[node, 1])
            widths[node] = max(widths[node], away)
    return ends, widths


@compiled
def _is_far(point: Floats, line: Floats, ends: Indices, width: float, least: float) -> bool:
    """Whether all of a stretch is further away, by more than what counts as equal."""
    _, _, _, _, away = _foot(point, line, ends[0], ends[1])
    return bool(away * (1.0 - TIE) > least * (1.0 + 4.0 * TIE) + width * (1.0 + TIE))


@compiled
def _foot(
    point: Floats, line: Floats, first: int, last: int
) -> tuple[float, float, float, float, float]:
    """Share of a chord that lies before its nearest point, that point, and its distance."""
    ux, uy, uz = (
        line[last, 0] - line[first, 0],
        line[last, 1] - line[first, 1],
        line[last, 2] - line[first, 2],
    )
    vx, vy, vz = (
        point[0] - line[first, 0],
        point[1] - line[first, 1],
        point[2] - line[first, 2],
    )
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

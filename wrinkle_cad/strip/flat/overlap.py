"""Whether a flat strip lies over itself, read off its outline.

The outline of a strip that was unrolled triangle by triangle bounds a disc that may cover parts of
the plane twice. It does so exactly if two edges of the outline cross, or else if some edge has a
place on its inner side that the outline winds around twice: where the disc covers most, the edges
around that place have it on their inner side. Both are looked for by sweeping along one axis, so
that an edge meets only those that reach its height. What only touches does not overlap.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.compiled import compiled
from wrinkle_cad.strip.curve.chebyshev import FloatArray

TOUCHING: Final = 1e-10
"""A share of the outline's size: points closer than that to a line lie on it."""
DEPTHS: Final = (1e-7, 3e-7)
"""Shares of the outline's size: how deep under each edge the cover is counted; both must agree."""


def is_overlapping(p: FloatArray, q: FloatArray) -> bool:
    """Returns whether a flat strip covers some place twice.

    Args:
        p: (m, 2) float64, mm: flat rail P, the strip on its left.
        q: (n, 2) float64, mm: flat rail Q, in the same direction, the strip on its right.

    Rails that meet (ends of zero length), edges that share an end, and parts of the strip that
    touch without covering each other do not overlap. Overlaps less than 1e-7 of the strip's size
    deep may go unseen.
    """
    corners = np.concatenate((p, q[::-1]))
    corners = corners - corners[0]
    extent = np.ptp(corners, axis=0)
    size = float(np.max(extent))
    if extent[0] > extent[1]:
        # Turned by a quarter, so that the sweep runs along the strip.
        corners = np.stack((-corners[:, 1], corners[:, 0]), axis=1)
    ends = np.roll(corners, -1, axis=0)
    is_edge = np.linalg.norm(ends - corners, axis=1) > TOUCHING * size
    edges = np.concatenate((corners[is_edge], ends[is_edge]), axis=1)
    edges = edges[np.argsort(np.minimum(edges[:, 1], edges[:, 3]), kind="stable")]
    if _has_crossing(edges, TOUCHING * size):
        return True
    covered = np.ones(len(edges), dtype=np.bool_)
    for depth in DEPTHS:
        covered &= _is_covered_twice(edges, depth * size)
    return bool(covered.any())


def _is_covered_twice(edges: FloatArray, depth: float) -> NDArray[np.bool_]:
    """(k,) bool: whether the outline winds twice around the place inside each edge's middle."""
    along = edges[:, 2:] - edges[:, :2]
    along /= np.linalg.norm(along, axis=1)[:, None]
    places = 0.5 * (edges[:, :2] + edges[:, 2:]) + depth * np.stack(
        (-along[:, 1], along[:, 0]), axis=1
    )
    order = np.argsort(places[:, 1], kind="stable")
    covered = np.empty(len(edges), dtype=np.bool_)
    covered[order] = _windings(edges, np.ascontiguousarray(places[order])) > 1
    return covered


@compiled
def _side(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Signed distance of a point from the line through a and b."""
    ux, uy = bx - ax, by - ay
    return float((ux * (y - ay) - uy * (x - ax)) / np.hypot(ux, uy))


@compiled
def _crosses(edges: FloatArray, i: int, j: int, touching: float) -> bool:
    """Whether two edges cross at a place inside both, all four ends clear of the other's line."""
    a, b = edges[i], edges[j]
    if max(a[0], a[2]) < min(b[0], b[2]) or max(b[0], b[2]) < min(a[0], a[2]):
        return False
    before = _side(a[0], a[1], a[2], a[3], b[0], b[1])
    after = _side(a[0], a[1], a[2], a[3], b[2], b[3])
    if min(before, after) > -touching or max(before, after) < touching:
        return False
    before = _side(b[0], b[1], b[2], b[3], a[0], a[1])
    after = _side(b[0], b[1], b[2], b[3], a[2], a[3])
    return bool(min(before, after) < -touching and max(before, after) > touching)


@compiled
def _has_crossing(edges: FloatArray, touching: float) -> bool:
    """Whether any two edges, sorted by their lower ends, cross."""
    active = np.empty(len(edges), dtype=np.int64)
    count = 0
    for i in range(len(edges)):
        low = min(edges[i, 1], edges[i, 3])
        kept = 0
        for k in range(count):
            j = active[k]
            if max(edges[j, 1], edges[j, 3]) < low:
                continue
            active[kept] = j
            kept += 1
            if _crosses(edges, i, j, touching):
                return True
        active[kept] = i
        count = kept + 1
    return False


@compiled
def _windings(edges: FloatArray, places: FloatArray) -> NDArray[np.int64]:
    """How often the outline winds around each place; both sorted by height."""
    windings = np.zeros(len(places), dtype=np.int64)
    active = np.empty(len(edges), dtype=np.int64)
    count = entered = 0
    for i in range(len(places)):
        x, y = places[i]
        while entered < len(edges) and min(edges[entered, 1], edges[entered, 3]) <= y:
            active[count] = entered
            count += 1
            entered += 1
        kept = 0
        for k in range(count):
            j = active[k]
            if max(edges[j, 1], edges[j, 3]) <= y:
                continue
            active[kept] = j
            kept += 1
            ax, ay, bx, by = edges[j]
            if (ay <= y) != (by <= y):
                on_left = (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0
                if by > ay and on_left:
                    windings[i] += 1
                elif by < ay and not on_left:
                    windings[i] -= 1
        count = kept
    return windings

"""How far two triangles in space cut each other, and where.

Each must reach through the other's plane; the line that both planes share then runs through either
triangle over an interval, and the two intervals must overlap (T. Moeller, A fast triangle-triangle
intersection test, doi:10.1080/10867651.1997.10487472). Triangles in one plane are told apart by an
edge of either.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from .compiled import compiled

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Vector = tuple[float, float, float]
Triangle = tuple[Vector, Vector, Vector]


@compiled
def cut_of(
    points: Floats, corners: Indices, i: int, j: int, planarity: float, length: float
) -> tuple[float, float, float, float]:
    """Returns how far triangles i and j cut each other, or cover each other in one plane.

    Args:
        points: (k, 3) float64, mm.
        corners: (l, 3) int64 into them.
        i: the first triangle.
        j: the second triangle; no cut is found if it shares two corners with the first.
        planarity: mm; they reach through each other's planes by more than this, or lie in one.
        length: mm; what they have in common is longer than this, and in one plane wider, too.

    Returns:
        mm, the length of what they have in common, its least width where both lie in one plane, 0
        if nothing; and its middle.
    """
    nothing = (0.0, 0.0, 0.0, 0.0)
    shared = 0
    for a in range(3):
        for b in range(3):
            shared += 1 if corners[i, a] == corners[j, b] else 0
    if shared > 1:
        return nothing
    first, second = _triangle(points, corners, i), _triangle(points, corners, j)
    own, other = _normal(first), _normal(second)
    if own == (0.0, 0.0, 0.0) or other == (0.0, 0.0, 0.0):
        return nothing
    heights = _heights(first, second[0], other)
    others = _heights(second, first[0], own)
    if _reach(heights) <= planarity and _reach(others) <= planarity:
        return _common_part(first, second, own, length)
    if not (_straddles(heights, planarity) and _straddles(others, planarity)):
        return nothing
    along = _unit(_cross(own, other))
    if along == (0.0, 0.0, 0.0):
        return nothing
    low, high, place = _interval(first, heights, along, first[0])
    other_low, other_high, _ = _interval(second, others, along, first[0])
    start, end = max(low, other_low), min(high, other_high)
    way = 0.5 * (start + end) - low
    return (
        end - start if end - start > length else 0.0,
        place[0] + way * along[0],
        place[1] + way * along[1],
        place[2] + way * along[2],
    )


@compiled
def _triangle(points: Floats, corners: Indices, i: int) -> Triangle:
    a, b, c = corners[i, 0], corners[i, 1], corners[i, 2]
    return (
        (points[a, 0], points[a, 1], points[a, 2]),
        (points[b, 0], points[b, 1], points[b, 2]),
        (points[c, 0], points[c, 1], points[c, 2]),
    )


@compiled
def _cross(a: Vector, b: Vector) -> Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@compiled
def _between(a: Vector, b: Vector) -> Vector:
    return (b[0] - a[0], b[1] - a[1], b[2] - a[2])


@compiled
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _unit(a: Vector) -> Vector:
    """The vector's direction; zero for a vector without length."""
    size = math.sqrt(_dot(a, a))
    return (a[0] / size, a[1] / size, a[2] / size) if size > 0.0 else (0.0, 0.0, 0.0)


@compiled
def _normal(triangle: Triangle) -> Vector:
    return _unit(_cross(_between(triangle[0], triangle[1]), _between(triangle[0], triangle[2])))


@compiled
def _heights(triangle: Triangle, base: Vector, normal: Vector) -> Vector:
    return (
        _dot(_between(base, triangle[0]), normal),
        _dot(_between(base, triangle[1]), normal),
        _dot(_between(base, triangle[2]), normal),
    )


@compiled
def _reach(heights: Vector) -> float:
    return max(abs(heights[0]), abs(heights[1]), abs(heights[2]))


@compiled
def _straddles(heights: Vector, by: float) -> bool:
    return min(heights[0], heights[1], heights[2]) < -by and (
        max(heights[0], heights[1], heights[2]) > by
    )


@compiled
def _interval(
    triangle: Triangle, heights: Vector, along: Vector, base: Vector
) -> tuple[float, float, Vector]:
    """What a plane cuts out of a triangle: from and to along a line, and the first place."""
    low, high, place = np.inf, -np.inf, triangle[0]
    for k in range(3):
        before, after = heights[k], heights[(k + 1) % 3]
        if (before < 0.0) == (after < 0.0):
            continue
        share = before / (before - after)
        way = _between(triangle[k], triangle[(k + 1) % 3])
        here = (
            triangle[k][0] + share * way[0],
            triangle[k][1] + share * way[1],
            triangle[k][2] + share * way[2],
        )
        at = _dot(_between(base, here), along)
        high = max(high, at)
        if at < low:
            low, place = at, here
    return low, high, place


@compiled
def _common_part(
    first: Triangle, second: Triangle, normal: Vector, width: float
) -> tuple[float, float, float, float]:
    """How far they reach over each other's edges if none keeps them apart (separating axes)."""
    least = np.inf
    for number in range(2):
        own = first if number == 0 else second
        for k in range(3):
            across = _unit(_cross(_between(own[k], own[(k + 1) % 3]), normal))
            one, other = _heights(first, own[k], across), _heights(second, own[k], across)
            low = max(min(one[0], one[1], one[2]), min(other[0], other[1], other[2]))
            high = min(max(one[0], one[1], one[2]), max(other[0], other[1], other[2]))
            if high - low <= width:
                return (0.0, 0.0, 0.0, 0.0)
            least = min(least, high - low)
    a, b, c = first
    d, e, f = second
    return (
        least,
        (a[0] + b[0] + c[0] + d[0] + e[0] + f[0]) / 6.0,
        (a[1] + b[1] + c[1] + d[1] + e[1] + f[1]) / 6.0,
        (a[2] + b[2] + c[2] + d[2] + e[2] + f[2]) / 6.0,
    )

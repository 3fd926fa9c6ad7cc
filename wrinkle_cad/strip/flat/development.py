"""Isometric development: polar angles of cones about their apices, and chains of triangles.

Over a curve segment c seen from an apex a, with v = c - a and r = |v|, the cone's polar angle in
the plane grows by |v x c'| / r^2 per unit of the parameter: the same as sqrt(1 - r'(s)^2) / r by
arc length s, but without the difference of nearly equal numbers. Its area grows by |v x c'| / 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.compiled import compiled
from wrinkle_cad.strip.curve.chebyshev import DEGREE, Cells, FloatArray, point_in_cell, times_each
from wrinkle_cad.strip.curve.nearest import gap_from_segment

IndexArray = NDArray[np.int64]
Pair = tuple[float, float]
Panel = tuple[float, float, float, float]
"""Length, polar angle, area, polar angle swept backwards."""

_HALF_NODES: Final = np.array(
    [
        0.14887433898163122,
        0.4333953941292472,
        0.6794095682990244,
        0.8650633666889845,
        0.9739065285171717,
    ]
)
_HALF_WEIGHTS: Final = np.array(
    [
        0.2955242247147528,
        0.2692667193099965,
        0.219086362515982,
        0.1494513491505804,
        0.06667134430868814,
    ]
)
NODES: Final = np.concatenate((-_HALF_NODES[::-1], _HALF_NODES))
WEIGHTS: Final = np.concatenate((_HALF_WEIGHTS[::-1], _HALF_WEIGHTS))
"""Gauss and Legendre's ten (Abramowitz and Stegun, table 25.4); numpy asks LAPACK for them."""
ACCURACY: Final = 1e-10
"""Halving a panel may change its length, and move its end, by this share of its length."""
ROUND_OFF: Final = 4096 * np.finfo(np.float64).eps
"""... or by this share of the largest coordinate: close to an apex nothing finer can be told."""
FIRST_DEPTH: Final = 2
"""Every cell is cut in four first, so that an S-bend does not pass for a straight line."""
DEEPEST: Final = 44
BULGE_SHARE: Final = 0.1
THINNING_SHARE: Final = 0.85
"""Shares of the tolerance: what a panel may bulge, and what leaving out points may add."""


@dataclass(frozen=True, slots=True, eq=False)
class DevelopedRail:
    """The cones over the segments of one rail, each about its own apex from its first ruling."""

    segment: IndexArray
    """(l,) int64: the rail's segment on which a point lies, in order."""
    angle: FloatArray
    """(l,) float64, rad: polar angle of the point, from the segment's start."""
    radius: FloatArray
    """(l,) float64, mm: distance of the point from the apex."""
    arc: FloatArray
    """(l,) float64, mm: length along the rail, from its start."""
    area: FloatArray
    """(k,) float64, mm2: of the cone over each segment."""
    back: FloatArray
    """(k,) float64, rad: how much of its angle each segment sweeps backwards."""


NO_RAIL: Final = DevelopedRail(np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(5)))
"""What a rail that is a point develops to."""


def _derivative_matrix() -> FloatArray:
    """(17, 17): from Chebyshev coefficients to those of the derivative on [-1, 1]."""
    k = np.arange(DEGREE + 1)
    matrix = np.where((k[None, :] > k[:, None]) & ((k[None, :] + k[:, None]) % 2 == 1), 2.0 * k, 0)
    matrix[0] *= 0.5
    return np.asarray(matrix, dtype=np.float64)


_TO_DERIVATIVE: Final = _derivative_matrix()


def develop_rail(
    cells: Cells,
    parameters: FloatArray,
    apexes: FloatArray,
    planes: FloatArray,
    tolerance: float,
) -> DevelopedRail:
    """Develops the cones between a rail's segments and their apices.

    In a plane nothing has to be unrolled: angles and areas are counted with their sign, so that a
    curve may turn back as it likes.

    Args:
        cells: the rail's curve; every parameter is an edge of a cell.
        parameters: (k + 1,) float64: ends of the segments.
        apexes: (k, 3) float64, mm: apex of the cone over each segment.
        planes: (k, 3) float64: normal of the plane that a segment lies in with its apex, to where
            angles about the apex grow; zero for a cone.
        tolerance: mm; points of the result follow the flat curve at least this closely.

    Returns:
        Points along the rail, the start of the first segment left out.
    """
    segment = np.searchsorted(parameters, cells.edges[:-1], side="right").astype(np.int64) - 1
    relative = cells.coefficients.copy()
    relative[:, 0, :] -= apexes[segment]
    slopes = times_each(_TO_DERIVATIVE, relative)
    is_plane = np.asarray(planes.any(axis=1), dtype=np.bool_)
    normals = _mean_normals(relative, slopes, segment, len(apexes))
    normals[is_plane] = planes[is_plane]
    slack = (BULGE_SHARE * tolerance, ROUND_OFF * cells.size)
    rows, back, area = _integrate(relative, slopes, segment, normals, is_plane, slack)
    return DevelopedRail(
        rows[:, 0].astype(np.int64), rows[:, 1], rows[:, 2], np.cumsum(rows[:, 3]), area, back
    )


@compiled
def _cross(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> tuple[float, float, float]:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@compiled
def _mean_normals(
    relative: FloatArray, slopes: FloatArray, segment: IndexArray, count: int
) -> FloatArray:
    """(k, 3): twice the vector area of the cone over each segment."""
    normals = np.zeros((count, 3))
    for cell in range(len(segment)):
        for i in range(len(NODES)):
            v = point_in_cell(relative[cell], NODES[i])
            n = _cross(v, point_in_cell(slopes[cell], NODES[i]))
            for j in range(3):
                normals[segment[cell], j] += WEIGHTS[i] * n[j]
    return normals


@compiled
def _panel(
    relative: FloatArray,
    slopes: FloatArray,
    low: float,
    high: float,
    normal: FloatArray,
    is_plane: bool,
) -> Panel:
    """Length, angle, area and backward angle between two places of one cell.

    In a plane angle and area are counted with their sign, and nothing is backward.
    """
    length = angle = area = back = 0.0
    half = 0.5 * (high - low)
    for i in range(len(NODES)):
        u = 0.5 * (low + high) + half * NODES[i]
        weight = half * WEIGHTS[i]
        v = point_in_cell(relative, u)
        slope = point_in_cell(slopes, u)
        n = _cross(v, slope)
        speed = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
        length += weight * np.sqrt(slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2)
        is_back = n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2] < 0.0
        if is_plane and is_back:
            speed, is_back = -speed, False
        area += 0.5 * weight * speed
        if square > 0.0:
            angle += weight * speed / square
            if is_back:
                back += weight * speed / square
    return length, angle, area, back


@compiled
def _radius(relative: FloatArray, u: float) -> float:
    v = point_in_cell(relative, u)
    return float(np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]))


@compiled
def _bulge(r0: float, r1: float, r2: float, angle1: float, angle2: float) -> float:
    """Distance of the middle one of three polar points from the segment between the others."""
    ux, uy = r2 * np.cos(angle1 + angle2) - r0, r2 * np.sin(angle1 + angle2)
    vx, vy = r1 * np.cos(angle1) - r0, r1 * np.sin(angle1)
    return float(gap_from_segment(ux, uy, vx, vy))


@compiled
def _is_settled(
    whole: Panel, left: Panel, right: Panel, radii: tuple[float, float, float], slack: Pair
) -> bool:
    """Whether halving a panel changed nothing that matters, and it is flat enough to draw.

    ``slack``: bulge and round-off, mm; ``radii``: at the panel's start, middle, end.
    """
    limit = ACCURACY * whole[0] + slack[1]
    reach = max(radii[0], radii[2])
    return bool(
        abs(left[0] + right[0] - whole[0]) <= limit
        and abs(left[1] + right[1] - whole[1]) * reach <= limit
        and abs(left[2] + right[2] - whole[2]) <= limit * reach
        and _bulge(radii[0], radii[1], radii[2], left[1], right[1]) <= slack[0]
    )


@compiled
def _integrate(
    relative: FloatArray,
    slopes: FloatArray,
    segment: IndexArray,
    normals: FloatArray,
    is_plane: NDArray[np.bool_],
    slack: Pair,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Panels so narrow that length, angle and area have settled and the flat curve is followed.

    Returns (l, 4) rows of segment, angle since its start, radius, length of the panel before;
    (k,) backward angles; (k,) areas.
    """
    rows = np.empty((1024, 4))
    back, area = np.zeros(len(normals)), np.zeros(len(normals))
    ends = np.empty(DEEPEST + 2)
    panels = np.empty((DEEPEST + 2, 4))
    depths = np.empty(DEEPEST + 2, dtype=np.int64)
    count, angle = 0, 0.0
    for cell in range(len(segment)):
        k = segment[cell]
        if cell > 0 and segment[cell - 1] != k:
            angle = 0.0
        curve, slope, normal = relative[cell], slopes[cell], normals[k]
        low, top = -1.0, 0
        ends[0], depths[0] = 1.0, 0
        panels[0] = np.array(_panel(curve, slope, -1.0, 1.0, normal, is_plane[k]))
        while top >= 0:
            high, depth = ends[top], depths[top]
            middle = 0.5 * (low + high)
            left = _panel(curve, slope, low, middle, normal, is_plane[k])
            right = _panel(curve, slope, middle, high, normal, is_plane[k])
            whole = (panels[top, 0], panels[top, 1], panels[top, 2], panels[top, 3])
            radii = (_radius(curve, low), _radius(curve, middle), _radius(curve, high))
            if depth < FIRST_DEPTH or (
                depth < DEEPEST and not _is_settled(whole, left, right, radii, slack)
            ):
                depths[top], depths[top + 1] = depth + 1, depth + 1
                panels[top], panels[top + 1] = np.array(right), np.array(left)
                ends[top + 1] = middle
                top += 1
                continue
            angle += left[1] + right[1]
            area[k] += left[2] + right[2]
            back[k] += left[3] + right[3]
            if count == len(rows):
                grown = np.empty((2 * count, 4))
                grown[:count] = rows
                rows = grown
            rows[count, 0], rows[count, 1] = k, angle
            rows[count, 2], rows[count, 3] = radii[2], left[0] + right[0]
            count += 1
            low = high
            top -= 1
    return rows[:count], back, area


@compiled
def place_chain(
    steps: NDArray[np.int8], angles: FloatArray, radii: FloatArray, start: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Lays triangles or cones side by side in the plane, each sharing its ruling with the last.

    Args:
        steps: (m+n-2,) int8: 0 where P goes on about the current point of Q, 1 the other way round.
        angles: (m+n-2,) float64, rad: polar angle of the triangle or cone at its apex.
        radii: (m+n-2,) float64, mm: length of the bridge that ends it.
        start: mm: length of the first bridge.

    Returns:
        (m, 2) and (n, 2) flat positions in mm, p[0] at the origin, q[0] above it; (m-1, 2) and
        (n-1, 2) unit directions from Q to P before each step of that rail. A bridge of zero length
        keeps the direction that the development gives it.
    """
    n = 1 + np.sum(steps)
    m = 2 + len(steps) - n
    p, q = np.zeros((m, 2)), np.zeros((n, 2))
    p_from, q_from = np.empty((m - 1, 2)), np.empty((n - 1, 2))
    x, y = 0.0, -1.0
    q[0, 1] = start
    i = j = 0
    for k in range(len(steps)):
        is_p = steps[k] == 0
        if is_p:
            p_from[i] = x, y
        else:
            q_from[j] = x, y
        cosine, sine = np.cos(angles[k]), np.sin(angles[k])
        if not is_p:
            sine = -sine
        x, y = x * cosine - y * sine, x * sine + y * cosine
        norm = np.hypot(x, y)
        x, y = x / norm, y / norm
        if is_p:
            i += 1
            p[i] = q[j, 0] + radii[k] * x, q[j, 1] + radii[k] * y
        else:
            j += 1
            q[j] = p[i, 0] - radii[k] * x, p[i, 1] - radii[k] * y
    return p, q, p_from, q_from


@compiled
def thinned(points: FloatArray, segment: IndexArray, slack: float) -> NDArray[np.bool_]:
    """Which points of a flat polyline stay (Douglas and Peucker, doi:10.3138/FM57-6770-U75U-7727).

    Args:
        points: (l + 1, 2) float64, mm: polyline; its first point belongs to no segment.
        segment: (l,) int64: the segment of each further point; the last one of each always stays.
        slack: mm; how far a point that is left out may lie from the line that replaces it.
    """
    keep = np.zeros(len(points), dtype=np.bool_)
    keep[0] = True
    ends = np.empty(len(points), dtype=np.int64)
    start = 0
    for k in range(len(segment)):
        if k + 1 < len(segment) and segment[k + 1] == segment[k]:
            continue
        top = 0
        ends[0] = k + 1
        while top >= 0:
            end = ends[top]
            gap, farthest = _farthest_between(points, start, end)
            if gap > slack:
                top += 1
                ends[top] = farthest
            else:
                keep[end] = True
                start = end
                top -= 1
    return keep


@compiled
def _farthest_between(points: FloatArray, start: int, end: int) -> tuple[float, int]:
    """Largest distance of the points between two others from the segment that joins these."""
    ux, uy = points[end, 0] - points[start, 0], points[end, 1] - points[start, 1]
    gap, farthest = 0.0, start
    for i in range(start + 1, end):
        vx, vy = points[i, 0] - points[start, 0], points[i, 1] - points[start, 1]
        distance = gap_from_segment(ux, uy, vx, vy)
        if distance > gap:
            gap, farthest = distance, i
    return gap, farthest

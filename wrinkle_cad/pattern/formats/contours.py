"""Contours with curves, for machines that want them: arcs (bulges) or one closed spline.

Both stay within the tolerance of the polyline, which itself stays within the chord tolerance of
the true outline. Where they would cross themselves, or gain nothing, the polyline is written.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from ezdxf.math import BSpline

from wrinkle_cad import settings
from wrinkle_cad.pattern.piece.flat import Indices
from wrinkle_cad.pattern.piece.outline import closed_turns
from wrinkle_cad.pattern.piece.piece import Floats
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths, row_lengths, segment_gaps
from wrinkle_cad.strip.portable import dot


def with_arcs(points: Floats, *, tolerance: float) -> Floats:
    """Returns a closed polygon with runs of vertices replaced by arcs.

    Args:
        points: (k, 2) mm, closed, counter-clockwise.
        tolerance: mm; no arc leaves its run of the polygon by more.

    Returns:
        (l, 3): x, y and the bulge of what follows (tangent of a quarter of the arc's angle).
    """
    ring, corners = _from_a_corner(points)
    rows: list[tuple[float, float, float]] = []
    first = 0
    while first < len(ring) - 1:
        stop = int(corners[np.searchsorted(corners, first, side="right")])
        last, bulge = _longest_arc(ring, first, stop, tolerance)
        rows.append((ring[first, 0], ring[first, 1], bulge))
        first = last
    made = np.array(rows)
    if not shapely.Polygon(_flattened(made)).is_valid:
        return np.column_stack((points, np.zeros(len(points))))
    return made


def closed_spline(points: Floats, *, tolerance: float) -> BSpline:
    """Returns one cubic spline along a closed polygon, with corners where that has corners.

    Args:
        points: (k, 2) mm, closed.
        tolerance: mm; the largest distance between the spline and the polygon.
    """
    ring, corners = _from_a_corner(points)
    smooth = _joined(
        [_fitted(ring[first : stop + 1], tolerance) for first, stop in pairwise(corners)]
    )
    outline = np.array([(point.x, point.y) for point in smooth.flattening(0.1 * tolerance)])
    if shapely.Polygon(outline[:-1]).is_valid:
        return smooth
    return _joined([_straight(ring)])


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """A cubic B-spline, clamped: (c, 2) controls, inner knots, last knot (the first is 0)."""

    controls: Floats
    inner: Floats
    last: float


def _joined(runs: Sequence[_Run]) -> BSpline:
    """Returns runs that meet end to end as one spline: a knot of three allows a corner there."""
    controls = np.vstack([runs[0].controls[:1], *(run.controls[1:] for run in runs)])
    knots: list[float] = [0.0] * 4
    start = 0.0
    for run in runs:
        knots.extend(start + run.inner)
        start += run.last
        knots.extend([start] * 3)
    knots.append(start)
    return BSpline([(x, y, 0.0) for x, y in controls], order=4, knots=knots)


def _fitted(run: Floats, tolerance: float) -> _Run:
    """Returns a smooth spline through every eighth, fourth, second or each vertex, if one fits."""
    # Only here is scipy needed, and only on request: it costs a fifth of a second to load.
    from scipy.interpolate import BSpline

    line = shapely.LineString(run)
    walked = arc_lengths(run)
    dense = np.linspace(0.0, walked[-1], 8 * len(run))
    for stride in (8, 4, 2, 1):
        index = np.unique(np.append(np.arange(0, len(run), stride), len(run) - 1))
        if len(index) < 4:
            continue
        knots, poles = cubic_through(walked[index], run[index])
        made = shapely.LineString(BSpline(knots, poles, 3)(dense))
        if shapely.hausdorff_distance(made, line) <= tolerance:
            return _Run(poles, knots[4:-4], float(walked[-1]))
    return _straight(run)


def _straight(run: Floats) -> _Run:
    """Returns a polyline as a cubic spline: each segment's controls stand at its thirds."""
    steps = np.diff(run, axis=0)
    thirds = run[:-1, None] + steps[:, None] * (np.array((1.0, 2.0, 3.0)) / 3.0)[:, None]
    knots = arc_lengths(run)[1:]
    return _Run(
        np.vstack((run[:1], thirds.reshape(-1, 2))), np.repeat(knots[:-1], 3), float(knots[-1])
    )


def _from_a_corner(points: Floats) -> tuple[Floats, Indices]:
    """Returns the ring rolled to start at its sharpest corner and closed, and its corners."""
    turn = np.abs(closed_turns(points))
    first = int(np.argmax(turn))
    ring = np.roll(points, -first, axis=0)
    is_corner = np.roll(turn, -first) > settings.PATTERN_CORNER
    is_corner[0] = True
    corners = np.append(np.flatnonzero(is_corner), len(ring))
    return np.vstack((ring, ring[:1])), corners


def _longest_arc(ring: Floats, first: int, stop: int, tolerance: float) -> tuple[int, float]:
    """Returns the last vertex of the longest arc from ``first``, up to ``stop``, and its bulge."""
    best, bulge = first + 1, 0.0
    reach = 2
    while first + reach <= stop:
        trial = _arc_bulge(ring[first : first + reach + 1], tolerance)
        if trial is None:
            break
        best, bulge = first + reach, trial
        reach += 1
    return best, bulge


def _arc_bulge(run: Floats, tolerance: float) -> float | None:
    """Returns the bulge of the arc through the ends and the middle of a run, None if it misses."""
    chord = run[-1] - run[0]
    length = float(np.hypot(*chord))
    if length < tolerance:
        return None
    along = chord / length
    across = np.array((along[1], -along[0]))
    away = run - run[0]
    x, y = dot(away, along) - 0.5 * length, dot(away, across)
    x_mid, rise = x[len(run) // 2], y[len(run) // 2]
    # The circle through (-c, 0), (c, 0) and the middle vertex: x^2 + y^2 - 2 e y = c^2.
    half = 0.5 * length
    if abs(rise) < 1e-12 * length:
        return 0.0 if float(np.abs(y).max()) <= tolerance else None
    centre = (x_mid**2 + rise**2 - half**2) / (2.0 * rise)
    radius = float(np.hypot(half, centre))
    # A segment is furthest from the circle at an end or where it is nearest to the centre.
    from_centre = np.column_stack((x, y - centre))
    nearest = segment_gaps((0.0, 0.0), from_centre[:-1], from_centre[1:])
    reach = np.concatenate((row_lengths(from_centre), nearest))
    if float(np.abs(reach - radius).max()) > tolerance:
        return None
    # The arc bulges to the side of the middle vertex; no more than half a circle at once.
    sagitta = radius - abs(centre) if centre * rise <= 0.0 else radius + abs(centre)
    bulge = sagitta / half
    return None if bulge > 1.0 else float(np.copysign(bulge, rise))


def _flattened(rows: Floats) -> Floats:
    """Returns the polygon (k, 2) of bulged vertices, eight chords to an arc."""
    after = np.roll(rows[:, :2], -1, axis=0)
    points: list[Floats] = []
    for start, stop, bulge in zip(rows[:, :2], after, rows[:, 2], strict=True):
        share = np.linspace(0.0, 1.0, 8, endpoint=False)[:, None] if bulge else np.zeros((1, 1))
        chord = stop - start
        across = np.array((chord[1], -chord[0]))
        # Exact only for small bulges; enough to see whether neighbours cross.
        points.append(start + share * chord + 2.0 * bulge * share * (1.0 - share) * across)
    return np.vstack(points)

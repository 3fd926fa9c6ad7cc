"""Vertices that a rail needs because of the other rail of its strip.

A straight rail has two vertices by its chord error alone. Opposite a tab or a wave of the other
rail all rulings then gather at these two, and where the tab is flat no triangulation exists that
does not fold. So a rail gets a vertex opposite each corner of the other one, and chords that are
long against the distance between the rails, or opposite much turning, or along which the other rail
winds about this one, are split. Both rails are judged by the samples they have on their own: the
order in which they are treated does not matter, nor which is P, nor which way they run.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.portable import atan2, dot

from .chebyshev import FloatArray, PointAt, evaluate
from .nearest import nearest_on_polyline
from .polyline import arc_lengths, points_at, segment_lengths, turnings
from .sampling import Samples, largest_gaps, sample_curve

CORNER: Final = math.radians(20.0)
"""A vertex that turns its rail by more than this needs a counterpart on the other rail ..."""
CORNER_REACH: Final = 0.1
"""... unless one is there, within this share of the distance between the rails."""
TURN_PER_PART: Final = math.radians(45.0)
"""So much turning of the other rail is opposite one chord at most."""
TWIST_PER_PART: Final = math.radians(15.0)
"""So much turn of the way to the other rail, about this one, is over one chord at most."""
STEEP: Final = 0.3
"""A way to the other rail that leaves this one at a smaller sine has no turn about it."""
WIDTH_SHARE: Final = 0.25
"""Near pinched ends distances count as this share of the strip's largest width."""
OPPOSITE_CHORDS: Final = 1.5
"""A chord is not split below so many chords of the other rail: rails of one shape that lie close
together are sampled alike on their own."""
CLOSEST: Final = 0.05
"""New vertices keep this share of the distance between the rails from each other."""
LOOKS: Final = (8, 64)
"""A chord is looked at in so many places: one that may become few parts, and one of many."""
ZOOM: Final = 8
"""A place on a chord is looked for among so many stretches of the curve ..."""
ZOOMS: Final = 3
"""... so many times over, and then on the straight line."""
FEW_PARTS: Final = 8
SAME_PLACE: Final = 1e-9
"""Places along a rail closer than this share of its length are one place."""
PART_SLACK: Final = 1e-6
"""A measure this far above a whole number is that number: round-off must not add a part."""


def sample_against(
    point_at: PointAt, samples: Samples, other: FloatArray, tolerance: float
) -> Samples:
    """Adds the vertices that a rail needs because of the other rail of its strip.

    A corner of the other rail puts the place nearest to it on this one, unless a vertex lies within
    a tenth of the distance there. Then chords are split into parts of equal measure, at most 1
    each: the integral of ds / h, with h the distance from the other rail, but at least a quarter of
    the strip's largest width and one and a half chords of the other rail there; and the turning
    of the other rail at the vertices opposite, in units of 45 degrees. Or, where that is more, how
    far the way to the other rail turns about this one, in units of 15 degrees: two skew lines.

    Args:
        point_at: the rail, from (k,) float64 parameters to (k, 3) points in mm.
        samples: of the rail on its own, as ``sample_curve`` makes them.
        other: (l, 3) float64, mm: samples of the other rail on its own.
        tolerance: mm; largest distance from a curve point to its chord, as for ``samples``.

    Returns:
        The given vertices and the new ones; the given object if there are none. Nothing is added
        where a rail is a point or the rails nowhere differ.

    >>> def line(t):
    ...     return np.stack((t, 0 * t, 0 * t), axis=1)
    >>> tab = np.array([[0.0, 30, 0], [50, 30, 0], [60, 50, 0], [70, 30, 0], [120, 30, 0]])
    >>> alone = sample_curve(line, (0.0, 120.0), 0.05)
    >>> sample_against(line, alone, tab, 0.05).parameters.tolist()
    [0.0, 50.0, 60.0, 70.0, 120.0]
    """
    return with_places(point_at, samples, _wanted_places(samples.points, other), tolerance)


def with_places(
    point_at: PointAt, samples: Samples, places: FloatArray, tolerance: float
) -> Samples:
    """Adds vertices to a rail at given lengths along its chords.

    Args:
        point_at: the rail, from (k,) float64 parameters to (k, 3) points in mm.
        samples: of the rail.
        places: (r,) float64, mm along the chords from the start, none at a vertex: the new vertices
            are the curve points whose feet on their chords stand there.
        tolerance: mm; largest distance from a curve point to its chord, as for ``samples``.

    Returns:
        The given vertices and the new ones, and more where a part of a chord would break the
        tolerance; the given object if there are no places.

    Example:
        >>> def parabola(t):
        ...     return np.stack((t, t * t, 0 * t), axis=1)
        >>> chord = Samples(np.array([0.0, 1.0]), parabola(np.array([0.0, 1.0])))
        >>> with_places(parabola, chord, np.array([np.sqrt(0.5)]), 1.0).parameters.round(3).tolist()
        [0.0, 0.618, 1.0]
    """
    if not len(places):
        return samples
    chord, share = _chords_of(samples.points, places)
    new = _parameters_at(point_at, samples, chord, share)
    parameters = np.unique(np.concatenate((samples.parameters, new)))
    found = _within(point_at, parameters, tolerance)
    # Where rails meet their ends were moved onto one point.
    points = found.points.copy()
    points[np.searchsorted(found.parameters, samples.parameters)] = samples.points
    return Samples(found.parameters, points)


def _wanted_places(line: FloatArray, other: FloatArray) -> FloatArray:
    """(r,) mm along a line, increasing: where it needs further vertices."""
    nothing = np.zeros(0)
    if len(line) < 2 or len(other) < 2:
        return nothing
    arc = arc_lengths(line)
    found = nearest_on_polyline(other, line)
    gap = found.distance
    width = max(float(gap.max()), float(nearest_on_polyline(line, other).distance.max()))
    if width <= SAME_PLACE * float(arc[-1]):
        return nothing
    feet = arc[found.segment] + found.share * np.diff(arc)[found.segment]
    turning = turnings(other)
    corners = _corner_feet(arc, feet[turning > CORNER], gap[turning > CORNER])
    knots = np.sort(np.concatenate((arc, corners)))
    parts = _split(line, other, knots, WIDTH_SHARE * width, feet, turning)
    if len(parts):
        reach = CLOSEST * nearest_on_polyline(points_at(line, arc, parts), other).distance
        parts = _apart(parts, reach, knots)
    return np.sort(np.concatenate((corners, parts)))


def _corner_feet(arc: FloatArray, feet: FloatArray, gap: FloatArray) -> FloatArray:
    """The places opposite corners where there is no vertex yet, increasing."""
    nearest = np.array([float(np.min(np.abs(arc - foot))) for foot in feet])
    missing = nearest >= np.maximum(CORNER_REACH * gap, SAME_PLACE * arc[-1])
    order = np.argsort(feet[missing], kind="stable")
    return _merged(feet[missing][order], CLOSEST * gap[missing][order])


def _merged(places: FloatArray, reach: FloatArray) -> FloatArray:
    """Replaces runs of places within reach of each other by their middle."""
    if not len(places):
        return places
    near = np.diff(places) <= np.minimum(reach[:-1], reach[1:])
    first = np.flatnonzero(np.concatenate(([True], ~near)))
    last = np.concatenate((first[1:] - 1, [len(places) - 1]))
    middle: FloatArray = 0.5 * (places[first] + places[last])
    return middle


def _apart(places: FloatArray, reach: FloatArray, knots: FloatArray) -> FloatArray:
    """Leaves out places too close to a knot and merges those too close to each other."""
    after = np.searchsorted(knots, places, side="right")
    before, behind = knots[after - 1], knots[np.minimum(after, len(knots) - 1)]
    limit = np.minimum(reach, CLOSEST * (behind - before))
    free = (places - before >= limit) & (behind - places >= limit)
    merged = [
        _merged(places[free & (after == k)], reach[free & (after == k)])
        for k in np.unique(after[free])
    ]
    return np.concatenate((np.zeros(0), *merged))


def _split(
    line: FloatArray,
    other: FloatArray,
    knots: FloatArray,
    least: float,
    feet: FloatArray,
    turning: FloatArray,
) -> FloatArray:
    """The places that split the stretches between knots into parts of measure at most 1."""
    length = np.diff(knots)
    slack = SAME_PLACE * knots[-1]
    inside = np.searchsorted(knots, feet, side="right") - 1
    inside = np.clip(inside, 0, len(length) - 1)
    turns = (feet - knots[inside] > slack) & (knots[inside + 1] - feet > slack) & (turning > 0.0)
    owner, place, parts = inside[turns], feet[turns], turning[turns] / TURN_PER_PART
    most = length / least + np.bincount(owner, parts, len(length))
    found = []
    for looks, mine in zip(LOOKS, (most <= FEW_PARTS, most > FEW_PARTS), strict=True):
        chosen = np.flatnonzero(mine & (most > 1.0))
        if not len(chosen):
            continue
        row = np.full(len(length), -1)
        row[chosen] = np.arange(len(chosen))
        grows, winds = _lengths_measure(line, other, knots, chosen, looks, least)
        is_here = row[owner] >= 0
        _add_turns(
            grows,
            row[owner][is_here],
            ((place - knots[owner]) / length[owner])[is_here],
            parts[is_here],
        )
        more = np.cumsum(winds, axis=1)[:, -1] > np.cumsum(grows, axis=1)[:, -1]
        grows[more] = winds[more]
        measure = np.concatenate((np.zeros((len(chosen), 1)), np.cumsum(grows, axis=1)), axis=1)
        for k, stretch in enumerate(chosen):
            count = math.ceil(measure[k, -1] - PART_SLACK)
            levels = measure[k, -1] * np.arange(1, count) / count
            shares = np.interp(levels, measure[k], np.arange(looks + 1) / looks)
            found.append(knots[stretch] + shares * length[stretch])
    return np.sort(np.concatenate((np.zeros(0), *found)))


def _lengths_measure(
    line: FloatArray,
    other: FloatArray,
    knots: FloatArray,
    chosen: NDArray[np.int64],
    looks: int,
    least: float,
) -> tuple[FloatArray, FloatArray]:
    """(c, looks) each, for bins of chosen stretches: the integral of ds / h, the turn about."""
    length = np.diff(knots)[chosen]
    places = knots[chosen][:, None] + length[:, None] * (np.arange(looks + 1) / looks)
    found = nearest_on_polyline(points_at(line, arc_lengths(line), places.ravel()), other)
    opposite = segment_lengths(other)
    # At a vertex of the other rail both of its chords are opposite.
    after = np.minimum(found.segment + (found.share >= 1.0 - SAME_PLACE), len(opposite) - 1)
    before = np.maximum(found.segment - (found.share <= SAME_PLACE), 0)
    coarse = np.maximum(opposite[before], opposite[after])
    rate = 1.0 / np.maximum(np.maximum(found.distance, least), OPPOSITE_CHORDS * coarse)
    rate = rate.reshape(len(chosen), looks + 1)
    grows: FloatArray = 0.5 * (rate[:, 1:] + rate[:, :-1]) * (length / looks)[:, None]
    points = points_at(line, arc_lengths(line), places.ravel())
    start, end = other[found.segment], other[found.segment + 1]
    way = start + found.share[:, None] * (end - start) - points
    along = np.diff(points.reshape(len(chosen), looks + 1, 3)[:, [0, -1]], axis=1)
    winds = _turns_about(way.reshape(len(chosen), looks + 1, 3), along, least) / TWIST_PER_PART
    return grows, winds


def _turns_about(way: FloatArray, along: FloatArray, least: float) -> FloatArray:
    """(c, looks) rad: how far ways (c, looks + 1, 3) turn about a direction (c, 1, 3) in each bin.

    Where the rails are closer than ``least`` it counts by as much less.
    """
    along = along / np.sqrt(dot(along, along))[..., None]
    across = way - dot(way, along)[..., None] * along
    reach, width = np.sqrt(dot(way, way)), np.sqrt(dot(across, across))
    before, after = across[:, :-1], across[:, 1:]
    sine = dot(np.cross(before, after), np.broadcast_to(along, before.shape))
    turn = np.abs(atan2(sine, dot(before, after)))
    known = (width > STEEP * reach) & (width > 0.0)
    share = np.where(known, np.minimum(reach / least, 1.0), 0.0)
    turned: FloatArray = turn * np.minimum(share[:, :-1], share[:, 1:])
    return turned


def _add_turns(
    grows: FloatArray, row: NDArray[np.int64], share: FloatArray, parts: FloatArray
) -> None:
    """Spreads each turn over the two bins whose middles it lies between."""
    looks = grows.shape[1]
    middle = np.clip(share * looks - 0.5, 0.0, looks - 1.0)
    low = np.minimum(middle.astype(np.int64), looks - 2)
    np.add.at(grows, (row, low), (1.0 - (middle - low)) * parts)
    np.add.at(grows, (row, low + 1), (middle - low) * parts)


def _chords_of(line: FloatArray, places: FloatArray) -> tuple[NDArray[np.int64], FloatArray]:
    """(r,) the chord and (r,) the share of it of places along a line."""
    arc = arc_lengths(line)
    chord = np.clip(np.searchsorted(arc, places, side="right") - 1, 0, len(arc) - 2)
    return chord, (places - arc[chord]) / np.diff(arc)[chord]


def _parameters_at(
    point_at: PointAt, samples: Samples, chord: NDArray[np.int64], share: FloatArray
) -> FloatArray:
    """(r,): parameters of the curve points whose feet on their chords stand at the shares."""
    start, step = samples.points[chord], samples.points[chord + 1] - samples.points[chord]
    square = dot(step, step)
    low, high = samples.parameters[chord], samples.parameters[chord + 1]
    for _ in range(ZOOMS):
        grid = low[:, None] + (high - low)[:, None] * (np.arange(ZOOM + 1) / ZOOM)
        grid[:, -1] = high
        arm = evaluate(point_at, grid.ravel()).reshape(len(chord), ZOOM + 1, 3) - start[:, None]
        along = dot(arm, step[:, None]) / square[:, None]
        passed = np.count_nonzero(along[:, 1:-1] < share[:, None], axis=1)
        rows = np.arange(len(chord))
        low, high = grid[rows, passed], grid[rows, passed + 1]
        before, after = along[rows, passed], along[rows, passed + 1]
    rise = np.maximum(after - before, np.finfo(np.float64).tiny)
    found: FloatArray = low + np.clip((share - before) / rise, 0.0, 1.0) * (high - low)
    return found


def _within(point_at: PointAt, parameters: FloatArray, tolerance: float) -> Samples:
    """Samples at the parameters, and more where a part of a chord breaks the tolerance.

    A curve that waves about its chord can be farther from a part of it than from the whole.
    """
    points = evaluate(point_at, parameters)
    gaps = largest_gaps(point_at, parameters, points)
    wide = np.flatnonzero(gaps > tolerance)
    if not len(wide):
        return Samples(parameters, points)
    finer = [
        sample_curve(point_at, (float(parameters[k]), float(parameters[k + 1])), tolerance)
        for k in wide
    ]
    inner = np.concatenate([piece.parameters[1:-1] for piece in finer])
    parameters = np.unique(np.concatenate((parameters, inner)))
    return Samples(parameters, evaluate(point_at, parameters))

"""Where two curves meet: halved against each other until the bounds of their chords decide.

A piece of a curve lies within its bulge of its chord. Pieces whose chords are further apart than
both bulges and the distance asked for do not meet; pieces whose chords and bulges together stay
within that distance do. What lies between is halved, the longer piece first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.compiled import compiled

from .chebyshev import PointAt, fit_cells, point_in_cells
from .sampling import Samples

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

_CURVE_ACCURACY: Final = 1e-11
"""Polynomials follow the curves to this share of their extent."""
_BULGE_MARGIN: Final = 1.5
"""A piece bulges at most so many times as far as at the three places looked at."""
_RESOLUTION: Final = 2e-3
"""Stretches are told to this share of the shorter curve."""
_REFINEMENTS: Final = 45
"""Halvings that narrow down a place."""

_Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Meeting:
    """A stretch over which two curves are no further apart than the distance asked for.

    Example:
        >>> from wrinkle_cad.strip import sample_curve
        >>> across = lambda t: np.stack((t, 0 * t, 0 * t), axis=1)
        >>> along = lambda t: np.stack((0.5 + 0 * t, t - 0.5, 0 * t), axis=1)
        >>> samples = [sample_curve(curve, (0.0, 1.0), 0.01) for curve in (across, along)]
        >>> [round(meeting.p_start, 2) for meeting in meetings_of(across, along, *samples, 1e-6)]
        [0.5]
    """

    p_start: float
    """Parameter of the first curve where it begins, exact to a 500th of the curve."""
    p_end: float
    """... and where it ends."""
    q_start: float
    """Lowest parameter of the second curve there."""
    q_end: float
    """... and the highest."""
    point: tuple[float, float, float]
    """mm; the place on the first curve where they are nearest at the beginning."""
    end_point: tuple[float, float, float]
    """mm; likewise at the end."""


class _Rail(NamedTuple):
    """A curve as polynomials, and where its chords end."""

    parameters: Floats
    edges: Floats
    coefficients: Floats


class _Piece(NamedTuple):
    """A piece of a curve: the ends of its chord, and how far it may leave it, mm."""

    first: _Point
    last: _Point
    bulge: float


def meetings_of(
    p_at: PointAt, q_at: PointAt, p_samples: Samples, q_samples: Samples, distance: float
) -> tuple[Meeting, ...]:
    """Returns where two curves meet, in the order of the first one.

    Args:
        p_at: the first curve, from (k,) parameters to (k, 3) points in mm.
        q_at: the second curve.
        p_samples: samples of the first curve, its corners among them; one sample stands for a
            curve that is a point.
        q_samples: samples of the second curve, likewise.
        distance: mm, above 0; curves no further apart than this meet.

    Example:
        >>> import numpy as np
        >>> from wrinkle_cad.strip.curve.meetings import meetings_of
        >>> from wrinkle_cad.strip.curve.sampling import Samples
        >>> def line(start, end):
        ...     ends = np.array([start, end], dtype=float)
        ...     return lambda u: ends[0] + u[:, None] * (ends[1] - ends[0])
        >>> p_at, q_at = line((0, 0, 0), (100, 20, 0)), line((0, 20, 0), (100, 0, 0))
        >>> u = np.array([0.0, 1.0])
        >>> (place,) = meetings_of(p_at, q_at, Samples(u, p_at(u)), Samples(u, q_at(u)), 1e-6)
        >>> [round(x, 6) for x in place.point]
        [50.0, 10.0, 0.0]
    """
    p, q = _as_rail(p_at, p_samples), _as_rail(q_at, q_samples)
    lengths = [
        float(np.sqrt((np.diff(samples.points, axis=0) ** 2).sum(axis=1)).sum())
        for samples in (p_samples, q_samples)
    ]
    size = _RESOLUTION * min(length for length in lengths if length > 0.0)
    rows = _near_pieces(p, q, distance, size)
    groups = _groups_of(rows)
    found = [_meeting(rows[groups == number], p, q) for number in np.unique(groups)]
    return tuple(sorted(found, key=lambda meeting: (meeting.p_start, meeting.q_start)))


def _as_rail(curve: PointAt, samples: Samples) -> _Rail:
    if len(samples.parameters) == 1:
        at = float(samples.parameters[0])
        ends = np.array([at, at])
        return _Rail(ends, np.array([at, at + 1.0]), samples.points.reshape(1, 1, 3).copy())
    parameters = np.array(samples.parameters)
    cells = fit_cells(curve, parameters, math.inf, share_of_extent=_CURVE_ACCURACY)
    return _Rail(parameters, cells.edges, cells.coefficients)


def _meeting(rows: Floats, p: _Rail, q: _Rail) -> Meeting:
    """Returns the meeting that rows of pieces, all of one stretch, make up."""
    first, last = rows[np.argmin(rows[:, 0])], rows[np.argmax(rows[:, 1])]
    start, end = np.array(_nearest(p, q, first)), np.array(_nearest(p, q, last))
    return Meeting(
        float(rows[:, 0].min()),
        float(rows[:, 1].max()),
        float(rows[:, 2].min()),
        float(rows[:, 3].max()),
        (float(start[0]), float(start[1]), float(start[2])),
        (float(end[0]), float(end[1]), float(end[2])),
    )


@compiled
def _near_pieces(p: _Rail, q: _Rail, distance: float, size: float) -> Floats:
    """(k, 4) parameters of pieces not longer than a size that meet: of P, from and to, of Q."""
    rows, count = np.empty((64, 4)), 0
    p_pieces, q_pieces = _pieces(p), _pieces(q)
    stack = np.empty((256, 4))
    for i in range(len(p_pieces)):
        for j in range(len(q_pieces)):
            if _boxes_apart(p_pieces[i], q_pieces[j], distance):
                continue
            stack[0, 0], stack[0, 1] = p.parameters[i], p.parameters[i + 1]
            stack[0, 2], stack[0, 3] = q.parameters[j], q.parameters[j + 1]
            top = 0
            while top >= 0:
                u, u_end, v, v_end = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
                top -= 1
                a, b = _piece(p, u, u_end), _piece(q, v, v_end)
                verdict = _verdict(a, b, distance, size)
                if verdict < 0:
                    continue
                if verdict == 0 and top + 3 < len(stack):
                    top = _push_halves(stack, top, (u, u_end, v, v_end), _span(a) >= _span(b))
                    continue
                if count == len(rows):
                    rows = _doubled(rows)
                rows[count, 0], rows[count, 1] = u, u_end
                rows[count, 2], rows[count, 3] = v, v_end
                count += 1
    return rows[:count]


@compiled
def _doubled(rows: Floats) -> Floats:
    grown = np.empty((2 * len(rows), rows.shape[1]))
    for i in range(len(rows)):
        for k in range(rows.shape[1]):
            grown[i, k] = rows[i, k]
    return grown


@compiled
def _push_halves(
    stack: Floats, top: int, pieces: tuple[float, float, float, float], is_first: bool
) -> int:
    """Puts both halves of one of two pieces on a stack, the other piece beside each."""
    u, u_end, v, v_end = pieces
    middle = 0.5 * (u + u_end) if is_first else 0.5 * (v + v_end)
    for half in range(2):
        row = top + 1 + half
        stack[row, 0], stack[row, 1], stack[row, 2], stack[row, 3] = u, u_end, v, v_end
        stack[row, (1 if is_first else 3) - half] = middle
    return top + 2


@compiled
def _verdict(a: _Piece, b: _Piece, distance: float, size: float) -> int:
    """1 if two pieces meet and are short enough to tell where, -1 if they do not, else 0."""
    if _boxes_apart(a, b, distance):
        return -1
    gap, bulges = _chord_distance(a, b), a.bulge + b.bulge
    if gap - bulges > distance:
        return -1
    longer = max(_span(a), _span(b))
    if longer <= size and (gap + bulges <= distance or longer <= 1e-3 * distance):
        return 1
    return 0


@compiled
def _pieces(rail: _Rail) -> list[_Piece]:
    return [
        _piece(rail, rail.parameters[i], rail.parameters[i + 1])
        for i in range(len(rail.parameters) - 1)
    ]


@compiled
def _piece(rail: _Rail, start: float, end: float) -> _Piece:
    """A piece of a curve between two parameters."""
    first = point_in_cells(rail.edges, rail.coefficients, start)
    last = point_in_cells(rail.edges, rail.coefficients, end)
    bulge = 0.0
    if end > start:
        for k in range(1, 4):
            at = point_in_cells(rail.edges, rail.coefficients, start + 0.25 * k * (end - start))
            bulge = max(bulge, _point_from_chord(at, first, last))
    return _Piece(first, last, _BULGE_MARGIN * bulge)


@compiled
def _between(a: _Point, b: _Point) -> _Point:
    return (b[0] - a[0], b[1] - a[1], b[2] - a[2])


@compiled
def _dot(a: _Point, b: _Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _point_from_chord(at: _Point, first: _Point, last: _Point) -> float:
    way, off = _between(first, last), _between(first, at)
    square = _dot(way, way)
    share = 0.0 if square == 0.0 else min(1.0, max(0.0, _dot(way, off) / square))
    rest = (off[0] - share * way[0], off[1] - share * way[1], off[2] - share * way[2])
    return math.sqrt(_dot(rest, rest))


@compiled
def _span(piece: _Piece) -> float:
    way = _between(piece.first, piece.last)
    return math.sqrt(_dot(way, way))


@compiled
def _boxes_apart(a: _Piece, b: _Piece, distance: float) -> bool:
    """Whether the boxes around two pieces, bulges included, are further apart than asked for."""
    reach = distance + a.bulge + b.bulge
    for axis in range(3):
        if min(a.first[axis], a.last[axis]) - max(b.first[axis], b.last[axis]) > reach:
            return True
        if min(b.first[axis], b.last[axis]) - max(a.first[axis], a.last[axis]) > reach:
            return True
    return False


@compiled
def _chord_distance(a: _Piece, b: _Piece) -> float:
    """Distance in mm between the chords of two pieces (Ericson, Real-time collision detection)."""
    first, second = _between(a.first, a.last), _between(b.first, b.last)
    base = _between(b.first, a.first)
    d11, d22, d12 = _dot(first, first), _dot(second, second), _dot(first, second)
    b1, b2 = _dot(first, base), _dot(second, base)
    spread = d11 * d22 - d12 * d12
    s = 0.0
    if spread > 1e-14 * d11 * d22:
        s = min(1.0, max(0.0, (d12 * b2 - b1 * d22) / spread))
    t = (d12 * s + b2) / d22 if d22 > 0.0 else 0.0
    if t < 0.0 or t > 1.0 or d22 == 0.0:
        t = min(1.0, max(0.0, t))
        s = min(1.0, max(0.0, (d12 * t - b1) / d11)) if d11 > 0.0 else 0.0
    gap = (
        base[0] + s * first[0] - t * second[0],
        base[1] + s * first[1] - t * second[1],
        base[2] + s * first[2] - t * second[2],
    )
    return math.sqrt(_dot(gap, gap))


@compiled
def _nearest(p: _Rail, q: _Rail, row: Floats) -> tuple[float, float, float]:
    """The point of the first curve, mm, where a piece of it is nearest to one of the second."""
    u, u_end, v, v_end = row[0], row[1], row[2], row[3]
    for _ in range(_REFINEMENTS):
        middles = 0.5 * (u + u_end), 0.5 * (v + v_end)
        best, choice = np.inf, 0
        for k in range(4):
            ends = (u, middles[0]) if k % 2 == 0 else (middles[0], u_end)
            others = (v, middles[1]) if k < 2 else (middles[1], v_end)
            gap = _chord_distance(_piece(p, ends[0], ends[1]), _piece(q, others[0], others[1]))
            if gap < best:
                best, choice = gap, k
        u, u_end = (u, middles[0]) if choice % 2 == 0 else (middles[0], u_end)
        v, v_end = (v, middles[1]) if choice < 2 else (middles[1], v_end)
    point: tuple[float, float, float] = point_in_cells(p.edges, p.coefficients, u)
    return point


@compiled
def _groups_of(rows: Floats) -> Indices:
    """(k,): for each row, the least row that it hangs together with on both curves."""
    count = len(rows)
    groups = np.arange(count)
    order = np.argsort(rows[:, 0])
    for a in range(count):
        i = order[a]
        for b in range(a + 1, count):
            j = order[b]
            if rows[j, 0] > rows[i, 1]:
                break
            if rows[j, 2] <= rows[i, 3] and rows[i, 2] <= rows[j, 3]:
                low, high = groups[i], groups[j]
                if low != high:
                    keep, drop = min(low, high), max(low, high)
                    for k in range(count):
                        if groups[k] == drop:
                            groups[k] = keep
    return groups

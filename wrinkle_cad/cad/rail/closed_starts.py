"""Where two closed rails start: at places that their shape tells, not where their parameters begin.

A closed curve has no start of its own; where its parameter happens to begin says how it was drawn.
So both rails of a closed strip are started again: at their corners that are nearest to each other;
if one rail only has corners, at the corner that is nearest to the other rail, and at that corner's
foot; if none has, where the rails are nearest to each other.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.portable import dot

from .directrix import Directrix
from .feet import FOOT_STEPS, LOOKED_AT, foot_on, settled_foot, within
from .trimming import part_of

Floats = NDArray[np.float64]

PAIR_STEPS: Final = 100
"""Steps to the nearest places of two rails; where these touch three ways each is worth a third."""
BEND_STEP: Final = 1e-3
"""The bend of an edge at its end is taken over this share of it ..."""
ALONG: Final = 33
"""Points of an open rail that are looked for on a closed one."""
SAME_BEND: Final = 0.05
"""... and goes on in the next one if it differs by no more than this share."""


def are_closed(p: Directrix, q: Directrix) -> bool:
    """Tells whether both rails of a strip are closed; a rail that is a point is neither.

    Raises:
        InputError: one is closed and the other is open.
    """
    if p.is_point or q.is_point:
        return False
    if p.is_closed == q.is_closed:
        return p.is_closed
    closed, opened = (p, q) if p.is_closed else (q, p)
    if _runs_along(opened, closed):
        names = closed.name or "P", opened.name or "Q"
        raise InputError(
            f"Rail {names[0]} is closed, and P and Q coincide over {opened.length:.4g} mm: rail"
            f" {names[0]} runs along the whole of rail {names[1]} and back, as an offset does that"
            " was closed. Pass the other side alone, in build123d offset_2d(..., closed=False)."
        )
    raise InputError(
        f"Rail {closed.name or 'P'} is closed, but the ends of rail {opened.name or 'Q'} are"
        f" {_ends_apart(opened):.4g} mm apart. Both must be closed, or both open: close the one, or"
        " cut the other."
    )


def _runs_along(opened: Directrix, closed: Directrix) -> bool:
    """Whether a closed rail passes all places of an open one."""
    points = opened.point_at(np.linspace(*opened.interval, ALONG))
    feet = [foot_on(point, closed) for point in points]
    apart = row_lengths(closed.point_at(np.array(feet)) - points)
    return bool(apart.max() <= settings.RAILS_APART_PER_LENGTH * opened.length)


def _ends_apart(rail: Directrix) -> float:
    ends = rail.point_at(np.array(rail.interval))
    return float(row_lengths(ends[1:] - ends[:1])[0])


def started_alike(p: Directrix, q: Directrix) -> tuple[Directrix, Directrix]:
    """Returns two closed rails, each started where its shape and the other rail tell.

    Swapping the rails, drawing one from another start and moving both make no difference, unless
    several places are equally good: then either may be taken.

    Args:
        p: closed rail P.
        q: closed rail Q, which runs as P does.
    """
    p_start, q_start = _starts(p, q)
    return _rejoined(started_at(p, p_start)), _rejoined(started_at(q, q_start))


def _rejoined(rail: Directrix) -> Directrix:
    """The rail without the joints where it goes on as if there were none: a start that was left.

    Edges of one degree become one where velocity and bend go on; straight ones lose the joint.
    """
    if rail.is_polyline or len(rail.pieces) == 1:
        return rail
    pieces = [rail.pieces[0]]
    for piece in rail.pieces[1:]:
        if _goes_on(pieces[-1], piece):
            pieces[-1] = _one_of(pieces[-1], piece)
        else:
            pieces.append(piece)
    if len(pieces) == len(rail.pieces):
        return rail
    joints = {float(piece.knots[0]) for piece in rail.pieces[1:]}
    gone = joints - {float(piece.knots[0]) for piece in pieces[1:]}
    return replace(
        rail,
        pieces=tuple(pieces),
        curves=tuple(
            make_curve(piece.poles, piece.knots, piece.multiplicities, piece.degree, piece.weights)
            for piece in pieces
        ),
        breaks=tuple(mark for mark in rail.breaks if mark not in gone),
    )


def _goes_on(before: PoleCurve, after: PoleCurve) -> bool:
    if before.degree != after.degree:
        return False
    joint = float(after.knots[0])
    step = BEND_STEP * min(joint - float(before.knots[0]), float(after.knots[-1]) - joint)
    at = np.array([joint])
    v_before, v_after = before.velocity_at(at, "left"), after.velocity_at(at, "right")
    speed = float(row_lengths(v_before)[0])
    if float(row_lengths(v_after - v_before)[0]) > settings.RAIL_JUMP * speed:
        return False
    bends = (v_before - before.velocity_at(at - step), after.velocity_at(at + step) - v_after)
    apart = float(row_lengths(bends[1] - bends[0])[0])
    return apart <= SAME_BEND * float(row_lengths(bends[0])[0]) + settings.RAIL_JUMP * speed


def _one_of(before: PoleCurve, after: PoleCurve) -> PoleCurve:
    if before.degree > 1 or len(before.poles) > 2 or len(after.poles) > 2:
        return _joined(before, after)
    ends = np.array([before.knots[0], after.knots[-1]])
    poles = np.array([before.poles[0], after.poles[-1]])
    return PoleCurve(1, ends, np.array([2, 2]), poles, None)


def _starts(p: Directrix, q: Directrix) -> tuple[float, float]:
    p_corners, q_corners = corners_of(p), corners_of(q)
    if len(p_corners) and len(q_corners):
        apart = row_lengths(
            (p.point_at(p_corners)[:, None] - q.point_at(q_corners)[None]).reshape(-1, 3)
        )
        i, j = divmod(int(apart.argmin()), len(q_corners))
        return float(p_corners[i]), float(q_corners[j])
    if len(p_corners):
        return _corner_and_foot(p, p_corners, q)
    if len(q_corners):
        q_start, p_start = _corner_and_foot(q, q_corners, p)
        return p_start, q_start
    return _nearest_places(p, q)


def corners_of(directrix: Directrix) -> Floats:
    """Returns the parameters at which a closed rail turns sharply; its start among them is 0."""
    found = []
    for at in (directrix.interval[0], *directrix.breaks):
        before, after = _velocities(directrix, at)
        sizes = float(row_lengths(before)[0] * row_lengths(after)[0])
        if float(dot(before, after)[0]) < math.cos(settings.CLOSED_RAIL_CORNER) * sizes:
            found.append(at)
    return np.array(found, dtype=np.float64)


def _velocities(directrix: Directrix, at: float) -> tuple[Floats, Floats]:
    """Returns (1, 3) each: the derivatives just before and just after a parameter, around."""
    here = np.array([at])
    after = directrix.velocity_at(here)
    i = int(directrix.piece_at(here)[0])
    piece = directrix.pieces[i]
    if at <= piece.knots[0]:
        piece = directrix.pieces[i - 1]
        here = piece.knots[-1:]
    return piece.velocity_at(here, "left"), after


def _corner_and_foot(leader: Directrix, corners: Floats, other: Directrix) -> tuple[float, float]:
    points = leader.point_at(corners)
    feet = [foot_on(point, other) for point in points]
    gaps = row_lengths(points - other.point_at(np.array(feet)))
    best = int(gaps.argmin())
    return float(corners[best]), feet[best]


def _nearest_places(p: Directrix, q: Directrix) -> tuple[float, float]:
    grid = np.linspace(*p.interval, LOOKED_AT)[:-1]
    line = q.point_at(np.linspace(*q.interval, LOOKED_AT))
    at_p = float(grid[nearest_on_polyline(p.point_at(grid), line).distance.argmin()])
    at_q = foot_on(p.point_at(np.array([at_p]))[0], q)
    for _ in range(FOOT_STEPS):
        before = at_p, at_q
        at_p = settled_foot(q.point_at(np.array([at_q]))[0], p, at_p)
        at_q = settled_foot(p.point_at(np.array([at_p]))[0], q, at_q)
        if (at_p, at_q) == before:
            break
    return _squared_pair(p, q, at_p, at_q)


def _squared_pair(p: Directrix, q: Directrix, at_p: float, at_q: float) -> tuple[float, float]:
    """The places where the way between the rails stands square on both: Newton's method.

    Where rails run side by side feet come nearer and nearer, and never arrive.
    """
    best, found = math.inf, (at_p, at_q)
    for _ in range(PAIR_STEPS):
        at = np.array([at_p]), np.array([at_q])
        way = p.point_at(at[0]) - q.point_at(at[1])
        (v_p, a_p), (v_q, a_q) = (_motion(rail, u) for rail, u in zip((p, q), at, strict=True))
        off = float(dot(way, v_p)[0]), -float(dot(way, v_q)[0])
        size = math.hypot(*off)
        # A step along both rails leaves the valley a little; the next one comes back to it.
        if size < best:
            best, found = size, (at_p, at_q)
        own = float((dot(v_p, v_p) + dot(way, a_p))[0]), float((dot(v_q, v_q) - dot(way, a_q))[0])
        mixed = -float(dot(v_p, v_q)[0])
        scale = own[0] * own[1] - mixed * mixed
        if abs(scale) <= 1e-14 * abs(own[0] * own[1]):
            break
        at_p = within(p, at_p - (off[0] * own[1] - off[1] * mixed) / scale)
        at_q = within(q, at_q - (off[1] * own[0] - off[0] * mixed) / scale)
    return found


def _motion(rail: Directrix, at: Floats) -> tuple[Floats, Floats]:
    """(1, 3) each: velocity and acceleration."""
    step = 1e-5 * (rail.interval[1] - rail.interval[0])
    ends = [np.array([within(rail, float(at[0]) + way)]) for way in (-step, step)]
    acceleration = (rail.velocity_at(ends[1]) - rail.velocity_at(ends[0])) / (2.0 * step)
    return rail.velocity_at(at), acceleration


def started_at(directrix: Directrix, at: float) -> Directrix:
    """Returns a closed rail that starts and ends at the point with a given parameter.

    A rail given as points starts at that one of them that is next.

    Args:
        directrix: the rail; the point at u of the returned one is this one's at u + at, around.
        at: the parameter, in the rail's interval.
    """
    first, last = directrix.interval
    length = last - first
    if directrix.is_polyline:
        at = float(directrix.pieces[0].knots[np.searchsorted(directrix.pieces[0].knots, at)])
    at = first if min(at - first, last - at) <= settings.KNOT_GAP else at
    if at == first:
        return directrix
    seam = _seam_breaks(directrix)
    turned = sorted((mark - at) % length for mark in (*seam, *directrix.breaks))
    pieces = _turned_pieces(directrix, at)
    return replace(
        directrix,
        pieces=pieces,
        curves=tuple(
            make_curve(piece.poles, piece.knots, piece.multiplicities, piece.degree, piece.weights)
            for piece in pieces
        ),
        breaks=tuple(
            mark for mark in turned if settings.KNOT_GAP < mark < length - settings.KNOT_GAP
        ),
    )


def _seam_breaks(directrix: Directrix) -> tuple[float, ...]:
    """The rail's start, if edges meet there or the curve is not C1."""
    if len(directrix.pieces) > 1:
        return (directrix.interval[0],)
    before, after = _velocities(directrix, directrix.interval[0])
    speed = max(float(row_lengths(before)[0]), float(row_lengths(after)[0]))
    is_smooth = float(row_lengths(after - before)[0]) <= settings.RAIL_JUMP * speed
    return () if is_smooth else (directrix.interval[0],)


def _turned_pieces(directrix: Directrix, at: float) -> tuple[PoleCurve, ...]:
    """The edges from a parameter around to it again, their knots from 0 on."""
    length = directrix.interval[1] - directrix.interval[0]
    i = int(directrix.piece_at(np.array([at]))[0])
    piece = directrix.pieces[i]
    later = [_moved(other, -at) for other in directrix.pieces[i + 1 :]]
    earlier = [_moved(other, length - at) for other in directrix.pieces[:i]]
    if at - piece.knots[0] <= settings.KNOT_GAP:
        return (_moved(piece, -at), *later, *earlier)
    head = _moved(part_of(piece, at, float(piece.knots[-1])), -at)
    tail = _moved(part_of(piece, float(piece.knots[0]), at), length - at)
    if len(directrix.pieces) == 1:
        return (_joined(head, tail),)
    return (head, *later, *earlier, tail)


def _moved(piece: PoleCurve, by: float) -> PoleCurve:
    return replace(piece, knots=piece.knots + by)


def _joined(head: PoleCurve, tail: PoleCurve) -> PoleCurve:
    """One curve of two of the same degree, the second beginning where the first ends."""
    joint = [head.degree]
    multiplicities = np.concatenate((head.multiplicities[:-1], joint, tail.multiplicities[1:]))
    weights = None
    if head.weights is not None or tail.weights is not None:
        # A curve whose weights are all the same says so by having none.
        before = np.ones(len(head.poles)) if head.weights is None else head.weights
        after = np.ones(len(tail.poles)) if tail.weights is None else tail.weights
        weights = np.concatenate((before, after[1:] * (before[-1] / after[0])))
    return PoleCurve(
        head.degree,
        np.concatenate((head.knots, tail.knots[1:])),
        multiplicities,
        np.concatenate((head.poles, tail.poles[1:])),
        weights,
    )

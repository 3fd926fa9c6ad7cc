"""Fans in a row: where one ends and the next begins, exactly.

A fan begins and ends at rulings without twist. Its apex is the place at which the fan before it
ends, so in a row of fans each follows from the one before; only one apex of a row is free. It is
the one that lies at a corner or an end of a rail, or else that of a fan which begins or ends at a
corner of the rail that it runs along, or else the row's first. A ruling stays at such a corner.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from .between_nodes import place_without_twist, point_and_tangent
from .nodes import Nodes
from .pairing import FAN_P, FAN_Q, RULED
from .stations import Stations

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

SHORT_IN_NODES: Final = 3.0
"""A ruled stretch of so many nodes between two fans is the grid's, and falls away."""


@dataclass(slots=True)
class _Stretch:
    """A run of intervals of one way; of a fan, those about one apex."""

    way: int
    first: int
    last: int


@dataclass(slots=True)
class _Place:
    """A ruling between two stretches."""

    u: float
    v: float
    p_piece: int
    q_piece: int


def with_exact_fans(p: Nodes, q: Nodes, stations: Stations, spacing: float) -> Stations:
    """Returns the rulings with all fans moved so that they begin and end without twist.

    Where there is no such place near by, the fan stays, and the sheet is creased there.

    Args:
        p: nodes of P.
        q: nodes of Q.
        stations: rulings to within `spacing`.
        spacing: mm between the nodes they were found on.
    """
    if len(p.u) == 1 or len(q.u) == 1:
        return stations
    stretches = _without_short(p, q, _stretches(stations), stations, spacing)
    places = _places(stations, stretches)
    at = 0
    while at < len(stretches):
        last = at
        while last < len(stretches) and stretches[last].way != RULED:
            last += 1
        if last > at:
            _solve_row(p, q, stretches, places, (at, last))
        at = max(last, at + 1)
    return _laid_out(stations, stretches, places)


def _stretches(stations: Stations) -> list[_Stretch]:
    way = stations.way
    change = way[1:] != way[:-1]
    change |= (way[1:] == FAN_P) & (stations.u[2:] != stations.u[1:-1])
    change |= (way[1:] == FAN_Q) & (stations.v[2:] != stations.v[1:-1])
    bounds = [0, *(int(cut) + 1 for cut in np.flatnonzero(change)), len(way)]
    return [_Stretch(int(way[a]), a, b) for a, b in pairwise(bounds)]


def _without_short(
    p: Nodes, q: Nodes, stretches: list[_Stretch], stations: Stations, spacing: float
) -> list[_Stretch]:
    """Leaves out ruled stretches of a few nodes between a fan on P and one on Q."""
    p_arc, q_arc = np.interp(stations.u, p.u, p.arc), np.interp(stations.v, q.u, q.arc)
    kept = []
    for k, stretch in enumerate(stretches):
        between = 0 < k < len(stretches) - 1 and stretch.way == RULED
        if between and {stretches[k - 1].way, stretches[k + 1].way} == {FAN_P, FAN_Q}:
            a, b = stretch.first, stretch.last
            # A fan's own rail may have a corner at its apex; the one that it runs along may not.
            on_p, on_q = (b, a - 1) if stretches[k - 1].way == FAN_P else (a - 1, b)
            same = stations.p_piece[on_p] == stations.p_piece[a]
            same &= stations.q_piece[on_q] == stations.q_piece[a]
            moved = p_arc[b] - p_arc[a] + q_arc[b] - q_arc[a]
            if same and moved <= SHORT_IN_NODES * spacing:
                continue
        kept.append(stretch)
    return kept


def _places(stations: Stations, stretches: list[_Stretch]) -> list[_Place]:
    """The strip's first ruling, those between stretches, and its last one."""
    places = [_Place(float(stations.u[0]), float(stations.v[0]), 0, 0)]
    for before, after in pairwise(stretches):
        # The tangent of a rail counts on the side on which the rail is run along.
        p_side = before.last - 1 if before.way in (RULED, FAN_Q) else after.first
        q_side = before.last - 1 if before.way in (RULED, FAN_P) else after.first
        at = before.last
        places.append(
            _Place(
                float(stations.u[at]),
                float(stations.v[at]),
                int(stations.p_piece[p_side]),
                int(stations.q_piece[q_side]),
            )
        )
    places.append(_Place(float(stations.u[-1]), float(stations.v[-1]), 0, 0))
    return places


def _solve_row(
    p: Nodes,
    q: Nodes,
    stretches: list[_Stretch],
    places: list[_Place],
    row: tuple[int, int],
) -> None:
    """Moves the rulings between the fans of a row; fan k lies between places k and k + 1."""
    first, last = row
    fixed = {k for k in range(first, last) if _is_fixed(p, q, stretches[k], places[k])}
    held = None if fixed else _held_by_corner(p, q, stretches, places, row)
    known = fixed or {first if held is None else held}
    for k in sorted(known):
        _take_apex(stretches[k], places[k], places[k + 1])
    earliest = min(known)
    for k in range(earliest, last):
        # Where the next fan's apex stays as well there is nothing to move.
        if k + 1 < len(stretches) and k + 1 not in fixed:
            _solve(p, q, places[k + 1], along=stretches[k].way)
            if k + 1 < last:
                _take_apex(stretches[k + 1], places[k + 1], places[k + 2])
    for k in range(earliest, first - 1, -1):
        if k > 0:
            _solve(p, q, places[k], along=stretches[k].way)
            if k > first:
                _take_apex(stretches[k - 1], places[k], places[k - 1])


def _is_fixed(p: Nodes, q: Nodes, fan: _Stretch, place: _Place) -> bool:
    return _is_edge(p, place.u) if fan.way == FAN_P else _is_edge(q, place.v)


def _is_edge(rail: Nodes, at: float) -> bool:
    """Whether a place is a corner or an end of a rail."""
    return any(at in (piece[0][0], piece[0][-1]) for piece in rail.pieces)


def _held_by_corner(
    p: Nodes,
    q: Nodes,
    stretches: list[_Stretch],
    places: list[_Place],
    row: tuple[int, int],
) -> int | None:
    """The first or last fan of a row, if it begins or ends at a corner of the rail it runs along.

    On the corner's other side the strip is ruled: the apex is where that ends without twist.
    """
    first, last = row
    for fan, beside, at in ((first, first - 1, first), (last - 1, last, last)):
        if not 0 <= beside < len(stretches):
            continue
        way, place, beyond = stretches[fan].way, places[at], int(beside > fan)
        on_p, on_q = place.p_piece, place.q_piece
        on_p, on_q = (on_p, on_q + beyond) if way == FAN_P else (on_p + beyond, on_q)
        rail, corner = (q, place.v) if way == FAN_P else (p, place.u)
        if _is_edge(rail, corner) and on_p < len(p.pieces) and on_q < len(q.pieces):
            ruled = _Place(place.u, place.v, on_p, on_q)
            _solve(p, q, ruled, along=FAN_Q if way == FAN_P else FAN_P)
            place.u, place.v = ruled.u, ruled.v
            _take_apex(stretches[fan], place, places[fan + 1 - beyond])
            return fan
    return None


def _take_apex(fan: _Stretch, known: _Place, other: _Place) -> None:
    """Gives the place at a fan's other end its apex."""
    if fan.way == FAN_P:
        other.u = known.u
    else:
        other.v = known.v


def _solve(p: Nodes, q: Nodes, place: _Place, *, along: int) -> None:
    """Moves a ruling to where it has no twist, along the rail that a fan runs along."""
    if _is_edge(*((q, place.v) if along == FAN_P else (p, place.u))):
        return
    p_piece, q_piece = p.pieces[place.p_piece], q.pieces[place.q_piece]
    if along == FAN_P:
        other = point_and_tangent(*p_piece, place.u)
        place.v = place_without_twist(*q_piece, place.v, _step(q_piece), other)
    else:
        other = point_and_tangent(*q_piece, place.v)
        place.u = place_without_twist(*p_piece, place.u, _step(p_piece), other)


def _step(piece: tuple[Floats, Floats, Floats]) -> float:
    """The parameter's mean way over one node of a piece."""
    u = piece[0]
    return float(u[-1] - u[0]) / (len(u) - 1)


def _laid_out(stations: Stations, stretches: list[_Stretch], places: list[_Place]) -> Stations:
    """The rulings again, those inside a fan spread between its new ends."""
    us, vs = [np.array([places[0].u])], [np.array([places[0].v])]
    chosen = []
    for stretch, start, end in zip(stretches, places[:-1], places[1:], strict=True):
        inner = slice(stretch.first, stretch.last + 1)
        u, v = stations.u[inner].copy(), stations.v[inner].copy()
        if stretch.way == FAN_P:
            u[:], v = start.u, _spread(v, start.v, end.v)
        elif stretch.way == FAN_Q:
            u, v[:] = _spread(u, start.u, end.u), start.v
        else:
            u, v = np.clip(u, start.u, end.u), np.clip(v, start.v, end.v)
        u[-1], v[-1] = end.u, end.v
        us.append(u[1:])
        vs.append(v[1:])
        chosen.append(np.arange(stretch.first, stretch.last))
    at = np.concatenate(chosen)
    return Stations(
        np.maximum.accumulate(np.concatenate(us)),
        np.maximum.accumulate(np.concatenate(vs)),
        stations.p_piece[at],
        stations.q_piece[at],
        stations.way[at],
    )


def _spread(values: Floats, first: float, last: float) -> Floats:
    whole = values[-1] - values[0]
    if not whole > 0.0:
        return np.linspace(first, last, len(values))
    spread: Floats = first + (values - values[0]) * ((last - first) / whole)
    return spread

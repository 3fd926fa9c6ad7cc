"""Rulings that a designer holds: some that must be, and stretches that none may join.

A surface is found between the rulings that are held, as if it began and ended there. One that keeps
out of a stretch by itself is left alone; one that enters it is held at that corner of the stretch
around which the strip was found: since rulings go forward on both rails, none enters it then.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from .rail_curve import RailCurve
from .stations import Stations

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Place = tuple[float, float]
"""Parameters on P and on Q."""

SAME: Final = 1e-9
"""Parameters that differ by a smaller share of a rail's interval are one."""


@dataclass(frozen=True, slots=True)
class Held:
    """What is asked of the rulings, in parameters of the curves.

    >>> Held(pinned=((1.0, 2.0),)).around((10.0, 20.0)).pinned
    ((-9.0, -18.0), (1.0, 2.0), (11.0, 22.0), (21.0, 42.0))
    """

    pinned: tuple[Place, ...] = ()
    """Rulings that must be."""
    forbidden: tuple[tuple[float, float, float, float], ...] = ()
    """From and to on P, from and to on Q: between these no ruling has both its ends."""

    def around(self, periods: Place) -> Held:
        """The same on the turn before, on two turns and on the one behind, of closed rails."""
        a, b = periods
        turns = range(-1, 3)
        return Held(
            tuple((u + k * a, v + k * b) for k in turns for u, v in self.pinned),
            tuple(
                (u + k * a, last_u + k * a, v + k * b, last_v + k * b)
                for k in turns
                for u, last_u, v, last_v in self.forbidden
            ),
        )


NOTHING_HELD: Final = Held()
"""Where nothing is asked of the rulings."""


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """A part of a strip between two rulings that are held."""

    p: RailCurve
    """This part of P."""
    q: RailCurve
    """Of Q."""
    bridges: tuple[Floats, Floats]
    """(k,) float64 each; parameters of the bridges in it, its ends among them."""
    pieces: tuple[int, int]
    """The smooth pieces of the whole rails in which it begins."""


def places_between(p: RailCurve, q: RailCurve, pinned: Iterable[Place]) -> list[Place]:
    """Returns the first ruling, those that are held between, and the last, in order.

    Args:
        p: the curve.
        q: the curve.
        pinned: what is held, in any order; what lies beyond the curves is left out.
    """
    first, last = (tuple(float(rail.edges[k]) for rail in (p, q)) for k in (0, -1))
    found = {(first[0], first[1]), (last[0], last[1])}
    for u, v in pinned:
        place = _at_edge(p, u), _at_edge(q, v)
        if all(a <= x <= b for a, x, b in zip(first, place, last, strict=True)):
            found.add(place)
    return sorted(found)


def _at_edge(rail: RailCurve, u: float) -> float:
    """The parameter, or the end of a smooth piece if that is the same."""
    edge = float(rail.edges[int(np.abs(rail.edges - u).argmin())])
    return edge if abs(edge - u) <= SAME * (rail.edges[-1] - rail.edges[0]) else u


def sections_of(
    p: RailCurve, q: RailCurve, bridges: tuple[Floats, Floats], places: Sequence[Place]
) -> list[Section]:
    """Returns the parts of a strip between rulings in order.

    Args:
        p: the curve.
        q: the curve.
        bridges: (k,) float64 each; parameters of the whole strip's bridges.
        places: the rulings, from the strip's first to its last.
    """
    if len(places) == 2:
        return [Section(p, q, bridges, (0, 0))]
    sections = []
    for start, end in pairwise(places):
        inside = np.ones(len(bridges[0]), dtype=np.bool_)
        for at, low, high in zip(bridges, start, end, strict=True):
            inside &= (at >= low) & (at <= high)
        own = [
            np.concatenate(([low], at[inside], [high]))
            for at, low, high in zip(bridges, start, end, strict=True)
        ]
        parts = [_part(rail, low, high) for rail, low, high in zip((p, q), start, end, strict=True)]
        (p_part, p_piece), (q_part, q_piece) = parts
        sections.append(Section(p_part, q_part, (own[0], own[1]), (p_piece, q_piece)))
    return sections


def _part(rail: RailCurve, first: float, last: float) -> tuple[RailCurve, int]:
    """A rail between two parameters, and the smooth piece in which that begins."""
    piece = int(np.searchsorted(rail.edges, first, side="right")) - 1
    piece = min(max(piece, 0), len(rail.edges) - 2)
    return RailCurve(rail.point_at, rail.velocity_at, (first, last), rail.breaks), piece


def joined(sections: Sequence[Section], found: Sequence[Stations]) -> Stations:
    """Returns the rulings of all sections, those between two of them once."""
    if len(found) == 1:
        return found[0]
    return Stations(
        np.concatenate([found[0].u[:1], *(one.u[1:] for one in found)]),
        np.concatenate([found[0].v[:1], *(one.v[1:] for one in found)]),
        np.concatenate(
            [one.p_piece + part.pieces[0] for one, part in zip(found, sections, strict=True)]
        ),
        np.concatenate(
            [one.q_piece + part.pieces[1] for one, part in zip(found, sections, strict=True)]
        ),
        np.concatenate([one.way for one in found]),
    )


def held_rulings(rulings: Stations, places: Sequence[Place]) -> Ints:
    """Returns the numbers of the rulings between sections.

    Args:
        rulings: of all sections, joined.
        places: that they were made between.
    """
    at = [np.flatnonzero((rulings.u == u) & (rulings.v == v)) for u, v in places[1:-1]]
    return np.concatenate([np.zeros(0, dtype=np.int64), *at]).astype(np.int64)


def corners_entered(
    rulings: Stations,
    bridges: tuple[Floats, Floats],
    forbidden: Iterable[tuple[float, float, float, float]],
) -> list[Place]:
    """Returns the corners at which rulings are to be held that join forbidden stretches.

    Args:
        rulings: in order.
        bridges: (k,) float64 each; of a triangulation that keeps out of the stretches.
        forbidden: from and to on P, from and to on Q.
    """
    corners = []
    for u, last_u, v, last_v in forbidden:
        slack = SAME * (last_u - u), SAME * (last_v - v)
        is_in = (rulings.u > u + slack[0]) & (rulings.u < last_u - slack[0])
        is_in &= (rulings.v > v + slack[1]) & (rulings.v < last_v - slack[1])
        beside = (bridges[0] > u + slack[0]) & (bridges[0] < last_u - slack[0])
        if is_in.any() and beside.any():
            is_before = bool((bridges[1][beside] <= v + slack[1]).all())
            corners.append((last_u, v) if is_before else (u, last_v))
    return corners

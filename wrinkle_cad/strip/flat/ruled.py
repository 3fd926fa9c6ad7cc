"""A ruled piece laid flat: every length along its rails, and every angle between rail and ruling.

Let a ruling of length ``L`` be swept, and ``a`` and ``b`` be how fast its ends on P and on Q move
across it. In the plane it then turns to the right by ``(b - a) / L``, and its end on P moves along
it and across it as in space: both rails keep their lengths and their angles to every ruling. Where
every ruling has one tangent plane the whole surface is laid flat without strain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.portable import atan2, cos, sin
from wrinkle_cad.strip.rulings.family import RulingFamily
from wrinkle_cad.strip.rulings.vectors import crosses, dots, lengths, units

from .development import NODES, WEIGHTS

Floats = npt.NDArray[np.float64]

PANELS: Final = 4
"""Gauss and Legendre's rule is applied to so many parts of each stretch between exact rulings."""
NO_PLACES: Final = np.zeros(0)


def _integrals() -> Floats:
    """(11, 10): from values at ``NODES`` to integrals from -1 to each node, and to 1."""
    count = len(NODES)
    at = np.append(NODES, 1.0)
    legendre = [np.ones(count + 1), at]
    for n in range(1, count + 1):
        legendre.append(((2 * n + 1) * at * legendre[n] - n * legendre[n - 1]) / (n + 1))
    matrix = np.zeros((count + 1, count))
    for n in range(count):
        # The integral of the n-th polynomial of Legendre, from -1 on.
        rise = at + 1.0 if n == 0 else (legendre[n + 1] - legendre[n - 1]) / (2 * n + 1)
        matrix += (n + 0.5) * rise[:, None] * (WEIGHTS * legendre[n][:-1])[None, :]
    return matrix


_INTEGRALS: Final = _integrals()


@dataclass(frozen=True, slots=True, eq=False)
class FlatPiece:
    """A ruled piece in the plane."""

    places: Floats
    """(k,) float64; places of rulings along the piece, 0 to 1."""
    p: Floats
    """(k, 2) float64, mm; their ends on P."""
    q: Floats
    """(k, 2) float64, mm; their ends on Q."""
    angle: Floats
    """(k,) float64, rad; their direction from P to Q, from the x axis on."""
    p_arc: Floats
    """(k,) float64, mm; length along P from the piece's start."""
    q_arc: Floats
    """(k,) float64, mm; along Q."""
    area: float
    """mm2; of the flat piece."""

    @property
    def p_length(self) -> float:
        """mm; of the piece's stretch of P."""
        return float(self.p_arc[-1])

    @property
    def q_length(self) -> float:
        """mm; of its stretch of Q."""
        return float(self.q_arc[-1])


def lay_flat(
    family: RulingFamily, start: Floats, places: Floats = NO_PLACES, panels: int = PANELS
) -> FlatPiece:
    """Returns a ruled piece in the plane, Q on the left of P.

    Args:
        family: its rulings.
        start: (2, 2) float64, mm; where the first ruling's ends on P and on Q lie. Their distance
            is the ruling's length; of a first ruling without length the second point is not used,
            and it points along y.
        places: (k,) float64, from 0 to 1; of further rulings that the result is to have.
        panels: each stretch between exact rulings is integrated in so many parts.

    Example:
        >>> from wrinkle_cad.strip.rulings.rail_curve import RailCurve
        >>> def line(y):
        ...     return RailCurve(
        ...         lambda u: np.stack((u, 0 * u + y, 0 * u), axis=-1),
        ...         lambda u: np.stack((1 + 0 * u, 0 * u, 0 * u), axis=-1),
        ...         (0.0, 40.0),
        ...     )
        >>> ends, places = np.array([[0.0, 0.0], [40.0, 40.0]]), np.array([0.0, 1.0])
        >>> strap = RulingFamily(line(0), line(9), 0, 0, ends, places, 0 * places, 0 * places)
        >>> round(lay_flat(strap, np.array([[0.0, 0.0], [0.0, 9.0]])).area, 9)
        360.0
    """
    edges = np.union1d(_edges(family, panels), places)
    half = np.diff(edges)[:, None] / 2.0
    middle = (edges[:-1] + edges[1:])[:, None] / 2.0
    at = (middle + half * NODES).ravel()
    motion = _Motion(family, at)
    turned = _running(motion.turn, half)
    way = start[1] - start[0]
    begin = float(atan2(way[1], way[0])) if way.any() else np.pi / 2.0
    step = motion.p_step(begin + turned.inside.ravel())
    p = np.stack(
        [start[0][axis] + _running(step[:, axis], half).at_edges for axis in range(2)], axis=1
    )
    final = begin + turned.at_edges
    p_space, q_space = family.points_at(edges)
    reach = lengths(q_space - p_space)[:, None]
    q = p + reach * np.stack((cos(final), sin(final)), axis=1)
    p_arc, q_arc, area = (
        _running(values, half).at_edges for values in (motion.p_speed, motion.q_speed, motion.area)
    )
    return FlatPiece(edges, p, q, final, p_arc, q_arc, float(area[-1]))


def flat_rulings(family: RulingFamily, flat: FlatPiece, place: Floats) -> tuple[Floats, Floats]:
    """Returns (k, 2) mm each: where the ends on P and Q of rulings at (k,) places lie flat.

    Args:
        family: the piece's rulings.
        flat: the piece in the plane.
        place: (k,) float64, from 0 to 1.
    """
    cell = np.searchsorted(flat.places, place, side="right") - 1
    cell = np.clip(cell, 0, len(flat.places) - 2)
    half = (place - flat.places[cell])[:, None] / 2.0
    motion = _Motion(family, (flat.places[cell][:, None] + half * (1.0 + NODES)).ravel())
    turned = _parts(motion.turn, half)
    step = motion.p_step((flat.angle[cell][:, None] + turned[:, :-1]).ravel())
    moved = np.stack([_parts(step[:, axis], half)[:, -1] for axis in range(2)], axis=1)
    p, final = flat.p[cell] + moved, flat.angle[cell] + turned[:, -1]
    p_space, q_space = family.points_at(place)
    reach = lengths(q_space - p_space)[:, None]
    return p, p + reach * np.stack((cos(final), sin(final)), axis=1)


def _edges(family: RulingFamily, panels: int) -> Floats:
    share = np.arange(panels) / panels
    cells = family.places[:-1, None] + np.diff(family.places)[:, None] * share
    return np.append(cells.ravel(), family.places[-1])


class _Motion:
    """How the ends of rulings move, by the place, at (k,) places."""

    def __init__(self, family: RulingFamily, place: Floats) -> None:
        start, end = family.points_at(place)
        p, q = family.velocities_at(place)
        ruling = end - start
        reach, direction = lengths(ruling), units(ruling)
        self.p_along = dots(p, direction)
        p_normal, q_normal = crosses(p, direction), crosses(q, direction)
        self.p_across, q_across = lengths(p_normal), lengths(q_normal)
        self.p_speed, self.q_speed = lengths(p), lengths(q)
        # Forward is to the right of the ruling, so it turns to the right where Q moves faster.
        self.turn = np.divide(
            self.p_across - q_across, reach, out=np.zeros_like(reach), where=reach > 0.0
        )
        self.area = reach * (self.p_across + q_across) / 2.0

    def p_step(self, angle: Floats) -> Floats:
        """(k, 2) mm: how P's ends move in the plane, where the rulings have (k,) directions."""
        # Forward across a ruling is to its right: Q is on the left of P.
        ahead = np.stack((sin(angle), -cos(angle)), axis=1)
        along = np.stack((cos(angle), sin(angle)), axis=1)
        return self.p_along[:, None] * along + self.p_across[:, None] * ahead


@dataclass(frozen=True, slots=True, eq=False)
class _Running:
    """An integral from the start on."""

    inside: Floats
    """(c, 10); at the nodes of every panel."""
    at_edges: Floats
    """(c + 1,); between the panels."""


def _running(values: Floats, half: Floats) -> _Running:
    """The integral of (10 c,) values at the nodes of c panels of half widths (c, 1)."""
    parts = _parts(values, half)
    before = np.concatenate(([0.0], np.cumsum(parts[:, -1])))
    return _Running(before[:-1, None] + parts[:, :-1], before)


def _parts(values: Floats, half: Floats) -> Floats:
    """(c, 11): the integral over each panel from its start to its nodes, and to its end."""
    rows = values.reshape(len(half), len(NODES))
    parts = np.zeros((len(half), len(NODES) + 1))
    for node in range(len(NODES)):
        parts += rows[:, node : node + 1] * _INTEGRALS[:, node]
    return parts * half

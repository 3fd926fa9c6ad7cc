"""A piece of the exact surface as splines: one ruled patch between its two stretches of rail.

Both rails of the patch are splines by the place along the piece; how a rail's own parameter runs
along the patch is a spline, too. So whoever makes a face of it has its surface, and where on that
surface the rails' exact edges lie.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.curve.quintic import Quintic, fitted

from .family import RulingFamily
from .vectors import angles, crosses, dots, lengths, units

Floats = npt.NDArray[np.float64]

FIT: Final = 1e-6
"""mm; the patch follows the rails so closely ..."""
FIT_PER_SIZE: Final = 2e-8
"""... or, where that is less, to this share of the piece's size ..."""
FIT_PER_COORDINATE: Final = 1e-14
"""... but never closer than to this share of the largest coordinate."""
SLIDE_PER_RULING: Final = 5e-7
"""Along its rail the end of a ruling may slide by this share of the ruling's length: its direction
is wrong by no more than so many radians."""
LARGEST_TURN: Final = math.radians(0.01)
"""rad; normals along a ruling of a patch agree to this."""
CHECKS_PER_SPAN: Final = 8
"""Rulings at which normals are compared, in each span of the patch."""
BESIDE: Final = 1e-6
"""Knots nearer to each other than this share of a piece are one."""
STEEPEST: Final = 100.0
"""Where a rail all but stands still its place rises so fast at most, in piece lengths; the fit is
finer there instead."""
ROUNDS: Final = 60
"""Steps of Newton's method, or bisections where it fails; it mostly needs four ..."""
SAME_PLACE: Final = 4.0 * float(np.finfo(np.float64).eps)
"""... until a place changes by no more."""
FEET: Final = 3
"""Steps of Newton's method from a ruling of the piece to that of the patch."""
MOST_SPANS: Final = 1000
"""A patch that would need more is none."""
SLANT: Final = 1e-6
"""Share of the speed across the rulings below which a rail's end has no tangent plane there."""


@dataclass(frozen=True, slots=True, eq=False)
class RuledPatch:
    """A ruled surface over a piece: from ``rails`` at 0 on P to 1 on Q."""

    rails: Quintic
    """By the place, 0 to 1: (k, 6) mm; the ends of rulings on P and on Q."""
    ways: tuple[Quintic, Quintic]
    """By the parameter of P and of Q: (k, 1); the place of the ruling that ends there."""
    jumps: Floats
    """(k,) places where a rail's higher derivatives may jump."""
    error: float
    """mm; a bound of how far the rails' points, put on the patch by ``ways``, are from it."""


def patch_of(family: RulingFamily, p_knots: Floats, q_knots: Floats) -> RuledPatch | None:
    """Returns the patch over a piece, None where no surface is so smooth and so developable.

    Args:
        family: the piece's rulings.
        p_knots: (k,) parameters where P's higher derivatives jump, in order.
        q_knots: (l,) likewise of Q.
    """
    (first, start), (last, end) = family.ends
    if not (first < last and start < end):
        return None
    tolerance = _tolerance(family)
    own = [
        knots[(knots > low) & (knots < high)]
        for knots, (low, high) in zip((p_knots, q_knots), family.ends.T, strict=True)
    ]
    found = [places_of(family, side, knots) for side, knots in enumerate(own)]
    rails = fitted(
        lambda place: _both(family, place),
        _apart(np.concatenate(found)),
        1.0,
        gap=lambda place, wanted, found: _off(family, place, found - wanted, tolerance),
        most_spans=MOST_SPANS,
    )
    if rails is None or not is_regular(rails):
        return None
    ways = [_way(family, side, rails, own[side], 2.0 * tolerance) for side in (0, 1)]
    if ways[0] is None or ways[1] is None:
        return None
    return RuledPatch(rails, (ways[0], ways[1]), np.concatenate(found), 3.0 * tolerance)


def places_of(family: RulingFamily, side: int, parameters: Floats) -> Floats:
    """Returns (k,) places of the rulings that end at parameters of a rail.

    Args:
        family: the piece's rulings.
        side: 0 for P, 1 for Q.
        parameters: (k,) float64; within the piece.
    """
    first, last = (float(at) for at in family.ends[:, side])
    sign = 1.0 if side == 0 else -1.0
    wanted = (parameters - first) / (last - first)
    known = np.clip(family.places + sign * family.ahead, 0.0, 1.0)
    cell = np.searchsorted(known, wanted, side="right") - 1
    cell = np.clip(cell, 0, len(known) - 2)
    low, high = family.places[cell], family.places[cell + 1]
    place = (low + high) / 2.0
    for _ in range(ROUNDS if len(parameters) else 0):
        ahead, slope = family.ahead_at(place)
        off, rate = place + sign * ahead - wanted, 1.0 + sign * slope
        low, high = np.where(off < 0.0, place, low), np.where(off < 0.0, high, place)
        near = place - off / np.where(rate > 0.0, rate, 1.0)
        is_inside = (rate > 0.0) & (near >= low) & (near <= high)
        before, place = place, np.where(is_inside, near, (low + high) / 2.0)
        if not (np.abs(place - before) > SAME_PLACE).any():
            break
    return place


def is_regular(rails: Quintic) -> bool:
    """Tells whether all rulings of a patch have one tangent plane, which turns steadily.

    It does not where rulings cross between the rails: there the planes at their ends face opposite
    ways.

    Args:
        rails: (k, 6) mm by the place.
    """
    share = (np.arange(CHECKS_PER_SPAN) + 0.5) / CHECKS_PER_SPAN
    at = (rails.knots[:-1, None] + np.diff(rails.knots)[:, None] * share).ravel()
    points, slopes = rails.at(at), rails.slope_at(at)
    direction = units(points[:, 3:] - points[:, :3])
    p_normal, q_normal = (crosses(part, direction) for part in (slopes[:, :3], slopes[:, 3:]))
    sizes = [lengths(normal) for normal in (p_normal, q_normal)]
    least = SLANT * np.maximum(*sizes)
    both = (sizes[0] > least) & (sizes[1] > least)
    turn = np.abs(angles(lengths(crosses(p_normal, q_normal)), dots(p_normal, q_normal)))
    if (turn[both] > LARGEST_TURN).any():
        return False
    normal = units(p_normal) + units(q_normal)
    steady = dots(normal[:-1], normal[1:])
    return bool((steady > 0.0).all() and lengths(normal).all())


def _tolerance(family: RulingFamily) -> float:
    """mm; how closely a patch follows its rails."""
    ends = np.vstack(family.points_at(np.linspace(0.0, 1.0, 9)))
    size, far = float(np.ptp(ends, axis=0).max()), float(np.abs(ends).max())
    return max(min(FIT, FIT_PER_SIZE * size), FIT_PER_COORDINATE * far)


def _both(family: RulingFamily, place: Floats) -> tuple[Floats, Floats]:
    return np.hstack(family.points_at(place)), np.hstack(family.velocities_at(place))


def _off(family: RulingFamily, place: Floats, apart: Floats, tolerance: float) -> Floats:
    """(k,) how far a patch is off its rails, and its rulings along them, in shares of the allowed.

    Args:
        family: its rulings.
        place: (k,)
        apart: (k, 6) mm; from the ends of the rulings to the patch's.
        tolerance: mm, across the rails.
    """
    p, q = family.points_at(place)
    slack = np.maximum(tolerance, SLIDE_PER_RULING * lengths(q - p))
    worst = np.zeros(len(place))
    for own, velocity in zip(
        (apart[:, :3], apart[:, 3:]), family.velocities_at(place), strict=True
    ):
        tangent = units(velocity)
        along = dots(own, tangent)
        across = lengths(own - along[:, None] * tangent)
        worst = np.maximum(worst, np.maximum(across / tolerance, np.abs(along) / slack))
    return worst


def _way(
    family: RulingFamily, side: int, rails: Quintic, knots: Floats, tolerance: float
) -> Quintic | None:
    """How a rail's own parameter runs along the patch."""
    low, high = (float(at) for at in family.ends[:, side])
    own = slice(3 * side, 3 * side + 3)
    rail = (family.p, family.q)[side]
    piece = (family.p_piece, family.q_piece)[side]

    def place_at(parameter: Floats) -> tuple[Floats, Floats]:
        place, point = places_of(family, side, parameter), rail.point_at(parameter)
        tangent, speed = rail.tangents(parameter, np.full(len(parameter), piece))
        inside = (parameter > low) & (parameter < high)
        for _ in range(FEET):
            # The patch's rulings may have slid along the rail a little.
            at = rails.at(place)[:, own]
            rate = dots(rails.slope_at(place)[:, own], tangent)
            step = dots(point - at, tangent) / np.maximum(rate, (high - low) / STEEPEST)
            place = np.where(inside, np.clip(place + step, 0.0, 1.0), place)
        rate = dots(rails.slope_at(place)[:, own], tangent)
        slope = speed / np.maximum(rate, speed * (high - low) / STEEPEST)
        return place[:, None], slope[:, None]

    def gap(parameter: Floats, _: Floats, found: Floats) -> Floats:
        return lengths(rails.at(found[:, 0])[:, own] - rail.point_at(parameter))

    at = np.concatenate((family.parameters_at(rails.knots[1:-1])[side], knots))
    edges = low + (high - low) * _apart((at - low) / (high - low))
    edges[-1] = high
    return fitted(place_at, edges, tolerance, gap=gap, most_spans=MOST_SPANS)


def _apart(places: Floats) -> Floats:
    """Places from 0 to 1 in order, those too near to others left out."""
    kept = [0.0]
    for place in np.sort(places).tolist():
        if place - kept[-1] > BESIDE and place < 1.0 - BESIDE:
            kept.append(place)
    return np.array([*kept, 1.0])

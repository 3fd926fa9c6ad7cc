"""Rulings in order along a strip, each with its place on both curves, as exact as Newton gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .least_twist import Pairing
from .pairing import FAN_P, FAN_Q, RULED
from .rail_curve import RailCurve
from .vectors import angles, crosses, dots, lengths

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.int8]
Bools = npt.NDArray[np.bool_]

ROUNDS: Final = 24
"""Rounds of the bracketed secant; it mostly needs four to six."""
NEARER: Final = (1.0, 0.7, 0.5, 0.35, 0.25)
"""Shares of the reach in which a zero is sought in turn, where twists are too large to tell."""
FLAT: Final = 1e-6
"""rad; where rulings twist by less wherever they slide, the sheet is flat and they stay."""
_NO_TWIST: Final = 1e-13
"""rad; where the secant ends, some hundred times the round-off of an angle."""


@dataclass(frozen=True, slots=True, eq=False)
class Stations:
    """Rulings in order, and what lies between each and the next.

    Rulings are numbered 0 to k - 1; what lies between ruling i and i + 1 is interval i.
    """

    u: Floats
    """(k,) float64; parameters on P, not falling."""
    v: Floats
    """(k,) float64; parameters on Q, not falling."""
    p_piece: Ints
    """(k - 1,) int64; the smooth piece of P that each interval lies in."""
    q_piece: Ints
    """(k - 1,) int64; of Q."""
    way: Bytes
    """(k - 1,) int8; RULED, FAN_P or FAN_Q."""


def stations_of(pairing: Pairing) -> Stations:
    """Returns the rulings of a pairing; steps from one side of a corner to the other fall away."""
    p, q, ways = pairing.p, pairing.q, pairing.ways
    i, j = pairing.pairs[:, 0], pairing.pairs[:, 1]
    moves = (np.diff(p.arc[i]) > 0.0) | (np.diff(q.arc[j]) > 0.0)
    at = np.concatenate(([0], np.flatnonzero(moves) + 1))
    way = ways[moves].copy()
    if len(p.u) == 1:  # beside a rail that is a point every stretch is a fan
        way[:] = FAN_P
    if len(q.u) == 1:
        way[:] = FAN_Q
    here = np.flatnonzero(moves) + 1  # the node an interval ends at belongs to its own piece
    return Stations(p.u[i[at]], q.u[j[at]], p.piece[i[here]], q.piece[j[here]], way)


def twists(
    p: RailCurve, q: RailCurve, u: Floats, v: Floats, p_piece: Ints, q_piece: Ints
) -> Floats:
    """(k,) rad: the turn from P's tangent to Q's, seen along each ruling from P to Q."""
    ruling = q.point_at(v) - p.point_at(u)
    reach = lengths(ruling)
    d = ruling / np.where(reach > 0.0, reach, 1.0)[:, None]
    a, b = p.tangents(u, p_piece)[0], q.tangents(v, q_piece)[0]
    ad, bd = dots(a, d), dots(b, d)
    sine, cosine = dots(crosses(a, b), d), dots(a, b) - ad * bd
    lost = (reach == 0.0) | (dots(a, a) - ad * ad < 1e-14) | (dots(b, b) - bd * bd < 1e-14)
    return np.where(lost, 0.0, angles(sine, cosine))


def slid(p: RailCurve, q: RailCurve, stations: Stations, spacing: float) -> Stations:
    """Returns the rulings with those inside ruled stretches moved to where they twist least.

    They slide on both rails against each other, along the sum of both arc lengths. Ends of ruled
    stretches stay; rulings that would overtake them fall away.

    Args:
        p: the curve.
        q: the curve.
        stations: rulings to within `spacing`.
        spacing: mm; how far a ruling may slide.
    """
    inside = np.zeros(len(stations.u), dtype=np.bool_)
    way, p_piece, q_piece = stations.way, stations.p_piece, stations.q_piece
    inside[1:-1] = (way[:-1] == RULED) & (way[1:] == RULED)
    inside[1:-1] &= (p_piece[:-1] == p_piece[1:]) & (q_piece[:-1] == q_piece[1:])
    chosen = np.flatnonzero(inside)
    if not chosen.size:
        return without_rest(stations)
    rates = []
    for rail, at, piece in ((p, stations.u, p_piece), (q, stations.v, q_piece)):
        speed = rail.tangents(at[chosen], piece[chosen])[1]
        rates.append(np.where(speed > 0.0, 1.0 / np.where(speed > 0.0, speed, 1.0), 0.0))
    u, v = stations.u.copy(), stations.v.copy()
    slide = _Slide(
        p, q, u[chosen], v[chosen], rates[0], -rates[1], p_piece[chosen], q_piece[chosen]
    )
    moved = _slid(slide, 2.0 * spacing)
    u[chosen], v[chosen] = slide.u_at(moved), slide.v_at(moved)
    u, v = _in_order(u, v, inside)
    return without_rest(Stations(u, v, p_piece, q_piece, way))


def _in_order(u: Floats, v: Floats, inside: Bools) -> tuple[Floats, Floats]:
    """Rulings inside a ruled stretch do not overtake its ends."""
    fixed = np.flatnonzero(~inside)
    place = np.arange(len(u))
    before = fixed[np.searchsorted(fixed, place, side="right") - 1]
    after = fixed[np.minimum(np.searchsorted(fixed, place), len(fixed) - 1)]
    u, v = np.clip(u, u[before], u[after]), np.clip(v, v[before], v[after])
    return np.maximum.accumulate(u), np.maximum.accumulate(v)


def without_rest(stations: Stations) -> Stations:
    """Leaves out intervals between a ruling and itself."""
    moves = (np.diff(stations.u) > 0.0) | (np.diff(stations.v) > 0.0)
    kept = np.concatenate(([True], moves))
    return Stations(
        stations.u[kept],
        stations.v[kept],
        stations.p_piece[moves],
        stations.q_piece[moves],
        stations.way[moves],
    )


def _pieces(stations: Stations, interval: Ints) -> tuple[Ints, Ints]:
    return stations.p_piece[interval], stations.q_piece[interval]


@dataclass(frozen=True, slots=True, eq=False)
class _Slide:
    """Rulings that slide along both rails, by mm."""

    p: RailCurve
    q: RailCurve
    u: Floats
    v: Floats
    du: Floats
    dv: Floats
    p_piece: Ints
    q_piece: Ints

    def u_at(self, x: Floats) -> Floats:
        low, high = self.p.edges[self.p_piece], self.p.edges[self.p_piece + 1]
        return np.clip(self.u + self.du * x, low, high)

    def v_at(self, x: Floats) -> Floats:
        low, high = self.q.edges[self.q_piece], self.q.edges[self.q_piece + 1]
        return np.clip(self.v + self.dv * x, low, high)

    def twist(self, x: Floats) -> Floats:
        return twists(self.p, self.q, self.u_at(x), self.v_at(x), self.p_piece, self.q_piece)

    def among(self, chosen: Bools) -> _Slide:
        return _Slide(
            self.p,
            self.q,
            self.u[chosen],
            self.v[chosen],
            self.du[chosen],
            self.dv[chosen],
            self.p_piece[chosen],
            self.q_piece[chosen],
        )


def _slid(slide: _Slide, reach: float) -> Floats:
    """(k,) mm: by how much each ruling slides to where its twist is 0, or else least.

    Near an edge of regression the twist turns over within a hair of it: there within less.
    """
    x = np.zeros(len(slide.u))
    left = np.arange(len(x))
    for nearer in NEARER:
        moved, sane = _slid_within(slide, nearer * reach)
        x[left[sane]] = moved[sane]
        if sane.all():
            break
        left, slide = left[~sane], slide.among(~sane)
    return x


def _slid_within(slide: _Slide, reach: float) -> tuple[Floats, Bools]:
    """(k,) mm likewise, and whether no twist within that reach is a right angle or more."""
    zero = np.zeros(len(slide.u))
    f = np.stack([slide.twist(zero + x) for x in (-reach, 0.0, reach)])
    sane: Bools = np.all(np.abs(f) < np.pi / 2, axis=0)
    twisting = sane & (np.abs(f) > FLAT).any(axis=0)
    left, right = twisting & (f[0] * f[1] <= 0.0), twisting & (f[1] * f[2] <= 0.0)
    # Of two zeros the nearer one, where the twist at the far end is smaller.
    left &= ~right | (np.abs(f[0]) < np.abs(f[2]))
    crossing, x = left | right, zero.copy()
    if crossing.any():
        low, high = np.where(left, -reach, zero), np.where(left, zero, reach)
        f_low, f_high = np.where(left, f[0], f[1]), np.where(left, f[1], f[2])
        ends = (values[crossing] for values in (low, high, f_low, f_high))
        x[crossing] = _zero_between(slide.among(crossing), *ends)
    twisted = twisting & ~crossing
    if twisted.any():
        x[twisted] = _least_near(slide.among(twisted), reach / 2)
    return x, sane


def _zero_between(
    slide: _Slide, low: Floats, high: Floats, f_low: Floats, f_high: Floats
) -> Floats:
    """The Illinois rule: secants that keep a bracket, which is why they cannot run away."""
    x = np.where(np.abs(f_low) < np.abs(f_high), low, high)
    best = np.minimum(np.abs(f_low), np.abs(f_high))
    side = np.zeros(len(x), dtype=np.int8)
    for _ in range(ROUNDS):
        fall = f_low - f_high
        share = np.where(fall != 0.0, f_low / np.where(fall != 0.0, fall, 1.0), 0.5)
        at = low + (high - low) * np.clip(share, 0.0, 1.0)
        f_at = slide.twist(at)
        better = np.abs(f_at) < best
        x, best = np.where(better, at, x), np.where(better, np.abs(f_at), best)
        if not (best > _NO_TWIST).any():
            break
        upward = f_at * f_low > 0.0
        f_high = np.where(upward, np.where(side == 1, f_high / 2, f_high), f_at)
        f_low = np.where(upward, f_at, np.where(side == -1, f_low / 2, f_low))
        low, high = np.where(upward, at, low), np.where(upward, high, at)
        side = np.where(upward, 1, -1).astype(np.int8)
    return x


def _least_near(slide: _Slide, reach: float) -> Floats:
    """Where a parabola through three squares of the twist is least; 0 if not between them."""
    x = np.zeros(len(slide.u))
    for width in (reach, reach / 2):
        before, here, after = (slide.twist(x + shift) ** 2 for shift in (-width, 0.0, width))
        bend = before - 2.0 * here + after
        bent = bend > 0.0
        shift = np.where(bent, 0.5 * width * (before - after) / np.where(bent, bend, 1.0), 0.0)
        x = np.where(np.abs(shift) <= width, x + shift, x)
    return np.where(np.abs(x) <= reach, x, 0.0)

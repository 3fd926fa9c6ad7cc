"""The rulings of one piece as a smooth family: a ruling at every place along it.

Places run from 0 to 1. With ``x`` the share of P's way within the piece and ``y`` that of Q's,
both in the rails' own parameters, the place is ``(x + y) / 2``; how far P is ahead is
``(x - y) / 2``, a cubic between exact rulings. So both ends of every ruling lie on their curves
exactly, neither rail runs back, and either may stand still while the other moves on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import numpy.typing as npt

from .pairing import FAN_P, FAN_Q, RULED
from .pieces import Piece
from .rail_curve import RailCurve
from .secants import bracketed_secants
from .stations import twists
from .surface import RuledStrip

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

FIRST_CELLS: Final = 16
"""Exact rulings are taken at so many places first ..."""
LARGEST_TWIST: Final = 1e-7
"""rad; ... and between them, until rulings in the middle twist by no more than this ..."""
MOST_ROUNDS: Final = 7
"""... or each of the first stretches was halved so often."""
UNSURE: Final = 1e-6
"""rad; where twist changes by less while a ruling slides, the sheet is flat, and no ruling is more
exact than another."""
ALIKE: Final = 2.0
"""On both sides of a ruling twist grows equally fast to within this factor, or others are near."""
KNOWN_REACH: Final = 4.0
"""The rulings of a sheet are looked at so many of their mean distances to either side ..."""
REACH_PER_GAP: Final = 0.125
"""... and those between exact ones so far, in shares of the distance to the nearest."""
SECANTS: Final = 24
"""Mostly four to six are needed."""
NO_TWIST: Final = 1e-13
"""rad; where they end, some hundred times the round-off of an angle."""


@dataclass(frozen=True, slots=True, eq=False)
class RulingFamily:
    """All rulings of a piece."""

    p: RailCurve
    """The curve P."""
    q: RailCurve
    """The curve Q."""
    p_piece: int
    """The smooth piece of P that it runs along."""
    q_piece: int
    """The smooth piece of Q."""
    ends: Floats
    """(2, 2) float64; parameters on P and on Q of the first ruling and of the last."""
    places: Floats
    """(k,) float64, from 0 to 1, increasing; of the exact rulings."""
    ahead: Floats
    """(k,) float64; how far P is ahead there."""
    slopes: Floats
    """(k,) float64; its derivative by the place, from -1 to 1."""

    def parameters_at(self, place: Floats) -> tuple[Floats, Floats]:
        """(k,) parameters each on P and on Q of the rulings at (k,) places."""
        ahead = self.ahead_at(place)[0]
        (first, start), (last, end) = self.ends
        u, v = first + (last - first) * (place + ahead), start + (end - start) * (place - ahead)
        return np.clip(u, first, last), np.clip(v, start, end)

    def points_at(self, place: Floats) -> tuple[Floats, Floats]:
        """(k, 3) mm each: the rulings' ends on P and on Q."""
        u, v = self.parameters_at(place)
        return self.p.point_at(u), self.q.point_at(v)

    def velocities_at(self, place: Floats) -> tuple[Floats, Floats]:
        """(k, 3) mm each: derivatives by the place of the rulings' ends on P and on Q."""
        u, v = self.parameters_at(place)
        slope = self.ahead_at(place)[1]
        rates = (1.0 + slope, 1.0 - slope)
        found = []
        for rail, at, piece, rate, (first, last) in zip(
            (self.p, self.q), (u, v), (self.p_piece, self.q_piece), rates, self.ends.T, strict=True
        ):
            tangent, speed = rail.tangents(at, np.full(len(at), piece))
            found.append(tangent * (speed * np.maximum(rate, 0.0) * (last - first))[:, None])
        return found[0], found[1]

    def twist_at(self, place: Floats) -> Floats:
        """(k,) rad: the turn of the tangent plane along the rulings; 0 on a cone."""
        if (self.ends[0] == self.ends[1]).any():
            return np.zeros(len(place))
        u, v = self.parameters_at(place)
        pieces = (np.full(len(u), self.p_piece), np.full(len(u), self.q_piece))
        return twists(self.p, self.q, u, v, *pieces)

    def ahead_at(self, place: Floats) -> tuple[Floats, Floats]:
        """(k,) each: how far P is ahead at (k,) places, and its derivative by the place."""
        cell = np.searchsorted(self.places, place, side="right") - 1
        cell = np.clip(cell, 0, len(self.places) - 2)
        width = self.places[cell + 1] - self.places[cell]
        x = (place - self.places[cell]) / width
        low, rise = self.ahead[cell], self.ahead[cell + 1] - self.ahead[cell]
        before, after = self.slopes[cell] * width, self.slopes[cell + 1] * width
        bend, sag = before + after - 2.0 * rise, 3.0 * rise - 2.0 * before - after
        value = low + x * (before + x * (sag + x * bend))
        return value, (before + x * (2.0 * sag + 3.0 * x * bend)) / width


def family_of(ruled: RuledStrip, piece: Piece, p: RailCurve, q: RailCurve) -> RulingFamily:
    """Returns the rulings of one piece of a strip's surface.

    Args:
        ruled: the surface.
        piece: one of its pieces; in a gap the rulings are those that twist least.
        p: the curve P that was ruled.
        q: the curve Q.
    """
    rulings = ruled.sheet.rulings
    run = slice(piece.first, piece.last + 1)
    u, v = rulings.u[run], rulings.v[run]
    way = int(rulings.way[piece.first])
    if piece.kind == "plane" and len(np.unique(rulings.way[piece.first : piece.last])) > 1:
        way = RULED
    own = (int(rulings.p_piece[piece.first]), int(rulings.q_piece[piece.first]))
    whole = _Share(p, q, own, np.array([[u[0], v[0]], [u[-1], v[-1]]]))
    if way in (FAN_P, FAN_Q) or not (whole.ends[0] < whole.ends[1]).all():
        return whole.family(np.array([0.0, 1.0]), np.zeros(2))
    place, ahead = whole.split(u, v)
    kept = np.concatenate(([True], np.diff(place) > 0.0))
    place, ahead = place[kept], ahead[kept]
    if piece.kind != "torsal":
        spread = np.linspace(0.0, 1.0, FIRST_CELLS + 1)
        return whole.family(spread, np.interp(spread, place, ahead))
    return _refined(whole, place, ahead)


@dataclass(frozen=True, slots=True, eq=False)
class _Share:
    """A piece's two stretches of rail, by shares of their parameters."""

    p: RailCurve
    q: RailCurve
    own: tuple[int, int]
    ends: Floats

    def split(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Places, and how far P is ahead, of rulings."""
        (first, start), (last, end) = self.ends
        x, y = (u - first) / (last - first), (v - start) / (end - start)
        return (x + y) / 2.0, (x - y) / 2.0

    def twist(self, place: Floats, ahead: Floats) -> Floats:
        """(k,) rad: the twist of rulings; their ends stay within the piece."""
        (first, start), (last, end) = self.ends
        x, y = np.clip(place + ahead, 0.0, 1.0), np.clip(place - ahead, 0.0, 1.0)
        pieces = (np.full(len(x), own) for own in self.own)
        return twists(
            self.p, self.q, first + (last - first) * x, start + (end - start) * y, *pieces
        )

    def family(self, place: Floats, ahead: Floats) -> RulingFamily:
        """The family through rulings."""
        slopes = _slopes(place, ahead)
        return RulingFamily(self.p, self.q, *self.own, self.ends, place, ahead, slopes)


def _refined(whole: _Share, place: Floats, ahead: Floats) -> RulingFamily:
    """The family through so many exact rulings that those between them are exact as well."""
    # Where the bend changes sides another surface has rulings, too: the known ones may be its.
    reach = np.full(len(place), KNOWN_REACH / len(place))
    place, ahead = _exact(whole, place, ahead, reach)
    at = np.linspace(0.0, 1.0, FIRST_CELLS + 1)
    known = _exact(whole, at, np.interp(at, place, ahead), np.full(len(at), reach[0]))
    for _ in range(MOST_ROUNDS):
        family = whole.family(*known)
        middle = (known[0][:-1] + known[0][1:]) / 2.0
        open_ = np.abs(family.twist_at(middle)) > LARGEST_TWIST
        if not open_.any():
            break
        at = np.sort(np.concatenate((known[0], middle[open_])))
        apart = np.diff(at)
        near = np.minimum(np.append(apart, apart[-1]), np.insert(apart, 0, apart[0]))
        more = _exact(whole, at, family.ahead_at(at)[0], REACH_PER_GAP * near)
        if len(more[0]) == len(known[0]):
            break
        known = more
    return whole.family(*known)


def _exact(whole: _Share, place: Floats, ahead: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Rulings moved to where they do not twist; left out where there is no such place, or not one.

    It is the only one if the twist grows about as fast on both sides of it. The first ruling and
    the last one stay.
    """
    low, high = ahead - reach, ahead + reach
    f_low, f_high = whole.twist(place, low), whole.twist(place, high)
    sure = (f_low * f_high < 0.0) & (np.abs(f_high - f_low) > UNSURE)
    found = ahead
    twist = partial(whole.twist, place)
    for at, f_at in bracketed_secants(twist, low, high, (f_low, f_high), SECANTS):
        found = np.where(sure, at, found)
        if not (np.abs(f_at[sure]) > NO_TWIST).any():
            break
    sure &= _is_alike(found - low, high - found, np.abs(f_low), np.abs(f_high))
    found[0], found[-1] = ahead[0], ahead[-1]
    sure[0] = sure[-1] = True
    return place[sure], found[sure]


def _is_alike(before: Floats, after: Floats, f_before: Floats, f_after: Floats) -> Bools:
    """Whether the twist grows about as fast on both sides of a ruling."""
    one, other = f_before * after, f_after * before
    alike: Bools = (one <= ALIKE * other) & (other <= ALIKE * one)
    return alike


def _slopes(place: Floats, ahead: Floats) -> Floats:
    """(k,): derivatives at rulings, from parabolas, and such that neither rail runs back."""
    width = np.diff(place)
    rise = np.diff(ahead) / width
    if len(rise) == 1:
        return np.repeat(np.clip(rise, -1.0, 1.0), 2)
    inner = (rise[:-1] * width[1:] + rise[1:] * width[:-1]) / (width[:-1] + width[1:])
    slopes = np.concatenate(([2.0 * rise[0] - inner[0]], inner, [2.0 * rise[-1] - inner[-1]]))
    # Fritsch and Carlson (1980): a cubic is monotone if its slopes are at most three times the
    # chord's; here for both rails at once.
    low = np.maximum(-1.0, 3.0 * rise - 2.0)
    high = np.minimum(1.0, 3.0 * rise + 2.0)
    least = np.maximum(np.concatenate((low[:1], low)), np.concatenate((low, low[-1:])))
    most = np.minimum(np.concatenate((high[:1], high)), np.concatenate((high, high[-1:])))
    return np.clip(slopes, np.minimum(least, most), np.maximum(least, most))

"""Which bridges are locally convex and bend at every step: told from signs, where signs are clear.

What convexity and folds at bridge (i, j) ask for are the determinants of the bridge and two of its
neighbours. Those of a neighbour on each rail are entries, up to sign, of one matrix, T(i, j) =
det(q[j] - p[i], p[i+1] - p[i], q[j+1] - q[j]), at (i-1..i, j-1..j): one product of six terms each,
of the Pluecker coordinates of both bank edges. Those of two neighbours on one rail are distances of
a sample from a plane. Where all are larger than a bound, every triangle at the bridge has an area,
no fold is coplanar or lies on itself, and convexity is a matter of their signs. The bound holds the
planarity, and the round-off of the exact measurement and of this one: a bridge that is closer to
any limit is left to the exact measurement.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import STEEPEST_HALF_FOLD

from .compiled import compiled, inlined

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

BLOCK: Final = 64
"""So many samples of Q share one bound."""
UNCLEAR: Final = 128
"""A mark from here on: the bridge has to be measured."""
INVALID, NOT_P_P, NOT_Q_Q = 1, 2, 4
"""Marks of a bridge that is not locally convex; that does not bend between two P-steps, because P
is straight there; between two Q-steps."""

_ROUND_OFF: Final = 1e-13
"""Of a determinant, as a share of the largest coordinate and both edges: some 400 units in the last
place, where the formulas below lose less than 50."""
_STRAIGHT: Final = 8.0
"""A rail is straight at a sample whose edges turn so little that their plane cannot matter where
the other determinants are as clear as this many planarities."""


_AT, _EDGE, _MOMENT, _TURN = 0, 3, 6, 9
_TURN_AT, _IS_STRAIGHT, _BEND, _SIZE, _ROWS = range(12, 17)
"""Rows of a side, for each sample: itself, from the middle of both rails; the edge to the next one;
sample x edge; minus the edge before it x that edge; this turn . sample; 1.0 where the rail is
straight, and the turn is left out; what a straight place asks of the other determinants, the larger
of this sample's and the next one's; the longest edge that touches this sample or the next."""


class Screen(NamedTuple):
    """Both rails and the bounds."""

    p: Floats
    """(16, m) float64, mm; rows as named above."""
    q: Floats
    """(16, n) float64, mm."""
    blocks: Floats
    """(b, 6) float64, mm; of samples of Q: their middle, how far the farthest of them, or the next
    one, is from it, their largest size and bend."""
    flatness: float
    """mm; see lanes.measure."""
    round_off: float
    """mm."""


def screen_of(p: Floats, q: Floats, *, planarity: float, nothing: float) -> Screen:
    """Returns what the signs of a strip are told from.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
    """
    both = np.concatenate((p, q))
    middle = 0.5 * (both.min(axis=0) + both.max(axis=0))
    p_side, q_side = (_side(rail, middle, planarity) for rail in (p, q))
    starts = np.arange(0, len(q), BLOCK)
    # The first sample of the next block counts as well.
    at = np.concatenate((q_side[:3], q_side[:3, -1:]), axis=1)
    behind = at[:, np.minimum(starts + BLOCK, len(q))]
    low = np.minimum(np.minimum.reduceat(at, starts, axis=1), behind)
    high = np.maximum(np.maximum.reduceat(at, starts, axis=1), behind)
    half = 0.5 * (high - low)
    reach = np.sqrt(half[0] ** 2 + half[1] ** 2 + half[2] ** 2)
    sizes = [np.maximum.reduceat(q_side[row], starts) for row in (_SIZE, _BEND)]
    return Screen(
        p_side,
        q_side,
        np.column_stack((0.5 * (low + high).T, reach, *sizes)),
        max(planarity, nothing),
        _ROUND_OFF * float(np.abs(both).max()),
    )


def _side(rail: Floats, middle: Floats, planarity: float) -> Floats:
    side = np.zeros((_ROWS, len(rail)))
    at, edge, turn = side[_AT:_EDGE], side[_EDGE:_MOMENT], side[_TURN:_TURN_AT]
    at[:] = (rail - middle).T
    edge[:, :-1] = np.diff(rail, axis=0).T
    before = np.zeros_like(at)
    before[:, 1:] = edge[:, :-1]
    turn[:] = np.cross(edge, before, axis=0)
    length = np.sqrt(edge[0] ** 2 + edge[1] ** 2 + edge[2] ** 2)
    turned = np.sqrt(turn[0] ** 2 + turn[1] ** 2 + turn[2] ** 2)
    longer = np.maximum(length, np.append(0.0, length[:-1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        asked = (turned + _ROUND_OFF * longer * longer) / np.float64(planarity)
    goes_on = edge[0] * before[0] + edge[1] * before[1] + edge[2] * before[2] > 0.0
    is_straight = goes_on & (asked <= _STRAIGHT * planarity)
    turn[:, is_straight] = 0.0
    bend = np.where(is_straight, asked, 0.0)
    side[_MOMENT:_TURN] = np.cross(at, edge, axis=0)
    side[_TURN_AT] = turn[0] * at[0] + turn[1] * at[1] + turn[2] * at[2]
    side[_IS_STRAIGHT] = is_straight
    side[_BEND] = np.maximum(bend, np.append(bend[1:], 0.0))
    side[_SIZE] = np.maximum(longer, np.append(longer[1:], 0.0))
    return side


@compiled
def _bounds(screen: Screen, i: int, block: int) -> tuple[float, float, float]:
    """The bounds in mm3 of determinants at sample i of P and a block of Q: of T, on P, on Q."""
    p, own = screen.p, screen.blocks[block]
    x, y, z = p[0, i] - own[0], p[1, i] - own[1], p[2, i] - own[2]
    d, bend, f, other_bend = p[_SIZE, i], p[_BEND, i], own[4], own[5]
    e = 1.000001 * (np.sqrt(x * x + y * y + z * z) + own[3] + d)
    flat = 1.000001 * screen.flatness
    off = 3.0 * e / STEEPEST_HALF_FOLD + screen.round_off
    least = flat * (e * max(d, f) + d * f) + off * d * f
    least += 1.000001 * e * (f * bend + d * other_bend)
    return least, flat * (e * d + d * d) + off * d * d, flat * (e * f + f * f) + off * f * f


@compiled
def sign_row(screen: Screen, i: int, first: int, stop: int, signs: Bytes) -> None:
    """Writes the clear signs of T(i, j): 1 above 0, 2 below, 0 where unclear.

    Args:
        screen: of the strip.
        i: from 0 to m-2.
        first: the first j.
        stop: behind the last one; below n.
        signs: (n+1,) uint8; entry j + 1 is written.
    """
    p, q = screen.p, screen.q
    dx, dy, dz = -p[_EDGE, i], -p[_EDGE + 1, i], -p[_EDGE + 2, i]
    mx, my, mz = -p[_MOMENT, i], -p[_MOMENT + 1, i], -p[_MOMENT + 2, i]
    for block in range(first // BLOCK, (stop + BLOCK - 1) // BLOCK):
        low, high = max(first, block * BLOCK), min(stop, (block + 1) * BLOCK)
        least, _, _ = _bounds(screen, i, block)
        gx, gy, gz = q[_MOMENT][low:high], q[_MOMENT + 1][low:high], q[_MOMENT + 2][low:high]
        fx, fy, fz = q[_EDGE][low:high], q[_EDGE + 1][low:high], q[_EDGE + 2][low:high]
        own = signs[low + 1 : high + 1]
        for k in range(high - low):
            size = dx * gx[k] + dy * gy[k] + dz * gz[k] + mx * fx[k] + my * fy[k] + mz * fz[k]
            own[k] = (1 if size > least else 0) + (2 if size < -least else 0)


@inlined
def _swapped(sign: int) -> int:
    return ((sign & 1) << 1) | (sign >> 1)


@compiled
def _mark(before: Bytes, behind: Bytes, p_signs: Bytes, q_signs: Bytes, marks: Bytes) -> None:
    """Writes marks of bridges whose signs are known: bits alone, so that bytes are enough."""
    for k in range(marks.size):
        p, q = p_signs[k], q_signs[k]
        a, b, c, d = before[k], before[k + 1], behind[k], behind[k + 1]
        s12, s21 = _swapped(b), _swapped(c)
        holds = (p & a & s12) | (_swapped(p) & s21 & d)
        holds |= (_swapped(a) & c & q) | (b & _swapped(d) & _swapped(q))
        invalid = ((holds | (holds >> 1)) & 1) ^ 1
        p_p, q_q = invalid & p & (p >> 1), invalid & q & (q >> 1)
        clear = (p | (p >> 1)) & (q | (q >> 1)) & (a | (a >> 1)) & (b | (b >> 1))
        clear &= (c | (c >> 1)) & (d | (d >> 1))
        # INVALID, NOT_P_P, NOT_Q_Q and UNCLEAR.
        marks[k] = invalid | (p_p << 1) | (q_q << 2) | (((clear & 1) ^ 1) << 7)


@compiled
def mark_row(
    screen: Screen, i: int, first: int, stop: int, before: Bytes, behind: Bytes, marks: Bytes
) -> None:
    """Writes what the signs tell of bridges from an inner sample of P to inner ones of Q.

    Args:
        screen: of the strip.
        i: from 1 to m-2.
        first: the first j, at least 1.
        stop: behind the last one, at most n-1.
        before: (n+1,) uint8; signs of row i - 1 (sign_row), from first - 1 to stop - 1.
        behind: (n+1,) uint8; of row i.
        marks: (n,) uint8; written.
    """
    p, q = screen.p, screen.q
    x, y, z = p[0, i], p[1, i], p[2, i]
    tx, ty, tz, at = p[_TURN, i], p[_TURN + 1, i], p[_TURN + 2, i], p[_TURN_AT, i]
    p_any = 3 if p[_IS_STRAIGHT, i] > 0.0 else 0
    p_signs, q_signs = np.empty(BLOCK, dtype=np.uint8), np.empty(BLOCK, dtype=np.uint8)
    for block in range(first // BLOCK, (stop + BLOCK - 1) // BLOCK):
        low, high = max(first, block * BLOCK), min(stop, (block + 1) * BLOCK)
        _, on_p, on_q = _bounds(screen, i, block)
        qx, qy, qz = q[0][low:high], q[1][low:high], q[2][low:high]
        for k in range(high - low):
            size = qx[k] * tx + qy[k] * ty + qz[k] * tz - at
            p_signs[k] = (1 if size > on_p else p_any) + (2 if size < -on_p else 0)
        ux, uy, uz = q[_TURN][low:high], q[_TURN + 1][low:high], q[_TURN + 2][low:high]
        turn_at, q_any = q[_TURN_AT][low:high], q[_IS_STRAIGHT][low:high]
        for k in range(high - low):
            size = turn_at[k] - (x * ux[k] + y * uy[k] + z * uz[k])
            sign = (1 if size > on_q else 0) + (2 if size < -on_q else 0)
            q_signs[k] = 3 if q_any[k] > 0.0 else sign
        _mark(before[low : high + 1], behind[low : high + 1], p_signs, q_signs, marks[low:high])

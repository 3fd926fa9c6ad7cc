"""The least-twist pairing of two rails: a dynamic program on nodes along both.

A pairing runs from the first pair of nodes to the last; each step moves along one rail, in one of
three ways:

- `RULED`: as a ruled surface. It costs the square of the twist `phi` of its rulings, integrated
  over half the way along both rails: the measure in which the cost of a path does not depend on
  how finely its stairs are cut.
- `FAN_P`: a cone with its apex on P, while Q is run through. It costs nothing.
- `FAN_Q`: a cone with its apex on Q.

A change between ways is a crease of the twist at that ruling, since a ruled surface has both
tangents in its planes and a cone only that of the rail it runs along; so is a corner of a rail. A
crease of the angle `c`, the larger one at both ends of the ruling, costs `CREASE c^2` times its
length: so much more than a twist by `c` over a stretch as long as the ruling. Zigzags of creases
never pay on a smooth strip (even at a weight of 1 they cost at least 2.6 times as much as twisting
it), and a crease that spares a long twist stays too slight to be called one. A sharp crease costs
but in proportion to its angle: were it the square, several in a row between the corners of both
rails would cost less than the one fold of a prism's edge. At the rails' ends and corners, where the
tangent is free, fans cost nothing.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.compiled import compiled

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.int8]

RULED: Final = 0
FAN_P: Final = 1
FAN_Q: Final = 2

P_FORWARD: Final = 1
Q_FORWARD: Final = 2

CREASE: Final = 20.0
"""Weight of a crease's squared angle times its length, against that of twist over as long a way."""
SHARP: Final = math.radians(10.0)
"""rad; what a crease costs grows with the square of its angle up to here, then evenly."""
_SHORTNESS: Final = 1e-8
"""Weight of a ruling's squared length, per squared mean length of the rails: decides in planes
only."""


@compiled
def twist_at(p: Floats, q: Floats, a: Floats, b: Floats) -> float:
    """Returns rad, (-pi, pi]: the turn from tangent a at p to tangent b at q, seen along p q.

    Args:
        p: (3,) float64, mm.
        q: (3,) float64, mm.
        a: (3,) float64; unit tangent at p.
        b: (3,) float64; unit tangent at q.

    Returns:
        Positive if right-handed about the direction from p to q; 0 where it has no meaning: rails
        meet, or a tangent lies along the ruling.
    """
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    square = dx * dx + dy * dy + dz * dz
    if square == 0.0:
        return 0.0
    length = math.sqrt(square)
    dx, dy, dz = dx / length, dy / length, dz / length
    ad = a[0] * dx + a[1] * dy + a[2] * dz
    bd = b[0] * dx + b[1] * dy + b[2] * dz
    aa = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - ad * ad
    bb = b[0] * b[0] + b[1] * b[1] + b[2] * b[2] - bd * bd
    if aa < 1e-14 or bb < 1e-14:
        return 0.0
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    across = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - ad * bd
    return math.atan2(x * dx + y * dy + z * dz, across)


@compiled
def corridor(
    p_arc: Floats, q_arc: Floats, p_at: Floats, q_at: Floats, reach: Floats
) -> tuple[Ints, Ints]:
    """Returns for each node of P the first and the last node of Q that it may be paired with.

    Args:
        p_arc: (M,) float64, mm; arc lengths of P's nodes.
        q_arc: (N,) float64, mm; of Q's.
        p_at: (k,) float64, mm; arc lengths on P of known pairs, not falling.
        q_at: (k,) float64, mm; on Q.
        reach: (k,) float64, mm; how far around each pair, and around the way to the next.
    """
    count, other = p_arc.size, q_arc.size
    low, high = np.full(count, other - 1), np.zeros(count, np.int64)
    for k in range(p_at.size):
        after = min(k + 1, p_at.size - 1)
        far = max(reach[k], reach[after])
        i = np.searchsorted(p_arc, p_at[k] - far)
        j = np.searchsorted(q_arc, q_at[k] - far)
        stop = q_at[after] + far
        last = np.searchsorted(q_arc, stop, side="right") - 1
        while i < count and p_arc[i] <= p_at[after] + far:
            low[i] = min(low[i], j)
            high[i] = max(high[i], last)
            i += 1
    low[0], high[count - 1] = 0, other - 1
    for i in range(1, count):
        low[i] = max(low[i], 0)
        high[i] = max(high[i], high[i - 1])
    for i in range(count - 2, -1, -1):
        low[i] = min(low[i], low[i + 1])
    return low, high


@compiled
def crease_cost(square: float) -> float:
    """Returns what a crease costs by its length, from its squared angle in rad."""
    if square <= SHARP * SHARP:
        return CREASE * square
    return CREASE * SHARP * (2.0 * math.sqrt(square) - SHARP)


@compiled
def pair_nodes(
    p: Floats,
    q: Floats,
    a: Floats,
    b: Floats,
    p_arc: Floats,
    q_arc: Floats,
    low: Ints,
    high: Ints,
    bending: float,
) -> tuple[Ints, Bytes]:
    """Returns the pairs of nodes of the cheapest pairing, and the way of each step between them.

    Args:
        p: (M, 3) float64, mm; nodes of P; the two of a corner have the same arc length.
        q: (N, 3) float64, mm; nodes of Q.
        a: (M, 3) float64; unit tangents of P.
        b: (N, 3) float64; of Q.
        p_arc: (M,) float64, mm; arc lengths.
        q_arc: (N,) float64, mm.
        low: (M,) int64; first node of Q that each node of P may be paired with.
        high: (M,) int64; the last one.
        bending: weight of the squared turn of the sheet over a stretch as long as the ruling.

    Returns:
        pairs: (k, 2) int64, from (0, 0) to (M - 1, N - 1).
        ways: (k - 1,) int8.
    """
    start = np.zeros(p.shape[0] + 1, np.int64)
    wide = 1
    for i in range(p.shape[0]):
        start[i + 1] = start[i] + high[i] - low[i] + 1
        wide = max(wide, high[i] - low[i] + 1)
    left, step = np.zeros((start[-1], 3), np.int8), np.zeros((start[-1], 3), np.int8)
    # Of costs and planes only this row of cells and the one before it are kept.
    reached, cost = np.full((2 * wide, 3), np.inf), np.full((2 * wide, 3), np.inf)
    plane = np.zeros((2 * wide, 14))
    size = 0.5 * (p_arc[-1] + q_arc[-1])
    weights = (bending, _SHORTNESS / (size * size))
    for i in range(p.shape[0]):
        i_corner = i > 0 and p_arc[i] == p_arc[i - 1]
        row, last = (i % 2) * wide - low[i], ((i + 1) % 2) * wide - low[max(i - 1, 0)]
        reached[row + low[i] : row + high[i] + 1] = np.inf
        if i == 0:
            reached[0] = 0.0
        for j in range(low[i], high[i] + 1):
            j_corner = j > 0 and q_arc[j] == q_arc[j - 1]
            cell, own = row + j, start[i] + j - low[i]
            length = _planes(p[i], q[j], a[i], b[j], plane[cell])
            if i > 0 and not i_corner and low[i - 1] <= j <= high[i - 1]:
                ds = p_arc[i] - p_arc[i - 1]
                _step(reached, cost, step[own], plane, cell, last + j, ds, weights, P_FORWARD)
            if j > low[i] and not j_corner:
                ds = q_arc[j] - q_arc[j - 1]
                _step(reached, cost, step[own], plane, cell, cell - 1, ds, weights, Q_FORWARD)
            _leave(reached[cell], cost[cell], left[own], length * crease_cost(plane[cell, 12]))
            for back in range(1, 4):
                i2, j2 = i - back % 2, j - back // 2
                if (back % 2 and not i_corner) or (back // 2 and not j_corner):
                    continue
                if low[i2] <= j2 <= high[i2]:
                    source = (last if back % 2 else row) + j2
                    rails = (p[i], q[j], a[i2], b[j2], a[i], b[j])
                    _leave_corner(reached[source], cost[cell], left[own], rails, length, back)
    return _trace(cost[row + high[p.shape[0] - 1]], left, step, start, low)


@compiled
def _leave(reached: Floats, cost: Floats, left: Bytes, price: float) -> None:
    """Leaves a ruling on each way, from that on which it was reached, at the price of a crease."""
    for way in range(3):
        cost[way], left[way] = reached[way], way
        for before in range(3):
            if before != way and reached[before] + price < cost[way]:
                cost[way], left[way] = reached[before] + price, before


@compiled
def _leave_corner(
    reached: Floats,
    cost: Floats,
    left: Bytes,
    rails: tuple[Floats, Floats, Floats, Floats, Floats, Floats],
    length: float,
    back: int,
) -> None:
    """Leaves a ruling at a corner, from the other side of it, at the price of the whole jump."""
    p, q, a, b, a2, b2 = rails
    for way in range(3):
        for before in range(3):
            if reached[before] == np.inf:
                continue
            x = twist_at(p, q, b if before == FAN_P else a, b2 if way == FAN_P else a2)
            y = twist_at(p, q, a if before == FAN_Q else b, a2 if way == FAN_Q else b2)
            total = reached[before] + length * crease_cost(max(x * x, y * y))
            if total < cost[way]:
                cost[way], left[way] = total, before + 3 * back


@compiled
def _planes(p: Floats, q: Floats, a: Floats, b: Floats, plane: Floats) -> float:
    """Notes normals, directions across and squared twist of a ruling; returns its length."""
    plane[:] = 0.0
    dx, dy, dz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return 0.0
    dx, dy, dz = dx / length, dy / length, dz / length
    for rail in (0, 1):
        t = b if rail else a
        x, y, z = t[1] * dz - t[2] * dy, t[2] * dx - t[0] * dz, t[0] * dy - t[1] * dx
        sine = math.sqrt(x * x + y * y + z * z)
        if sine < 1e-7:
            continue
        x, y, z = x / sine, y / sine, z / sine
        at = 6 * rail
        plane[at], plane[at + 1], plane[at + 2] = x, y, z
        plane[at + 3], plane[at + 4], plane[at + 5] = (
            y * dz - z * dy,
            z * dx - x * dz,
            x * dy - y * dx,
        )
    phi = twist_at(p, q, a, b)
    plane[12], plane[13] = phi * phi, length
    return length


@compiled
def _turn(before: Floats, here: Floats, rail: int) -> float:
    """Returns rad, about: how far a rail's normal turns across the ruling from one to the next.

    Across both rulings, so that it is as far the other way.
    """
    at = 6 * rail
    turn = 0.0
    for axis in range(at, at + 3):
        turn += (here[axis] - before[axis]) * (here[axis + 3] + before[axis + 3])
    return 0.5 * turn


@compiled
def _step(
    reached: Floats,
    cost: Floats,
    step: Bytes,
    plane: Floats,
    cell: int,
    before: int,
    ds: float,
    weights: tuple[float, float],
    rail: int,
) -> None:
    """Reaches a pair of nodes from the one before it on one rail, ruled or as a fan."""
    fan = FAN_Q if rail == P_FORWARD else FAN_P
    p_turn, q_turn = _turn(plane[before], plane[cell], 0), _turn(plane[before], plane[cell], 1)
    square = 0.5 * (plane[before, 13] ** 2 + plane[cell, 13] ** 2)
    weight, short = weights[0] * square / ds, weights[1] * square * ds
    twist = 0.25 * ds * (plane[before, 12] + plane[cell, 12])
    ruled = cost[before, RULED] + twist + short + weight * 0.5 * (p_turn**2 + q_turn**2)
    if ruled < reached[cell, RULED]:
        reached[cell, RULED], step[RULED] = ruled, rail
    own = p_turn if rail == P_FORWARD else q_turn
    fanned = cost[before, fan] + short + weight * own * own
    if fanned < reached[cell, fan]:
        reached[cell, fan], step[fan] = fanned, rail


@compiled
def _trace(cost: Floats, left: Bytes, step: Bytes, start: Ints, low: Ints) -> tuple[Ints, Bytes]:
    """Follows the cheapest pairing back from the last pair of nodes."""
    i = start.size - 2
    cell = start[i + 1] - 1
    j = low[i] + cell - start[i]
    at = i + j
    pairs, ways = np.empty((at + 1, 2), np.int64), np.empty(at, np.int8)
    mode = 0
    for other in (1, 2):
        if cost[other] < cost[mode]:
            mode = other
    pairs[at, 0], pairs[at, 1] = i, j
    while at > 0:
        back, mode = left[cell, mode] // 3, left[cell, mode] % 3
        for rail in (Q_FORWARD, P_FORWARD):
            if back & rail:
                i, j, at = i - (rail == P_FORWARD), j - (rail == Q_FORWARD), at - 1
                pairs[at, 0], pairs[at, 1], ways[at] = i, j, mode
        rail = step[start[i] + j - low[i], mode]
        i, j, at = i - (rail == P_FORWARD), j - (rail == Q_FORWARD), at - 1
        pairs[at, 0], pairs[at, 1], ways[at] = i, j, mode
        cell = start[i] + j - low[i]
    return pairs, ways

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
crease of the angle `c` costs `CREASE c^2` times its length: so much more than a twist by `c` over a
stretch as long as the ruling. Zigzags of creases never pay on a smooth strip (even at a weight of 1
they cost at least 2.6 times as much as twisting it), and a crease that spares a long twist stays
too slight to be called one. At the rails' ends and corners, where the tangent is free, fans cost
nothing.
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
_SHORTNESS: Final = 1e-12
"""Weight of a ruling's squared length, per mm^2: decides in planes only."""


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
def _switch(cost: Floats, way: Bytes, price: float) -> None:
    """Lets each way at a node be reached from the other two, at the price of a crease."""
    r, p, q = cost[0], cost[1], cost[2]
    way[0], way[1], way[2] = 0, 1, 2
    if p + price < cost[0]:
        cost[0], way[0] = p + price, 1
    if q + price < cost[0]:
        cost[0], way[0] = q + price, 2
    if r + price < cost[1]:
        cost[1], way[1] = r + price, 0
    if q + price < cost[1]:
        cost[1], way[1] = q + price, 2
    if r + price < cost[2]:
        cost[2], way[2] = r + price, 0
    if p + price < cost[2]:
        cost[2], way[2] = p + price, 1


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
    for i in range(p.shape[0]):
        start[i + 1] = start[i] + high[i] - low[i] + 1
    cost = np.full((start[-1], 3), np.inf)
    plane = np.zeros((start[-1], 14))
    way = np.zeros((start[-1], 3), np.int8)
    step = np.zeros((start[-1], 3), np.int8)
    cost[0, :] = 0.0
    for i in range(p.shape[0]):
        for j in range(low[i], high[i] + 1):
            cell = start[i] + j - low[i]
            length = _planes(p[i], q[j], a[i], b[j], plane[cell])
            if i > 0 and low[i - 1] <= j <= high[i - 1]:
                before, ds = start[i - 1] + j - low[i - 1], p_arc[i] - p_arc[i - 1]
                turn = twist_at(p[i], q[j], a[i - 1], a[i]) if ds == 0.0 else 0.0
                _step(cost, step, plane, cell, before, ds, length, turn, bending, P_FORWARD)
            if j > low[i]:
                ds = q_arc[j] - q_arc[j - 1]
                turn = twist_at(p[i], q[j], b[j - 1], b[j]) if ds == 0.0 else 0.0
                _step(cost, step, plane, cell, cell - 1, ds, length, turn, bending, Q_FORWARD)
            _switch(cost[cell], way[cell], CREASE * plane[cell, 12] * length)
    return _trace(cost, way, step, start, low)


@compiled
def _planes(p: Floats, q: Floats, a: Floats, b: Floats, plane: Floats) -> float:
    """Notes normals, directions across and squared twist of a ruling; returns its length."""
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
    cost: Floats,
    step: Bytes,
    plane: Floats,
    cell: int,
    before: int,
    ds: float,
    length: float,
    turn: float,
    bending: float,
    rail: int,
) -> None:
    """Reaches a pair of nodes from the one before it on one rail, in each of the three ways."""
    moving = FAN_Q if rail == P_FORWARD else FAN_P
    resting = FAN_P if rail == P_FORWARD else FAN_Q
    if ds > 0.0:
        p_turn, q_turn = _turn(plane[before], plane[cell], 0), _turn(plane[before], plane[cell], 1)
        square = 0.5 * (plane[before, 13] ** 2 + plane[cell, 13] ** 2)
        weight, short = bending * square / ds, _SHORTNESS * square
        twist = 0.25 * ds * (plane[before, 12] + plane[cell, 12])
        ruled = cost[before, 0] + twist + short * ds + weight * 0.5 * (p_turn**2 + q_turn**2)
        rest = np.inf
        own = p_turn if rail == P_FORWARD else q_turn
        fan = cost[before, moving] + short * ds + weight * own * own
    else:  # from one side of a corner to the other
        crease = CREASE * turn * turn * length
        ruled = cost[before, 0] + crease
        rest = cost[before, resting]
        fan = cost[before, moving] + crease
    if ruled < cost[cell, 0]:
        cost[cell, 0], step[cell, 0] = ruled, rail
    if rest < cost[cell, resting]:
        cost[cell, resting], step[cell, resting] = rest, rail
    if fan < cost[cell, moving]:
        cost[cell, moving], step[cell, moving] = fan, rail


@compiled
def _trace(cost: Floats, way: Bytes, step: Bytes, start: Ints, low: Ints) -> tuple[Ints, Bytes]:
    """Follows the cheapest pairing back from the last pair of nodes."""
    i = start.size - 2
    cell = start[i + 1] - 1
    j = low[i] + cell - start[i]
    longest = i + j + 1
    pairs, ways = np.empty((longest, 2), np.int64), np.empty(longest, np.int8)
    mode = 0
    for other in (1, 2):
        if cost[cell, other] < cost[cell, mode]:
            mode = other
    at = longest - 1
    pairs[at, 0], pairs[at, 1] = i, j
    while at > 0:
        mode = way[cell, mode]
        if step[cell, mode] == P_FORWARD:
            i -= 1
        else:
            j -= 1
        cell = start[i] + j - low[i]
        at -= 1
        ways[at] = mode
        pairs[at, 0], pairs[at, 1] = i, j
    return pairs, ways[: longest - 1]

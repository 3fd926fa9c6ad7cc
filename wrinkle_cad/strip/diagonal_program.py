"""The search along the diagonals of a corridor: the dynamic program at its fastest.

No bridge of a diagonal depends on another of it, so all are decided at once (lanes). Costs of at
most SHORT parts of which the first two alone tell folds and triangles apart: those of most
objectives. Energies are the hinge's, and nothing is barred.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from .compiled import compiled, inlined
from .corridor import Corridor
from .lanes import (
    AREA_P,
    AREA_Q,
    BACK,
    BENDING,
    BENT,
    FLAT_P,
    FLAT_Q,
    FREE,
    INVALID,
    LANES,
    LENGTH,
    P_PART,
    P_REST,
    PART,
    Q_PART,
    Q_REST,
    REST,
    Rails,
    measure,
    put_rows,
    take_rows,
)
from .objective import LENGTH as LENGTH_PART
from .objective import Weights

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

SHORT: Final = 4
"""Parts of a cost that this program takes."""
NEVER: Final = 1e300
"""What it costs to leave the corridor, in the first part."""

_AHEAD_P, _AHEAD_Q, _AFTER_P, _AFTER_Q, _CHOICE = range(
    FREE * LANES, (FREE + 20) * LANES, 4 * LANES
)
_ROWS: Final = FREE + 17
_P0, _P1, _P2, _P3 = range(_AHEAD_P, _AHEAD_Q, LANES)
_Q0, _Q1, _Q2, _Q3 = range(_AHEAD_Q, _AFTER_P, LANES)
_E0, _E1, _E2, _E3 = range(_AFTER_P, _AFTER_Q, LANES)
_F0, _F1, _F2, _F3 = range(_AFTER_Q, _CHOICE, LANES)


def short_weights(weights: Weights) -> Weights | None:
    """Returns the parts of a cost as this program takes them; None if it does not.

    Example:
        >>> from wrinkle_cad.strip.objective import weights_of
        >>> len(short_weights(weights_of(("invalid", "bending"), bridge_count=9)))
        4
        >>> short_weights(weights_of(("area", "bending"), bridge_count=9)) is None
        True
    """
    is_short = len(weights) == SHORT and not any(any(part[:LENGTH_PART]) for part in weights[2:])
    return weights if is_short else None


@compiled
def _put(block: Floats, lane: int, p: Floats, q: Floats, d: int, i: int, count: int) -> None:
    """Writes so many bridges of a diagonal into a block."""
    back = i + q.shape[1] - 2 - d
    put_rows(block, P_PART + lane, p, 0, PART, i, count)
    put_rows(block, P_REST + lane, p, PART - REST, REST, i + 1, count)
    put_rows(block, Q_PART + lane, q, 0, PART, back, count)
    put_rows(block, Q_REST + lane, q, PART - REST, REST, back + 1, count)


@inlined
def _is_q_less(
    p: tuple[float, float, float, float],
    q: tuple[float, float, float, float],
    ties: tuple[float, float, float, float],
) -> bool:
    """Whether the Q-step costs less; without branches."""
    (p0, p1, p2, p3), (q0, q1, q2, q3) = p, q
    more = q3 - p3 if abs(p3 - q3) > ties[3] * (p3 + q3) else 0.0
    more = q2 - p2 if abs(p2 - q2) > ties[2] * (p2 + q2) else more
    more = q1 - p1 if abs(p1 - q1) > ties[1] * (p1 + q1) else more
    more = q0 - p0 if abs(p0 - q0) > ties[0] * (p0 + q0) else more
    return bool(more < 0.0)


@inlined
def _later(
    p: tuple[float, float, float, float],
    q: tuple[float, float, float, float],
    p_fold: tuple[float, float, float],
    q_fold: tuple[float, float, float],
    weights: Weights,
) -> tuple[bool, float, float, float, float]:
    """Whether the Q-step is better, and what the better step costs in each part.

    Args:
        p: costs behind the fold by the P-step.
        q: by the Q-step.
        p_fold: whether the fold before the P-step lies on itself, is invalid; its energy.
        q_fold: the same of the Q-step.
        weights: parts of the cost.
    """
    (back_0, _, invalid_0, bend_0, _, _, _, _), (back_1, _, invalid_1, bend_1, _, _, _, _) = (
        weights[0],
        weights[1],
    )
    x0 = p[0] + (back_0 * p_fold[0] + invalid_0 * p_fold[1] + bend_0 * p_fold[2])
    x1 = p[1] + (back_1 * p_fold[0] + invalid_1 * p_fold[1] + bend_1 * p_fold[2])
    y0 = q[0] + (back_0 * q_fold[0] + invalid_0 * q_fold[1] + bend_0 * q_fold[2])
    y1 = q[1] + (back_1 * q_fold[0] + invalid_1 * q_fold[1] + bend_1 * q_fold[2])
    ties = weights[0][7], weights[1][7], weights[2][7], weights[3][7]
    is_q = _is_q_less((x0, x1, p[2], p[3]), (y0, y1, q[2], q[3]), ties)
    return (
        is_q,
        y0 if is_q else x0,
        y1 if is_q else x1,
        q[2] if is_q else p[2],
        q[3] if is_q else p[3],
    )


@compiled
def _decide(block: Floats, first: int, count: int, weights: Weights) -> None:
    """Decides the step to take from bridges of a block, by the step that came (decide_row)."""
    # Lanes counted from 0 on: no index can be negative, which numba would look at.
    w = block[first:]
    _, flat_0, _, _, area_0, length_0, all_0, _ = weights[0]
    _, flat_1, _, _, area_1, length_1, all_1, _ = weights[1]
    length_2, all_2, length_3, all_3 = weights[2][5], weights[2][6], weights[3][5], weights[3][6]
    for k in range(count):
        size, invalid = w[LENGTH + k], w[INVALID + k]
        p = (
            w[_P0 + k] + (flat_0 * w[FLAT_P + k] + area_0 * w[AREA_P + k]),
            w[_P1 + k] + (flat_1 * w[FLAT_P + k] + area_1 * w[AREA_P + k]),
            w[_P2 + k],
            w[_P3 + k],
        )
        q = (
            w[_Q0 + k] + (flat_0 * w[FLAT_Q + k] + area_0 * w[AREA_Q + k]),
            w[_Q1 + k] + (flat_1 * w[FLAT_Q + k] + area_1 * w[AREA_Q + k]),
            w[_Q2 + k],
            w[_Q3 + k],
        )
        p_fold = w[BACK[0] + k], invalid * w[BENT[0] + k], w[BENDING[0] + k]
        q_fold = w[BACK[1] + k], invalid * w[BENT[1] + k], w[BENDING[1] + k]
        after_p, e0, e1, e2, e3 = _later(p, q, p_fold, q_fold, weights)
        p_fold = w[BACK[2] + k], invalid * w[BENT[2] + k], w[BENDING[2] + k]
        q_fold = w[BACK[3] + k], invalid * w[BENT[3] + k], w[BENDING[3] + k]
        after_q, f0, f1, f2, f3 = _later(p, q, p_fold, q_fold, weights)
        own_0, own_1 = length_0 * size + all_0 * invalid, length_1 * size + all_1 * invalid
        own_2, own_3 = length_2 * size + all_2 * invalid, length_3 * size + all_3 * invalid
        w[_E0 + k], w[_E1 + k], w[_E2 + k], w[_E3 + k] = (
            own_0 + e0,
            own_1 + e1,
            own_2 + e2,
            own_3 + e3,
        )
        w[_F0 + k], w[_F1 + k], w[_F2 + k], w[_F3 + k] = (
            own_0 + f0,
            own_1 + f1,
            own_2 + f2,
            own_3 + f3,
        )
        w[_CHOICE + k] = (1.0 if after_p else 0.0) + (2.0 if after_q else 0.0)


@compiled
def _end(block: Floats, weights: Weights) -> None:
    """Writes what the last bridge costs, which no step leaves; it is in the first lane."""
    size, invalid = block[LENGTH], block[INVALID]
    for number in range(SHORT):
        part = weights[number]
        own = part[5] * size + part[6] * invalid
        block[_AFTER_P + number * LANES] = block[_AFTER_Q + number * LANES] = own


@compiled
def _next_piece(corridor: Corridor, d: int, i: int, used: int) -> tuple[int, int, int]:
    """How many bridges of a diagonal fit into a block; and from where its rest begins."""
    count = min(LANES - used, corridor.high[d] - i)
    if i + count < corridor.high[d]:
        return count, d, i + count
    return count, d - 1, corridor.low[d - 1] if d > 0 else 0


@compiled
def _decide_pieces(
    block: Floats,
    used: int,
    d: int,
    i: int,
    corridor: Corridor,
    weights: Weights,
    costs: Floats,
    choices: Bytes,
) -> None:
    """Decides the bridges of a block, diagonal by diagonal, from bridge i of diagonal d on."""
    last, lane = corridor.low.size - 1, 0
    while lane < used:
        count, next_d, next_i = _next_piece(corridor, d, i, lane)
        count = min(count, used - lane)
        ahead, here = costs[1 - (d & 1)], costs[d & 1]
        put_rows(block, _AHEAD_P + lane, ahead[0], 0, SHORT, i + 2, count)
        put_rows(block, _AHEAD_Q + lane, ahead[1], 0, SHORT, i + 1, count)
        _decide(block, lane, count, weights)
        if d == last:
            _end(block, weights)
        take_rows(block, _AFTER_P + lane, here[0], i + 1, count)
        take_rows(block, _AFTER_Q + lane, here[1], i + 1, count)
        at = i - corridor.low[d]
        for k in range(count):
            byte = corridor.first[d] + ((at + k) >> 2)
            choices[byte] |= int(block[_CHOICE + lane + k]) << (2 * ((at + k) & 3))
        if next_d != d:
            # Stretches move on by at most one bridge: these two stand for all outside.
            here[:, :, corridor.low[d]] = here[:, :, corridor.high[d] + 1] = NEVER
        lane, d, i = lane + count, next_d, next_i


@compiled
def decide_corridor(
    rails: Rails,
    corridor: Corridor,
    weights: Weights,
    planarity: float,
    nothing: float,
) -> tuple[Bytes, Floats]:
    """Finds the best path from the first bridge to the last within a corridor.

    Args:
        rails: of m and n samples.
        corridor: connected from the first bridge to the last.
        weights: parts of the cost (short_weights).
        planarity: mm; see validity_matrix; also how far coplanar triangles are apart.
        nothing: mm; a distance that is round-off.

    Returns:
        (bytes,) uint8, two bits a bridge: bit 0 is the step to take (0: P) after a P-step, bit 1
        that after a Q-step. (4,) the parts of the least cost.
    """
    block = np.zeros(_ROWS * LANES)
    costs = np.full((2, 2, SHORT, rails.p.shape[1] + 1), NEVER)
    choices = np.zeros(corridor.first[-1], dtype=np.uint8)
    d, i = corridor.low.size - 1, corridor.low[-1]
    while d >= 0:
        first_d, first_i, used = d, i, 0
        while d >= 0 and used < LANES:
            count, next_d, next_i = _next_piece(corridor, d, i, used)
            _put(block, used, rails.p, rails.q, d, i, count)
            used, d, i = used + count, next_d, next_i
        measure(block, used, planarity, nothing)
        _decide_pieces(block, used, first_d, first_i, corridor, weights, costs, choices)
    return choices, costs[0, 0, :, 1].copy()


@compiled
def follow_corridor(choices: Bytes, corridor: Corridor) -> npt.NDArray[np.int8]:
    """Returns the steps from the first bridge to the last, (m+n-2,) int8: 0 a P-step, 1 a Q-step.

    Args:
        choices: of decide_corridor.
        corridor: the same.
    """
    steps = np.empty(corridor.low.size - 1, dtype=np.int8)
    i = step = 0
    for d in range(steps.size):
        at = i - corridor.low[d]
        step = (choices[corridor.first[d] + (at >> 2)] >> (2 * (at & 3)) >> step) & 1
        steps[d] = step
        i += 1 - step
    return steps

"""The best of all boundary bridge triangulations: GODT+GMBT, GMBT, GMAT and any other objective.

Wang and Tang (sections 5 and 6) run Dijkstra's algorithm on a graph with two nodes per bridge, by
the step that arrives there, since the bending at a bridge depends on both its triangles. That
graph is a monotone grid, so a dynamic program visits each node once and needs no heap. Costs are
tuples compared in order, so one pass minimises all criteria over all paths, where the paper takes
one path with the fewest invalid bridges and bends only its gaps less.

The program runs from the last bridge to the first and remembers for each node which step to
take next; of two steps that cost the same in every part of the objective it takes the P-step. It
looks at the bridges of a corridor only, where counts tell that no other can be on the best path.
Sums of energies, areas or lengths are the same if they differ by no more than objective.REAL_TIE
of themselves, so that round-off decides nothing; a result may cost more than the least by as much
at each bridge.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .bars import Bars, bar_row, no_bars
from .compiled import compiled
from .convexity import judge_row
from .folding import HINGE, StepCosts, cost_row, new_costs
from .narrow_search import narrow_steps
from .objective import (
    AREA,
    BENDING,
    DEGENERATE,
    FLAT_INVALID,
    FOLD_BACK,
    INVALID,
    LENGTH,
    TIE,
    Part,
    Weights,
)
from .sightlines import VIEW_ROWS, bank_lengths, look_along, padded_banks

Floats = npt.NDArray[np.float64]


@compiled
def weighted_fold(part: Part, costs: StepCosts, invalid: float, row: int, j: int) -> float:
    """What one part of the cost says to the fold at bridge j, by the steps around it (row)."""
    back, bent = costs.fold_backs[row, j], costs.bent[row, j]
    counts = part[FOLD_BACK] * back + part[INVALID] * (invalid * bent)
    return float(counts + part[BENDING] * costs.bending[row, j])


@compiled
def later_step(
    weights: Weights, to_end: Floats, costs: StepCosts, invalid: float, earlier: int, j: int
) -> int:
    """Returns the better step to take from bridge j of a row; ties go to the P-step.

    Args:
        weights: parts of the cost.
        to_end: (2, parts) float64; cost of each step's triangle and of all behind it.
        costs: of the row's bridges.
        invalid: 1.0 if the bridge is not locally convex, else 0.0.
        earlier: the step that arrived here.
        j: the bridge.
    """
    for number in range(len(weights)):
        part = weights[number]
        p_cost = to_end[0, number] + weighted_fold(part, costs, invalid, 2 * earlier, j)
        q_cost = to_end[1, number] + weighted_fold(part, costs, invalid, 2 * earlier + 1, j)
        if abs(p_cost - q_cost) > part[TIE] * (p_cost + q_cost):
            return 0 if p_cost < q_cost else 1
    return 0


@compiled
def decide_row(
    weights: Weights,
    is_last_row: bool,
    view: Floats,
    valid: npt.NDArray[np.bool_],
    costs: StepCosts,
    ahead: Floats,
    choices: npt.NDArray[np.uint8],
) -> None:
    """Decides the step to take from each bridge of a row, from its last bridge to its first.

    One row of the dynamic program. Where a strip ends is said by `ahead` and `is_last_row` alone.

    Args:
        weights: parts of the cost, in order of comparison.
        is_last_row: no P-step leaves this row: it ends at its last bridge.
        view: (9, n) float64, mm; the row's bridges (look_along).
        valid: (n,) bool; which of them are locally convex.
        costs: what leaving them costs (cost_row).
        ahead: (n, parts) float64; costs from the next row's bridges, reached by a P-step, to the
            end; on return those from this row's.
        choices: (n,) uint8; written. Bit 0 is the step to take (0: P) after a P-step, bit 1 that
            after a Q-step.
    """
    parts = len(weights)
    last = view.shape[1] - 1
    cost = np.zeros((2, parts))
    after_q = np.zeros(parts)
    for j in range(last, -1, -1):
        for number in range(parts):
            part = weights[number]
            flat, size = part[DEGENERATE], part[AREA]
            p_triangle = flat * costs.degenerate[1, j] + size * costs.area[0, j]
            q_triangle = flat * costs.degenerate[3, j] + size * costs.area[1, j]
            cost[0, number] = ahead[j, number] + p_triangle
            cost[1, number] = after_q[number] + q_triangle
        choice = 0
        invalid = 0.0 if valid[j] else 1.0
        is_end = is_last_row and j == last
        for earlier in range(2):
            if is_last_row or j == last:
                later = 1 if is_last_row else 0
            else:
                later = later_step(weights, cost, costs, invalid, earlier, j)
            choice |= later << earlier
            for number in range(parts):
                part = weights[number]
                own = part[LENGTH] * view[0, j] + part[FLAT_INVALID] * invalid
                if not is_end:
                    fold = weighted_fold(part, costs, invalid, 2 * earlier + later, j)
                    own += cost[later, number] + fold
                if earlier == 0:
                    ahead[j, number] = own
                else:
                    after_q[number] = own
        choices[j] = choice


@compiled
def _decide_all(
    p: Floats,
    p_banks: Floats,
    q: Floats,
    q_banks: Floats,
    weights: Weights,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars,
) -> npt.NDArray[np.uint8]:
    """The step to take from every bridge as decide_row writes it, (m, (n+3)//4) uint8: 2 bits."""
    m, n = p.shape[0], q.shape[1]
    view = np.empty((VIEW_ROWS, n))
    valid = np.empty(n, dtype=np.bool_)
    costs = new_costs(n)
    banks = np.empty((4, n))
    banks[2] = bank_lengths(q_banks[:, :-1])
    banks[3] = bank_lengths(q_banks[:, 1:])
    p_lengths = bank_lengths(p_banks)
    ahead = np.zeros((n, len(weights)))
    row = np.empty(n, dtype=np.uint8)
    choices = np.zeros((m, (n + 3) // 4), dtype=np.uint8)
    for i in range(m - 1, -1, -1):
        banks[0], banks[1] = p_lengths[i], p_lengths[i + 1]
        look_along(p[i], p_banks[:, i : i + 2], q, q_banks, view)
        judge_row(view, planarity, valid)
        cost_row(view, banks, nothing, planarity, energy, costs)
        bar_row(view, bars, i, costs)
        decide_row(weights, i == m - 1, view, valid, costs, ahead, row)
        for j in range(n):
            choices[i, j >> 2] |= row[j] << (2 * (j & 3))
    return choices


@compiled
def _follow(choices: npt.NDArray[np.uint8], n: int) -> npt.NDArray[np.int8]:
    """The steps from the first bridge to the last, (m+n-2,) int8: 0 a P-step, 1 a Q-step."""
    count = choices.shape[0] + n - 2
    steps = np.empty(count, dtype=np.int8)
    i = j = step = 0
    for number in range(count):
        step = (choices[i, j >> 2] >> (2 * (j & 3)) >> step) & 1
        steps[number] = step
        i, j = i + 1 - step, j + step
    return steps


def best_steps(
    p: Floats,
    q: Floats,
    weights: Weights,
    *,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars | None = None,
) -> npt.NDArray[np.int8]:
    """Returns the steps of the triangulation that costs least of all.

    At most O(m n) time; memory: a quarter of a byte per bridge and a few rows. Where counts come
    first, or have a price, and hardly any bridge is invalid, O(m+n) of both.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        weights: parts of the cost, in order of comparison (objective.weights_of).
        planarity: mm; see validity_matrix; also how far coplanar triangles are apart.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
        bars: bridges and folds to avoid wherever that can be; none by default.

    Returns:
        (m+n-2,) int8: 0 a P-step, 1 a Q-step. Of equal continuations the P-step is taken.
    """
    if energy == HINGE and (bars is None or bars.is_none):
        steps = narrow_steps(p, q, weights, planarity=planarity, nothing=nothing)
        if steps is not None:
            return steps
    choices = _decide_all(
        p,
        padded_banks(p),
        np.ascontiguousarray(q.T),
        padded_banks(q),
        weights,
        planarity,
        nothing,
        energy,
        no_bars() if bars is None else bars,
    )
    return _follow(choices, q.shape[0])

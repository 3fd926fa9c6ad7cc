"""The best of all boundary bridge triangulations: GODT+GMBT, GMBT, GMAT and any other objective.

Wang and Tang (sections 5 and 6) run Dijkstra's algorithm on a graph with two nodes per bridge, by
the step that arrives there, since the bending at a bridge depends on both its triangles. That
graph is a monotone grid, so a dynamic program visits each node once and needs no heap. Costs are
tuples compared in order, so one pass minimises all criteria over all paths, where the paper takes
one path with the fewest invalid bridges and bends only its gaps less.

The program runs from the last bridge to the first and remembers for each node which step to
take next; of two steps that cost the same in every criterion it takes the P-step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError

from .compiled import compiled
from .convexity import judge_row
from .folding import StepCosts, cost_row, new_costs
from .sightlines import VIEW_ROWS, bank_lengths, look_along, padded_banks

Floats = npt.NDArray[np.float64]
Weights = tuple[tuple[float, float, float, float, float], ...]

INVALID, DEGENERATE, BENDING, AREA, LENGTH = range(5)
"""What is measured at a bridge and on the step that leaves it; columns of the weights."""

_MEASURES = {
    "invalid": (INVALID,),
    "bending": (DEGENERATE, BENDING),
    "area": (AREA,),
    "length": (LENGTH,),
}

_COUNT_BASE = 2.0**26
"""Two counts share a float64 exactly as long as a strip has fewer bridges than this."""


def weights_of(criteria: Sequence[str]) -> Weights:
    """Returns one row of weights per part of the cost, in order of comparison.

    A part is the weighted sum of invalid bridges, degenerate triangles, bending, area and length.
    Degenerate triangles (and folds of 180 degrees) count as a criterion of their own just before
    bending; two counts in a row share a part.

    Raises:
        InputError: there is no criterion, an unknown one, or one twice.
    """
    names = list(criteria) if not isinstance(criteria, str) else [criteria]
    unknown = [name for name in names if name not in _MEASURES]
    if unknown or not names or len(set(names)) < len(names):
        found = ", ".join(map(str, names)) or "none"
        raise InputError(
            f"criteria - {found} - an ordered choice of {', '.join(_MEASURES)}, each once"
            ' - for instance ("invalid", "bending")'
        )
    rows: list[list[float]] = []
    last = -1
    for measure in (measure for name in names for measure in _MEASURES[name]):
        if measure == DEGENERATE and last == INVALID:
            rows[-1][INVALID] = _COUNT_BASE
            rows[-1][DEGENERATE] = 1.0
        else:
            rows.append([1.0 if column == measure else 0.0 for column in range(5)])
        last = measure
    return tuple((row[0], row[1], row[2], row[3], row[4]) for row in rows)


@compiled
def _later_step(
    weights: Weights, to_p: Floats, to_q: Floats, bending: Floats, fold_backs: Floats
) -> int:
    """The better step to take, after the folds that it makes are added; ties go to the P-step."""
    for part in range(len(weights)):
        fold, bend = weights[part][DEGENERATE], weights[part][BENDING]
        p_cost = to_p[part] + (fold * fold_backs[0] + bend * bending[0])
        q_cost = to_q[part] + (fold * fold_backs[1] + bend * bending[1])
        if p_cost != q_cost:
            return 0 if p_cost < q_cost else 1
    return 0


@compiled
def _decide_row(
    weights: Weights,
    is_last_row: bool,
    view: Floats,
    valid: npt.NDArray[np.bool_],
    costs: StepCosts,
    ahead: Floats,
    choices: npt.NDArray[np.uint8],
) -> None:
    """Decides the step to take from each bridge of a row, from its last bridge to its first.

    `ahead` (n, parts) holds the costs from the next row's bridges, reached by a P-step, to the
    end; on return those from this row's. Bit 0 of a choice is the step to take (0: P) after
    a P-step, bit 1 that after a Q-step.
    """
    bending, fold_backs, degenerate, area = (
        costs.bending,
        costs.fold_backs,
        costs.degenerate[1::2],
        costs.area,
    )
    parts = len(weights)
    last = view.shape[1] - 1
    to_end = np.zeros((2, parts))
    cost = np.zeros((2, parts))
    for j in range(last, -1, -1):
        for part in range(parts):
            flat, size = weights[part][DEGENERATE], weights[part][AREA]
            cost[0, part] = ahead[j, part] + (flat * degenerate[0, j] + size * area[0, j])
            cost[1, part] = to_end[1, part] + (flat * degenerate[1, j] + size * area[1, j])
        choice = 0
        for earlier in range(2):
            row = 2 * earlier
            if j == last or is_last_row:
                later = 1 if is_last_row else 0
            else:
                later = _later_step(
                    weights,
                    cost[0],
                    cost[1],
                    bending[row : row + 2, j],
                    fold_backs[row : row + 2, j],
                )
            choice |= later << earlier
            for part in range(parts):
                weight = weights[part]
                own = weight[INVALID] * (0.0 if valid[j] else 1.0) + weight[LENGTH] * view[0, j]
                fold = weight[DEGENERATE] * fold_backs[row + later, j]
                fold += weight[BENDING] * bending[row + later, j]
                is_end = is_last_row and j == last
                to_end[earlier, part] = own + (0.0 if is_end else cost[later, part] + fold)
        choices[j] = choice
        for part in range(parts):
            ahead[j, part] = to_end[0, part]


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
) -> npt.NDArray[np.uint8]:
    """The step to take from every bridge, (m, n) uint8, as _decide_row writes it."""
    m, n = p.shape[0], q.shape[1]
    view = np.empty((VIEW_ROWS, n))
    valid = np.empty(n, dtype=np.bool_)
    costs = new_costs(n)
    banks = np.empty((4, n))
    banks[2] = bank_lengths(q_banks[:, :-1])
    banks[3] = bank_lengths(q_banks[:, 1:])
    p_lengths = bank_lengths(p_banks)
    ahead = np.zeros((n, len(weights)))
    choices = np.empty((m, n), dtype=np.uint8)
    for i in range(m - 1, -1, -1):
        banks[0], banks[1] = p_lengths[i], p_lengths[i + 1]
        look_along(p[i], p_banks[:, i : i + 2], q, q_banks, view)
        judge_row(view, planarity, valid)
        cost_row(view, banks, nothing, energy, costs)
        _decide_row(weights, i == m - 1, view, valid, costs, ahead, choices[i])
    return choices


@compiled
def _follow(choices: npt.NDArray[np.uint8]) -> npt.NDArray[np.int8]:
    """The steps from the first bridge to the last, (m+n-2,) int8: 0 a P-step, 1 a Q-step."""
    count = choices.shape[0] + choices.shape[1] - 2
    steps = np.empty(count, dtype=np.int8)
    i = j = step = 0
    for number in range(count):
        step = (choices[i, j] >> step) & 1
        steps[number] = step
        i, j = i + 1 - step, j + step
    return steps


def best_steps(
    p: Floats, q: Floats, weights: Weights, *, planarity: float, nothing: float, energy: int
) -> npt.NDArray[np.int8]:
    """Returns the steps of the triangulation that costs least of all.

    O(m n) time; memory: one byte per bridge and a few rows.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        weights: parts of the cost, in order of comparison (weights_of).
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.

    Returns:
        (m+n-2,) int8: 0 a P-step, 1 a Q-step. Of equal continuations the P-step is taken.
    """
    columns = np.ascontiguousarray(q.T)
    choices = _decide_all(
        p, padded_banks(p), columns, padded_banks(q), weights, planarity, nothing, energy
    )
    return _follow(choices)

"""The best triangulation of a closed strip over all starting bridges, by branch and bound.

A closed strip has no first bridge: every triangulation of it takes exactly one P-step out of sample
0 of P, from some bridge (0, j), and comes back to (m, j + n). Costs depend on the step that
arrived, so the best triangulations of different j cross and dividing between them (Fuchs, Kedem,
Uselton, "Optimal surface reconstruction from planar contours", 1977) is not exact. Instead one
dynamic program over all starts j in [a, b) and all ends in [a + n, b + n) gives a lower bound,
which is exact if its path ends n behind its start. Else the range is cut between the two and both
parts are searched, the cheaper bound first, without the starts whose own bound is no better than
the best closed path.

Starts are taken on the rail with fewer samples. Smooth strips of 180 and 240 samples took one to
four programs, flat and noisy ones up to forty.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .compiled import compiled
from .convexity import judge_row
from .folding import cost_row, new_costs
from .global_search import decide_row
from .objective import TIE, Weights
from .sightlines import VIEW_ROWS, bank_lengths, look_along

Floats = npt.NDArray[np.float64]
Steps = npt.NDArray[np.int8]

_NEVER = 1e300
"""Cost in the first part, a count, of what is not allowed."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedPath:
    """The best way once around a closed strip."""

    start: tuple[int, int]
    """i, j of the bridge where it starts and ends: i or j is 0."""
    steps: Steps
    """(m+n,) int8; 0 a P-step, 1 a Q-step, from the start until it is reached again."""
    programs: int
    """How many dynamic programs it took, each over m times n to 2 n bridges."""


@compiled
def _decide_range(
    p: Floats,
    q: Floats,
    first: int,
    starts: int,
    weights: Weights,
    planarity: float,
    nothing: float,
    energy: int,
) -> tuple[Floats, npt.NDArray[np.uint8]]:
    """One program over the starts (0, first), ..., (0, first + starts - 1).

    Returns:
        (starts, parts): the least cost from each start to any of the ends. (m, n + starts) uint8:
        the step to take at samples 1 to m of P, as decide_row writes it.
    """
    m, n = p.shape[0], q.shape[1]
    count = n + starts
    columns, q_banks = np.empty((3, count)), np.empty((3, count + 1))
    for c in range(count + 1):
        here, before = (first + c) % n, (first + c - 1) % n
        for axis in range(3):
            q_banks[axis, c] = q[axis, here] - q[axis, before]
            if c < count:
                columns[axis, c] = q[axis, here]
    view, valid, costs = np.empty((VIEW_ROWS, count)), np.empty(count, np.bool_), new_costs(count)
    banks, p_banks = np.empty((4, count)), np.empty((3, 2))
    banks[2] = bank_lengths(q_banks[:, :-1])
    banks[3] = bank_lengths(q_banks[:, 1:])
    ahead = np.zeros((count, len(weights)))
    ahead[:n, 0] = _NEVER
    choices = np.empty((m, count), dtype=np.uint8)
    for i in range(m, 0, -1):
        for axis in range(3):
            p_banks[axis, 0] = p[i % m, axis] - p[i - 1, axis]
            p_banks[axis, 1] = p[(i + 1) % m, axis] - p[i % m, axis]
        lengths = bank_lengths(p_banks)
        banks[0], banks[1] = lengths[0], lengths[1]
        look_along(p[i % m], p_banks, columns, q_banks, view)
        judge_row(view, planarity, valid)
        cost_row(view, banks, nothing, planarity, energy, costs)
        decide_row(weights, False, view, valid, costs, ahead, choices[i - 1])
    return ahead[:starts].copy(), choices


@compiled
def _follow_around(choices: npt.NDArray[np.uint8], start: int) -> tuple[Steps, int]:
    """The steps from (0, start) until row m is left, and the column where it is left."""
    m, count = choices.shape
    steps = np.zeros(m + count, dtype=np.int8)
    number, i, j, step = 1, 1, start, 0
    while i <= m:
        step = (choices[i - 1, j] >> step) & 1
        steps[number] = step
        number += 1
        i, j = i + 1 - step, j + step
    return steps[: number - 1], j


class _Cost:
    """A cost that compares part by part, sums up to round-off."""

    def __init__(self, parts: Floats, weights: Weights) -> None:
        self.parts, self.weights = parts, weights

    def __lt__(self, other: _Cost) -> bool:
        for mine, its, part in zip(self.parts, other.parts, self.weights, strict=True):
            if abs(mine - its) > part[TIE] * (mine + its):
                return bool(mine < its)
        return False


class _Search:
    """Branch and bound over the starts on the columns' rail."""

    def __init__(self, p: Floats, q: Floats, weights: Weights, limits: tuple[float, float, int]):
        self.p, self.columns = p, np.ascontiguousarray(q.T)
        self.weights, self.limits = weights, limits
        self.programs = 0
        self.best: tuple[_Cost, int, Steps] | None = None

    def run(self) -> tuple[int, Steps]:
        """The start of the best closed path, and its steps."""
        ranges: list[tuple[_Cost, int, int, list[_Cost]]] = []
        self._search_range(0, self.columns.shape[1], ranges)
        while ranges:
            bound, first, cut, costs = heapq.heappop(ranges)
            if not self._is_open(bound):
                break
            starts = [first + c for c, cost in enumerate(costs) if self._is_open(cost)]
            for part in ([j for j in starts if j < cut], [j for j in starts if j >= cut]):
                if part:
                    self._search_range(part[0], part[-1] + 1, ranges)
        assert self.best is not None
        return self.best[1], self.best[2]

    def _is_open(self, bound: _Cost) -> bool:
        return self.best is None or bound < self.best[0]

    def _search_range(
        self, first: int, stop: int, ranges: list[tuple[_Cost, int, int, list[_Cost]]]
    ) -> None:
        """Keeps the best path of a range of starts if it is closed, else the range, to be cut."""
        parts, choices = self._program(first, stop)
        costs = [_Cost(one, self.weights) for one in parts]
        start = 0
        for c in range(1, len(costs)):
            start = c if costs[c] < costs[start] else start
        steps, end = _follow_around(choices, start)
        landed = end - self.columns.shape[1]
        if landed == start:
            if self._is_open(costs[start]):
                self.best = costs[start], first + start, steps
            return
        if self.best is None:
            self._search_range(first + start, first + start + 1, ranges)
        if self._is_open(costs[start]):
            cut = first + (start + landed + 1) // 2
            heapq.heappush(ranges, (costs[start], first, cut, costs))

    def _program(self, first: int, stop: int) -> tuple[Floats, npt.NDArray[np.uint8]]:
        self.programs += 1
        planarity, nothing, energy = self.limits
        return _decide_range(
            self.p,
            self.columns,
            first,
            stop - first,
            self.weights,
            planarity,
            nothing,
            energy,
        )


def closed_steps(
    p: Floats, q: Floats, weights: Weights, *, planarity: float, nothing: float, energy: int
) -> ClosedPath:
    """Returns the triangulation of a closed strip that costs least of all, over all its starts.

    Args:
        p: (m, 3) float64, mm; checked samples of closed directrix P, the first one not repeated at
            the end; m at least 2.
        q: (n, 3) float64, mm; checked samples of closed directrix Q in the same sense, n >= 2.
        weights: parts of the cost, in order of comparison (objective.weights_of).
        planarity: mm; see validity_matrix; also how far coplanar triangles are apart.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
    """
    is_swapped = q.shape[0] > p.shape[0]
    rails = (q, p) if is_swapped else (p, q)
    search = _Search(*rails, weights, (planarity, nothing, energy))
    start, steps = search.run()
    if is_swapped:
        return ClosedPath((start, 0), (1 - steps).astype(np.int8), search.programs)
    return ClosedPath((0, start), steps, search.programs)

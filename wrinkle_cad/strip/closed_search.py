"""The best triangulation of a closed strip over all starting bridges, by branch and bound.

A closed strip has no first bridge: every triangulation of it takes exactly one P-step out of sample
0 of P, from some bridge (0, j), and comes back to (m, j + n). Costs depend on the step that
arrived, so the best triangulations of different j cross and dividing between them (Fuchs, Kedem,
Uselton, "Optimal surface reconstruction from planar contours", 1977) is not exact. Instead one
dynamic program over all starts j in [a, b) and all ends in [a + n, b + n) gives a lower bound,
which is exact if its path ends n behind its start. Else the range is cut between the two and both
parts are searched, the cheaper bound first, without the starts whose own bound is no better than
the best closed path.

Pinned bridges lie at places of the strip's cover, where it runs on and on around: the rails are
started at the first of them, and bridges are barred that no path through the others can have.

Starts are taken on the rail with fewer samples. Smooth strips of 180 and 240 samples took one to
four programs, flat and noisy ones up to forty.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from .bars import Bars, bar_row, no_bars
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
    """i, j of the bridge where it starts and ends."""
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
    bars: Bars,
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
        bar_row(view, Bars(bars.bridges[:, first:], bars.least_cosine), i - 1, costs)
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

    def __init__(
        self,
        p: Floats,
        q: Floats,
        weights: Weights,
        limits: tuple[float, float, int],
        bars: Bars,
    ) -> None:
        self.p, self.columns = p, np.ascontiguousarray(q.T)
        self.weights, self.limits = weights, limits
        self.bars = Bars(np.ascontiguousarray(bars.bridges), bars.least_cosine)
        self.programs = 0
        self.best: tuple[_Cost, int, Steps] | None = None

    @property
    def cost(self) -> _Cost:
        """Of the best closed path, once the search has run."""
        assert self.best is not None
        return self.best[0]

    @property
    def found(self) -> tuple[int, Steps]:
        """The start of the best closed path, and its steps."""
        assert self.best is not None
        return self.best[1:]

    def run(self) -> None:
        """Finds the best closed path."""
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
            self.bars,
        )


def closed_steps(
    p: Floats,
    q: Floats,
    weights: Weights,
    *,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars | None = None,
    pinned: Sequence[tuple[int, int]] = (),
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
        bars: bridges and folds to avoid wherever that can be; none by default.
        pinned: bridges it must have; some path has all of them (is_around).
    """
    is_swapped = q.shape[0] > p.shape[0]
    rails = (q, p) if is_swapped else (p, q)
    pins = [pin[::-1] if is_swapped else pin for pin in pinned]
    barred, least_cosine = no_bars() if bars is None else bars
    base = pins[0] if pins else (0, 0)
    rolled = [np.roll(rail, -at, axis=0) for rail, at in zip(rails, base, strict=True)]
    around = np.roll(barred.T if is_swapped else barred, (-base[0], -base[1]), (0, 1))
    best: _Search | None = None
    programs = 0
    for cover in _covers(around, pins, (len(rails[0]), len(rails[1]))):
        search = _Search(
            rolled[0], rolled[1], weights, (planarity, nothing, energy), Bars(cover, least_cosine)
        )
        search.run()
        programs += search.programs
        if best is None or search.cost < best.cost:
            best = search
    assert best is not None
    start, steps = best.found
    first = base[0], (base[1] + start) % len(rails[1])
    if is_swapped:
        return ClosedPath(first[::-1], (1 - steps).astype(np.int8), programs)
    return ClosedPath(first, steps, programs)


def is_around(pinned: Sequence[tuple[int, int]], m: int, n: int) -> bool:
    """Whether some path around a closed strip of m and n samples has all of the pinned bridges.

    Example:
        >>> is_around([(0, 0), (2, 3), (5, 4)], 8, 8), is_around([(0, 0), (2, 4), (5, 3)], 8, 8)
        (True, False)
    """
    return not pinned or any(True for _ in _places(pinned, m, n))


def _places(
    pinned: Sequence[tuple[int, int]], m: int, n: int
) -> Iterator[tuple[tuple[int, int], ...]]:
    """Where pinned bridges can lie on one turn of the cover, from the first one to itself again."""
    ways = []
    for i, j in dict.fromkeys(((a - pinned[0][0]) % m, (b - pinned[0][1]) % n) for a, b in pinned):
        own = [(i, j)]
        own += [(m, j)] * (i == 0) + [(i, n)] * (j == 0)
        ways.append([(0, 0)] if i == j == 0 else own)
    for places in product(*ways):
        if all((a - c) * (b - d) >= 0 for (a, b), (c, d) in combinations(places, 2)):
            yield places


def _covers(
    barred: npt.NDArray[np.bool_], pinned: Sequence[tuple[int, int]], shape: tuple[int, int]
) -> Iterator[npt.NDArray[np.bool_]]:
    """The barred bridges of samples 1 to m and 0 to 2 n of the cover, for each way to pin them."""
    m, n = shape
    if not pinned:
        yield np.roll(np.tile(barred, 2), -1, axis=0)
        return
    once = np.roll(barred, -1, axis=0) if barred.size else np.zeros(shape, dtype=np.bool_)
    rows, columns = np.arange(1, m + 1)[:, None], np.arange(2 * n)
    for places in _places(pinned, m, n):
        cover = np.tile(once, 2)
        # The bridges before the first step on P are seen on the next turn, so pins stand there too.
        for i, j in (*places, *((i + m, j + n) for i, j in places)):
            cover |= ((rows < i) & (columns > j)) | ((rows > i) & (columns < j))
        yield cover

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

What each program finds out is a bound for the bridges as well: if the least cost of coming to a
bridge and that of going on from it are together more than the best closed path costs, no better one
has it. So the programs behind the first look at a corridor of bridges only, and the strip is begun
where that is narrowest (closed_corridor).

Starts are taken on the rail with fewer samples. Of 64 strips of 180 and 240 samples, smooth ones
took the time of 2 to 10 open searches, flat or noisy ones that of 7 to 13, and the same share at
2,000 and 2,000 samples. Without bending and validity (least area) it may be 100.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Final

import numpy as np
import numpy.typing as npt

from .bars import Bars, no_bars
from .closed_corridor import Around, Corridor, corridor_of, stride_of
from .closed_program import (
    CROSSINGS,
    NEVER,
    NOTHING,
    Window,
    decide_range,
    follow_around,
    whole_window,
)
from .objective import TIE, Weights

Floats = npt.NDArray[np.float64]
Steps = npt.NDArray[np.int8]

GRAIN: Final = 1024.0
"""Charges of counts are whole numbers of one part in so many."""
LARGEST_COUNT: Final = 2.0**40
"""Sums of counts below this are exact with such charges."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedPath:
    """The best way once around a closed strip."""

    start: tuple[int, int]
    """i, j of the bridge where it starts and ends."""
    steps: Steps
    """(m+n,) int8; 0 a P-step, 1 a Q-step, from the start until it is reached again."""
    programs: int
    """How many dynamic programs it took, each over m times n to 2 n bridges."""


class _Cost:
    """A cost that compares part by part, sums up to round-off."""

    def __init__(self, parts: list[float], weights: Weights) -> None:
        self.parts, self.weights = parts, weights

    def __lt__(self, other: _Cost) -> bool:
        for mine, its, part in zip(self.parts, other.parts, self.weights, strict=True):
            if mine != its and abs(mine - its) > part[TIE] * (mine + its):
                return mine < its
        return False


_Range = tuple[_Cost, int, int, list[_Cost]]
"""Starts still to be searched: the least cost of any, the first, where to cut, the cost of each."""


class _Search:
    """Branch and bound over the starts on the columns' rail."""

    def __init__(self, around: Around, *, is_same_each_turn: bool) -> None:
        self.around, self.is_same_each_turn = around, is_same_each_turn
        self.seam = (0, 0)
        self.programs = 0
        self.best: tuple[_Cost, tuple[int, int], Steps] | None = None
        self.charge = np.zeros(len(around.weights))
        self.corridor: Corridor | None = None
        self.possible = np.zeros((0, 0), dtype=np.bool_)
        self.own: tuple[Around, Corridor] | None = None

    @property
    def cost(self) -> _Cost:
        """Of the best closed path, once the search has run."""
        assert self.best is not None
        own = np.array(self.best[0].parts) - self.around.shape[1] * self.charge
        return _Cost(own.tolist(), self.around.weights)

    @property
    def found(self) -> tuple[tuple[int, int], Steps]:
        """The start of the best closed path, and its steps."""
        assert self.best is not None
        return self.best[1:]

    def run(self) -> None:
        """Finds the best closed path."""
        ranges: list[_Range] = []
        self._search_range(0, self.around.shape[1], ranges)
        if ranges:
            ranges = self._charged_anew(np.array(ranges[0][0].parts))
        while ranges:
            bound, first, cut, costs = heapq.heappop(ranges)
            if not self._is_open(bound):
                break
            starts = [first + c for c, cost in enumerate(costs) if self._is_open(cost)]
            if self.corridor is not None:
                starts = [j for j in starts if self.possible[0, j]]
            for part in ([j for j in starts if j < cut], [j for j in starts if j >= cut]):
                if part:
                    self._search_range(part[0], part[-1] + 1, ranges)
        self._begin_again()

    def _charged_anew(self, bound: Floats) -> list[_Range]:
        """The whole range, searched with a charge for each step on Q that is left out.

        A path that ends before it has gone around saves what the missing steps cost, and its bound
        is worth little. Closed paths all have n such steps, so the charge changes nothing between
        them. It is the mean cost of a step; that of counts is rounded, so that they stay exact.
        """
        m, n = self.around.shape
        is_real = np.array([part[TIE] > 0.0 for part in self.around.weights])
        mean = bound / (m + n)
        rounded = np.where(bound < LARGEST_COUNT, np.round(GRAIN * mean) / GRAIN, 0.0)
        self.charge = np.where(is_real, mean, rounded)
        self.best = None
        ranges: list[_Range] = []
        stride = stride_of(self.around)
        onward = self._search_range(0, n, ranges, stride)
        if not ranges:
            return []
        if stride:
            self.corridor = corridor_of(self.around, onward, self.charge, stride)
            self._look_for_better()
        if stride and self.is_same_each_turn:
            return self._begun_where_narrowest(ranges)
        self._search_range(ranges[0][2], ranges[0][2] + 1, [])
        return ranges

    def _begun_where_narrowest(self, ranges: list[_Range]) -> list[_Range]:
        """Ranges of as few starts as there can be, at the sample of P where the ways are fewest.

        The path that costs least of all goes wrong at its ends: what it has in the middle is likely
        to be on a good closed path, which then tells where there are few ways.
        """
        assert self.corridor is not None
        self.own = self.around, self.corridor
        self._begin_at(*self.corridor.middle())
        self._search_range(0, 1, [])
        self._begin_as_given()
        if not self.possible.any(axis=1).all():
            return []
        i, j, count = self.corridor.narrowest(self.possible)
        if count >= np.count_nonzero(self.possible[0]):
            return ranges
        self._begin_at(i, j)
        anew: list[_Range] = []
        self._search_range(0, count, anew)
        return anew

    def _begin_again(self) -> None:
        """Finds the best path once more from sample 0 of P on.

        Of paths that cost the same, the one is taken that steps on P first: from there, and not
        from where the strip happened to be narrow.
        """
        if self.own is None or self.best is None:
            return
        cost, (i, j), steps = self.best
        self._begin_as_given()
        m, n = self.around.shape
        at_p = i + np.cumsum(steps == 0) - (steps == 0)
        (leaves,) = np.flatnonzero((steps == 0) & (at_p % m == 0))
        column = j + int(np.count_nonzero(steps[:leaves]))
        for first in ((column - 1) % n, column % n):
            costs, steps, end, _ = self._program(first, first + 1)
            if end == first + n and not cost < costs[0]:
                self.best = costs[0], (0, first), steps
                return

    def _begin_as_given(self) -> None:
        assert self.own is not None
        self.seam = 0, 0
        self.around, self.corridor = self.own
        self._look_for_better()

    def _begin_at(self, i: int, j: int) -> None:
        """Counts samples from there on."""
        assert self.corridor is not None
        m = self.around.shape[0]
        self.seam = self.seam[0] + i, self.seam[1] + j
        self.around = self.around.begun_at(i, j)
        self.corridor = self.corridor.begun_at(m, i, j)
        self._look_for_better()

    def _look_for_better(self) -> None:
        if self.corridor is not None:
            best = None if self.best is None else np.array(self.best[0].parts)
            self.possible = self.corridor.possible(best)

    def _is_open(self, bound: _Cost) -> bool:
        return self.best is None or bound < self.best[0]

    def _search_range(
        self, first: int, stop: int, ranges: list[_Range], stride: int | None = None
    ) -> Floats:
        """Keeps the best path of a range of starts if it is closed, else the range, to be cut.

        Returns what the program wrote down, of samples of P so far apart if a stride is given.
        """
        n = self.around.shape[1]
        costs, steps, end, crossings = self._program(first, stop, stride)
        if not len(steps):
            return crossings
        start = min(range(len(costs)), key=costs.__getitem__)
        landed = end - first - n
        if landed != start:
            if self._is_open(costs[start]):
                cut = first + (start + landed + 1) // 2
                heapq.heappush(ranges, (costs[start], first, cut, costs))
        elif self._is_open(costs[start]):
            self.best = costs[start], (self.seam[0], self.seam[1] + first + start), steps
            self._look_for_better()
        return crossings

    def _program(
        self, first: int, stop: int, stride: int | None = None
    ) -> tuple[list[_Cost], Steps, int, Floats]:
        """The least cost from each start, the best path and its end, and what was written down.

        There is no path, but an empty one, where none may be better than the best.
        """
        around = self.around
        left, width = self._window(first, stop)
        self.programs += 1
        parts, choices, crossings = decide_range(
            around.p,
            around.columns,
            (first, stop - first),
            around.weights,
            around.limits,
            around.bars,
            (left, width),
            self.charge,
            CROSSINGS if stride else NOTHING,
            (0, stride or 1),
        )
        costs = [_Cost(one, around.weights) for one in parts.tolist()]
        start = min(range(len(costs)), key=costs.__getitem__)
        if costs[start].parts[0] >= NEVER:
            return costs, np.zeros(0, dtype=np.int8), -1, crossings
        steps, end = follow_around(choices, left, first + start)
        return costs, steps, end, crossings

    def _window(self, first: int, stop: int) -> Window:
        """The bridges that a program looks at: all of them until there is a best path."""
        m, n = self.around.shape
        if self.corridor is None:
            return whole_window(m, n, first, stop)
        return self.corridor.window(self.possible, m, first, stop)


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
    weights_and_limits = weights, (planarity, nothing, energy)
    best: _Search | None = None
    programs = 0
    for cover in _covers(around, pins, (len(rails[0]), len(rails[1]))):
        own = Bars(np.ascontiguousarray(cover), least_cosine)
        strip = Around(rolled[0], np.ascontiguousarray(rolled[1].T), *weights_and_limits, own)
        search = _Search(strip, is_same_each_turn=not pins)
        search.run()
        programs += search.programs
        if search.best is not None and (best is None or search.cost < best.cost):
            best = search
    assert best is not None
    start, steps = best.found
    first = tuple((a + b) % len(rail) for a, b, rail in zip(base, start, rails, strict=True))
    if is_swapped:
        return ClosedPath((first[1], first[0]), (1 - steps).astype(np.int8), programs)
    return ClosedPath((first[0], first[1]), steps, programs)


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

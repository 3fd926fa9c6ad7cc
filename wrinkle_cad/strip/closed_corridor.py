"""Which bridges of a closed strip can be on a path that is better than the best one known.

A first program over all starts tells what it costs at least to go on from each P-step; the same
program on the strip turned round tells what it costs at least to come there. A P-step that costs
more than the best path in sum is on no better one.

Where the P-steps that come to some sample of P are few, the strip is best begun there: as few
starts are left to be searched.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from .bars import Bars
from .closed_program import BUT_LAST, Limits, Window, decide_range, whole_window
from .folding import HINGE
from .objective import TIE, Part, Weights

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

LARGEST: Final = 8_000_000
"""So many numbers are kept at most: 64 MB. Of longer strips not every sample of P is looked at."""
CLEARLY: Final = 1e-9
"""Sums that are more by this share are more, however they were added."""


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """A closed strip on its cover, from some seam on, and what a path around it costs."""

    p: Floats
    """(m, 3) float64, mm."""
    columns: Floats
    """(3, n) float64, mm; the samples of Q."""
    weights: Weights
    """Parts of the cost."""
    limits: Limits
    """Planarity, round-off, energy."""
    bars: Bars
    """Of samples 1 to m of P and columns 0 to 2 n of the cover."""

    @property
    def shape(self) -> tuple[int, int]:
        """m, n."""
        return self.p.shape[0], self.columns.shape[1]

    def turned_round(self) -> Around:
        """The same strip, run the other way; what its triangles cost is left out."""
        barred = self.bars.bridges
        if barred.size:
            barred = np.roll(barred[::-1, ::-1], -1, axis=0).copy()
        # A triangle belongs to the bridge before it, which turned round is the one behind it.
        return replace(
            self,
            p=np.ascontiguousarray(np.roll(self.p[::-1], 1, axis=0)),
            columns=self.columns[:, ::-1].copy(),
            weights=tuple(_without_triangles(part) for part in self.weights),
            bars=Bars(barred, self.bars.least_cosine),
        )

    def begun_at(self, i: int, j: int) -> Around:
        """The same strip from samples i, j on, where its bars are the same on every turn."""
        n = self.columns.shape[1]
        barred = self.bars.bridges
        if barred.size:
            barred = np.roll(np.tile(barred[:, :n], 2), (-i, -j), (0, 1))
        return replace(
            self,
            p=np.ascontiguousarray(np.roll(self.p, -i, axis=0)),
            columns=np.ascontiguousarray(np.roll(self.columns, -j, axis=1)),
            bars=Bars(np.ascontiguousarray(barred), self.bars.least_cosine),
        )


def stride_of(around: Around) -> int | None:
    """How far the samples of P are apart at which P-steps are looked at; None where none is."""
    m, n = around.shape
    # The paper's energy differs from the other end: nothing is known of the way there.
    if around.limits[2] != HINGE:
        return None
    return -(-2 * m * n * len(around.weights) // LARGEST)


@dataclass(frozen=True, slots=True, eq=False)
class Corridor:
    """What a path around costs at least with each P-step that comes to some samples of P."""

    samples: Integers
    """(k,) from 1 to m, in order, the first 1; on the cover."""
    sums: Floats
    """(k, 2n, parts) the least cost of a path around with the P-step that comes there."""
    weights: Weights
    """Parts of the cost."""

    def possible(self, best: Floats | None) -> Bools:
        """(k, 2n) which P-steps a path can have that is better than one of this cost, if any."""
        if best is None:
            return np.isfinite(self.sums[..., 0])
        return _may_be(self.sums, best, self.weights)

    def window(self, possible: Bools, m: int, first: int, stop: int) -> Window:
        """Returns the bridges that a program over a range of starts need look at.

        Args:
            possible: which P-steps a better path can have.
            m: samples of P.
            first: the first start.
            stop: behind the last one.
        """
        n = possible.shape[1] // 2
        inside = possible.copy()
        inside[0, stop:] = False
        inside[:, :first] = inside[:, n + stop :] = False
        if not inside.any(axis=1).all():
            return np.full(m + 1, first, dtype=np.int64), 1
        low, high = _reach(inside)
        # Paths only go forward: that tells of the samples between those that were looked at, too.
        low = np.maximum.accumulate(low)
        high = np.minimum.accumulate(np.append(high, stop + n)[::-1])[::-1]
        before = np.searchsorted(self.samples, np.arange(1, m + 1), side="right") - 1
        after = np.searchsorted(self.samples, np.arange(2, m + 2), side="left")
        # A sample of P is looked at from where the path comes to it until where it leaves it.
        left = np.append(low[before], first + n)
        width = int((high[after] - left[:-1]).max())
        if width >= n + stop - first:
            return whole_window(m, n, first, stop)
        return np.minimum(left, 2 * n - width).astype(np.int64), width

    def middle(self) -> tuple[int, int]:
        """The sample of P before the middle one, from 0 on, and where it is left at least cost."""
        at = len(self.samples) // 2
        least = np.lexsort(self.sums[at].T[::-1])[0]
        return int(self.samples[at]) - 1, int(least)

    def narrowest(self, possible: Bools) -> tuple[int, int, int]:
        """Where a better path has the fewest ways to go.

        Args:
            possible: which P-steps it can have; at least one to each sample.

        Returns:
            The sample of P, from 0 on, from which the strip is best begun; the first start there;
            how many there are.
        """
        low, high = _reach(possible)
        at = int((high - low).argmin())
        return int(self.samples[at]) - 1, int(low[at]), int(high[at] - low[at])

    def begun_at(self, m: int, i: int, low: int) -> Corridor:
        """The same from sample i of P and column low of the cover on; i + 1 is one of its samples.

        Args:
            m: samples of P.
            i: from 0 on.
            low: before the first start there.
        """
        n = self.sums.shape[1] // 2
        is_later = self.samples > i
        sums = np.full_like(self.sums, np.inf)
        later = int(np.count_nonzero(is_later))
        sums[:later, : 2 * n - low] = self.sums[is_later, low:]
        back = n - low
        if back >= 0:
            sums[later:, back:] = self.sums[~is_later, : 2 * n - back]
        else:
            sums[later:, : 2 * n + back] = self.sums[~is_later, -back:]
        samples = np.concatenate((self.samples[is_later], self.samples[~is_later] + m)) - i
        return Corridor(samples, sums, self.weights)


def corridor_of(around: Around, onward: Floats, charge: Floats, stride: int) -> Corridor:
    """Returns what is known of the bridges of a closed strip.

    Args:
        around: the strip.
        onward: (k, 2n, parts) what decide_range wrote down over all starts; the corridor's own.
        charge: (parts,) it was run with.
        stride: the grid's.
    """
    m, n = around.shape
    back = around.turned_round()
    # Sample 0 of P, where paths begin and end, counts on the way onward only.
    _, _, came = decide_range(
        back.p,
        back.columns,
        (0, n),
        back.weights,
        back.limits,
        back.bars,
        whole_window(m, n, 0, n),
        charge,
        BUT_LAST,
        ((m - 1) % stride, stride),
    )
    onward += came[::-1, ::-1]
    return Corridor(np.arange(1, m + 1, stride), onward, around.weights)


def _reach(may_be: Bools) -> tuple[Integers, Integers]:
    """The first column that may be in each row, and the one behind the last."""
    return may_be.argmax(axis=1), may_be.shape[1] - may_be[:, ::-1].argmax(axis=1)


def _without_triangles(part: Part) -> Part:
    fold_back, _, invalid, bending, _, length, flat_invalid, tie = part
    return fold_back, 0.0, invalid, bending, 0.0, length, flat_invalid, tie


def _may_be(sums: Floats, best: Floats, weights: Weights) -> Bools:
    """Which sums are not clearly more than the best cost, compared part by part."""
    is_more = np.zeros(sums.shape[:-1], dtype=np.bool_)
    is_same = np.ones(sums.shape[:-1], dtype=np.bool_)
    for number, part in enumerate(weights):
        slack = CLEARLY * np.abs(best[number]) if part[TIE] else 0.0
        difference = sums[..., number] - best[number]
        is_more |= is_same & (difference > slack)
        is_same &= np.abs(difference) <= slack
        if not is_same.any():
            break
    return ~is_more

"""Which bridges of a closed strip can be on a path that is better than the best one known.

A first program over all starts tells what it costs at least to go on from each P-step; the same
program on the strip turned round tells what it costs at least to come there. A P-step that costs
more than the best path in sum is on no better one.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from .bars import Bars
from .closed_program import BUT_LAST, CROSSINGS, NOTHING, Limits, Window, decide_range, whole_window
from .folding import HINGE
from .objective import TIE, Part, Weights

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

LARGEST: Final = 8_000_000
"""So many numbers are kept for each direction, at most: 64 MB."""
CLEARLY: Final = 1e-9
"""Sums that are more by this share are more, however they were added."""


class Corridor:
    """What is known of the bridges of one search."""

    def __init__(
        self,
        p: Floats,
        columns: Floats,
        weights: Weights,
        limits: Limits,
        bars: Bars,
        charge: Floats,
    ) -> None:
        self._strip, self._charge = (p, columns, weights, limits, bars), charge
        m, n = len(p), columns.shape[1]
        # The paper's energy differs from the other end: nothing is known of the way there.
        is_known = limits[2] == HINGE and 2 * m * n * len(weights) <= LARGEST
        self.wanted = CROSSINGS if is_known else NOTHING
        """What the next program is to write down."""
        self._onward: Floats | None = None
        self._sums: Floats | None = None

    def take(self, crossings: Floats) -> None:
        """Keeps what the first program, over all starts, found of the P-steps."""
        if self.wanted:
            self._onward, self.wanted = crossings, NOTHING

    def window(self, first: int, stop: int, best: Floats) -> Window:
        """Returns the bridges that a program over a range of starts need look at.

        Args:
            first: the first start.
            stop: behind the last one.
            best: (parts,) the cost of the best path.
        """
        p, columns, weights, _, _ = self._strip
        m, n = len(p), columns.shape[1]
        if self._onward is None:
            return whole_window(m, n, first, stop)
        if self._sums is None:
            self._sums = self._bounds(self._onward)
        may_be = _may_be(self._sums, best, weights)
        may_be[:, :first] = may_be[:, n + stop :] = False
        has_any = may_be.any(axis=1)
        if not has_any.all():
            return np.full(m + 1, first, dtype=np.int64), 1
        low = may_be.argmax(axis=1)
        high = 2 * n - may_be[:, ::-1].argmax(axis=1)
        # A sample of P is looked at from where the path comes to it until where it leaves it.
        low, high = np.append(low, first + n), np.append(high, stop + n)
        width = int((high[1:] - low[:-1]).max())
        if width >= n + stop - first:
            return whole_window(m, n, first, stop)
        return np.minimum(low, 2 * n - width).astype(np.int64), width

    def _bounds(self, onward: Floats) -> Floats:
        """(m, 2n, parts): the least cost of a path around with the P-step that comes there."""
        p, columns, weights, limits, bars = self._strip
        m, n = len(p), columns.shape[1]
        turned = np.ascontiguousarray(np.roll(p[::-1], 1, axis=0)), columns[:, ::-1].copy()
        barred = bars.bridges
        if barred.size:
            barred = np.roll(barred[::-1, ::-1], -1, axis=0).copy()
        # Sample 0 of P, where paths begin and end, counts on the way onward only. So does the
        # triangle behind it, which is reckoned as the last one there; here none are.
        _, _, back = decide_range(
            *turned,
            (0, n),
            tuple(_without_triangles(part) for part in weights),
            limits,
            Bars(barred, bars.least_cosine),
            whole_window(m, n, 0, n),
            self._charge,
            BUT_LAST,
        )
        return np.asarray(onward + back[::-1, ::-1])


def _without_triangles(part: Part) -> Part:
    fold_back, _, invalid, bending, _, length, flat_invalid, tie = part
    return fold_back, 0.0, invalid, bending, 0.0, length, flat_invalid, tie


def _may_be(sums: Floats, best: Floats, weights: Weights) -> npt.NDArray[np.bool_]:
    """(m, 2n) which sums are not clearly more than the best cost, compared part by part."""
    is_more = np.zeros(sums.shape[:2], dtype=np.bool_)
    is_same = np.ones(sums.shape[:2], dtype=np.bool_)
    for number, part in enumerate(weights):
        slack = CLEARLY * np.abs(best[number]) if part[TIE] else 0.0
        difference = sums[:, :, number] - best[number]
        is_more |= is_same & (difference > slack)
        is_same &= np.abs(difference) <= slack
    return ~is_more

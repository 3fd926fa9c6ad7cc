"""What a search must not do: bridges and folds that are barred, and which ways stay open then.

A barred bridge or fold costs more than everything else together, so a search leaves it out if any
triangulation can. That none can is seen from the triangulation that it finds.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from .compiled import compiled
from .folding import StepCosts
from .sightlines import BEFORE_P, NEXT_P

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Bytes = npt.NDArray[np.uint8]

BARRED: Final = 1e250
"""Counted as so many fold-backs: they come first, and no sum of others comes near."""
COSINE_ROUND_OFF: Final = 1e-14
"""Cosines of folds that differ by less are equal."""


class Bars(NamedTuple):
    """Barred bridges and folds of a strip."""

    bridges: Bools
    """(m, n) bool; bridges that must not be; (0, 0) where all may."""
    least_cosine: float
    """Cosine of the largest fold that may be; below -1 where any may."""

    @property
    def is_none(self) -> bool:
        """Whether everything may be."""
        return self.bridges.size == 0 and self.least_cosine < -1.0


def no_bars() -> Bars:
    """Returns the bars of a strip where everything may be.

    Example:
        >>> no_bars().bridges.shape
        (0, 0)
    """
    return Bars(np.zeros((0, 0), dtype=np.bool_), -2.0)


def least_cosine_of(fold_bound: float | None) -> float:
    """Returns the cosine of the largest fold, given in rad from 0 to pi; -2 where any may be."""
    return -2.0 if fold_bound is None else math.cos(fold_bound) - COSINE_ROUND_OFF


@compiled
def bar_row(view: Floats, bars: Bars, i: int, costs: StepCosts) -> None:
    """Makes the barred bridges of a row, and the barred folds at them, cost more than all else.

    Args:
        view: (9, n) float64, mm; the row's bridges (look_along).
        bars: of the strip; its row i belongs to the view.
        i: the row.
        costs: of leaving the bridges (cost_row); changed.
    """
    if bars.bridges.shape[0] > 0:
        for j in range(view.shape[1]):
            if bars.bridges[i, j]:
                for row in range(4):
                    costs.fold_backs[row, j] += BARRED
    if bars.least_cosine < -1.0:
        return
    for row in range(4):
        before, after = row // 2, row % 2
        ax, bx = BEFORE_P + 4 * before, NEXT_P + 4 * after
        first, second = costs.heights[2 * before], costs.heights[2 * after + 1]
        flat, later_flat = costs.degenerate[2 * before], costs.degenerate[2 * after + 1]
        for j in range(view.shape[1]):
            has_fold = flat[j] + later_flat[j] == 0.0
            against = view[ax, j] * view[bx, j] + view[ax + 1, j] * view[bx + 1, j]
            if has_fold and -against < bars.least_cosine * first[j] * second[j]:
                costs.fold_backs[row, j] += BARRED


@compiled
def is_barred(costs: StepCosts, row: int, j: int) -> bool:
    """Whether bridge j is barred, or its fold between the steps of a row of costs."""
    return bool(costs.fold_backs[row, j] >= BARRED)

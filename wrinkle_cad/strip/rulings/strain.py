"""How much a flat sheet must give to take the shape of a strip.

At a ruling with the twist `phi`, where the rails move by `a` and `b` across it, a flat sheet that
keeps its rulings and the lengths of its seams has a mid-line of `(a + b) / 2`; the surface's is
`sqrt(a^2 + b^2 + 2 a b cos(phi)) / 2`. The middle must shrink, or the seams stretch, by the share
`1 - sqrt(a^2 + b^2 + 2 a b cos(phi)) / (a + b)`: about `phi^2 / 8` for equal rails, 0 in torsal
pieces, cones and planes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from .pairing import RULED
from .sheet import Sheet
from .vectors import cosines

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

WINDOW: Final = 4
"""The rails' speeds are taken over so many intervals to either side."""


@dataclass(frozen=True, slots=True, eq=False)
class Strain:
    """What a flat sheet must give along a strip."""

    share: Floats
    """(k - 1,) float64; strain of each interval between rulings, 0 to 1."""
    length: Floats
    """(k - 1,) float64, mm; each interval's length along the middle of the strip."""

    @property
    def largest(self) -> float:
        """The largest strain, 0 to 1."""
        return float(self.share.max(initial=0.0))

    def percentile(self, share: float) -> float:
        """The strain that is not exceeded on a share (0 to 1) of the strip's length."""
        order = np.argsort(self.share, kind="stable")
        reached = np.cumsum(self.length[order])
        if not len(order) or not reached[-1] > 0.0:
            return 0.0
        at = int(np.searchsorted(reached, share * reached[-1] * (1.0 - 1e-12)))
        return float(self.share[order[min(at, len(order) - 1)]])

    def length_above(self, limit: float) -> float:
        """How many mm along the middle of the strip are strained more than a limit (0 to 1)."""
        return math.fsum(self.length[self.share > limit].tolist())


def strain_of(sheet: Sheet) -> Strain:
    """Measures the strain between rulings.

    Args:
        sheet: the strip's tangent planes.
    """
    twist = np.abs(sheet.twist[:, 0] + sheet.twist[:, 1]) / 2.0
    a, b = sheet.p_across.copy(), sheet.q_across.copy()
    length = (a + b) / 2.0
    for first, last in ruled_runs(sheet):
        run = slice(first, last)
        a[run], b[run] = _around(a[run]), _around(b[run])
    # The same as 1 - sqrt(a^2 + b^2 + 2 a b cos phi) / (a + b), without the difference of likes.
    whole = a + b
    lost = 2.0 * a * b * (1.0 - cosines(twist))
    ratio = np.where(whole > 0.0, lost / np.where(whole > 0.0, whole * whole, 1.0), 0.0)
    share = ratio / (1.0 + np.sqrt(np.maximum(0.0, 1.0 - ratio)))
    return Strain(np.where(sheet.rulings.way == RULED, share, 0.0), length)


def ruled_runs(sheet: Sheet) -> list[tuple[int, int]]:
    """First and last ruling of each ruled stretch between fans and corners."""
    rulings = sheet.rulings
    ruled = rulings.way == RULED
    cut = (ruled[1:] != ruled[:-1]) | (rulings.p_piece[1:] != rulings.p_piece[:-1])
    cut |= rulings.q_piece[1:] != rulings.q_piece[:-1]
    bounds = [0, *(int(at) + 1 for at in np.flatnonzero(cut)), len(ruled)]
    return [(first, last) for first, last in pairwise(bounds) if ruled[first]]


def _around(values: Floats) -> Floats:
    """(k,) sums over WINDOW intervals to either side, as many as there are."""
    count = len(values)
    total = np.concatenate(([0.0], np.cumsum(values)))
    at = np.arange(count)
    summed: Floats = total[np.minimum(at + WINDOW + 1, count)] - total[np.maximum(at - WINDOW, 0)]
    return summed

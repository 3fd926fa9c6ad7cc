"""Which bridges of an open strip a search looks at: a connected stretch of every diagonal.

Bridges (i, j) with the same i + j form a diagonal; every step leads from one to the next.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Integers = npt.NDArray[np.int64]


class Corridor(NamedTuple):
    """The bridges (i, d - i) with low[d] <= i < high[d], of diagonals d from 0 to m+n-2."""

    low: Integers
    """(m+n-1,) int64; from one diagonal to the next it is the same, or one more."""
    high: Integers
    """(m+n-1,) int64; behind the last one; as low."""
    first: Integers
    """(m+n,) int64; where in a list of bytes, each for four bridges, a diagonal begins."""

    @property
    def bridge_count(self) -> int:
        """How many bridges are looked at."""
        return int((self.high - self.low).sum())


def whole_corridor(m: int, n: int) -> Corridor:
    """Returns all bridges of a strip.

    Example:
        >>> whole_corridor(3, 2).low.tolist(), whole_corridor(3, 2).high.tolist()
        ([0, 0, 1, 2], [1, 2, 3, 3])
    """
    return corridor_of_rows(np.zeros(m, dtype=np.int64), np.full(m, n, dtype=np.int64))


def corridor_of_rows(left: Integers, right: Integers) -> Corridor:
    """Returns the bridges (i, j) with left[i] <= j < right[i].

    Args:
        left: (m,) int64, not decreasing, the first 0.
        right: (m,) int64, not decreasing, each above the next one's left, the last n.

    Example:
        >>> found = corridor_of_rows(np.array([0, 1, 1]), np.array([2, 2, 3]))
        >>> found.low.tolist(), found.high.tolist(), found.bridge_count
        ([0, 0, 1, 1, 2], [1, 1, 2, 3, 3], 5)
    """
    rows = np.arange(left.size, dtype=np.int64)
    diagonals = np.arange(left.size + right[-1] - 1)
    low = np.searchsorted(rows + right, diagonals, side="right")
    high = np.searchsorted(rows + left, diagonals, side="right")
    first = np.concatenate(([0], np.cumsum((high - low + 3) // 4)))
    return Corridor(low, high, first)

"""Runs of what is marked in a row."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def runs_of(marked: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Returns where each run of True begins, and where it ends (not included).

    Args:
        marked: (k,) bool.

    Example:
        >>> runs_of(np.array([True, False, True, True]))
        [(0, 1), (2, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([False], marked, [False]))))
    return [(int(first), int(stop)) for first, stop in edges.reshape(-1, 2)]

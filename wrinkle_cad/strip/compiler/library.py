"""Functions of numpy that are written as compiled ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def places_left(ordered: Floats, value: float) -> int:
    """`numpy.searchsorted`: how many of the ordered numbers are less."""
    low, high = 0, len(ordered)
    while low < high:
        middle = (low + high) >> 1
        if ordered[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


def places_right(ordered: Floats, value: float) -> int:
    """`numpy.searchsorted` with side="right": how many of the ordered numbers are not greater."""
    low, high = 0, len(ordered)
    while low < high:
        middle = (low + high) >> 1
        if ordered[middle] <= value:
            low = middle + 1
        else:
            high = middle
    return low


SEARCHSORTED: Final[Mapping[str, Any]] = {"left": places_left, "right": places_right}

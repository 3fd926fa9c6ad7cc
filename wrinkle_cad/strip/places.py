"""Places in space as a message names them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

import numpy as np
import numpy.typing as npt

SAME: Final = 1e-6
"""Sizes closer than this share of the largest, and places closer than it, are equal but for
round-off."""


def place_text(point: Iterable[float], size: float) -> str:
    """Returns a place in mm, to a thousandth of a size or a tenth of a millimetre.

    Args:
        point: x, y, z in mm.
        size: mm; of what the place is on.

    Example:
        >>> place_text((50.0, 10.00001, -0.0), 200.0)
        '(50.0, 10.0, 0.0) mm'
    """
    decimals = 1 if size >= 100.0 or not size > 0.0 else min(9, math.ceil(3.0 - math.log10(size)))
    # Adding zero turns a negative zero into a plain one.
    rounded = (round(float(x), decimals) + 0.0 for x in point)
    return f"({', '.join(f'{x:.{decimals}f}' for x in rounded)}) mm"


def outstanding(sizes: npt.NDArray[np.float64], points: npt.NDArray[np.float64]) -> int:
    """Returns the index of the largest of some places, whatever order they come in.

    Of equally large ones it is that with the smallest x, then y, then z.

    Args:
        sizes: (k,) float64, in any unit, k >= 1.
        points: (k, 3) float64, mm.

    Example:
        >>> outstanding(np.array([1.0, 2.0, 2.0]), np.array([[0.0, 0, 0], [9, 0, 0], [8, 0, 0]]))
        2
    """
    largest = float(sizes.max())
    (equal,) = np.nonzero(sizes >= largest - SAME * abs(largest))
    step = SAME * max(float(np.abs(points).max()), math.ulp(1.0))
    rounded = np.round(points[equal] / step)
    return int(equal[np.lexsort((rounded[:, 2], rounded[:, 1], rounded[:, 0]))[0]])

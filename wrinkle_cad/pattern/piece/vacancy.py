"""Room for a rectangle: where an upright one of a given size fits into a region."""

from __future__ import annotations

import copy
from typing import Final

import numpy as np
import shapely
from shapely import affinity

from .piece import Floats

_CELLS: Final = 120
"""Cells along the longer side of the region."""
_FINEST: Final = 0.25
"""mm; no cell is smaller."""


class Vacancy:
    """A region as cells that are free or not, ready to be asked for many sizes at many angles.

    Args:
        region: polygons of any kind.
    """

    def __init__(self, region: shapely.Geometry) -> None:
        size = 0.0 if region.is_empty else float(np.hypot(*_size_of(region)))
        self._region = region
        self._cell = max(_FINEST, size / _CELLS)
        # A cell is free where its middle keeps half a cell's diagonal from everything.
        self._inner = region.buffer(-0.71 * self._cell, quad_segs=2)
        self._low = np.zeros(2)
        self._sums = np.zeros((1, 1), dtype=np.int64)
        self._degrees = 0.0

    def turned(self, degrees: float) -> Vacancy:
        """Returns the region turned about the origin, counter-clockwise, with cells of its own."""
        made = copy.copy(self)
        made._degrees = degrees
        inner = affinity.rotate(self._inner, degrees, origin=(0.0, 0.0))
        if inner.is_empty:
            return made
        made._low = np.array(inner.bounds[:2]) - 0.5 * self._cell
        columns, rows = np.ceil(_size_of(inner) / self._cell).astype(np.int64) + 1
        x = made._low[0] + self._cell * (np.arange(columns) + 0.5)
        y = made._low[1] + self._cell * (np.arange(rows) + 0.5)
        shapely.prepare(inner)
        is_free = shapely.contains_xy(inner, *np.meshgrid(x, y))
        made._sums = np.zeros((rows + 1, columns + 1), dtype=np.int64)
        made._sums[1:, 1:] = np.cumsum(np.cumsum(~is_free, axis=0), axis=1)
        return made

    def corner_for(self, width: float, height: float) -> Floats | None:
        """Returns the lower left corner (2,) mm of a rectangle that fits, None if none is found.

        Of all places the one nearest to the region's middle is taken.

        Args:
            width: mm along x.
            height: mm along y.
        """
        columns = int(np.ceil(width / self._cell))
        rows = int(np.ceil(height / self._cell))
        sums = self._sums
        if sums.shape[0] <= rows or sums.shape[1] <= columns:
            return None
        blocked = (
            sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns]
            + sums[:-rows, :-columns]
        )  # fmt: skip
        row, column = np.nonzero(blocked == 0)
        if not len(row):
            return None
        middle = 0.5 * (np.array(sums.shape) - 1 - (rows, columns))
        nearest = int(np.argmin((row - middle[0]) ** 2 + (column - middle[1]) ** 2))
        corner: Floats = self._low + self._cell * np.array((column[nearest], row[nearest]))
        # Room that the cells leave over: the rectangle stands in the middle of its cells.
        corner = corner + 0.5 * (self._cell * np.array((columns, rows)) - (width, height))
        box = shapely.box(*corner, corner[0] + width, corner[1] + height)
        back = affinity.rotate(box, -self._degrees, origin=(0.0, 0.0))
        return corner if shapely.contains(self._region, back) else None


def _size_of(region: shapely.Geometry) -> Floats:
    low, high = np.array(region.bounds).reshape(2, 2)
    size: Floats = high - low
    return size

"""Pieces on sheets of material: grain kept, none on another, as few and as full sheets as found.

Every piece lies as drawn or turned by half a turn: across the grain it would stretch differently.
Pieces are put down one by one, each where it keeps the used length of the sheet shortest, and then
as low as it can lie; that is tried for several orders, and the best result is kept. A sheet is a
grid of cells; where a piece fits is found for all places at once by a convolution of whole numbers,
so the result is the same on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt
import shapely

from wrinkle_cad.errors import InputError

from .piece import PatternPiece, frozen

NESTING_GAP: Final = 3.0
"""mm between pieces that are nested on a sheet of material."""

_CELLS: Final = 640
"""Cells along the longer side of a sheet, at most."""
_FINEST: Final = 1.0
"""mm; no cell is smaller."""
_EXCHANGES: Final = 12
"""Orders that are tried beside those by size."""

_Cells = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class NestedSheet:
    """A sheet of material with pieces on it.

    Attributes:
        pieces: where they lie; (0, 0) is the sheet's lower left corner.
        index: of each of them among the pieces that were given.
        size: (2,) mm, length along the grain and width.
    """

    pieces: tuple[PatternPiece, ...]
    index: tuple[int, ...]
    size: tuple[float, float]

    @property
    def used_length(self) -> float:
        """Mm of the sheet from its start to the end of the last piece."""
        return max(float(piece.cut_line[:, 0].max()) for piece in self.pieces)

    @property
    def utilisation(self) -> float:
        """The pieces' share of the used length's area, 0 to 1."""
        area = sum(shapely.Polygon(piece.cut_line).area for piece in self.pieces)
        return float(area / (self.used_length * self.size[1]))


def nested(
    pieces: Sequence[PatternPiece],
    *,
    sheet: tuple[float, float],
    gap: float = NESTING_GAP,
) -> tuple[NestedSheet, ...]:
    """Returns sheets that hold all pieces, each once for every copy that is wanted of it.

    Args:
        pieces: at least one; ``quantity`` copies of each are laid.
        sheet: mm, length along the grain, which is laid along x, and width.
        gap: mm between pieces, and to the sheet's edge half of it.

    Raises:
        InputError: a piece is larger than a sheet.
    """
    grid = _Grid(sheet, gap)
    pieces = [piece.with_grain_along_x() for piece in pieces]
    index = [i for i, piece in enumerate(pieces) for _ in range(piece.quantity)]
    shapes = [grid.shapes_of(piece) for piece in pieces]
    for piece, masks in zip(pieces, shapes, strict=True):
        if not masks:
            width, height = np.ptp(piece.cut_line, axis=0)
            raise InputError(
                f"{piece.name} is {width:.1f} x {height:.1f} mm and does not fit on a sheet of "
                f"{sheet[0]:g} x {sheet[1]:g} mm. Take a larger sheet, or split the strip."
            )
    best = _best_laid([(i, shapes[i]) for i in index], [pieces[i] for i in index], grid)
    sheets = []
    for number in range(1 + max(one.sheet for one in best)):
        here = [one for one in best if one.sheet == number]
        placed = tuple(
            one.shape.piece.moved(frozen(grid.cell * np.array((one.column, one.row))))
            for one in here
        )
        sheets.append(NestedSheet(placed, tuple(one.index for one in here), sheet))
    return tuple(sheets)


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    """A piece one way round, at the origin of its cells; ``cells`` are those it takes."""

    piece: PatternPiece
    cells: _Cells


@dataclass(frozen=True, slots=True, eq=False)
class _Laid:
    index: int
    shape: _Shape
    sheet: int
    column: int
    row: int

    @property
    def end(self) -> int:
        return self.column + int(self.shape.cells.shape[1])


class _Grid:
    def __init__(self, sheet: tuple[float, float], gap: float) -> None:
        self.cell = max(_FINEST, max(sheet) / _CELLS)
        self.columns, self.rows = (math.floor(side / self.cell) for side in sheet)
        self._gap = gap

    def shapes_of(self, piece: PatternPiece) -> tuple[_Shape, ...]:
        """Returns a piece as it is and turned by half a turn; none if it is too large."""
        made = []
        for turned in (piece, piece.turned_round()):
            outline = shapely.Polygon(turned.cut_line).buffer(0.5 * self._gap, quad_segs=4)
            low = np.array(outline.bounds[:2])
            here = turned.moved(frozen(-low))
            region = shapely.Polygon(here.cut_line).buffer(0.5 * self._gap, quad_segs=4)
            columns, rows = (math.ceil(side / self.cell + 1e-9) for side in region.bounds[2:])
            if columns > self.columns or rows > self.rows:
                continue
            shapely.prepare(region)
            x, y = np.meshgrid(np.arange(columns), np.arange(rows))
            boxes = shapely.box(
                x * self.cell, y * self.cell, (x + 1) * self.cell, (y + 1) * self.cell
            )
            made.append(_Shape(here, shapely.intersects(region, boxes).astype(np.float32)))
        return tuple(made)


def _best_laid(
    items: Sequence[tuple[int, tuple[_Shape, ...]]], pieces: Sequence[PatternPiece], grid: _Grid
) -> list[_Laid]:
    """Returns the best layout of some orders by size and of others that exchange two pieces."""
    areas = [shapely.Polygon(piece.cut_line).area for piece in pieces]
    sizes = [np.ptp(piece.cut_line, axis=0) for piece in pieces]
    keys = (areas, [float(size[0]) for size in sizes], [float(size[1]) for size in sizes])
    orders = [np.lexsort((np.arange(len(items)), -np.array(key))).tolist() for key in keys]
    trials = [(_laid_in_order([items[i] for i in order], grid), order) for order in orders]
    best, order = min(trials, key=lambda trial: _worth(trial[0]))
    random = np.random.default_rng(0)
    for _ in range(_EXCHANGES if len(items) > 2 else 0):
        trial = list(order)
        i, j = (int(k) for k in random.choice(len(trial), 2, replace=False))
        trial[i], trial[j] = trial[j], trial[i]
        laid = _laid_in_order([items[k] for k in trial], grid)
        if _worth(laid) <= _worth(best):
            best, order = laid, trial
    return best


def _worth(laid: Sequence[_Laid]) -> tuple[int, int, int]:
    """Returns the number of sheets, the last one's used cells and the sum of ends."""
    last = max(one.sheet for one in laid)
    ends = [one.end for one in laid if one.sheet == last]
    return last, max(ends), sum(ends)


def _laid_in_order(items: Sequence[tuple[int, tuple[_Shape, ...]]], grid: _Grid) -> list[_Laid]:
    taken: list[_Cells] = []
    laid: list[_Laid] = []
    for index, shapes in items:
        one = None
        for number, cells in enumerate(taken):
            one = _nearest(index, shapes, cells, number)
            if one is not None:
                break
        if one is None:
            taken.append(np.zeros((grid.rows, grid.columns), dtype=np.float32))
            one = _nearest(index, shapes, taken[-1], len(taken) - 1)
        assert one is not None  # every shape fits on an empty sheet
        rows = one.shape.cells.shape[0]
        taken[one.sheet][one.row : one.row + rows, one.column : one.end] += one.shape.cells
        laid.append(one)
    return laid


def _nearest(index: int, shapes: Sequence[_Shape], taken: _Cells, number: int) -> _Laid | None:
    """Returns the place that ends first along the sheet, then lies lowest, if there is any."""
    from scipy.signal import fftconvolve

    best: _Laid | None = None
    # Beyond what is used and one piece more nothing can be better.
    used = int(np.flatnonzero(taken.any(axis=0))[-1]) + 1 if taken.any() else 0
    for shape in shapes:
        columns = shape.cells.shape[1]
        window = taken[:, : min(taken.shape[1], used + columns)]
        if window.shape[1] < columns:
            continue
        # Counts of cells: whole numbers, far above the transform's round-off.
        overlap = fftconvolve(window, shape.cells[::-1, ::-1], mode="valid")
        row, column = np.nonzero(overlap < 0.5)
        if not len(row):
            continue
        first = int(np.lexsort((row, column))[0])
        found = _Laid(index, shape, number, int(column[first]), int(row[first]))
        if best is None or (found.end, found.row) < (best.end, best.row):
            best = found
    return best

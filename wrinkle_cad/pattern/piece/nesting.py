"""Pieces on sheets of material: grain kept, none on another, as few and as full sheets as found.

Every piece lies as drawn or turned by half a turn: across the grain it would stretch differently.
Pieces are put down one by one, each where it ends first along the sheet and then as low as it can
lie; the order decides how full a sheet becomes. Orders by size are tried, then ones with two pieces
exchanged or one moved: late acceptance (Burke and Bykov 2017, doi:10.1016/j.ejor.2016.07.012). A
sheet is a grid of cells and the number of orders is fixed, so the layout is the same on every
machine, however fast.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Final

import numpy as np
import shapely

from wrinkle_cad.errors import InputError

from .cells import Runs, Sheet, empty_sheet, first_place, runs_of, take, taken_cells
from .piece import PatternPiece, frozen

NESTING_GAP: Final = 3.0
"""mm between pieces that are nested on a sheet of material."""

_CELLS: Final = 1280
"""Cells along the longer side of what is used of a sheet."""
_FINEST: Final = 0.5
"""mm; no cell is smaller."""
_EXPECTED: Final = 0.4
"""Utilisation that pieces have at least, else more of the sheet is looked at."""
_MOST_PIECES: Final = 20_000
"""5,000 take 10 s."""
_PLACEMENTS: Final = 10_000
"""Pieces that are put down in all orders together."""
_MOST_ORDERS: Final = 500
_LATE: Final = 40
"""An order may be as bad as the one so many orders ago."""
_MANY: Final = 100
"""Pieces beyond which a sheet is not asked again for one hardly smaller than what it refused."""
_HARDLY_SMALLER: Final = 0.9


@dataclass(frozen=True, slots=True, eq=False)
class NestedSheet:
    """A sheet of material with pieces on it."""

    pieces: tuple[PatternPiece, ...]
    """Where they lie; (0, 0) is the sheet's lower left corner."""
    index: tuple[int, ...]
    """Of each of them among the pieces that were given."""
    size: tuple[float, float]
    """(2,) mm, length along the grain and width."""

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
    pieces: Sequence[PatternPiece], *, sheet: tuple[float, float]
) -> tuple[NestedSheet, ...]:
    """Returns sheets that hold all pieces, each once for every copy that is wanted of it.

    Pieces keep ``NESTING_GAP`` from each other, and half of it from the sheet's edge.

    Args:
        pieces: at least one; ``quantity`` copies of each are laid.
        sheet: mm, length along the grain, which is laid along x, and width.

    Raises:
        InputError: a piece is larger than a sheet, or there are too many.
    """
    count = sum(piece.quantity for piece in pieces)
    if count > _MOST_PIECES:
        raise InputError(
            f"{count:,} pieces are to be nested, and at most {_MOST_PIECES:,} are. Ask for fewer "
            "copies, and cut the sheets several times."
        )
    for piece in pieces:
        check_fits(piece, sheet)
    pieces = [piece.with_grain_along_x() for piece in pieces]
    index = [i for i, piece in enumerate(pieces) for _ in range(piece.quantity)]
    length = _expected_length([pieces[i] for i in index], sheet)
    while True:
        grid = _Grid((length, sheet[1]))
        shapes = [grid.shape_of(i, piece) for i, piece in enumerate(pieces)]
        start = _laid_by_size([shapes[i] for i in index], grid)
        if length >= sheet[0] or start.worth[0] == 0:
            break
        # One sheet would be fuller than this if it could hold everything.
        length = min(sheet[0], 2.0 * length)
    laid = _improved(start, grid).laid
    return tuple(
        NestedSheet(
            tuple(grid.placed(one) for one in laid if one.sheet == number),
            tuple(one.shape.index for one in laid if one.sheet == number),
            sheet,
        )
        for number in range(1 + max(one.sheet for one in laid))
    )


def check_fits(piece: PatternPiece, sheet: tuple[float, float]) -> None:
    """Raises an ``InputError`` if a piece is larger than a sheet.

    Args:
        piece: its grain line comes to lie along the sheet.
        sheet: mm, length along the grain and width.
    """
    outline = piece.with_grain_along_x().cut_line
    width, height = np.ptp(outline, axis=0)
    if width + NESTING_GAP > sheet[0] or height + NESTING_GAP > sheet[1]:
        raise InputError(
            f"{piece.name} is {width:.1f} x {height:.1f} mm and does not fit on a sheet of "
            f"{sheet[0]:g} x {sheet[1]:g} mm. Take a larger sheet, or split the strip."
        )


def _expected_length(pieces: Sequence[PatternPiece], sheet: tuple[float, float]) -> float:
    sizes = np.array([np.ptp(piece.cut_line, axis=0) + NESTING_GAP for piece in pieces])
    area = math.fsum(shapely.Polygon(piece.cut_line).area for piece in pieces)
    expected = float(sizes[:, 0].max()) + area / (_EXPECTED * sheet[1])
    return min(sheet[0], expected, math.fsum(sizes[:, 0].tolist()))


@dataclass(frozen=True, slots=True, eq=False)
class _Shape:
    """A piece as cells: its runs as drawn and turned by half a turn, and how many cells it has."""

    index: int
    piece: PatternPiece
    runs: tuple[Runs, Runs]
    rows: int
    columns: int
    cell_count: int


@dataclass(frozen=True, slots=True, eq=False)
class _Laid:
    shape: _Shape
    is_turned: bool
    sheet: int
    column: int
    row: int

    @property
    def end(self) -> int:
        return self.column + self.shape.columns


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Pieces laid in an order; worth: the last sheet, its used columns, the sum of ends there."""

    order: Sequence[_Shape]
    laid: Sequence[_Laid]
    worth: tuple[int, int, int]


class _Grid:
    def __init__(self, sheet: tuple[float, float]) -> None:
        self.cell = max(_FINEST, max(sheet) / _CELLS)
        self.columns, self.rows = (math.floor(side / self.cell + 1e-9) for side in sheet)

    def shape_of(self, index: int, piece: PatternPiece) -> _Shape:
        here = piece.moved(frozen(0.5 * NESTING_GAP - piece.cut_line.min(axis=0)))
        taken = taken_cells(here.cut_line, cell=self.cell, gap=NESTING_GAP)
        # A piece that fills the sheet to a part of a cell has room all the same.
        taken = taken[: self.rows, : self.columns]
        rows, columns = taken.shape
        runs = (runs_of(taken), runs_of(taken[::-1, ::-1]))
        return _Shape(index, here, runs, rows, columns, int(taken.sum()))

    def placed(self, laid: _Laid) -> PatternPiece:
        piece, shape = laid.shape.piece, laid.shape
        if laid.is_turned:
            # A piece whose cells were more than the sheet has keeps its half gap from the edges.
            size = np.ptp(piece.cut_line, axis=0) + NESTING_GAP
            corner = np.maximum(self.cell * np.array((shape.columns, shape.rows)), size)
            piece = piece.turned_round().moved(frozen(corner))
        return piece.moved(frozen(self.cell * np.array((laid.column, laid.row))))


def _laid_by_size(items: Sequence[_Shape], grid: _Grid) -> _Layout:
    """Returns the best layout of some orders by size."""
    orders = (
        sorted(items, key=attrgetter(size), reverse=True)
        for size in ("cell_count", "columns", "rows")
    )
    return min((_laid_in_order(order, grid) for order in orders), key=attrgetter("worth"))


def _improved(start: _Layout, grid: _Grid) -> _Layout:
    """Returns the best layout of changed orders, or the first one."""
    best = here = start
    earlier = [start.worth] * _LATE
    chance = random.Random(1)
    for number in range(_order_count(start.order)):
        trial = _laid_in_order(_changed(here.order, chance), grid)
        if trial.worth <= max(here.worth, earlier[number % _LATE]):
            here = trial
        earlier[number % _LATE] = here.worth
        best = min(best, here, key=attrgetter("worth"))
    return best


def _order_count(items: Sequence[_Shape]) -> int:
    if len({item.index for item in items}) < 2:
        return 0
    return min(_MOST_ORDERS, _PLACEMENTS // len(items))


def _changed(order: Sequence[_Shape], chance: random.Random) -> list[_Shape]:
    """Returns an order with two pieces exchanged, or one moved to another place."""
    # random() alone gives the same numbers in every version of Python.
    i, j = (int(chance.random() * len(order)) for _ in range(2))
    changed = list(order)
    if chance.random() < 0.5:
        changed[i], changed[j] = changed[j], changed[i]
    else:
        changed.insert(j, changed.pop(i))
    return changed


class _Material:
    """Sheets that are filled: what each has left, and what it was asked for in vain."""

    def __init__(self, grid: _Grid, *, is_long: bool) -> None:
        self._grid = grid
        self._is_long = is_long
        self._sheets: list[Sheet] = []
        self._free: list[int] = []
        self._refused: list[set[int]] = []
        self._least: list[float] = []

    def lay(self, shape: _Shape) -> _Laid:
        for number in range(len(self._sheets)):
            if self._may_have_room(number, shape):
                laid = self._laid(number, shape)
                if laid is not None:
                    return laid
                self._refused[number].add(shape.index)
                self._least[number] = min(self._least[number], shape.cell_count)
        self._sheets.append(empty_sheet(self._grid.rows, self._grid.columns))
        self._free.append(self._grid.rows * self._grid.columns)
        self._refused.append(set())
        self._least.append(math.inf)
        laid = self._laid(len(self._sheets) - 1, shape)
        assert laid is not None  # every shape fits on an empty sheet
        return laid

    def _may_have_room(self, number: int, shape: _Shape) -> bool:
        if self._free[number] < shape.cell_count or shape.index in self._refused[number]:
            return False
        return not self._is_long or shape.cell_count < _HARDLY_SMALLER * self._least[number]

    def _laid(self, number: int, shape: _Shape) -> _Laid | None:
        sheet = self._sheets[number]
        size = shape.rows, shape.columns
        column, row = first_place(sheet, shape.runs[0], *size, self._grid.columns)
        before = self._grid.columns if column < 0 else column
        other, other_row = first_place(sheet, shape.runs[1], *size, before)
        is_turned = other >= 0
        if is_turned:
            column, row = other, other_row
        if column < 0:
            return None
        take(sheet, shape.runs[int(is_turned)], column, row)
        self._free[number] -= shape.cell_count
        return _Laid(shape, is_turned, number, column, row)


def _laid_in_order(items: Sequence[_Shape], grid: _Grid) -> _Layout:
    material = _Material(grid, is_long=len(items) > _MANY)
    laid = [material.lay(item) for item in items]
    last = max(one.sheet for one in laid)
    ends = [one.end for one in laid if one.sheet == last]
    return _Layout(items, laid, (last, max(ends), sum(ends)))

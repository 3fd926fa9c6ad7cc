"""Pieces as cells of a grid, and the first place where one fits among others: whole numbers only.

A piece takes every cell that comes nearer to it than half the gap. In each row of cells these are
runs; a sheet keeps for every cell the next one that is taken and the next one that is free, so that
a piece that collides moves on to behind what it met, not by one cell.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.compiled import compiled

from .piece import Floats

Mask = npt.NDArray[np.bool_]
Runs = npt.NDArray[np.int32]
"""(r, 3): row, first column, column behind the last, of each run of taken cells."""
Sheet = npt.NDArray[np.int32]
"""(2, rows, columns + 1): for each cell the next taken and the next free column of its row."""

_NOWHERE: Final = -1


@compiled
def _squared_distance(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> float:
    """From a point to a segment."""
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    share = 0.0
    if length > 0.0:
        share = min(1.0, max(0.0, ((px - ax) * dx + (py - ay) * dy) / length))
    ex, ey = ax + share * dx - px, ay + share * dy - py
    return float(ex * ex + ey * ey)


@compiled
def _take_border(taken: Mask, ring: Floats, cell: float, reach: float) -> None:
    """Marks the cells whose middle is nearer to the ring than reach."""
    rows, columns = taken.shape
    for i in range(len(ring)):
        ax, ay = ring[i, 0], ring[i, 1]
        bx, by = ring[(i + 1) % len(ring), 0], ring[(i + 1) % len(ring), 1]
        first_column = max(0, int((min(ax, bx) - reach) / cell))
        last_column = min(columns - 1, int((max(ax, bx) + reach) / cell))
        first_row = max(0, int((min(ay, by) - reach) / cell))
        last_row = min(rows - 1, int((max(ay, by) + reach) / cell))
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                x, y = cell * (column + 0.5), cell * (row + 0.5)
                if _squared_distance(x, y, ax, ay, bx, by) <= reach * reach:
                    taken[row, column] = True


@compiled
def _take_inside(taken: Mask, ring: Floats, cell: float) -> None:
    """Marks the cells whose middle is inside the ring, by the crossings of each row's middle."""
    rows, columns = taken.shape
    for row in range(rows):
        y = cell * (row + 0.5)
        for column in range(columns):
            x = cell * (column + 0.5)
            is_inside = False
            if taken[row, column]:
                continue
            for i in range(len(ring)):
                ax, ay = ring[i, 0], ring[i, 1]
                bx, by = ring[(i + 1) % len(ring), 0], ring[(i + 1) % len(ring), 1]
                if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
                    is_inside = not is_inside
            taken[row, column] = is_inside


def taken_cells(ring: Floats, *, cell: float, gap: float) -> Mask:
    """Returns the cells (rows, columns) that a piece takes with half the gap around it.

    Args:
        ring: (k, 2) mm, its outline, at least half the gap away from both axes.
        cell: mm.
        gap: mm.
    """
    high = ring.max(axis=0) + 0.5 * gap
    columns, rows = (int(np.ceil(side / cell - 1e-9)) for side in high)
    taken = np.zeros((rows, columns), dtype=np.bool_)
    # Half a diagonal more, so that no part of a cell that is free is nearer than half the gap.
    reach = 0.5 * gap + cell * float(np.sqrt(0.5))
    _take_border(taken, np.ascontiguousarray(ring), cell, reach)
    _take_inside(taken, np.ascontiguousarray(ring), cell)
    return taken


def runs_of(taken: Mask) -> Runs:
    """Returns the runs of taken cells, row by row."""
    framed = np.zeros((taken.shape[0], taken.shape[1] + 2), dtype=np.int8)
    framed[:, 1:-1] = taken
    steps = np.diff(framed, axis=1)
    row, first = np.nonzero(steps == 1)
    _, behind = np.nonzero(steps == -1)
    return np.column_stack((row, first, behind)).astype(np.int32)


def empty_sheet(rows: int, columns: int) -> Sheet:
    """Returns a sheet of which nothing is taken."""
    sheet = np.empty((2, rows, columns + 1), dtype=np.int32)
    sheet[0] = columns
    sheet[1] = np.arange(columns + 1)
    return sheet


@compiled
def first_place(sheet: Sheet, runs: Runs, rows: int, columns: int, before: int) -> tuple[int, int]:
    """Returns the column and row at which a piece ends first, then lies lowest; (-1, -1) if none.

    Args:
        sheet: what is taken.
        runs: of the piece.
        rows: of the piece.
        columns: of the piece.
        before: the column must be smaller.
    """
    best_column, best_row = _NOWHERE, _NOWHERE
    limit = min(before, sheet.shape[2] - columns)
    for row in range(sheet.shape[1] - rows + 1):
        column = 0
        clear = 0
        i = 0
        # Every run is looked at until all are clear one after another at the same column.
        while clear < len(runs) and column < limit:
            at = row + runs[i, 0]
            met = sheet[0, at, column + runs[i, 1]]
            if met < column + runs[i, 2]:
                column = sheet[1, at, met] - runs[i, 1]
                clear = 0
            clear += 1
            i = i + 1 if i + 1 < len(runs) else 0
        if column < limit:
            best_column, best_row = column, row
            limit = column
            if column == 0:
                break
    return best_column, best_row


@compiled
def take(sheet: Sheet, runs: Runs, column: int, row: int) -> None:
    """Puts a piece down: its cells, which are free, are taken from now on."""
    for i in range(len(runs)):
        at = row + runs[i, 0]
        first, behind = column + runs[i, 1], column + runs[i, 2]
        k = first - 1
        while k >= 0 and sheet[0, at, k] > first:
            sheet[0, at, k] = first
            k -= 1
        # Where the next run of taken cells joins, the free cell is behind that one.
        free = sheet[1, at, behind]
        for k in range(first, behind):
            sheet[0, at, k] = k
            sheet[1, at, k] = free
        k = first - 1
        while k >= 0 and sheet[0, at, k] == k:
            sheet[1, at, k] = free
            k -= 1

"""Pieces on sheets of paper: whole on one where they fit, over several only where they must.

A group is a plane of its own with one page or more: small pieces share a page, a large piece has
pages in rows and columns that overlap a little.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece, frozen

from .drawing import Drawing, draw, text_box

SHORT: Final = 210.0
LONG: Final = 297.0
"""mm; A4."""
MARGIN: Final = 12.0
"""mm that no printer needs to reach."""
OVERLAP: Final = 10.0
"""mm that neighbouring pages of a large piece share."""
_GAP: Final = 6.0
"""mm between pieces on one page."""
_ROOM: Final = 2.0
"""mm between a piece and the frame of its page."""


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Pieces on the pages of one plane."""

    pieces: tuple[PatternPiece, ...]
    """Moved into the plane."""
    page: Floats
    """(2,) mm, size of a page."""
    columns: int
    """How many pages stand beside each other."""
    rows: int
    """How many stand above each other."""
    pages: tuple[tuple[int, int], ...]
    """(column, row) of those with anything on them, from the top left."""

    @property
    def window(self) -> Floats:
        """(2,) mm, the part of a page that is drawn on."""
        size: Floats = self.page - 2.0 * MARGIN
        return size

    def corner(self, column: int, row: int) -> Floats:
        """Returns the lower left corner (2,) mm of a page's window in the plane."""
        place: Floats = (self.window - OVERLAP) * (column, row)
        return place

    @property
    def size(self) -> Floats:
        """(2,) mm, from the first page's window to the last one's."""
        size: Floats = self.corner(self.columns - 1, self.rows - 1) + self.window
        return size

    def name_of(self, column: int, row: int) -> str:
        """Returns a page's place: rows from the top by letter, columns by number."""
        if self.columns * self.rows == 1:
            return ""
        number, letters = self.rows - row, ""
        while number:
            number, digit = divmod(number - 1, 26)
            letters = chr(ord("A") + digit) + letters
        return f"row {letters}, column {column + 1}"


def on_paper(pieces: Sequence[PatternPiece]) -> tuple[Group, ...]:
    """Returns the groups of pages, large pieces first, in the order of the pieces.

    Args:
        pieces: at least one.
    """
    large: list[Group] = []
    upright: list[PatternPiece] = []
    lying: list[PatternPiece] = []
    for piece in pieces:
        width, height = _extent(piece)[1] - _extent(piece)[0]
        if width <= _inner(LONG) and height <= _inner(SHORT):
            lying.append(piece)
        elif width <= _inner(SHORT) and height <= _inner(LONG):
            upright.append(piece)
        else:
            large.append(_tiled(piece))
    return (
        *large,
        *_shared_pages(lying, np.array((LONG, SHORT))),
        *_shared_pages(upright, np.array((SHORT, LONG))),
    )


def _inner(side: float) -> float:
    return side - 2.0 * (MARGIN + _ROOM)


def _extent(piece: PatternPiece) -> tuple[Floats, Floats]:
    held = np.vstack((piece.cut_line, text_box(piece)))
    return held.min(axis=0), held.max(axis=0)


def _placed(piece: PatternPiece, corner: Floats) -> PatternPiece:
    return piece.moved(frozen(corner + _ROOM - _extent(piece)[0]))


def _shared_pages(pieces: Sequence[PatternPiece], page: Floats) -> Iterator[Group]:
    """Yields pages with pieces side by side in shelves, tall ones first."""
    sizes = [_extent(piece)[1] - _extent(piece)[0] for piece in pieces]
    room = page - 2.0 * (MARGIN + _ROOM)
    here: list[PatternPiece] = []
    left = bottom = shelf = 0.0
    for i in sorted(range(len(pieces)), key=lambda i: -float(sizes[i][1])):
        width, height = map(float, sizes[i])
        if left > 0.0 and left + width > room[0]:
            left, bottom, shelf = 0.0, bottom + shelf + _GAP, 0.0
        if here and bottom + height > room[1]:
            yield _page_of(here, page)
            here, left, bottom, shelf = [], 0.0, 0.0, 0.0
        here.append(_placed(pieces[i], np.array((left, bottom))))
        left, shelf = left + width + _GAP, max(shelf, height)
    if here:
        yield _page_of(here, page)


def _page_of(pieces: Sequence[PatternPiece], page: Floats) -> Group:
    return Group(tuple(pieces), frozen(page), 1, 1, ((0, 0),))


def _tiled(piece: PatternPiece) -> Group:
    """Returns a large piece on the fewest pages, upright or lying."""
    low, high = _extent(piece)
    size = high - low + 2.0 * _ROOM
    trials = []
    for page in (np.array((SHORT, LONG)), np.array((LONG, SHORT))):
        step = page - 2.0 * MARGIN - OVERLAP
        columns, rows = (
            max(1, math.ceil((size[axis] - OVERLAP) / step[axis] - 1e-9)) for axis in (0, 1)
        )
        group = Group((_placed(piece, np.zeros(2)),), frozen(page), columns, rows, ())
        pages = tuple(_inked(group))
        trials.append(Group(group.pieces, group.page, columns, rows, pages))
    return min(trials, key=lambda group: len(group.pages))


def _inked(group: Group) -> Iterator[tuple[int, int]]:
    """Yields the pages with anything to see, row by row from the top."""
    ink = _ink([draw(piece) for piece in group.pieces])
    for row in reversed(range(group.rows)):
        for column in range(group.columns):
            corner = group.corner(column, row)
            if shapely.box(*corner, *(corner + group.window)).intersects(ink):
                yield column, row


def _ink(drawings: Sequence[Drawing]) -> shapely.Geometry:
    lines = [
        np.vstack((stroke.points, stroke.points[:1])) if stroke.is_closed else stroke.points
        for drawing in drawings
        for stroke in drawing.strokes
    ]
    return shapely.union_all(
        [
            shapely.MultiLineString(lines),
            *(shapely.Point(label.position) for d in drawings for label in d.labels),
        ]
    )

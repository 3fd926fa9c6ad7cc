"""Where the texts of a piece stand: inside it, across no line, at any angle; else beside it.

The texts form a block of one or more columns. It is put where it is largest, within limits, in what
the piece's lines leave free: first clear of the rulings, then over rulings that are broken around
it, then, where the piece is too narrow for readable letters, beside it with a leader. Rulings are
broken around the grain line, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Final

import numpy as np
import shapely

from wrinkle_cad import settings

from .grain_place import CLEAR, SIDE, arrow_lines, grain_lines
from .notch_forms import notch_lines
from .piece import Floats, PatternPiece, frozen
from .vacancy import Vacancy

_HEIGHTS: Final = (4.0, 3.5, 3.0, 2.5, 2.0)
"""mm; letters are as high as fits, and never lower than the last."""
_COMFORTABLE: Final = 3.0
"""mm; letters of this height are not looked for any longer."""
_ANGLES: Final = (0, 15, -15, 30, -30, 45, -45, 60, -60, 75, -75, 90)
"""deg; readable from below or from the right."""
_PITCH: Final = 1.5
"""Heights of a letter from one base line to the next."""
_DESCENT: Final = 0.35
"""Heights of a letter that tails reach below the base line."""
_ADVANCE: Final = 1.1
"""Heights of a letter that it takes along the line, at most: in DejaVu Sans, Arial and txt.shx."""
_WIDE: Final = frozenset("MWmw@%")
_WIDE_ADVANCE: Final = 1.45
_COLUMN_GAP: Final = 2.0
"""Heights of a letter between columns."""
_HOLE: Final = 1.0
"""mm; radius that is kept free around a drill hole."""


@dataclass(frozen=True, slots=True, eq=False)
class TextRow:
    """One line of text."""

    text: str
    """As the piece has it."""
    position: Floats
    """(2,) mm, the left end of its base line."""
    height: float
    """mm of a capital letter."""
    angle: float
    """rad, counter-clockwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Lettering:
    """Where the texts of a piece stand."""

    rows: tuple[TextRow, ...]
    """One for each text."""
    box: Floats
    """(4, 2) mm, the corners of the block around them."""
    leader: Floats | None
    """(2, 2) mm from the block to the cut line, None where it stands inside."""
    grain_line: Floats
    """(2, 2) mm, moved or shortened to make room."""
    grain_leader: Floats | None
    """(2, 2) mm from the grain line to the cut line, None where it stands inside."""
    rulings: tuple[Floats, ...]
    """(k, 2) mm each, broken around the block and the grain line."""
    ruling_fold: tuple[float, ...]
    """(r,) rad, of each of them."""

    @property
    def extent(self) -> Floats:
        """(k, 2) mm, points around the texts and what else stands beside the piece."""
        if self.grain_leader is None:
            return self.box
        return frozen(np.vstack((self.box, *arrow_lines(self.grain_line))))


@dataclass(frozen=True, slots=True)
class _Block:
    """Texts in columns, for letters 1 mm high: (x, y) of each row, width and height of all."""

    places: tuple[tuple[float, float], ...]
    width: float
    height: float


def lettering(piece: PatternPiece, lines: Sequence[str]) -> Lettering:
    """Returns where texts stand on a piece.

    The same for a piece wherever it is moved to, to the last bit of a rounded coordinate.

    Args:
        piece: with a cut line of some area.
        lines: the texts, one per row.
    """
    # Decisions are taken in the piece's own frame: moving a piece changes its last bits.
    origin = piece.cut_line.min(axis=0)
    here = piece.moved(-origin)
    made = _decided(_Question(_content_of(here), tuple(lines), here))
    return Lettering(
        rows=tuple(replace(row, position=frozen(row.position + origin)) for row in made.rows),
        box=frozen(made.box + origin),
        leader=None if made.leader is None else frozen(made.leader + origin),
        grain_line=frozen(made.grain_line + origin),
        grain_leader=None if made.grain_leader is None else frozen(made.grain_leader + origin),
        rulings=tuple(frozen(line + origin) for line in made.rulings),
        ruling_fold=made.ruling_fold,
    )


@dataclass(frozen=True, slots=True)
class _Question:
    """A piece and its texts, equal to another if the piece looks the same."""

    content: bytes
    lines: tuple[str, ...]
    piece: PatternPiece = field(compare=False)


@lru_cache(maxsize=256)
def _decided(question: _Question) -> Lettering:
    """Returns the answer: every format asks for it, several times."""
    found = _inside(question.piece, question.lines)
    return _beside(question.piece, question.lines) if found is None else found


def _content_of(piece: PatternPiece) -> bytes:
    """Returns what decides where texts stand, to the nanometer."""
    lines = [piece.cut_line, piece.sew_line, *piece.cut_outs, piece.grain_line]
    lines += [] if piece.stretch_line is None else [piece.stretch_line]
    lines += [line for notch in piece.notches for line in notch_lines(notch)]
    lines += [] if piece.bends is None else [piece.bends.lines.reshape(-1, 2)]
    lines += [piece.drill_holes, piece.rulings.reshape(-1, 2), piece.ruling_fold]
    return b"|".join((np.round(line, 6) + 0.0).tobytes() for line in lines)


def text_width(text: str) -> float:
    """Returns how wide a text may be in any plain font, in heights of a capital letter.

    Example:
        >>> round(text_width("SIZE M"), 2)
        6.95
    """
    return sum(
        _WIDE_ADVANCE if letter in _WIDE or not letter.isascii() else _ADVANCE for letter in text
    )


def _blocks(lines: Sequence[str]) -> Iterator[_Block]:
    """Yields the texts in one column, in two, and so on, to all in one row."""
    for columns in range(1, len(lines) + 1):
        row_count = -(-len(lines) // columns)
        if -(-len(lines) // row_count) != columns:
            continue
        places = []
        left = 0.0
        for first in range(0, len(lines), row_count):
            column = lines[first : first + row_count]
            for row in range(len(column)):
                places.append((left, _DESCENT + _PITCH * (row_count - 1 - row)))
            left += max(map(text_width, column)) + _COLUMN_GAP
        height = _DESCENT + _PITCH * (row_count - 1) + 1.0
        yield _Block(tuple(places), left - _COLUMN_GAP, height)


def _inside(piece: PatternPiece, lines: Sequence[str]) -> Lettering | None:
    blocks = list(_blocks(lines))
    best: tuple[float, Lettering] | None = None
    for breaks_rulings in (False, True):
        if breaks_rulings and not len(piece.rulings):
            break
        for grain in grain_lines(piece):
            free = _free(piece, grain, with_rulings=not breaks_rulings)
            # Not even one row of the lowest letters has room between the lines.
            if free.buffer(-0.49 * (1.0 + _DESCENT) * _HEIGHTS[-1]).is_empty:
                continue
            vacancy = Vacancy(free)
            for angle in _ANGLES:
                smallest = _HEIGHTS[-1] if best is None else best[0] + 1e-9
                made = _placed(vacancy, blocks, lines, float(angle), smallest)
                if made is not None:
                    rows, box = made
                    best = rows[0].height, _with_lines(piece, rows, box, None, grain)
                if best is not None and best[0] >= _COMFORTABLE:
                    return best[1]
        if best is not None:
            return best[1]
    return None


def _free(piece: PatternPiece, grain: Floats, *, with_rulings: bool) -> shapely.Geometry:
    """Returns what no line of a piece takes, with room around every line."""
    taken = [shapely.LineString(arrow) for arrow in arrow_lines(grain)]
    if piece.stretch_line is not None:
        taken += [shapely.LineString(arrow) for arrow in arrow_lines(piece.stretch_line)]
    taken += [shapely.LineString(line) for notch in piece.notches for line in notch_lines(notch)]
    taken += [shapely.LinearRing(hole) for hole in piece.cut_outs]
    taken += [shapely.Point(hole).buffer(_HOLE) for hole in piece.drill_holes]
    if piece.bends is not None:
        taken += list(shapely.linestrings(piece.bends.lines))
    if with_rulings:
        taken += list(shapely.linestrings(drawn_rulings(piece)[0]))
    inner = shapely.Polygon(piece.sew_line)
    inner = inner.intersection(shapely.Polygon(piece.cut_line)).buffer(-CLEAR)
    return inner.difference(shapely.union_all(taken).buffer(CLEAR, quad_segs=2))


def _placed(
    vacancy: Vacancy,
    blocks: Sequence[_Block],
    lines: Sequence[str],
    degrees: float,
    smallest: float,
) -> tuple[tuple[TextRow, ...], Floats] | None:
    """Returns the largest rows at an angle, with the box around them, if any fit."""
    turned = vacancy.turned(-degrees)
    for height in (height for height in _HEIGHTS if height >= smallest):
        for block in blocks:
            corner = turned.corner_for(height * block.width, height * block.height)
            if corner is not None:
                return _turned(block, lines, corner, height, degrees)
    return None


def _turned(
    block: _Block, lines: Sequence[str], corner: Floats, height: float, degrees: float
) -> tuple[tuple[TextRow, ...], Floats]:
    angle = np.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)

    def back(points: Floats) -> Floats:
        x, y = points[..., 0], points[..., 1]
        return np.stack((cosine * x - sine * y, sine * x + cosine * y), axis=-1)

    rows = tuple(
        TextRow(text, frozen(back(corner + height * np.array(place))), height, float(angle))
        for text, place in zip(lines, block.places, strict=True)
    )
    size = height * np.array((block.width, block.height))
    corners = corner + size * np.array(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)))
    return rows, back(corners)


def _beside(piece: PatternPiece, lines: Sequence[str]) -> Lettering:
    """Returns the texts above a piece, or on its right where it is shorter than they are."""
    block = next(_blocks(lines))
    height = _HEIGHTS[0]
    low, high = piece.cut_line.min(axis=0), piece.cut_line.max(axis=0)
    size = height * np.array((block.width, block.height))
    if size[0] <= high[0] - low[0]:
        corner = np.array((low[0], high[1] + SIDE))
        start = corner + np.array((0.5 * size[0], -CLEAR))
    else:
        corner = np.array((high[0] + SIDE, 0.5 * (low[1] + high[1] - size[1])))
        start = corner + np.array((-CLEAR, 0.5 * size[1]))
    rows, box = _turned(block, lines, corner, height, 0.0)
    way = shapely.shortest_line(shapely.Point(start), shapely.LinearRing(piece.cut_line))
    return _with_lines(piece, rows, box, np.array(way.coords), grain_lines(piece)[0])


def _with_lines(
    piece: PatternPiece,
    rows: tuple[TextRow, ...],
    box: Floats,
    leader: Floats | None,
    grain: Floats,
) -> Lettering:
    """Returns the texts with the rulings broken around them and around the grain line."""
    windows = [shapely.Polygon(box).buffer(CLEAR)]
    windows += [shapely.LineString(arrow).buffer(CLEAR) for arrow in arrow_lines(grain)]
    window = shapely.union_all(windows)
    kept: list[Floats] = []
    folds: list[float] = []
    for line, fold in zip(*drawn_rulings(piece), strict=True):
        rest = shapely.LineString(line).difference(window)
        for part in shapely.get_parts(rest):
            if part.length > piece.tolerance:
                kept.append(np.array(part.coords))
                folds.append(float(fold))
    return Lettering(
        rows, box, leader, grain, _grain_leader(piece, grain), tuple(kept), tuple(folds)
    )


def _grain_leader(piece: PatternPiece, grain: Floats) -> Floats | None:
    if shapely.Polygon(piece.cut_line).intersects(shapely.LineString(grain)):
        return None
    middle = shapely.Point(0.5 * (grain[0] + grain[1]))
    return np.array(shapely.shortest_line(middle, shapely.LinearRing(piece.cut_line)).coords)


def drawn_rulings(piece: PatternPiece) -> tuple[Floats, Floats]:
    """Returns the rulings at which the sheet is folded, (r, 2, 2) mm, and their folds, (r,) rad.

    A ruling between facets of one plane is not folded: there is nothing to draw.
    """
    is_folded = np.abs(piece.ruling_fold) >= settings.FLAT_FOLD
    return piece.rulings[is_folded], piece.ruling_fold[is_folded]

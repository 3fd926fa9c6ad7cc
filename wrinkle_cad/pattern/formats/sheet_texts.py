"""Names of narrow pieces on a full sheet of material: in the waste near them, with a leader."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from wrinkle_cad.pattern.piece.lettering import lettering, text_width
from wrinkle_cad.pattern.piece.piece import RIGHT_SIDE, PatternPiece, frozen
from wrinkle_cad.pattern.piece.vacancy import Vacancy

from .drawing import Label, Stroke

_HEIGHTS: Final = (4.0, 3.0, 2.0)
"""mm; letters are as high as fits, and never lower than the last."""
_LINE: Final = 1.35
"""Heights of a letter from its tails to its top."""
_DESCENT: Final = 0.35
"""Heights of a letter from its tails to the base line."""
_FRAME: Final = 0.5
"""mm from letters to the end of their leader, and from a leader to anything else."""
_CLEAR: Final = 1.0
"""mm between letters and any piece or the sheet's edge."""
_AWAY: Final = (10.0, 25.0, 60.0, 150.0)
"""mm from its piece within which a name is looked for, nearest first."""


@dataclass(frozen=True, slots=True, eq=False)
class SheetTexts:
    """What is written of a piece on a sheet."""

    inside: tuple[str, ...]
    """The texts in the piece, none where it is too narrow."""
    beside: Label | None = None
    """Its name in the waste, None where it is not needed or has no room either."""
    leader: Stroke | None = None
    """From there to the piece."""


def sheet_texts(
    pieces: Sequence[PatternPiece], sheet: tuple[float, float]
) -> tuple[SheetTexts, ...]:
    """Returns what is written of each piece, and where.

    All texts stand inside where they fit. Else the name and which side is the right one, inside or
    in the waste; else the name alone, which is read from the right side. A leader crosses no other
    piece and no other name.

    Args:
        pieces: where they lie on the sheet.
        sheet: mm, length and width.
    """
    waste = _Waste(pieces, sheet)
    return tuple(_texts_of(piece, number, waste) for number, piece in enumerate(pieces))


def _texts_of(piece: PatternPiece, number: int, waste: _Waste) -> SheetTexts:
    if _fit_inside(piece, piece.texts):
        return SheetTexts(piece.texts)
    for texts in ((piece.name, RIGHT_SIDE), (piece.name,)):
        if _fit_inside(piece, texts):
            return SheetTexts(texts)
        made = waste.named(number, ", ".join(texts))
        if made is not None:
            return SheetTexts((), *made)
    return SheetTexts(())


def _fit_inside(piece: PatternPiece, texts: Sequence[str]) -> bool:
    return lettering(piece, texts).leader is None


class _Waste:
    """What pieces and names leave free on a sheet."""

    def __init__(self, pieces: Sequence[PatternPiece], sheet: tuple[float, float]) -> None:
        self._regions = [shapely.Polygon(piece.cut_line) for piece in pieces]
        self._boxes: list[shapely.Polygon] = []
        taken = shapely.union_all(self._regions).buffer(_CLEAR, quad_segs=2)
        self._free = shapely.box(0.0, 0.0, *sheet).buffer(-_CLEAR).difference(taken)

    def named(self, number: int, text: str) -> tuple[Label, Stroke] | None:
        """Returns a text near a piece and its leader, if there is room, which is then taken."""
        region = self._regions[number]
        others = shapely.union_all(
            [*self._regions[:number], *self._regions[number + 1 :], *self._boxes]
        )
        made = _named(text, region, self._free, others)
        if made is None:
            return None
        box, leader, label = made
        self._boxes.append(box)
        self._free = self._free.difference(shapely.union(box, leader).buffer(_CLEAR, quad_segs=2))
        return label, Stroke("text", frozen(leader.coords))


def _named(
    text: str, region: shapely.Polygon, free: shapely.Geometry, others: shapely.Geometry
) -> tuple[shapely.Polygon, shapely.LineString, Label] | None:
    for away in _AWAY:
        around = free.intersection(region.buffer(away, quad_segs=2))
        if around.is_empty:
            continue
        vacancy = Vacancy(around).turned(0.0)
        for height in _HEIGHTS:
            size = height * np.array((text_width(text), _LINE)) + 2.0 * _FRAME
            corner = vacancy.corner_for(*size.tolist())
            if corner is None:
                continue
            box = shapely.box(*corner, *(corner + size))
            leader = shapely.shortest_line(box, region.exterior)
            if leader.distance(others) > _FRAME:
                place = corner + _FRAME + height * np.array((0.0, _DESCENT))
                return box, leader, Label("text", text, frozen(place), height)
    return None

"""What a piece looks like on paper or on the machine: strokes, spots and labels, each with a role.

Every format that shows plain lines (DXF for cutters, SVG, PDF) draws from here, so that all of
them show the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from wrinkle_cad import settings
from wrinkle_cad.pattern.piece.notch_forms import notch_lines
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece, frozen

from .layers import Role


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """A polyline: (k, 2) mm; a closed one does not repeat its first point."""

    role: Role
    points: Floats
    is_closed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A point: (2,) mm."""

    role: Role
    position: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """One line of text, its left end on the base line at (2,) mm, ``height`` mm high."""

    role: Role
    text: str
    position: Floats
    height: float


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """All that is drawn for one piece."""

    strokes: tuple[Stroke, ...]
    spots: tuple[Spot, ...]
    labels: tuple[Label, ...]


def draw(piece: PatternPiece) -> Drawing:
    """Returns the strokes, spots and labels of a piece, in the order in which a machine acts."""
    strokes: list[Stroke] = []
    if piece.has_allowance:
        strokes.append(Stroke("sew", piece.sew_line, is_closed=True))
    for line, fold in zip(piece.rulings, piece.ruling_fold, strict=True):
        # A ruling between facets of one plane is not folded: there is nothing to draw.
        if abs(fold) >= settings.FLAT_FOLD:
            strokes.append(Stroke("mountain" if fold > 0.0 else "valley", line))
    strokes.append(Stroke("grain", piece.grain_line))
    if piece.stretch_line is not None:
        strokes.append(Stroke("stretch", piece.stretch_line))
    for notch in piece.notches:
        # Without an allowance a slit would go into the product.
        role: Role = "notch" if notch.is_cut else "mark"
        strokes += [Stroke(role, line) for line in notch_lines(notch)]
    strokes += [Stroke("cut", outline, is_closed=True) for outline in piece.cut_outs]
    strokes.append(Stroke("cut", piece.cut_line, is_closed=True))
    spots = tuple(Spot("punch", frozen(hole)) for hole in piece.drill_holes)
    return Drawing(tuple(strokes), spots, _labels(piece))


def _labels(piece: PatternPiece) -> tuple[Label, ...]:
    """Returns the texts on a roomy spot, as large as fits inside the sew line, within limits."""
    region = shapely.Polygon(piece.sew_line)
    circle = shapely.maximum_inscribed_circle(region, piece.tolerance)
    spots = (np.array(circle.coords[0]), piece.grain_line.mean(axis=0))
    lines = piece.texts
    size = np.array((0.9 * max(map(len, lines)), 1.5 * len(lines)))
    shapely.prepare(region)
    middle, height = spots[0], settings.TEXT_HEIGHT_MIN
    for trial in np.geomspace(settings.TEXT_HEIGHT, settings.TEXT_HEIGHT_MIN, 12):
        boxes = [
            shapely.box(*(spot - 0.5 * trial * size), *(spot + 0.5 * trial * size))
            for spot in spots
        ]
        fits = np.flatnonzero(shapely.contains(region, boxes))
        if len(fits):
            middle, height = spots[fits[0]], float(trial)
            break
    left, top = middle + 0.5 * height * size * (-1.0, 1.0)
    return tuple(
        Label("text", text, frozen((left, top - (1.5 * row + 1.2) * height)), height)
        for row, text in enumerate(lines)
    )

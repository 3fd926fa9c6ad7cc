"""What a piece looks like on paper or on the machine: strokes, spots and labels, each with a role.

Every format that shows plain lines (DXF for cutters, SVG, PDF) draws from here, so that all of
them show the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wrinkle_cad.pattern.piece.grain_place import arrow_lines
from wrinkle_cad.pattern.piece.lettering import lettering
from wrinkle_cad.pattern.piece.notch_forms import notch_lines
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece, frozen

from .layers import Role


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """A polyline: (k, 2) mm; a closed one does not repeat its first point."""

    role: Role
    """What it stands for."""
    points: Floats
    """(k, 2) mm; a closed one does not repeat its first point."""
    is_closed: bool = False
    """Whether its end is its start."""


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A point: (2,) mm."""

    role: Role
    """What it stands for."""
    position: Floats
    """(2,) mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Label:
    """One line of text: the left end of its base line (2,) mm, its height in mm, angle in rad."""

    role: Role
    """What it stands for."""
    text: str
    """What it says."""
    position: Floats
    """(2,) mm; the left end of its base line."""
    height: float
    """mm of a capital letter."""
    angle: float = 0.0
    """rad, counter-clockwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """All that is drawn for one piece."""

    strokes: tuple[Stroke, ...]
    """Its lines."""
    spots: tuple[Spot, ...]
    """Its points."""
    labels: tuple[Label, ...]
    """Its texts."""


def draw(piece: PatternPiece, *, texts: Sequence[str] | None = None) -> Drawing:
    """Returns the strokes, spots and labels of a piece, in the order in which a machine acts.

    Args:
        piece: what is drawn.
        texts: what is written on it, or beside it with a leader; all its texts when None.
    """
    strokes: list[Stroke] = []
    if piece.has_allowance:
        strokes.append(Stroke("sew", piece.sew_line, is_closed=True))
    written = piece.texts if texts is None else tuple(texts)
    # Without a text nothing is moved to make room for it.
    lettered = lettering(piece, written or (piece.name,))
    for line, fold in zip(lettered.rulings, lettered.ruling_fold, strict=True):
        strokes.append(Stroke("mountain" if fold > 0.0 else "valley", line))
    if piece.bends is not None:
        for line, fold in zip(piece.bends.lines, piece.bends.fold, strict=True):
            strokes.append(Stroke("bend_down" if fold > 0.0 else "bend_up", line))
    # On a sheet there is no room beside a piece, and the grain runs along the sheet.
    if lettered.grain_leader is None or texts is None:
        strokes += [Stroke("grain", line) for line in arrow_lines(lettered.grain_line)]
    if lettered.grain_leader is not None and texts is None:
        strokes.append(Stroke("grain", lettered.grain_leader))
    if piece.stretch_line is not None:
        strokes += [Stroke("stretch", line) for line in arrow_lines(piece.stretch_line)]
    if lettered.leader is not None and written:
        strokes.append(Stroke("text", lettered.leader))
    for notch in piece.notches:
        # Without an allowance a slit would go into the product.
        role: Role = "notch" if notch.is_cut else "mark"
        strokes += [Stroke(role, line) for line in notch_lines(notch)]
    strokes += [Stroke("cut", outline, is_closed=True) for outline in piece.cut_outs]
    strokes.append(Stroke("cut", piece.cut_line, is_closed=True))
    spots = tuple(Spot("punch", frozen(hole)) for hole in piece.drill_holes)
    labels = (
        Label("text", row.text, row.position, row.height, row.angle)
        for row in (lettered.rows if written else ())
    )
    return Drawing(tuple(strokes), spots, tuple(labels))


def text_box(piece: PatternPiece) -> Floats:
    """Returns points (k, 2) mm around texts and what else stands beside a piece, to lay it out."""
    return lettering(piece, piece.texts).extent

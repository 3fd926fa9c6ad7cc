"""Pattern pieces as blocks, the way AAMA-292 and ASTM D6673 lay them out for pattern CAD.

One block per piece and size, its coordinates absolute, inserted at the origin on layer 1. Every
vertex of a line on layers 1, 8, 11 and 14 has a point on layer 2 (turn) or 3 (curve), and every
such line a dense copy on layers 84-87, for the reader to check its own curves against. Notches
are points: z is the depth, thickness the width, the angle points into the piece. ``astm`` tells
the forms of notches by layers 80-83; ``aama`` has layer 4 for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from typing import Final

import ezdxf
import numpy as np
from ezdxf.document import Drawing as DxfDocument
from ezdxf.layouts import BlockLayout

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding
from wrinkle_cad.pattern.piece.lettering import Lettering, lettering
from wrinkle_cad.pattern.piece.notch_forms import notch_lines
from wrinkle_cad.pattern.piece.options import NotchKind
from wrinkle_cad.pattern.piece.outline import closed_turns
from wrinkle_cad.pattern.piece.piece import (
    RIGHT_SIDE,
    Bools,
    Floats,
    PatternPiece,
    frozen,
    make_outline,
)  # fmt: skip

from .cutter import rounded
from .layers import LayerStyle, Profile, Role
from .plain_text import ascii_name, ascii_text, text_changed

STYLE_NAME: Final = "PATTERN"
"""What a file of pieces calls its style when nobody named it."""
TURN_POINTS: Final = "2"
CURVE_POINTS: Final = "3"
VALIDATION: Final = {"1": "84", "8": "85", "11": "86", "14": "87"}
_ASTM_NOTCHES: Final[dict[NotchKind, str]] = {"t": "80", "castle": "81", "check": "82", "u": "83"}
_DENSE: Final = 2.0
"""mm; largest distance of vertices on a validation curve."""
_PLAIN_COLOR: Final = 7
_NAME_LENGTH: Final = 20
"""Characters of a piece's name, and of its size, in the name of its block (31 in R12)."""


def block_document(
    pieces: Sequence[PatternPiece],
    profile: Profile,
    *,
    style: str,
    release: str,
    timestamp: datetime,
) -> tuple[DxfDocument, tuple[Finding, ...]]:
    """Returns a document with one block per piece, and which texts had to be changed.

    Args:
        pieces: laid out already.
        profile: ``aama`` or ``astm``, or a map with other layers for the same roles.
        style: what all pieces belong to.
        release: DXF release of the document.
        timestamp: the creation date and time that the file states.
    """
    document = ezdxf.new(release, units=ezdxf.units.MM)
    findings: list[Finding] = []
    names: set[str] = set()
    for piece in pieces:
        name = _block_name(piece, names)
        block = document.blocks.new(name)
        lettered = _lettered(piece, profile)
        findings += _write_texts(block, piece, lettered, profile)
        _write_lines(block, piece, lettered, profile)
        _write_marks(block, piece, profile)
        document.modelspace().add_blockref(name, (0.0, 0.0), dxfattribs={"layer": "1"})
    findings += text_changed("style name", style, _stated(style) or STYLE_NAME)
    _write_style(document, pieces, profile, style, timestamp)
    _add_layers(document, profile)
    return document, tuple(findings)


def scale_piece(piece: PatternPiece) -> PatternPiece:
    """Returns the square that shows the scale, as a piece: no other block is allowed."""
    side = settings.TEST_SQUARE
    corners = np.array(((0.0, 0.0), (side, 0.0), (side, side), (0.0, side)))
    square = make_outline(corners, [0, 3, 1, 2], [True] * 4)
    return replace(
        piece,
        name=f"TEST SQUARE {side:g} MM",
        quantity=1,
        material="",
        cut=square,
        sew=square,
        cut_outs=(),
        widths=(0.0, 0.0, 0.0, 0.0),
        notches=(),
        grain_line=frozen(((0.2 * side, 0.2 * side), (0.8 * side, 0.2 * side))),
        stretch_line=None,
        rulings=frozen(np.zeros((0, 2, 2))),
        ruling_fold=frozen(np.zeros(0)),
        drill_holes=frozen(np.zeros((0, 2))),
        hand=None,
        is_mirrored=False,
        bends=None,
        findings=(),
    )


def _block_name(piece: PatternPiece, taken: set[str]) -> str:
    """Returns NAME_SIZE in what R12 allows, with a number when that is taken already."""
    size = ascii_name(piece.size, longest=31 - _NAME_LENGTH - 5)
    stem = ascii_name(piece.name, longest=_NAME_LENGTH)
    name, count = f"{stem}_{size}", 1
    while name in taken:
        count += 1
        name = f"{stem}-{count}_{size}"
    taken.add(name)
    return name


def block_text_box(piece: PatternPiece, profile: Profile) -> Floats:
    """Returns the corners (4, 2) mm of the block of a piece's texts, for laying pieces out."""
    return _lettered(piece, profile).extent


def _lettered(piece: PatternPiece, profile: Profile) -> Lettering:
    # These formats have no bends, so that nothing has to make room for them.
    return lettering(replace(piece, bends=None), [text for text, _ in _texts(piece, profile)])


def _write_texts(
    block: BlockLayout, piece: PatternPiece, lettered: Lettering, profile: Profile
) -> list[Finding]:
    for row, (_, layer) in zip(lettered.rows, _texts(piece, profile), strict=True):
        block.add_text(
            row.text,
            height=row.height,
            rotation=round(float(np.degrees(row.angle)), settings.DXF_DECIMALS),
            dxfattribs={"layer": layer},
        ).set_placement(rounded(row.position))
    if lettered.leader is not None and "text" in profile.styles:
        layer = profile.styles["text"].layer
        block.add_line(*map(rounded, lettered.leader), dxfattribs={"layer": layer})
    return [
        *text_changed("piece name", piece.name, _stated(piece.name) or "PIECE"),
        *text_changed("size", piece.size, _stated(piece.size) or settings.PIECE_SIZE),
        *text_changed("material", piece.material, _stated(piece.material)),
    ]


def _texts(piece: PatternPiece, profile: Profile) -> list[tuple[str, str]]:
    """Returns the texts of a piece with their layers: what the standard asks for, then notes."""
    system = [
        f"Piece Name: {_stated(piece.name) or 'PIECE'}",
        f"Size: {_stated(piece.size) or settings.PIECE_SIZE}",
        # Copies as drawn, then mirrored copies. Pieces for the other foot are pieces of their own.
        f"Quantity: {piece.quantity},0",
    ]
    if _stated(piece.material):
        system.append(f"Material: {_stated(piece.material)}")
    notes = []
    if "text" in profile.styles:
        notes = [RIGHT_SIDE, f"CHORD TOLERANCE {piece.tolerance:g} MM"]
        if piece.hand:
            notes.append(piece.hand.upper())
        if len(piece.rulings) and "mountain" in profile.styles and "valley" in profile.styles:
            mountain, valley = profile.styles["mountain"], profile.styles["valley"]
            notes.append(f"RULINGS: COLOR {mountain.color} MOUNTAIN, {valley.color} VALLEY")
    note_layer = profile.styles["text"].layer if notes else ""
    return [*((text, "1") for text in system), *((text, note_layer) for text in notes)]


def _stated(text: str) -> str:
    """Returns a text short enough to stand behind a key."""
    return ascii_text(text, longest=200)


def _write_column(
    space: BlockLayout, lines: Sequence[str], layer: str, corner: Floats, height: float
) -> None:
    for row, line in enumerate(lines):
        place = corner - np.array((0.0, 1.5 * height * row))
        space.add_text(line, height=height, dxfattribs={"layer": layer}).set_placement(
            rounded(place)
        )


def _write_lines(
    block: BlockLayout, piece: PatternPiece, lettered: Lettering, profile: Profile
) -> None:
    styles = profile.styles
    _write_contour(block, piece.cut_line, piece.cut.corners, styles["cut"], is_closed=True)
    if piece.has_allowance and "sew" in styles:
        _write_contour(block, piece.sew_line, piece.sew.corners, styles["sew"], is_closed=True)
    for outline in piece.cut_outs:
        corners = np.abs(closed_turns(outline)) > settings.PATTERN_CORNER
        _write_contour(block, outline, corners, LayerStyle("11"), is_closed=True)
    for line, fold in zip(lettered.rulings, lettered.ruling_fold, strict=True):
        role: Role = "mountain" if fold > 0.0 else "valley"
        if role in styles:
            _write_contour(block, line, np.ones(2, dtype=np.bool_), styles[role], is_closed=False)
    if "mark" in styles:
        for notch in (notch for notch in piece.notches if not notch.is_cut):
            for line in notch_lines(notch):
                _write_contour(block, line, np.ones(2, np.bool_), styles["mark"], is_closed=False)
    # These formats want the grain line inside its piece, however narrow that is.
    is_inside = lettered.grain_leader is None
    grain = lettered.grain_line if is_inside else piece.grain_line
    _write_arrow(block, grain, styles.get("grain"))
    if piece.stretch_line is not None:
        _write_arrow(block, piece.stretch_line, styles.get("stretch"))


def _write_arrow(block: BlockLayout, line: Floats, style: LayerStyle | None) -> None:
    if style is not None:
        block.add_line(rounded(line[0]), rounded(line[1]), dxfattribs={"layer": style.layer})


def _write_contour(
    block: BlockLayout, points: Floats, corners: Bools, style: LayerStyle, *, is_closed: bool
) -> None:
    """Writes a line, the points at its vertices and its dense copy."""
    given: dict[str, object] = {"layer": style.layer}
    if style.color != _PLAIN_COLOR:
        given["color"] = style.color
    block.add_polyline2d(list(map(rounded, points)), close=is_closed, dxfattribs=given)
    if style.layer not in VALIDATION:
        return
    for point, is_corner in zip(points, corners, strict=True):
        layer = TURN_POINTS if is_corner else CURVE_POINTS
        block.add_point(rounded(point), dxfattribs={"layer": layer})
    # The copy of a straight line has nothing to validate in between.
    dense = _densified(points, is_closed=is_closed) if len(points) > 2 else points
    given = {"layer": VALIDATION[style.layer]}
    block.add_polyline2d(list(map(rounded, dense)), close=is_closed, dxfattribs=given)


def _densified(points: Floats, *, is_closed: bool) -> Floats:
    """Returns the same line with every segment divided into parts of at most ``_DENSE`` mm."""
    after = np.roll(points, -1, axis=0) if is_closed else points[1:]
    before = points if is_closed else points[:-1]
    lengths = np.linalg.norm(after - before, axis=1)
    counts = np.maximum(1, np.ceil(lengths / _DENSE).astype(np.int64))
    index = np.repeat(np.arange(len(before)), counts)
    share = (np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[index]
    dense: Floats = before[index] + share[:, None] * (after - before)[index]
    return dense if is_closed else np.vstack((dense, points[-1:]))


def _write_marks(block: BlockLayout, piece: PatternPiece, profile: Profile) -> None:
    if "notch" in profile.styles:
        for notch in (notch for notch in piece.notches if notch.is_cut):
            layer = profile.styles["notch"].layer
            if profile.name == "astm":
                layer = _ASTM_NOTCHES.get(notch.kind, layer)
            x, y = rounded(notch.position)
            angle = math.degrees(math.atan2(notch.direction[1], notch.direction[0])) % 360.0
            width = 0.0 if notch.kind == "slit" else notch.width
            given = {
                "layer": layer,
                "thickness": round(width, settings.DXF_DECIMALS),
                "angle": round(angle, settings.DXF_DECIMALS),
            }
            block.add_point((x, y, round(notch.depth, settings.DXF_DECIMALS)), dxfattribs=given)
    if "punch" in profile.styles:
        for hole in piece.drill_holes:
            given = {"layer": profile.styles["punch"].layer}
            block.add_point(rounded(hole), dxfattribs=given)


def _write_style(
    document: DxfDocument,
    pieces: Sequence[PatternPiece],
    profile: Profile,
    style: str,
    timestamp: datetime,
) -> None:
    lines = (
        f"Style Name: {_stated(style) or STYLE_NAME}",
        f"Creation Date: {timestamp:%d-%m-%Y}",
        f"Creation Time: {timestamp:%H:%M}",
        "Author: wrinkle-cad",
        f"Sample Size: {_stated(pieces[0].size) or settings.PIECE_SIZE}",
        "Units: METRIC",
        f"Curve Tolerance: {max(piece.tolerance for piece in pieces):g}",
        "ASTM/D13Proposal 1 Version: D 6673-10",
    )
    height = settings.TEXT_HEIGHT
    # Texts beside a narrow piece may lie lower than the piece itself.
    lowest = min(float(block_text_box(piece, profile)[:, 1].min()) for piece in pieces)
    corner = np.array((0.0, min(0.0, lowest) - 2.0 * height))
    _write_column(document.modelspace(), lines, "1", corner, height)


def _add_layers(document: DxfDocument, profile: Profile) -> None:
    """Enters the layers in use in the layer table, which the R12 form for Gerber leaves out."""
    colors = {style.layer: style.color for style in profile.styles.values()}
    spaces = [document.modelspace(), *(block for block in document.blocks)]
    used = sorted({entity.dxf.layer for space in spaces for entity in space}, key=_layer_order)
    for layer in used:
        if layer not in document.layers:
            document.layers.add(layer, color=colors.get(layer, _PLAIN_COLOR))


def _layer_order(layer: str) -> tuple[int, str]:
    return (int(layer) if layer.isdigit() else 0, layer)

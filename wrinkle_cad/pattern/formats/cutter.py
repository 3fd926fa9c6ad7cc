"""Pattern pieces as the plain drawing that knife cutters and lasers read.

One closed LWPOLYLINE per contour (or one closed SPLINE on request), lines for rulings and marks,
points for holes, single-line texts. No blocks. Millimetres, said in the header and on every piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import ezdxf
import numpy as np
from ezdxf.document import Drawing as DxfDocument
from ezdxf.layouts import Modelspace

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece
from wrinkle_cad.settings import Curves

from .contours import closed_spline, with_arcs
from .drawing import Drawing, Stroke, draw
from .layers import LINE_TYPES, LayerStyle, Profile, Role
from .plain_text import ascii_text, text_changed
from .sheet_texts import SheetTexts, sheet_texts

_CURVE_PER_TOLERANCE: Final = 0.5
"""Arcs and splines leave the polygon of an outline by this share of the chord tolerance: with those
of the flat rails (0.2) and of the allowance's facets (0.3) it stays within the whole."""


def cutter_document(
    pieces: Sequence[PatternPiece],
    profile: Profile,
    *,
    release: str,
    curves: Curves,
    test_square: bool,
    sheet: tuple[float, float] | None = None,
) -> tuple[DxfDocument, tuple[Finding, ...]]:
    """Returns a document with all pieces where they stand, and which texts had to be changed.

    Args:
        pieces: laid out already.
        profile: layers; a role that it lacks is not drawn.
        release: R2000 or later.
        curves: how the contours are written.
        test_square: add the square that shows the scale.
        sheet: mm, of material, on which the pieces are nested; their texts may then not stand
            beside them.
    """
    document = ezdxf.new(release, units=ezdxf.units.MM)
    _add_tables(document, profile)
    findings: list[Finding] = []
    told = (None,) * len(pieces) if sheet is None else sheet_texts(pieces, sheet)
    for piece, texts in zip(pieces, told, strict=True):
        drawing = draw(piece) if texts is None else _drawn_on_sheet(piece, texts)
        if not drawing.labels:
            findings.append(_unnamed_finding(piece))
        _write_strokes(document.modelspace(), drawing, piece, profile, curves)
        findings += _write_labels(document.modelspace(), drawing, piece, profile)
    if test_square:
        _write_test_square(document.modelspace(), pieces, profile)
    _remove_unused_layers(document)
    corners = np.vstack([piece.cut_line for piece in pieces])
    low, high = corners.min(axis=0), corners.max(axis=0)
    document.modelspace().reset_extents((*rounded(low), 0.0), (*rounded(high), 0.0))
    return document, tuple(findings)


def _drawn_on_sheet(piece: PatternPiece, texts: SheetTexts) -> Drawing:
    drawing = draw(piece, texts=texts.inside)
    if texts.beside is None or texts.leader is None:
        return drawing
    strokes = (texts.leader, *drawing.strokes)
    return replace(drawing, strokes=strokes, labels=(texts.beside,))


def _unnamed_finding(piece: PatternPiece) -> Finding:
    return Finding(
        "name-left-out",
        "warning",
        f"Neither {piece.name} nor the waste near it has room for its name on the sheet. Mark it "
        "by hand after cutting.",
    )


def attributes(style: LayerStyle) -> dict[str, object]:
    """Returns a style as ezdxf's attributes."""
    given: dict[str, object] = {"layer": style.layer, "color": style.color}
    if style.line_type != "CONTINUOUS":
        given["linetype"] = style.line_type
    return given


def rounded(point: Floats) -> tuple[float, float]:
    """Returns x and y in mm as the file has them; adding 0.0 turns -0.0 into 0.0."""
    first, second = np.round(point, settings.DXF_DECIMALS) + 0.0
    return float(first), float(second)


def _add_tables(document: DxfDocument, profile: Profile) -> None:
    for name, (description, pattern) in LINE_TYPES.items():
        used = any(style.line_type == name for style in profile.styles.values())
        if used and name not in document.linetypes:
            document.linetypes.add(name, pattern=list(pattern), description=description)
    first: dict[str, LayerStyle] = {}
    for style in profile.styles.values():
        first.setdefault(style.layer, style)
    for layer, style in first.items():
        if layer not in document.layers:
            document.layers.add(layer, color=style.color)


def _remove_unused_layers(document: DxfDocument) -> None:
    used = {entity.dxf.layer.lower() for entity in document.modelspace()}
    for name in [layer.dxf.name for layer in document.layers]:
        if name.lower() not in used | {"0", "defpoints"}:
            document.layers.remove(name)


def _write_strokes(
    space: Modelspace, drawing: Drawing, piece: PatternPiece, profile: Profile, curves: Curves
) -> None:
    tolerance = _CURVE_PER_TOLERANCE * piece.tolerance
    for stroke in drawing.strokes:
        if stroke.role in profile.styles:
            style = profile.styles[stroke.role]
            if stroke.is_closed and curves == "arcs":
                bulged = with_arcs(stroke.points, tolerance=tolerance)
                rows = [(*rounded(row[:2]), float(row[2])) for row in bulged]
                space.add_lwpolyline(rows, "xyb", close=True, dxfattribs=attributes(style))
            elif stroke.is_closed and curves == "splines":
                spline = space.add_spline(dxfattribs=attributes(style))
                spline.apply_construction_tool(closed_spline(stroke.points, tolerance=tolerance))
            else:
                _write_polyline(space, stroke, style)
    for spot in drawing.spots:
        if spot.role in profile.styles:
            space.add_point(
                rounded(spot.position), dxfattribs=attributes(profile.styles[spot.role])
            )


def _write_polyline(space: Modelspace, stroke: Stroke, style: LayerStyle) -> None:
    points = [rounded(point) for point in stroke.points]
    if len(points) == 2 and not stroke.is_closed:
        space.add_line(points[0], points[1], dxfattribs=attributes(style))
    else:
        space.add_lwpolyline(points, close=stroke.is_closed, dxfattribs=attributes(style))


def _write_labels(
    space: Modelspace, drawing: Drawing, piece: PatternPiece, profile: Profile
) -> list[Finding]:
    findings: list[Finding] = []
    for label in drawing.labels:
        if label.role in profile.styles:
            text = ascii_text(label.text)
            findings += text_changed(f"text on {ascii_text(piece.name)}", label.text, text)
            height = round(label.height, settings.DXF_DECIMALS)
            given = attributes(profile.styles[label.role])
            angle = round(float(np.degrees(label.angle)), settings.DXF_DECIMALS)
            space.add_text(text, height=height, rotation=angle, dxfattribs=given).set_placement(
                rounded(label.position)
            )
    return findings


def _write_test_square(space: Modelspace, pieces: Sequence[PatternPiece], profile: Profile) -> None:
    role: Role = "test_square"
    if role not in profile.styles:
        return
    side = settings.TEST_SQUARE
    top = max(float(piece.cut_line[:, 1].max()) for piece in pieces) + settings.PIECE_GAP
    corners = np.array(((0.0, top), (side, top), (side, top + side), (0.0, top + side)))
    _write_polyline(space, Stroke(role, corners, is_closed=True), profile.styles[role])
    style = profile.styles.get("text", profile.styles[role])
    space.add_text(
        f"TEST SQUARE {side:g} X {side:g} MM",
        height=settings.TEXT_HEIGHT,
        dxfattribs=attributes(style),
    ).set_placement(rounded(corners[0] + settings.TEXT_HEIGHT))

"""Pattern pieces as DXF: one entry for every profile, and the plain drawing for cutters.

Cutters get one closed polyline per contour (LWPOLYLINE, or POLYLINE in R12), lines for rulings,
marks and notches, points for holes and single-line texts. The aama and astm profiles are written
by ``aama``. Millimetres; R12 cannot say so in its header, so a text on every piece does.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final, Literal, get_args

import ezdxf
import numpy as np
from ezdxf.document import Drawing as DxfDocument

from wrinkle_cad import settings
from wrinkle_cad.atomic import write_atomically
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.findings import Finding

from .drawing import Drawing, Stroke, draw
from .layers import LINE_TYPES, LayerStyle, Profile, Role, profile_from
from .nesting import laid_out
from .piece import Floats, PatternPiece
from .plain_text import ascii_text, text_changed
from .stamping import EPOCH, stamped

DxfVersion = Literal["R12", "R2000", "R2010"]
VERSIONS: Final[tuple[str, ...]] = get_args(DxfVersion)


@dataclass(frozen=True, slots=True, eq=False)
class DxfFile:
    """A finished file in memory.

    Attributes:
        content: its bytes, 7-bit ASCII, the same for the same pieces on every machine.
        findings: texts that had to be changed.
    """

    content: bytes
    findings: tuple[Finding, ...]


def dxf_file(
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
    version: DxfVersion = settings.DXF_VERSION,
    timestamp: datetime | None = None,
    test_square: bool = False,
) -> DxfFile:
    """Returns a DXF file of all pieces, laid out side by side at one scale.

    Args:
        pieces: at least one.
        profile: a shipped profile, the user's own ``.toml`` file or a profile itself.
        version: of DXF. Profiles of blocks (aama, astm) are always the plainest R12.
        timestamp: what the file says about when it was made; ``EPOCH`` if None.
        test_square: add a square of 100 mm to check the scale on the machine.

    Raises:
        InputError: no pieces, or an unknown profile or version.
    """
    if not pieces:
        raise InputError("DXF - no pieces - at least one - make a pattern first")
    if version not in VERSIONS:
        raise InputError(f"DXF version {version!r} - one of {', '.join(VERSIONS)} - choose one")
    chosen = profile if isinstance(profile, Profile) else profile_from(profile)
    document = _document(chosen, version)
    findings: list[Finding] = []
    for piece in laid_out(pieces):
        findings += _write_piece(document, draw(piece), piece, chosen)
    if test_square:
        _write_test_square(document, laid_out(pieces), chosen)
    _remove_unused_layers(document)
    stream = io.StringIO()
    document.write(stream)
    text = stamped(stream.getvalue(), timestamp or EPOCH)
    return DxfFile(text.encode("ascii"), tuple(findings))


def dxf_bytes(
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
    version: DxfVersion = settings.DXF_VERSION,
    timestamp: datetime | None = None,
    test_square: bool = False,
) -> bytes:
    """Returns only the bytes of ``dxf_file``, with the same arguments and errors."""
    return dxf_file(
        pieces, profile=profile, version=version, timestamp=timestamp, test_square=test_square
    ).content


def write_dxf(
    path: Path,
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
    version: DxfVersion = settings.DXF_VERSION,
    timestamp: datetime | None = None,
    test_square: bool = False,
) -> tuple[Finding, ...]:
    """Writes a DXF file, whole or not at all, and returns what was changed on the way.

    The other arguments are those of ``dxf_file``.

    Raises:
        InputError: as ``dxf_file``.
        ExportError: the file cannot be written.
    """
    made = dxf_file(
        pieces, profile=profile, version=version, timestamp=timestamp, test_square=test_square
    )
    try:
        write_atomically(path, made.content)
    except OSError as error:
        raise ExportError(path, "DXF", f"{error.strerror} - check the folder") from error
    return made.findings


def _document(profile: Profile, version: str) -> DxfDocument:
    # R12 has no unit in its header, and ezdxf warns when one is set.
    document = ezdxf.new(version, setup=False, units=0 if version == "R12" else 4)
    document.encoding = "cp1252"
    if version != "R12":
        document.header["$MEASUREMENT"] = 1
    for name, (description, pattern) in LINE_TYPES.items():
        used = any(style.line_type == name for style in profile.styles.values())
        if used and name not in document.linetypes:
            document.linetypes.add(name, pattern=list(pattern), description=description)
    first: dict[str, LayerStyle] = {}
    for style in profile.styles.values():
        first.setdefault(style.layer, style)
    for layer, style in first.items():
        if layer not in document.layers:
            document.layers.add(layer, color=style.colour)
    return document


def _remove_unused_layers(document: DxfDocument) -> None:
    used = {entity.dxf.layer.lower() for entity in document.modelspace()}
    for name in [layer.dxf.name for layer in document.layers]:
        if name.lower() not in used | {"0", "defpoints"}:
            document.layers.remove(name)


def _write_piece(
    document: DxfDocument, drawing: Drawing, piece: PatternPiece, profile: Profile
) -> list[Finding]:
    space = document.modelspace()
    findings: list[Finding] = []
    for stroke in drawing.strokes:
        if stroke.role in profile.styles:
            _write_stroke(document, stroke, profile.styles[stroke.role])
    for spot in drawing.spots:
        if spot.role in profile.styles:
            attributes = _attributes(profile.styles[spot.role])
            space.add_point(_rounded(spot.position), dxfattribs=attributes)
    for label in drawing.labels:
        if label.role in profile.styles:
            text = ascii_text(label.text)
            findings += text_changed(f"text on {ascii_text(piece.name)}", label.text, text)
            attributes = _attributes(profile.styles[label.role])
            space.add_text(text, height=label.height, dxfattribs=attributes).set_placement(
                _rounded(label.position)
            )
    return findings


def _write_stroke(document: DxfDocument, stroke: Stroke, style: LayerStyle) -> None:
    space = document.modelspace()
    points = [_rounded(point) for point in stroke.points]
    attributes = _attributes(style)
    if len(points) == 2 and not stroke.is_closed:
        space.add_line(points[0], points[1], dxfattribs=attributes)
    elif document.dxfversion == ezdxf.const.DXF12:
        space.add_polyline2d(points, close=stroke.is_closed, dxfattribs=attributes)
    else:
        space.add_lwpolyline(points, close=stroke.is_closed, dxfattribs=attributes)


def _write_test_square(
    document: DxfDocument, pieces: Sequence[PatternPiece], profile: Profile
) -> None:
    role: Role = "test_square"
    if role not in profile.styles:
        return
    side = settings.TEST_SQUARE
    top = max(float(piece.cut_line[:, 1].max()) for piece in pieces) + settings.PIECE_GAP
    corners = np.array(((0.0, top), (side, top), (side, top + side), (0.0, top + side)))
    _write_stroke(document, Stroke(role, corners, is_closed=True), profile.styles[role])
    space = document.modelspace()
    space.add_text(
        f"TEST SQUARE {side:g} X {side:g} MM",
        height=settings.TEXT_HEIGHT,
        dxfattribs=_attributes(profile.styles.get("text", profile.styles[role])),
    ).set_placement((5.0, top + 5.0))


def _attributes(style: LayerStyle) -> dict[str, object]:
    attributes: dict[str, object] = {"layer": style.layer, "color": style.colour}
    if style.line_type != "CONTINUOUS":
        attributes["linetype"] = style.line_type
    return attributes


def _rounded(point: Floats) -> tuple[float, float]:
    """Returns x and y as the file has them; adding 0.0 turns -0.0 into 0.0."""
    first, second = np.round(point, settings.DXF_DECIMALS) + 0.0
    return float(first), float(second)

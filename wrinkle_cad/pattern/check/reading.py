"""Any DXF file as plain lines and marks, for the check: nothing here judges.

A drawing's blocks are taken apart where they are inserted. In a file of pattern pieces (AAMA-292,
ASTM D6673) every block stays by itself, as it is a piece.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import ezdxf
import numpy as np
from ezdxf import disassemble, recover
from ezdxf.document import Drawing as DxfDocument
from ezdxf.entities import DXFEntity
from ezdxf.path import make_path

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.piece.piece import Bools, Floats, frozen

ENTITIES: Final = "ENTITIES"
"""The space of what does not stand in a block."""

_LINES: Final = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"}
_TEXTS: Final = {"TEXT", "MTEXT", "ATTRIB", "ATTDEF"}
_SAGITTA: Final = 0.01
"""mm; how finely curves are taken apart."""


@dataclass(frozen=True, slots=True, eq=False)
class FileLine:
    """A line of any kind: (k, 2) points; a closed one does not repeat its first point.

    Attributes:
        height: largest distance from the plane z = 0.
        vertex_count: as the file states them, not those of a curve taken apart.
    """

    space: str
    layer: str
    kind: str
    points: Floats
    is_closed: bool
    vertex_count: int
    height: float
    is_curved: bool


@dataclass(frozen=True, slots=True, eq=False)
class FileMark:
    """Anything that is no line: a text, a point, a hatch. ``text`` is empty for the others."""

    space: str
    layer: str
    kind: str
    position: tuple[float, float]
    text: str


@dataclass(frozen=True, slots=True)
class FileInsert:
    """A block's insertion: (x, y, z), and whether it is neither turned nor scaled."""

    block: str
    layer: str
    position: tuple[float, float, float]
    is_plain: bool


@dataclass(frozen=True, slots=True, eq=False)
class DxfContent:
    """What a DXF file holds.

    Attributes:
        release: "R12", "R2000", ...
        unit: ``$INSUNITS``, or None where the release has none.
        is_metric: ``$MEASUREMENT``, or None.
        layers: names in the layer table. ``blocks``: names of the blocks that are no layouts.
        lines, marks, inserts: what is drawn.
        is_blocks: whether it is a file of pattern pieces.
        problems: what the reader had to mend, one line each.
    """

    release: str
    unit: int | None
    is_metric: bool | None
    layers: tuple[str, ...]
    blocks: tuple[str, ...]
    lines: tuple[FileLine, ...]
    marks: tuple[FileMark, ...]
    inserts: tuple[FileInsert, ...]
    is_blocks: bool
    problems: tuple[str, ...]


def read_dxf(path: Path) -> DxfContent:
    """Returns the content of a DXF file of any release, text or binary.

    Raises:
        InputError: it cannot be read, or is no DXF file.
    """
    is_whole = _check_sections(path)
    try:
        document, auditor = recover.readfile(path)
    except (OSError, ezdxf.DXFError, ValueError, IndexError, KeyError, AttributeError) as error:
        # ezdxf raises these bare ones too from files cut off in the middle of a structure.
        raise InputError(
            f"{path.name} - no DXF structure in it ({type(error).__name__}) - a DXF file - export "
            "it again"
        ) from error
    blocks = tuple(
        block.name for block in document.blocks if not block.is_any_layout and block.name[0] != "*"
    )
    is_blocks = _has_pieces(document, blocks)
    lines: list[FileLine] = []
    marks: list[FileMark] = []
    for space, entities in _spaces(document, blocks, is_blocks=is_blocks):
        for entity in entities:
            _collect(entity, space, lines, marks)
    unit, is_metric = _units(document)
    return DxfContent(
        release=document.acad_release,
        unit=unit,
        is_metric=is_metric,
        layers=tuple(layer.dxf.name for layer in document.layers),
        blocks=blocks,
        lines=tuple(lines),
        marks=tuple(marks),
        inserts=tuple(_insert(entity) for entity in document.modelspace().query("INSERT")),
        is_blocks=is_blocks,
        problems=(
            *(() if is_whole else ("no EOF at its end, cut off",)),
            *(error.message for error in (*auditor.errors, *auditor.fixes)),
        ),
    )


def _units(document: DxfDocument) -> tuple[int | None, bool | None]:
    """Returns ``$INSUNITS`` and whether ``$MEASUREMENT`` is metric; R12 has neither."""
    if document.dxfversion < ezdxf.const.DXF2000:
        return None, None
    header = document.header
    return int(header.get("$INSUNITS", 0)), bool(header.get("$MEASUREMENT", 0))


def _check_sections(path: Path) -> bool:
    """Raises InputError for what is no DXF at all; returns whether the file has its end."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path.name} - {error.strerror} - a DXF file - check the path") from error
    if not content.strip():
        raise InputError(f"{path.name} - empty - a DXF file - export it again")
    if b"SECTION" not in content:
        raise InputError(f"{path.name} - no DXF section in it - a DXF file - check what it is")
    return content.rstrip(b"\r\n\t \0\x1a").endswith(b"EOF")


def _has_pieces(document: DxfDocument, blocks: Iterable[str]) -> bool:
    for name in blocks:
        for entity in document.blocks.get(name):
            if entity.dxf.layer == "1" and entity.dxftype() in ("POLYLINE", "LWPOLYLINE"):
                return True
            if entity.dxftype() == "TEXT" and entity.dxf.text.lower().startswith("piece name:"):
                return True
    return False


def _spaces(
    document: DxfDocument, blocks: Iterable[str], *, is_blocks: bool
) -> Iterator[tuple[str, Iterable[DXFEntity]]]:
    if not is_blocks:
        yield ENTITIES, disassemble.recursive_decompose(document.modelspace())
        return
    yield ENTITIES, document.modelspace().query("* !INSERT")
    for name in blocks:
        yield name, document.blocks.get(name)


def _collect(entity: DXFEntity, space: str, lines: list[FileLine], marks: list[FileMark]) -> None:
    kind = entity.dxftype()
    if kind in _LINES and not (kind == "POLYLINE" and not _is_flat_polyline(entity)):
        line = _line(entity, space)
        if line is not None:
            lines.append(line)
            return
    text = ""
    if kind in _TEXTS:
        text = entity.plain_text() if kind == "MTEXT" else entity.dxf.text
    named = [name for name in ("location", "insert") if entity.dxf.hasattr(name)]
    place = entity.dxf.get(named[0]) if named else (0.0, 0.0)
    marks.append(FileMark(space, entity.dxf.layer, kind, (place[0], place[1]), text))


def _is_flat_polyline(entity: DXFEntity) -> bool:
    return bool(entity.is_2d_polyline or entity.is_3d_polyline)


def _line(entity: DXFEntity, space: str) -> FileLine | None:
    kind = entity.dxftype()
    stated = _stated_vertices(entity)
    path = make_path(entity)
    is_curved = kind in ("ARC", "CIRCLE", "ELLIPSE", "SPLINE") or bool(path.has_curves)
    if kind == "SPLINE":
        points = _along_spline(entity)
    elif is_curved:
        points = np.array([tuple(point) for point in path.flattening(_SAGITTA)])
    else:
        # As the file states them: make_path leaves out segments without length.
        points = stated
    if len(points) == 0:
        return None
    if is_curved:
        is_closed = len(points) > 2 and math.dist(points[0], points[-1]) < settings.CHECK_ZERO
        points = points[:-1] if is_closed else points
    else:
        is_closed = bool(getattr(entity, "is_closed", False))
    return FileLine(
        space=space,
        layer=entity.dxf.layer,
        kind=kind,
        points=frozen(points[:, :2]),
        is_closed=is_closed,
        vertex_count=len(stated) or len(points),
        height=float(np.abs(points[:, 2]).max()),
        is_curved=is_curved,
    )


def _along_spline(entity: DXFEntity) -> Floats:
    """Returns points (k, 3) along a spline's own domain, which a periodic one's knots exceed."""
    spline = entity.construction_tool()
    knots = spline.knots()
    low, high = knots[spline.degree], knots[len(spline.control_points)]
    parameters = np.linspace(low, high, 32 * len(spline.control_points) + 1)
    return np.array([tuple(point) for point in spline.points(parameters.tolist())])


def _stated_vertices(entity: DXFEntity) -> Floats:
    kind = entity.dxftype()
    if kind == "LINE":
        rows = [tuple(entity.dxf.start), tuple(entity.dxf.end)]
    elif kind == "LWPOLYLINE":
        rows = [tuple(point) for point in entity.vertices_in_wcs()]
    elif kind == "POLYLINE":
        rows = [tuple(point) for point in entity.points_in_wcs()]
    else:
        rows = []
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _insert(entity: DXFEntity) -> FileInsert:
    place = entity.dxf.insert
    scales = (entity.dxf.xscale, entity.dxf.yscale, entity.dxf.zscale)
    return FileInsert(
        entity.dxf.name,
        entity.dxf.layer,
        (place.x, place.y, place.z),
        scales == (1.0, 1.0, 1.0) and entity.dxf.rotation == 0.0,
    )


def repeated_vertices(line: FileLine) -> Bools:
    """Returns which segments of a line have no length, (k,) or (k-1,) bool."""
    points = line.points
    after = np.roll(points, -1, axis=0) if line.is_closed else points[1:]
    before = points if line.is_closed else points[:-1]
    short: Bools = np.linalg.norm(after - before, axis=1) < settings.CHECK_ZERO
    return short

"""Any DXF file as plain lines and marks, for the check: nothing here judges.

A drawing's blocks are taken apart where they are inserted. In a file of pattern pieces (AAMA-292,
ASTM D6673) every block stays by itself, as it is a piece.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import ezdxf
from ezdxf import disassemble
from ezdxf.document import Drawing as DxfDocument
from ezdxf.entities import DXFEntity

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.formats.ezdxf_log import without_ezdxf_log

from . import limits
from .document import check_unfolding, open_dxf
from .entities import LINES, FileLine, FileMark, line_of, mark_of

ENTITIES: Final = "ENTITIES"
"""The space of what does not stand in a block."""

_PIECE_KEYS: Final = ("piece name:", "size:", "quantity:")
_SIMPLE: Final = frozenset({"LINE", "POINT", "TEXT", "ARC", "CIRCLE", "LWPOLYLINE"})
"""Kinds that stand for themselves: most of what a drawing holds."""
_PLANAR: Final = ("LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE")


@dataclass(frozen=True, slots=True)
class FileInsert:
    """A block's insertion: (x, y, z), and whether it is neither turned nor scaled."""

    block: str
    """The block's name."""
    layer: str
    """Its layer."""
    position: tuple[float, float, float]
    """(x, y, z)."""
    is_plain: bool
    """Whether it is neither turned nor scaled."""


@dataclass(frozen=True, slots=True, eq=False)
class DxfContent:
    """What a DXF file holds."""

    release: str
    """"R12", "R2000", ..."""
    unit: int | None
    """``$INSUNITS``, or None where the release has none."""
    is_metric: bool | None
    """``$MEASUREMENT``, or None."""
    layers: tuple[str, ...]
    """Names in the layer table."""
    hidden_layers: tuple[str, ...]
    """Those switched off or frozen."""
    blocks: tuple[str, ...]
    """Names of the blocks that are no layouts."""
    lines: tuple[FileLine, ...]
    """What is drawn: lines of every kind."""
    marks: tuple[FileMark, ...]
    """What is drawn and is no line."""
    inserts: tuple[FileInsert, ...]
    """Where blocks are inserted."""
    paper_layers: tuple[str, ...]
    """The layer of each line in a paper space."""
    turned: tuple[tuple[str, str], ...]
    """(kind, layer) of each line whose plane is not that of the drawing."""
    unusable: tuple[str, ...]
    """What has no place in the plane, one sentence each."""
    is_blocks: bool
    """Whether it is a file of pattern pieces."""
    problems: tuple[str, ...]
    """What the reader had to mend, one sentence each."""


def read_dxf(path: Path) -> DxfContent:
    """Returns the content of a DXF file of any release, text or binary.

    Raises:
        InputError: it cannot be read, is no DXF file, or would unfold without end.
    """
    try:
        with _collector_at_rest(), without_ezdxf_log():
            return _content(path)
    except (InputError, MemoryError):
        # What is told already, and what is the memory limit's.
        raise
    # A table that contradicts itself shows only when ezdxf is asked for what is in it.
    except Exception as error:
        raise InputError(
            f"{path.name} contradicts itself ({type(error).__name__}). Export it again."
        ) from error


@contextmanager
def _collector_at_rest() -> Iterator[None]:
    """Keeps Python from looking for garbage while a million small objects are made, all in use."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _content(path: Path) -> DxfContent:
    opened = open_dxf(path)
    document = opened.document
    blocks = tuple(
        block.name
        for block in document.blocks
        if not block.is_any_layout and not block.name.startswith("*")
    )
    is_blocks = any(_is_piece(document.blocks.get(name)) for name in blocks)
    if not is_blocks:
        check_unfolding(document, path.name)
    lines: list[FileLine] = []
    marks: list[FileMark] = []
    unusable: list[str] = []
    curve_points = 0
    try:
        for space, entities in _spaces(document, blocks, is_blocks=is_blocks):
            for entity in entities:
                _check_fit_points(entity, path.name)
                curve_points += _collect(entity, space, lines, marks, unusable)
                if curve_points > limits.MOST_CURVE_POINTS:
                    raise InputError(_too_curved(path.name))
    except (InputError, MemoryError):
        raise
    # ezdxf meets contradictions inside entities only here, with errors of any class.
    except Exception as error:
        raise InputError(
            f"{path.name} has an entity that cannot be taken apart ({type(error).__name__}: "
            f"{' '.join(str(error).split())[:100]}). Export it again."
        ) from error
    unit, is_metric = _units(document)
    return DxfContent(
        release=document.acad_release,
        unit=unit,
        is_metric=is_metric,
        layers=tuple(layer.dxf.name for layer in document.layers),
        hidden_layers=tuple(
            layer.dxf.name for layer in document.layers if layer.is_off() or layer.is_frozen()
        ),
        blocks=blocks,
        lines=tuple(lines),
        marks=tuple(marks),
        inserts=tuple(_insert(entity) for entity in document.modelspace().query("INSERT")),
        paper_layers=tuple(_paper_layers(document)),
        turned=tuple(_turned(document, blocks)),
        unusable=tuple(unusable),
        is_blocks=is_blocks,
        problems=opened.problems,
    )


def _units(document: DxfDocument) -> tuple[int | None, bool | None]:
    """Returns ``$INSUNITS`` and whether ``$MEASUREMENT`` is metric; R12 has neither."""
    if document.dxfversion < ezdxf.const.DXF2000:
        return None, None
    header = document.header
    return int(header.get("$INSUNITS", 0)), bool(header.get("$MEASUREMENT", 0))


def _is_piece(block: Iterable[DXFEntity]) -> bool:
    """Whether a block is a pattern piece: it says so, or has a boundary with turn points.

    A line on layer 1 alone may as well be a drawing's frame.
    """
    has_boundary = has_points = False
    for entity in block:
        layer, kind = entity.dxf.layer, entity.dxftype()
        if layer == "1" and kind in ("TEXT", "ATTDEF"):
            text = str(entity.dxf.get("text", "")).strip().lower()
            if text.startswith(_PIECE_KEYS):
                return True
        has_boundary |= layer == "1" and kind in ("POLYLINE", "LWPOLYLINE")
        has_points |= layer in ("2", "3") and kind == "POINT"
    return has_boundary and has_points


def _spaces(
    document: DxfDocument, blocks: Iterable[str], *, is_blocks: bool
) -> Iterator[tuple[str, Iterable[DXFEntity]]]:
    if not is_blocks:
        yield ENTITIES, _taken_apart(document.modelspace())
        return
    yield ENTITIES, document.modelspace().query("* !INSERT")
    for name in blocks:
        yield name, document.blocks.get(name)


def _taken_apart(entities: Iterable[DXFEntity]) -> Iterator[DXFEntity]:
    for entity in entities:
        if entity.dxftype() in _SIMPLE:
            yield entity
        else:
            yield from disassemble.recursive_decompose((entity,))


def _collect(
    entity: DXFEntity,
    space: str,
    lines: list[FileLine],
    marks: list[FileMark],
    unusable: list[str],
) -> int:
    """Adds an entity where it belongs, and returns how many points it was taken apart to."""
    kind = entity.dxftype()
    # A block's attribute definition is a form to be filled in: only its attributes are drawn.
    if kind == "ATTDEF" and (space == ENTITIES or entity.dxf.layer != "1"):
        return 0
    made: FileLine | FileMark | None = line_of(entity, space) or mark_of(entity, space)
    if made is None:
        unusable.append(
            f"{kind} on layer {entity.dxf.layer} has no place in the plane: a number is none, "
            f"beyond {settings.LARGEST_COORDINATE:g} mm, or contradicts another. Remove it."
        )
    elif isinstance(made, FileLine):
        lines.append(made)
        return len(made.points) if made.is_curved else 0
    else:
        marks.append(made)
    return 0


def _check_fit_points(entity: DXFEntity, name: str) -> None:
    if entity.dxftype() != "SPLINE" or len(entity.control_points):
        return
    if len(entity.fit_points) > limits.MOST_FIT_POINTS:
        raise InputError(
            f"{name} has a SPLINE on layer {entity.dxf.layer!a} without control points, through "
            f"{len(entity.fit_points):,} points. At most {limits.MOST_FIT_POINTS:,} are read: "
            "export it with control points, or as lines."
        )


def _too_curved(name: str) -> str:
    return (
        f"{name} has curves that take more than {limits.MOST_CURVE_POINTS:,} points to follow. "
        "Export its pieces in several files, or as lines."
    )


def _paper_layers(document: DxfDocument) -> Iterator[str]:
    for layout in document.layouts:
        if not layout.is_modelspace:
            yield from (entity.dxf.layer for entity in layout if entity.dxftype() in LINES)


def _turned(document: DxfDocument, blocks: Iterable[str]) -> Iterator[tuple[str, str]]:
    spaces = [document.modelspace(), *(document.blocks.get(name) for name in blocks)]
    for entity in (entity for space in spaces for entity in space):
        if entity.dxftype() in _PLANAR and entity.dxf.hasattr("extrusion"):
            x, y, z = entity.dxf.extrusion
            if not (abs(x) <= 1e-9 and abs(y) <= 1e-9 and z > 0.0):
                yield entity.dxftype(), entity.dxf.layer


def _insert(entity: DXFEntity) -> FileInsert:
    place = entity.dxf.insert
    scales = (entity.dxf.xscale, entity.dxf.yscale, entity.dxf.zscale)
    return FileInsert(
        entity.dxf.name,
        entity.dxf.layer,
        (place.x, place.y, place.z),
        scales == (1.0, 1.0, 1.0) and entity.dxf.rotation == 0.0,
    )

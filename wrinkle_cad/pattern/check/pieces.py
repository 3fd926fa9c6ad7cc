"""Files of pattern pieces held against AAMA-292 and ASTM D6673: keys, blocks, points, layers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from wrinkle_cad.errors import Finding
from wrinkle_cad.pattern.formats.aama import CURVE_POINTS, TURN_POINTS, VALIDATION

from .reading import ENTITIES, DxfContent, FileLine, FileMark

_STYLE_KEYS: Final = (
    "Style Name:", "Creation Date:", "Creation Time:", "Author:", "Sample Size:", "Units:",
    "Curve Tolerance:",
)  # fmt: skip
_VERSION_KEYS: Final = ("ASTM/D13Proposal", "ANSI/AAMA")
_PIECE_KEYS: Final = ("Piece Name:", "Size:", "Quantity:")


def judge_pieces(content: DxfContent) -> Iterator[Finding]:
    """Yields what breaks the rules of a file of pattern pieces."""
    style = [mark.text for mark in content.marks if mark.space == ENTITIES and mark.layer == "1"]
    for key in _missing(_STYLE_KEYS, style):
        yield _missing_key(key, "style text on layer 1")
    if not any(_starts(text, key) for text in style for key in _VERSION_KEYS):
        yield _missing_key("ASTM/D13Proposal or ANSI/AAMA version", "style text on layer 1")
    if any(_starts(text, "Units:") and "english" in text.lower() for text in style):
        yield Finding(
            "units-not-mm", "warning", "units - ENGLISH (inches) - METRIC (mm) - convert the file"
        )
    drawn: tuple[FileLine | FileMark, ...] = (*content.lines, *content.marks)
    count = sum(item.layer == "0" for item in drawn)
    if count:
        yield _broken("layer-0", f"layer 0 - {count} entities - nothing on it - move them")
    for block in content.blocks:
        lines = [line for line in content.lines if line.space == block]
        marks = [mark for mark in content.marks if mark.space == block]
        yield from _piece(block, lines, marks)
        yield from _inserted(block, content)


def _piece(block: str, lines: Sequence[FileLine], marks: Sequence[FileMark]) -> Iterator[Finding]:
    texts = [mark.text for mark in marks if mark.layer == "1" and mark.text]
    for key in _missing(_PIECE_KEYS, texts):
        yield _missing_key(key, f"piece {block}, text on layer 1")
    if not any(line.layer == "1" and line.is_closed for line in lines):
        yield _broken(
            "no-boundary", f"piece {block} - no closed polyline on layer 1 - one - add it"
        )
    for line in lines:
        if line.kind in ("LWPOLYLINE", "SPLINE", "ARC", "ELLIPSE"):
            yield _broken(
                "not-polyline", f"piece {block} - {line.kind} - POLYLINE - export as lines"
            )
    yield from _points(block, lines, marks)
    for layer, copy in VALIDATION.items():
        stated = [_count(lines, name) for name in (layer, copy)]
        if 0 < stated[1] < stated[0]:
            yield _broken(
                "validation-curve",
                f"piece {block} - {stated[1]} vertices on layer {copy} - at least the {stated[0]} "
                f"of layer {layer} - export it again",
            )


def _points(block: str, lines: Sequence[FileLine], marks: Sequence[FileMark]) -> Iterator[Finding]:
    """Yields broken counts of turn and curve points, then points that stand beside the lines."""
    points = [m for m in marks if m.kind == "POINT" and m.layer in (TURN_POINTS, CURVE_POINTS)]
    drawn = [line for line in lines if line.layer in VALIDATION and line.kind == "POLYLINE"]
    vertex_count = sum(line.vertex_count for line in drawn)
    if len(points) != vertex_count:
        yield _broken(
            "point-count",
            f"piece {block} - {len(points)} turn and curve points - {vertex_count}, as many as "
            "vertices on layers 1, 8, 11 and 14 - export it again",
        )
        return
    wanted = Counter(place for line in drawn for place in _places(line.points))
    found = Counter(place for point in points for place in _places(np.array([point.position])))
    if wanted != found:
        yield _broken(
            "point-place",
            f"piece {block} - {(found - wanted).total()} turn or curve points beside the lines - "
            "on their vertices - export it again",
        )


def _inserted(block: str, content: DxfContent) -> Iterator[Finding]:
    inserts = [insert for insert in content.inserts if insert.block == block]
    if len(inserts) != 1:
        yield _broken(
            "insert", f"piece {block} - inserted {len(inserts)} times - once - insert it once"
        )
    for insert in inserts:
        if insert.layer != "1" or insert.position != (0.0, 0.0, 0.0) or not insert.is_plain:
            yield _broken(
                "insert",
                f"piece {block} - inserted on layer {insert.layer} at {insert.position} - on layer "
                "1 at the origin, neither turned nor scaled - insert it there",
            )


def _places(points: np.ndarray) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in np.round(points, 4) + 0.0]


def _count(lines: Sequence[FileLine], layer: str) -> int:
    return sum(line.vertex_count for line in lines if line.layer == layer)


def _missing(keys: Sequence[str], texts: Sequence[str]) -> list[str]:
    return [key for key in keys if not any(_starts(text, key) for text in texts)]


def _starts(text: str, key: str) -> bool:
    return text.strip().lower().startswith(key.lower())


def _missing_key(key: str, where: str) -> Finding:
    return Finding("missing-key", "error", f"{where} - no {key!r} - one - add it")


def _broken(code: str, message: str) -> Finding:
    return Finding(code, "error", message)

"""Files of pattern pieces held against AAMA-292 and ASTM D6673: keys, blocks, points, layers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from wrinkle_cad.errors import Finding, Severity
from wrinkle_cad.pattern.formats.aama import CURVE_POINTS, TURN_POINTS, VALIDATION

from .contours import closed_contours
from .entities import FileLine, FileMark
from .reading import ENTITIES, DxfContent

_STYLE_KEYS: Final = (
    "Style Name:", "Creation Date:", "Creation Time:", "Author:", "Sample Size:", "Units:",
    "Curve Tolerance:",
)  # fmt: skip
_VERSION_KEYS: Final = ("ASTM/D13Proposal", "ANSI/AAMA")
_PIECE_KEYS: Final = ("Piece Name:", "Size:", "Quantity:")
_NEEDED_KEYS: Final = ("Piece Name:", "Size:")
"""Some readers refuse a piece without these; the others are read where they stand."""


_OUTLINES: Final = ("1", "11", "14")


def judge_pieces(content: DxfContent) -> Iterator[Finding]:
    """Yields what breaks the rules of a file of pattern pieces."""
    style = [mark.text for mark in content.marks if mark.space == ENTITIES and mark.layer == "1"]
    for key in _missing(_STYLE_KEYS, style):
        yield _missing_key(key, "The style's texts on layer 1 have")
    if not any(_starts(text, key) for text in style for key in _VERSION_KEYS):
        yield _missing_key("ASTM/D13Proposal or ANSI/AAMA", "The style's texts on layer 1 have")
    if any(_starts(text, "Units:") and "english" in text.lower() for text in style):
        yield _broken(
            "units-not-mm", "The units are ENGLISH (inches). Convert the file to METRIC.", "warning"
        )
    drawn: tuple[FileLine | FileMark, ...] = (*content.lines, *content.marks)
    count = sum(item.layer == "0" for item in drawn)
    if count:
        yield _broken(
            "layer-0", f"Layer 0 holds {count} entities; the standard leaves it empty.", "info"
        )
    for block in content.blocks:
        lines = [line for line in content.lines if line.space == block]
        marks = [mark for mark in content.marks if mark.space == block]
        if _is_piece(marks):
            yield from _piece(block, lines, marks)
            yield from _inserted(block, content)
        else:
            yield _broken(
                "no-piece",
                f"Block {block} is no piece: it has neither a name nor turn points. Gerber refuses "
                "other blocks: remove it.",
                "warning",
            )


def _is_piece(marks: Sequence[FileMark]) -> bool:
    """Whether a block is meant as a piece; a frame is not."""
    return any(
        (mark.layer == "1" and any(_starts(mark.text, key) for key in _PIECE_KEYS))
        or (mark.kind == "POINT" and mark.layer in (TURN_POINTS, CURVE_POINTS))
        for mark in marks
    )


def _piece(block: str, lines: Sequence[FileLine], marks: Sequence[FileMark]) -> Iterator[Finding]:
    texts = [mark.text for mark in marks if mark.layer == "1" and mark.text]
    for key in _missing(_PIECE_KEYS, texts):
        yield _missing_key(key, f"The texts of piece {block} on layer 1 have")
    boundary = [line for line in lines if line.layer == "1"]
    rings, _ = closed_contours(boundary)
    if not rings:
        yield _broken(
            "no-boundary", f"Piece {block} has no closed boundary on layer 1. Close or add it."
        )
    elif not any(line.is_closed for line in boundary):
        yield _broken(
            "split-boundary",
            f"The boundary of piece {block} is {len(boundary)} open polylines end to end, as "
            "AccuMark writes it. Readers of one closed polyline need them joined.",
            "info",
        )
    for line in lines:
        if line.kind in ("LWPOLYLINE", "SPLINE", "ARC", "ELLIPSE"):
            yield _broken(
                "not-polyline",
                f"Piece {block} has a {line.kind} on layer {line.layer}; pattern CAD reads "
                "POLYLINE. Export it as lines.",
            )
    yield from _points(block, lines, marks)
    for layer, copy in VALIDATION.items():
        stated = [_count(lines, name) for name in (layer, copy)]
        if 0 < stated[1] < stated[0]:
            yield _broken(
                "validation-curve",
                f"Piece {block} has {stated[1]} vertices on layer {copy}, fewer than the "
                f"{stated[0]} of layer {layer} that they validate. Export it again.",
            )


def _points(block: str, lines: Sequence[FileLine], marks: Sequence[FileMark]) -> Iterator[Finding]:
    """Yields broken counts of turn and curve points, then points that stand beside the lines."""
    points = [m for m in marks if m.kind == "POINT" and m.layer in (TURN_POINTS, CURVE_POINTS)]
    drawn = [line for line in lines if line.layer in VALIDATION and line.kind == "POLYLINE"]
    vertex_count = sum(line.vertex_count for line in drawn)
    found = Counter(place for point in points for place in _places(np.array([point.position])))
    wanted = Counter(place for line in drawn for place in _places(line.points))
    shared = _shared_ends(drawn)
    # Where polylines meet end to end some programs give the joint one point, others two.
    if not vertex_count - shared.total() <= len(points) <= vertex_count:
        yield _broken(
            "point-count",
            f"Piece {block} has {len(points)} turn and curve points for the {vertex_count} "
            "vertices on layers 1, 8, 11 and 14. Export it again.",
        )
    elif (found - wanted) or (wanted - found - shared):
        beside = (found - wanted).total()
        yield _broken(
            "point-place",
            f"Piece {block} has {beside} turn or curve points beside its lines. They stand on the "
            "vertices: export it again.",
        )


def _shared_ends(lines: Sequence[FileLine]) -> Counter[tuple[float, float]]:
    """Returns how often each place is the end of one more open line of the same outline."""
    shared: Counter[tuple[float, float]] = Counter()
    for layer in _OUTLINES:
        ends = Counter(
            place
            for line in lines
            if line.layer == layer and not line.is_closed
            for place in _places(line.points[[0, -1]])
        )
        shared += ends - Counter(ends.keys())
    return shared


def _inserted(block: str, content: DxfContent) -> Iterator[Finding]:
    inserts = [insert for insert in content.inserts if insert.block == block]
    if len(inserts) != 1:
        yield _broken("insert", f"Piece {block} is inserted {len(inserts)} times. Insert it once.")
    for insert in inserts:
        if insert.position != (0.0, 0.0, 0.0) or not insert.is_plain:
            yield _broken(
                "insert",
                f"Piece {block} is inserted at {insert.position}. Insert it at the origin, neither "
                "turned nor scaled.",
            )
        elif insert.layer != "1":
            yield _broken(
                "insert-layer",
                f"Piece {block} is inserted on layer {insert.layer}; the standard has layer 1.",
                "info",
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
    is_needed = key in _NEEDED_KEYS
    return _broken("missing-key", f"{where} no {key!r}. Add it.", "error" if is_needed else "info")


def _broken(code: str, message: str, severity: Severity = "error") -> Finding:
    return Finding(code, severity, message)

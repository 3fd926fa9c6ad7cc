"""Preflight of a pattern file: reads any DXF and finds what a cutter would stumble over.

A file of pattern pieces (AAMA-292, ASTM D6673) is also held against the rules of its format.
Findings of severity ``info`` are no faults.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from wrinkle_cad.errors import Finding, Severity
from wrinkle_cad.strip.curve.polyline import segment_lengths

from . import limits
from .contours import judge_contours
from .cut_layers import likely_cut_layers
from .drawing_space import judge_space
from .entities import FileLine, FileMark
from .grouping import grouped
from .pieces import judge_pieces
from .reading import DxfContent, read_dxf

_UNIT_NAMES: Final = {0: "none", 1: "inches", 2: "feet", 4: "mm", 5: "cm", 6: "m", 13: "microns"}
_MM: Final = 4
_SAYS_MM: Final = re.compile(r"\bmm\b|millimet|units:\s*metric", re.I)
_UNUSED_LAYERS: Final = ("0", "defpoints")


@dataclass(frozen=True, slots=True, eq=False)
class CheckReport:
    """What was found in a file."""

    name: str
    """Of the file."""
    release: str
    """Of DXF."""
    format: str
    """``drawing`` or ``pieces``."""
    cut_layers: tuple[str, ...]
    """The layers whose lines were taken as contours to cut."""
    contour_count: int
    """Lines on them."""
    findings: tuple[Finding, ...]
    """One of each kind, errors first, then warnings, then what is no fault."""
    counts: tuple[int, ...]
    """How many there are of each kind."""

    @property
    def is_clean(self) -> bool:
        """Whether nothing is wrong; an ``info`` is nothing wrong."""
        return all(finding.severity == "info" for finding in self.findings)


def judge_dxf(path: Path, *, cut_layers: tuple[str, ...] = ()) -> CheckReport:
    """Returns what is wrong with a DXF file.

    Args:
        path: of the file.
        cut_layers: names of the layers to be cut, in any case. If none are given: 1 and 11 in a
            file of pieces, else the layers whose names have a word for cutting, else every layer
            with a closed line.

    Raises:
        InputError: the file cannot be read, or is no DXF file.
    """
    content = read_dxf(path)
    layers = cut_layers or likely_cut_layers(content)
    chosen = frozenset(layer.lower() for layer in layers)
    contours = [line for line in content.lines if line.layer.lower() in chosen]
    findings = [
        *(_finding("structure", "error", problem) for problem in content.problems),
        *(_finding("coordinates", "error", problem) for problem in content.unusable),
        *judge_space(content, chosen),
        *_lines(content),
        *_cut_layer_marks(content, chosen),
        *judge_contours(contours),
    ]
    findings += judge_pieces(content) if content.is_blocks else _empty_layers(content)
    findings += [*_units(content), *_scale(content), *_texts(content)]
    if not contours:
        findings.append(
            _finding(
                "nothing-to-cut",
                "error",
                "There is no line on any cut layer. Name the layer that is to be cut.",
            )
        )
    groups = grouped(dict.fromkeys(findings))
    return CheckReport(
        name=path.name,
        release=content.release,
        format="pieces" if content.is_blocks else "drawing",
        cut_layers=layers,
        contour_count=len(contours),
        findings=tuple(finding for finding, _ in groups),
        counts=tuple(count for _, count in groups),
    )


def _units(content: DxfContent) -> Iterator[Finding]:
    said = any(_SAYS_MM.search(mark.text) for mark in content.marks)
    if content.unit is None or (content.unit == 0 and content.is_blocks):
        if not said:
            yield _finding(
                "units-unsaid",
                "warning",
                f"{content.release} has no unit, and no text says mm. Add a text that does.",
            )
    elif content.unit == 0:
        yield _finding("units-unsaid", "warning", "$INSUNITS is 0, no unit. Set it to 4 (mm).")
    elif content.unit != _MM:
        name = _UNIT_NAMES.get(content.unit, f"number {content.unit}")
        yield _finding("units-not-mm", "warning", f"The unit is {name}. Convert the drawing to mm.")
    elif content.is_metric is False:
        yield _finding(
            "units-contradict",
            "warning",
            "The unit is mm, but $MEASUREMENT is 0 (inch). Set it to 1.",
        )


def _scale(content: DxfContent) -> Iterator[Finding]:
    if not content.lines:
        return
    points = np.vstack([line.points for line in content.lines])
    size = float(np.ptp(points, axis=0).max())
    if not limits.SMALLEST <= size <= limits.LARGEST:
        yield _finding(
            "scale",
            "warning",
            f"The drawing is {size:.6g} units large; patterns have {limits.SMALLEST:g} to "
            f"{limits.LARGEST:g} mm. Check its unit (25.4 is an inch).",
        )


def _texts(content: DxfContent) -> Iterator[Finding]:
    named = [("Layer name", name) for name in content.layers]
    named += [("Block name", name) for name in content.blocks]
    named += [(f"Text on layer {mark.layer}", mark.text) for mark in content.marks if mark.text]
    for what, text in named:
        if not text.isascii() or re.search(r"\\[Uu]\+[0-9A-Fa-f]{4}", text):
            yield _finding(
                "non-ascii",
                "warning",
                f"{what} {text[:60]!a} is not 7-bit ASCII, which is all that many cutters read. "
                "Rename it.",
            )


def _lines(content: DxfContent) -> Iterator[Finding]:
    for line in _with_short_segments(content.lines):
        points = line.corners
        lengths = segment_lengths(np.vstack((points, points[: int(line.is_closed)])))
        short = np.flatnonzero(lengths < limits.ZERO)
        if len(short) or len(points) < 2:
            yield _finding(
                "zero-length",
                "error",
                f"{line.kind} on layer {line.layer} has a segment without length at "
                f"{_place(points[short[0] if len(short) else 0])}. Remove the repeat.",
            )
        elif not line.is_curved and len(lengths) and lengths.min() < limits.SHORTEST:
            at = points[int(np.argmin(lengths))]
            yield _finding(
                "micro-segment",
                "warning",
                f"{line.kind} on layer {line.layer} has a segment of {lengths.min():.2g} mm at "
                f"{_place(at)}. Machines stutter below {limits.SHORTEST:g} mm: simplify.",
            )
    for key, count in Counter(_likenesses(content.lines)).items():
        if count > 1:
            yield _finding(
                "duplicate",
                "error",
                f"Layer {key[1]} has the same line {count} times from {_place(key[2][0])}. Keep "
                "one.",
            )


def _with_short_segments(lines: Sequence[FileLine]) -> Iterator[FileLine]:
    """Yields the lines without any segment, or with one that is short: of most, none is."""
    if not lines:
        return
    counts = np.array([len(line.corners) for line in lines])
    # Of a closed line the segment that closes it counts: each ends with its first point.
    rings = (
        np.vstack((line.corners, line.corners[:1])) if line.is_closed else line.corners
        for line in lines
    )
    closed = counts + [int(line.is_closed) for line in lines]
    points = np.vstack(list(rings))
    stops = np.cumsum(closed)
    lengths = np.append(np.hypot(*np.diff(points, axis=0).T), np.inf)
    # The step from one line to the next is none of either.
    lengths[stops - 1] = np.inf
    shortest = np.minimum.reduceat(lengths, stops - closed)
    for i in np.flatnonzero((shortest < limits.SHORTEST) | (counts < 2)):
        yield lines[int(i)]


_Likeness = tuple[str, str, tuple[tuple[float, float], ...]]


def _likenesses(lines: Sequence[FileLine]) -> Iterator[_Likeness]:
    """Yields for each line a key, the same for lines through the same points either way."""
    if not lines:
        return
    points = (np.round(np.vstack([line.points for line in lines]), 4) + 0.0).tolist()
    rows = [(x, y) for x, y in points]
    start = 0
    for line in lines:
        stop = start + len(line.points)
        yield _likeness(line, rows[start:stop])
        start = stop


def _likeness(line: FileLine, rows: list[tuple[float, float]]) -> _Likeness:
    if line.is_closed or (len(rows) > 2 and rows[0] == rows[-1]):
        rows = rows[:-1] if rows[0] == rows[-1] else rows
        first = rows.index(min(rows))
        forward = rows[first:] + rows[:first]
        backward = [forward[0], *reversed(forward[1:])]
    else:
        forward, backward = rows, rows[::-1]
    return line.space, line.layer, tuple(min(forward, backward))


def _cut_layer_marks(content: DxfContent, layers: frozenset[str]) -> Iterator[Finding]:
    for mark in content.marks:
        is_system_text = content.is_blocks and mark.kind in ("TEXT", "ATTDEF")
        if mark.layer.lower() not in layers or is_system_text:
            continue
        code = "text-on-cut" if mark.text else "mark-on-cut"
        yield _finding(
            code,
            "error",
            f"{mark.kind} stands on cut layer {mark.layer} at {_place(mark.position)}. Only "
            "contours may: move it to a layer of its own.",
        )
    for line in content.lines:
        if line.layer.lower() not in layers:
            continue
        if line.height > limits.ZERO:
            yield _finding(
                "not-flat",
                "error",
                f"{line.kind} on cut layer {line.layer} lies {line.height:g} mm off the plane. "
                "Flatten it.",
            )
        if line.kind in ("SPLINE", "ELLIPSE"):
            yield _finding(
                "spline",
                "info",
                f"{line.kind} on cut layer {line.layer}: some cutters ignore it. Export lines "
                "where yours does.",
            )


def _empty_layers(content: DxfContent) -> Iterator[Finding]:
    drawn: tuple[FileLine | FileMark, ...] = (*content.lines, *content.marks)
    used = {item.layer.lower() for item in drawn}
    used |= {insert.layer.lower() for insert in content.inserts}
    used |= {layer.lower() for layer in content.paper_layers}
    for layer in content.layers:
        if layer.lower() not in used and layer.lower() not in _UNUSED_LAYERS:
            yield _finding("empty-layer", "warning", f"Layer {layer} is empty. Remove it.")


def _place(point: tuple[float, float] | np.ndarray) -> str:
    return f"({point[0]:.3f}, {point[1]:.3f}) mm"


def _finding(code: str, severity: Severity, message: str) -> Finding:
    return Finding(code, severity, " ".join(message.split()))

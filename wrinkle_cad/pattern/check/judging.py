"""Preflight of a pattern file: reads any DXF and finds what a cutter would stumble over.

A file of pattern pieces (AAMA-292, ASTM D6673) is also held against the rules of its format.
Findings of severity ``info`` are no faults.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, Severity

from .contours import judge_contours
from .pieces import judge_pieces
from .reading import DxfContent, FileLine, FileMark, read_dxf, repeated_vertices

_UNIT_NAMES: Final = {0: "none", 1: "inches", 2: "feet", 4: "mm", 5: "cm", 6: "m", 13: "microns"}
_MM: Final = 4
_CUT_NAMES: Final = re.compile(
    r"cut|knife|laser|contour|outline|boundary|kontur|schnitt|coupe|decoupe|taglio|corte", re.I
)
_SAYS_MM: Final = re.compile(r"\bmm\b|millimet|units:\s*metric", re.I)
_UNUSED_LAYERS: Final = ("0", "defpoints")


@dataclass(frozen=True, slots=True, eq=False)
class CheckReport:
    """What was found in a file.

    Attributes:
        name: of the file. ``release``: of DXF. ``format``: ``drawing`` or ``pieces``.
        cut_layers: the layers whose lines were taken as contours to cut.
        contour_count: lines on them. ``findings``: sorted as they were looked for.
    """

    name: str
    release: str
    format: str
    cut_layers: tuple[str, ...]
    contour_count: int
    findings: tuple[Finding, ...]

    @property
    def is_clean(self) -> bool:
        """Whether nothing is wrong; an ``info`` is nothing wrong."""
        return all(finding.severity == "info" for finding in self.findings)


def judge_dxf(path: Path, *, cut_layers: tuple[str, ...] = ()) -> CheckReport:
    """Returns what is wrong with a DXF file.

    Args:
        path: of the file.
        cut_layers: names of the layers to be cut. If none are given: 1 and 11 in a file of
            pieces, else the layers whose names say so, else every layer with a closed line.

    Raises:
        InputError: the file cannot be read, or is no DXF file.
    """
    content = read_dxf(path)
    layers = cut_layers or _likely_cut_layers(content)
    contours = [line for line in content.lines if line.layer in layers]
    findings = [
        *(_structure(problem) for problem in content.problems),
        *_units(content),
        *_scale(content),
        *_texts(content),
        *_lines(content),
        *_cut_layer_marks(content, layers),
        *judge_contours(contours),
    ]
    findings += judge_pieces(content) if content.is_blocks else _empty_layers(content)
    if not contours:
        findings.append(
            _finding("nothing-to-cut", "error", "cut layer - no line on any - one - name the layer")
        )
    return CheckReport(
        name=path.name,
        release=content.release,
        format="pieces" if content.is_blocks else "drawing",
        cut_layers=layers,
        contour_count=len(contours),
        findings=tuple(dict.fromkeys(findings)),
    )


def _likely_cut_layers(content: DxfContent) -> tuple[str, ...]:
    if content.is_blocks:
        return ("1", "11")
    used = sorted({line.layer for line in content.lines})
    named = tuple(layer for layer in used if _CUT_NAMES.search(layer))
    closed = {line.layer for line in content.lines if line.is_closed}
    return named or tuple(layer for layer in used if layer in closed) or tuple(used)


def _structure(problem: str) -> Finding:
    return _finding("structure", "error", f"DXF structure - {problem} - none - export it again")


def _units(content: DxfContent) -> Iterator[Finding]:
    said = any(_SAYS_MM.search(mark.text) for mark in content.marks)
    if content.unit is None or (content.unit == 0 and content.is_blocks):
        if not said:
            yield _finding(
                "units-unsaid",
                "warning",
                f"units - {content.release} has none and no text says mm - a text that does - add",
            )
    elif content.unit == 0:
        yield _finding("units-unsaid", "warning", "units - $INSUNITS is 0 - 4 (mm) - set it")
    elif content.unit != _MM:
        name = _UNIT_NAMES.get(content.unit, f"number {content.unit}")
        yield _finding("units-not-mm", "warning", f"units - {name} - mm - convert the drawing")
    elif content.is_metric is False:
        yield _finding(
            "units-contradict", "warning", "units - mm, but $MEASUREMENT is 0 (inch) - 1 - set it"
        )


def _scale(content: DxfContent) -> Iterator[Finding]:
    if not content.lines:
        return
    points = np.vstack([line.points for line in content.lines])
    size = float(np.ptp(points, axis=0).max())
    if not settings.CHECK_SMALLEST <= size <= settings.CHECK_LARGEST:
        yield _finding(
            "scale",
            "warning",
            f"drawing - {size:.6g} units large - {settings.CHECK_SMALLEST:g} to "
            f"{settings.CHECK_LARGEST:g} mm - check its unit (25.4 is an inch)",
        )


def _texts(content: DxfContent) -> Iterator[Finding]:
    named = [("layer name", name) for name in content.layers]
    named += [("block name", name) for name in content.blocks]
    named += [(f"text on layer {mark.layer}", mark.text) for mark in content.marks if mark.text]
    for what, text in named:
        if not text.isascii() or re.search(r"\\[Uu]\+[0-9A-Fa-f]{4}", text):
            yield _finding(
                "non-ascii", "warning", f"{what} {text!a} - not ASCII - 7-bit ASCII - rename"
            )


def _lines(content: DxfContent) -> Iterator[Finding]:
    for line in content.lines:
        short = np.flatnonzero(repeated_vertices(line))
        if len(short) or len(line.points) < 2:
            at = line.points[short[0] if len(short) else 0]
            yield _finding(
                "zero-length",
                "error",
                f"{line.kind} on layer {line.layer} - segment without length at {_place(at)} - "
                f"{settings.CHECK_ZERO:g} mm - remove the repeated vertex",
            )
    for key, count in Counter(map(_likeness, content.lines)).items():
        if count > 1:
            yield _finding(
                "duplicate",
                "error",
                f"layer {key[1]} - the same line {count} times from {_place(key[2][0])} - once - "
                "remove the others",
            )


def _likeness(line: FileLine) -> tuple[str, str, tuple[tuple[float, float], ...]]:
    """Returns a key that is the same for lines that run through the same points either way."""
    rows = [(float(x), float(y)) for x, y in np.round(line.points, 4) + 0.0]
    if line.is_closed or (len(rows) > 2 and rows[0] == rows[-1]):
        rows = rows[:-1] if rows[0] == rows[-1] else rows
        first = rows.index(min(rows))
        forward = rows[first:] + rows[:first]
        backward = [forward[0], *reversed(forward[1:])]
    else:
        forward, backward = rows, rows[::-1]
    return line.space, line.layer, tuple(min(forward, backward))


def _cut_layer_marks(content: DxfContent, layers: tuple[str, ...]) -> Iterator[Finding]:
    for mark in content.marks:
        if mark.layer not in layers or (content.is_blocks and mark.kind == "TEXT"):
            continue
        code = "text-on-cut" if mark.text else "mark-on-cut"
        yield _finding(
            code,
            "error",
            f"{mark.kind} on cut layer {mark.layer} - at {_place(mark.position)} - contours only - "
            "move it to a layer of its own",
        )
    for line in content.lines:
        if line.layer in layers and line.height > settings.CHECK_ZERO:
            yield _finding(
                "not-flat",
                "error",
                f"{line.kind} on cut layer {line.layer} - {line.height:g} mm off the plane - 0 - "
                "flatten it",
            )
        if line.layer in layers and line.kind in ("SPLINE", "ELLIPSE"):
            yield _finding(
                "spline",
                "info",
                f"cut layer {line.layer} - {line.kind} - some cutters ignore it - export lines",
            )


def _empty_layers(content: DxfContent) -> Iterator[Finding]:
    drawn: tuple[FileLine | FileMark, ...] = (*content.lines, *content.marks)
    used = {item.layer.lower() for item in drawn}
    used |= {insert.layer.lower() for insert in content.inserts}
    for layer in content.layers:
        if layer.lower() not in used and layer.lower() not in _UNUSED_LAYERS:
            yield _finding("empty-layer", "warning", f"layer {layer} - empty - used - remove it")


def _place(point: tuple[float, float] | np.ndarray) -> str:
    return f"({point[0]:.3f}, {point[1]:.3f}) mm"


def _finding(code: str, severity: Severity, message: str) -> Finding:
    return Finding(code, severity, " ".join(message.split()))

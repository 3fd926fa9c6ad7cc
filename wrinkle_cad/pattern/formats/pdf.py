"""Pattern pieces as PDF, 1:1, tiled on A4 to be printed at home and taped together.

Every page shows 10 mm of its neighbours, crosses where pages meet, its place among them and a bar
of 50 mm to check that the printer did not scale. Empty pages are left out.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import shapely

from wrinkle_cad import settings
from wrinkle_cad.errors import ExportError, Finding, InputError
from wrinkle_cad.files.atomic import write_atomically
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece
from wrinkle_cad.pattern.piece.stacking import laid_out

from .drawing import Drawing, draw
from .layers import LINE_TYPES, Profile, profile_from
from .plain_text import ascii_text, text_changed
from .svg import colour_of

_SHORT, _LONG = 210.0, 297.0
_MARGIN: Final = 12.0
"""mm that no printer needs to reach."""
_OVERLAP: Final = 10.0
"""mm that neighbouring pages share."""
_BAR: Final = 50.0
_INCH: Final = 25.4
_POINTS_PER_MM: Final = 72.0 / _INCH


@dataclass(frozen=True, slots=True, eq=False)
class PdfFile:
    """A finished file in memory: its bytes, its pages, and which texts had to be changed."""

    content: bytes
    page_count: int
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Tiling:
    """Pages of ``page`` (2,) mm, their windows ``step`` (2,) mm apart, the first at ``low``."""

    page: Floats
    low: Floats
    columns: int
    rows: int

    @property
    def window(self) -> Floats:
        size: Floats = self.page - 2.0 * _MARGIN
        return size

    @property
    def step(self) -> Floats:
        size: Floats = self.window - _OVERLAP
        return size

    def corner(self, column: int, row: int) -> Floats:
        place: Floats = self.low + self.step * (column, row)
        return place


def pdf_file(
    pieces: Sequence[PatternPiece], *, profile: str | Path | Profile = settings.DXF_PROFILE
) -> PdfFile:
    """Returns a tiled PDF of all pieces, laid out as in the DXF; the same bytes every time.

    Args:
        pieces: at least one.
        profile: whose roles and colours are used.

    Raises:
        InputError: no pieces, or an unknown profile.
    """
    if not pieces:
        raise InputError("PDF - no pieces - at least one - make a pattern first")
    # Only a PDF needs matplotlib, which takes a third of a second to load.
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    chosen = profile if isinstance(profile, Profile) else profile_from(profile)
    placed = laid_out(pieces)
    drawings = [draw(piece) for piece in placed]
    tiling = _tiling(drawings)
    pages = _inked_pages(drawings, tiling)
    stream = io.BytesIO()
    with PdfPages(stream, metadata={"CreationDate": None, "Producer": None}) as book:
        for number, (column, row) in enumerate(pages, start=1):
            figure = Figure(figsize=tuple(tiling.page / _INCH))
            _draw_page(figure, drawings, chosen, tiling, column, row)
            place = f"page {number} of {len(pages)}, column {column + 1}, row {row + 1}"
            _draw_foot(figure, tiling, place)
            book.savefig(figure)
    findings = tuple(
        finding
        for drawing in drawings
        for label in drawing.labels
        for finding in text_changed("text in the PDF", label.text, ascii_text(label.text))
    )
    return PdfFile(stream.getvalue(), len(pages), findings)


def write_pdf(
    path: Path,
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
) -> tuple[Finding, ...]:
    """Writes a tiled PDF, whole or not at all, and returns the findings of ``pdf_file``.

    Raises:
        InputError: as ``pdf_file``.
        ExportError: the file cannot be written.
    """
    made = pdf_file(pieces, profile=profile)
    try:
        write_atomically(path, made.content)
    except OSError as error:
        raise ExportError(path, "PDF", f"{error.strerror} - check the folder") from error
    return made.findings


def _tiling(drawings: Sequence[Drawing]) -> _Tiling:
    """Returns the tiling with the fewest pages, upright if both ways need as many."""
    points = np.vstack([stroke.points for drawing in drawings for stroke in drawing.strokes])
    low, high = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    tilings = []
    for page in ((_SHORT, _LONG), (_LONG, _SHORT)):
        step = _Tiling(np.array(page), low, 1, 1).step
        columns, rows = (
            max(1, math.ceil((size - _OVERLAP) / way))
            for size, way in zip(high - low, step, strict=True)
        )
        tilings.append(_Tiling(np.array(page), low, columns, rows))
    return min(tilings, key=lambda tiling: tiling.columns * tiling.rows)


def _inked_pages(drawings: Sequence[Drawing], tiling: _Tiling) -> list[tuple[int, int]]:
    """Returns (column, row) of the pages with something on them, from the top left."""
    ink = shapely.MultiLineString(
        [
            np.vstack((stroke.points, stroke.points[:1])) if stroke.is_closed else stroke.points
            for drawing in drawings
            for stroke in drawing.strokes
        ]
    )
    pages = []
    for row in reversed(range(tiling.rows)):
        for column in range(tiling.columns):
            corner = tiling.corner(column, row)
            if shapely.box(*corner, *(corner + tiling.window)).intersects(ink):
                pages.append((column, row))
    return pages


def _draw_page(
    figure: Any,
    drawings: Sequence[Drawing],
    profile: Profile,
    tiling: _Tiling,
    column: int,
    row: int,
) -> None:
    low = tiling.corner(column, row)
    high = low + tiling.window
    start, size = _MARGIN / tiling.page, tiling.window / tiling.page
    axes = figure.add_axes((*start, *size), xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set(linewidth=0.3, color="0.6")
    for drawing in drawings:
        _draw_lines(axes, drawing, profile)
        _draw_labels(axes, drawing, profile, low, high)
    for x in (low[0] + 0.5 * _OVERLAP, high[0] - 0.5 * _OVERLAP):
        for y in (low[1] + 0.5 * _OVERLAP, high[1] - 0.5 * _OVERLAP):
            axes.plot(x, y, marker="+", markersize=_OVERLAP * _POINTS_PER_MM, color="0.4", lw=0.3)


def _draw_lines(axes: Any, drawing: Drawing, profile: Profile) -> None:
    for stroke in drawing.strokes:
        style = profile.styles.get(stroke.role)
        if style is None:
            continue
        closing = stroke.points[:1] if stroke.is_closed else stroke.points[:0]
        points = np.vstack((stroke.points, closing))
        dashes = LINE_TYPES[style.line_type][1][1:]
        pattern: Any = "-"
        if dashes:
            pattern = (0, [(abs(dash) or 0.25) * _POINTS_PER_MM / 0.7 for dash in dashes])
        axes.plot(*points.T, color=colour_of(style), linewidth=0.7, linestyle=pattern)
    for spot in drawing.spots:
        style = profile.styles.get(spot.role)
        if style is not None:
            axes.plot(*spot.position, marker="o", markersize=3, mfc="none", color=colour_of(style))


def _draw_labels(axes: Any, drawing: Drawing, profile: Profile, low: Floats, high: Floats) -> None:
    for label in drawing.labels:
        style = profile.styles.get(label.role)
        inside = np.all(label.position > low - (_LONG, 0.0)) and np.all(label.position < high)
        if style is not None and inside:
            axes.text(
                *label.position,
                ascii_text(label.text),
                fontsize=label.height * _POINTS_PER_MM / 0.73,
                color=colour_of(style),
                clip_on=True,
                parse_math=False,
            )


def _draw_foot(figure: Any, tiling: _Tiling, place: str) -> None:
    """Draws the bar for the scale check and the page's place below its window."""
    axes = figure.add_axes(
        (0.0, 0.0, 1.0, _MARGIN / tiling.page[1]), xlim=(0.0, tiling.page[0]), ylim=(0.0, _MARGIN)
    )
    axes.set_axis_off()
    level = 0.45 * _MARGIN
    axes.plot((_MARGIN, _MARGIN + _BAR), (level, level), color="black", linewidth=0.7)
    for i in range(6):
        x = _MARGIN + 0.2 * _BAR * i
        axes.plot((x, x), (level, level + 2.0), color="black", linewidth=0.7)
    note = f"this bar is {_BAR:g} mm: print at 100 %   -   {place}"
    axes.text(_MARGIN + _BAR + 4.0, level, note, fontsize=8)

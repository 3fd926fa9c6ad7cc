"""Pattern pieces as PDF, 1:1 on A4, to be printed at home.

Where there are several pages, the first is a picture of all others with their numbers. A piece that
fits on one sheet is not cut by an edge of paper; a larger one has pages in rows and columns that
share 10 mm, with crosses where they meet. Lines are told apart in black and white: cut lines are
thick, sew lines dashed, folds dash-dotted (mountain) and dotted (valley), bends of a bend table
with one more dot (up) or dash (down). Every page has a bar of 50 mm to check that the printer did
not scale.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.pattern.piece.piece import Floats, PatternPiece

from .drawing import Drawing, Stroke, draw
from .layers import Profile, profile_from
from .paper import LONG, MARGIN, OVERLAP, SHORT, Group, on_paper
from .pens import PENS, Pen, pen_of
from .plain_text import ascii_text, text_changed
from .svg import color_of

_BAR: Final = 50.0
_OVERVIEW_GAP: Final = 4.0
_INCH: Final = 25.4
_POINTS_PER_MM: Final = 72.0 / _INCH
_BENDS: Final = ("bend_up", "bend_down")
_FOLDS: Final = ("mountain", "valley")


@dataclass(frozen=True, slots=True, eq=False)
class PdfFile:
    """A finished file in memory: its bytes, its pages, and which texts had to be changed."""

    content: bytes
    """Its bytes."""
    page_count: int
    """How many pages it has."""
    findings: tuple[Finding, ...]
    """Texts that had to be changed."""


def pdf_file(
    pieces: Sequence[PatternPiece], *, profile: str | Path | Profile = settings.DXF_PROFILE
) -> PdfFile:
    """Returns a PDF of all pieces at full size; the same bytes every time.

    Args:
        pieces: at least one.
        profile: whose roles and colors are used.

    Raises:
        InputError: no pieces, or an unknown profile.
    """
    if not pieces:
        raise InputError("There are no pieces to write as PDF. Make a pattern first.")
    # Only a PDF needs matplotlib, which takes a third of a second to load.
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    chosen = profile if isinstance(profile, Profile) else profile_from(profile)
    groups = on_paper(pieces)
    own_pages = sum(len(group.pages) for group in groups)
    has_overview = own_pages > 1
    page_count = own_pages + has_overview
    drawn = [[draw(piece) for piece in group.pieces] for group in groups]
    stream = io.BytesIO()
    with PdfPages(stream, metadata={"CreationDate": None, "Producer": None}) as book:
        if has_overview:
            first = Figure(figsize=(SHORT / _INCH, LONG / _INCH))
            _draw_overview(first, groups)
            _draw_legend(first.axes[0], [item for items in drawn for item in items], chosen)
            _draw_foot(first, np.array((SHORT, LONG)), f"page 1 of {page_count}: all pages")
            book.savefig(first)
        number = int(has_overview)
        for group, drawings in zip(groups, drawn, strict=True):
            for column, row in group.pages:
                number += 1
                figure = Figure(figsize=tuple(group.page / _INCH))
                _draw_page(figure, group, drawings, chosen, column, row)
                place = group.name_of(column, row)
                told = f"page {number} of {page_count}" + (f", {place}" if place else "")
                _draw_foot(figure, group.page, told)
                book.savefig(figure)
    changed = [finding for drawings in drawn for finding in _changed(drawings)]
    return PdfFile(stream.getvalue(), page_count, tuple(changed))


def _changed(drawings: Sequence[Drawing]) -> list[Finding]:
    return [
        finding
        for drawing in drawings
        for label in drawing.labels
        for finding in text_changed("text in the PDF", label.text, ascii_text(label.text))
    ]


def write_pdf(
    path: Path,
    pieces: Sequence[PatternPiece],
    *,
    profile: str | Path | Profile = settings.DXF_PROFILE,
) -> tuple[Finding, ...]:
    """Writes a PDF, whole or not at all, and returns the findings of ``pdf_file``.

    Raises:
        InputError: as ``pdf_file``.
        ExportError: the file cannot be written.
    """
    made = pdf_file(pieces, profile=profile)
    write_export(path, "PDF", made.content)
    return made.findings


def _draw_page(
    figure: Any,
    group: Group,
    drawings: Sequence[Drawing],
    profile: Profile,
    column: int,
    row: int,
) -> None:
    low = group.corner(column, row)
    high = low + group.window
    start, size = MARGIN / group.page, group.window / group.page
    axes = figure.add_axes((*start, *size), xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set(linewidth=0.3, color="0.6")
    for drawing in drawings:
        _draw_lines(axes, drawing, profile)
        _draw_labels(axes, drawing, profile, low, high)
    if len(group.pages) == 1:
        return
    for x in (low[0] + 0.5 * OVERLAP, high[0] - 0.5 * OVERLAP):
        for y in (low[1] + 0.5 * OVERLAP, high[1] - 0.5 * OVERLAP):
            axes.plot(x, y, marker="+", markersize=OVERLAP * _POINTS_PER_MM, color="0.4", lw=0.3)


def _draw_lines(axes: Any, drawing: Drawing, profile: Profile) -> None:
    for stroke in _shown(drawing, profile):
        style = profile.styles[stroke.role]
        closing = stroke.points[:1] if stroke.is_closed else stroke.points[:0]
        points = np.vstack((stroke.points, closing))
        pen = pen_of(stroke.role)
        axes.plot(*points.T, color=color_of(style), linewidth=pen.width, linestyle=_pattern(pen))
    for spot in drawing.spots:
        if spot.role in profile.styles:
            color = color_of(profile.styles[spot.role])
            axes.plot(*spot.position, marker="o", markersize=3, mfc="none", color=color)


def _shown(drawing: Drawing, profile: Profile) -> list[Stroke]:
    """Returns the strokes that the profile shows; on paper bends stand for the rulings."""
    strokes = [stroke for stroke in drawing.strokes if stroke.role in profile.styles]
    if any(stroke.role in _BENDS for stroke in strokes):
        return [stroke for stroke in strokes if stroke.role not in _FOLDS]
    return strokes


def _pattern(pen: Pen) -> Any:
    """Returns dashes in mm as matplotlib has them, which counts in line widths."""
    return (0, [dash * _POINTS_PER_MM / pen.width for dash in pen.dashes]) if pen.dashes else "-"


def _draw_labels(axes: Any, drawing: Drawing, profile: Profile, low: Floats, high: Floats) -> None:
    for label in drawing.labels:
        style = profile.styles.get(label.role)
        near = np.all(label.position > low - LONG) and np.all(label.position < high + LONG)
        if style is not None and near:
            axes.text(
                *label.position,
                ascii_text(label.text),
                fontsize=label.height * _POINTS_PER_MM / 0.73,
                color=color_of(style),
                rotation=np.degrees(label.angle),
                rotation_mode="anchor",
                clip_on=True,
                parse_math=False,
            )


def _draw_overview(figure: Any, groups: Sequence[Group]) -> None:
    """Draws all pages small, with their numbers."""
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, SHORT), ylim=(0.0, LONG))
    axes.set_axis_off()
    axes.text(MARGIN, LONG - MARGIN - 4.0, "HOW THE PAGES GO TOGETHER", fontsize=11)
    room = np.array((SHORT - 2.0 * MARGIN, LONG - 2.0 * MARGIN - 50.0))
    places, scale = _overview_places(groups, room)
    number = 1
    for group, place in zip(groups, places, strict=True):
        corner = np.array((MARGIN, MARGIN + 8.0)) + place
        inset = figure.add_axes(
            (*(corner / (SHORT, LONG)), *(scale * group.size / (SHORT, LONG))),
            xlim=(0.0, group.size[0]),
            ylim=(0.0, group.size[1]),
        )
        inset.set_axis_off()
        for piece in group.pieces:
            outline = np.vstack((piece.cut_line, piece.cut_line[:1]))
            inset.plot(*outline.T, color="black", linewidth=0.6)
        for column, row in group.pages:
            number += 1
            low = group.corner(column, row)
            frame = low + group.window * np.array(((0, 0), (1, 0), (1, 1), (0, 1), (0, 0)))
            inset.plot(*frame.T, color="0.5", linewidth=0.4)
            middle = low + 0.5 * group.window
            told = f"{number}\n{group.name_of(column, row)}".strip()
            inset.text(*middle, told, fontsize=7, ha="center", va="center", color="0.3")


def _overview_places(groups: Sequence[Group], room: Floats) -> tuple[list[Floats], float]:
    """Returns lower left corners (2,) mm of the groups in shelves, and the scale that fits."""
    scale = 0.5
    while True:
        places, left, bottom, shelf = [], 0.0, 0.0, 0.0
        for group in groups:
            width, height = scale * group.size
            if left > 0.0 and left + width > room[0]:
                left, bottom, shelf = 0.0, bottom + shelf + _OVERVIEW_GAP, 0.0
            places.append(np.array((left, bottom)))
            left, shelf = left + width + _OVERVIEW_GAP, max(shelf, height)
            if width > room[0] or bottom + height > room[1]:
                break
        else:
            # The first group stands at the top.
            heights = [float(scale * group.size[1]) for group in groups]
            for i, place in enumerate(places):
                places[i] = np.array((place[0], room[1] - place[1] - heights[i]))
            return places, scale
        scale *= 0.9


def _draw_legend(axes: Any, drawings: Sequence[Drawing], profile: Profile) -> None:
    """Draws what each kind of line that stands on a page means."""
    top = LONG - MARGIN - 12.0
    drawn = {stroke.role for drawing in drawings for stroke in _shown(drawing, profile)}
    named = [(role, pen) for role, pen in PENS.items() if role in drawn and role in profile.styles]
    for i, (role, pen) in enumerate(named):
        x, y = MARGIN + 62.0 * (i % 3), top - 6.0 * (i // 3)
        axes.plot(
            (x, x + 20.0),
            (y, y),
            color=color_of(profile.styles[role]),
            linewidth=pen.width,
            linestyle=_pattern(pen),
        )
        axes.text(x + 22.0, y - 1.0, pen.name, fontsize=8)


def _draw_foot(figure: Any, page: Floats, place: str) -> None:
    """Draws the bar for the scale check and the page's place below its window."""
    axes = figure.add_axes(
        (0.0, 0.0, 1.0, MARGIN / page[1]), xlim=(0.0, page[0]), ylim=(0.0, MARGIN)
    )
    axes.set_axis_off()
    level = 0.45 * MARGIN
    axes.plot((MARGIN, MARGIN + _BAR), (level, level), color="black", linewidth=0.7)
    for i in range(6):
        x = MARGIN + 0.2 * _BAR * i
        axes.plot((x, x), (level, level + 2.0), color="black", linewidth=0.7)
    note = f"this bar is {_BAR:g} mm: print at 100 %      {place}"
    axes.text(MARGIN + _BAR + 4.0, level, note, fontsize=8)

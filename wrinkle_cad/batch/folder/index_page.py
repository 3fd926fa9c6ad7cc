"""DIR/index.html: every file of a batch on one page, with links to the reports."""

from __future__ import annotations

import base64
import hashlib
import html
import math
import re
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path, PurePosixPath
from typing import Final, NamedTuple
from urllib.parse import quote

from wrinkle_cad import settings
from wrinkle_cad.files.names import printable
from wrinkle_cad.files.own import write_own

from .events import BatchSummary
from .failure_causes import Cause, causes_of
from .manifest import WAITING, Record
from .summary_table import total_seconds

PAGE_NAME: Final = "index.html"

_PAGE: Final = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="wrinkle_cad batch">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; base-uri 'none';
 form-action 'none'; style-src 'unsafe-inline'; script-src 'sha256-{script_hash}'">
<title>wrinkle_cad batch</title>
<style>
{style}</style></head><body>
<h1>wrinkle_cad batch</h1>
<p>{counts}</p>
{causes}<div class="card">
<div class="tools"><input type="search" placeholder="Search names and outcomes"
 aria-label="Search names and outcomes">
<div class="choices" role="group" aria-label="Show only">{choices}</div>
<span class="shown muted" role="status"></span></div>
<div class="scroll"><table><thead><tr>{header}</tr></thead>
<tbody>
{rows}
</tbody></table></div></div>
<script>{script}</script></body></html>
"""
BEGINNINGS: Final = (_PAGE[: _PAGE.index('batch">')].encode("ascii"),)
"""What a page begins with: its generator's name is in it."""
_OPEN_RECORDS: Final = 5
"""A cause of so few failures shows them at once."""
_OUTLINE: Final = re.compile(r"(?:\d{1,9}(?:\.\d{1,6})?,\d{1,9}(?:\.\d{1,6})? ?){3,100}")
"""The points of a picture; whatever else a manifest has there is not drawn."""
_CHOICES: Final = (
    *((state, state) for state in settings.STATES),
    ("passed", "PASS"),
    ("missed", "FAIL"),
    ("failed", "failed"),
    (WAITING, "not come to"),
)
_HEADER: Final = (
    "pattern",
    "file",
    "state",
    "developable rails",
    "strain",
    "crease",
    "bend radius",
    "twist",
    "piece longer",
    "pattern area",
    "seconds",
    "outcome",
)


class _Cell(NamedTuple):
    """One cell of the table."""

    content: str
    """HTML, whatever comes from a file escaped."""
    key: str
    """What the column is sorted by."""
    kind: str = "text"
    """Its class."""


def write_index_page(folder: Path, records: Sequence[Record], summary: BatchSummary) -> None:
    """Writes the page: most developable files first, failed ones last, ties by name.

    Raises:
        JobError: a file of somebody else has its name.
        OSError: it cannot be written; an earlier page stays.
    """
    page = index_page(records, summary).encode("utf-8", "backslashreplace")
    write_own(folder / PAGE_NAME, page, BEGINNINGS)


def index_page(records: Sequence[Record], summary: BatchSummary) -> str:
    """The page as text; everything that comes from a file is escaped."""
    ordered = sorted(records, key=_rank)
    counts = (
        f"{len(records)} files: {summary.done} done, {summary.failed} failed, {summary.skipped}"
        f" done before, {summary.left} not come to. {summary.seconds:.1f} s."
    )
    if summary.missed_limits:
        counts += f" {summary.missed_limits} miss a limit."
    counts = " ".join((counts, summary.sheets, *summary.sheet_failures)).strip()
    if not summary.is_over:
        counts = f"Under way. {counts}"
    if summary.stopped_by:
        counts += f" Stopped: {printable(summary.stopped_by)}."
    script = _packaged("index.js")
    digest = hashlib.sha256(script.encode()).digest()
    kinds = {kind for record in records for kind in _kinds(record)}
    return _PAGE.format(
        # The only script that a browser may run there, whatever a name smuggles in.
        script_hash=base64.b64encode(digest).decode("ascii"),
        script=script,
        style=_packaged("index.css"),
        counts=html.escape(counts),
        causes=_causes(causes_of(ordered)),
        choices="".join(
            f'<button type="button" aria-pressed="false" data-choice="{kind}">{title}</button>'
            for kind, title in _CHOICES
            if kind in kinds
        ),
        header="".join(
            f'<th scope="col"><button type="button">{html.escape(title)}</button></th>'
            for title in _HEADER
        ),
        rows="\n".join(_row(record) for record in ordered),
    )


@cache
def _packaged(name: str) -> str:
    return files(__package__).joinpath("index", name).read_text(encoding="utf-8")


def _rank(record: Record) -> tuple[bool, float, str]:
    return (not record.is_done, -float(record.figures.get("developability", -1.0)), record.input)


def _causes(causes: Sequence[Cause]) -> str:
    """The failed files by cause, each group with what helps."""
    if not causes:
        return ""
    groups = "".join(
        f"<details{' open' if len(cause.records) <= _OPEN_RECORDS else ''}>"
        f"<summary>{html.escape(cause.title)}: {len(cause.records)}</summary>"
        f'<p class="muted">{html.escape(cause.hint)}</p><ul>'
        + "".join(
            f"<li>{html.escape(printable(f'{record.input}: {record.message}'))}</li>"
            for record in cause.records
        )
        + "</ul></details>"
        for cause in causes
    )
    return f'<div class="card"><h2>Failed, by cause</h2>{groups}</div>\n'


def _kinds(record: Record) -> list[str]:
    """What the choices above the table find a file by."""
    if not record.is_done:
        return [record.outcome]
    state = str(record.figures.get("state", ""))
    judged = record.figures.get("limits") or record.missed_limits
    kinds = ["missed" if record.missed_limits else "passed"] if judged else []
    return [*([state] if state in settings.STATES else []), *kinds]


def _row(record: Record) -> str:
    state = printable(str(record.figures.get("state", "")))
    tone = state if state in settings.STATES else ""
    cells = [
        _Cell(_thumbnail(record), "", "picture"),
        _Cell(_link(record), record.input, "file"),
        _Cell(f'<span class="state {tone}">{html.escape(state)}</span>' if state else "", state),
        _developability(record),
        _number(record, "max_strain_percent", "{:.3f}%"),
        _number(record, "max_crease_deg", "{:.1f}&deg;"),
        _number(record, "inner_bend_radius_mm", "{:.2f} mm"),
        _number(record, "max_twist_deg", "{:.2f}&deg;"),
        _number(record, "cut_longer_percent", "{:.1f}%"),
        _number(record, "area_pattern_mm2", "{:,.1f} mm&sup2;"),
        _Cell(f"{total_seconds(record):.2f} s", f"{total_seconds(record):.6f}", "number"),
        _outcome(record),
    ]
    shown = "".join(
        f'<td data-title="{title}" class="{cell.kind}"'
        f' data-key="{html.escape(printable(cell.key))}">{cell.content}</td>'
        for title, cell in zip(_HEADER, cells, strict=True)
    )
    return f'<tr data-kinds="{" ".join(_kinds(record))}">{shown}</tr>'


def _thumbnail(record: Record) -> str:
    """The first piece, small; nothing where the manifest holds no outline of the known form."""
    outline = str(record.figures.get("outline", ""))
    if not _OUTLINE.fullmatch(outline):
        return ""
    points = [[float(part) for part in point.split(",")] for point in outline.split()]
    width, height = (max(point[axis] for point in points) or 1.0 for axis in (0, 1))
    turned = " ".join(f"{x:g},{height - y:g}" for x, y in points)
    pad = 0.02 * max(width, height)
    view = f"{-pad:g} {-pad:g} {width + 2 * pad:g} {height + 2 * pad:g}"
    return f'<svg class="thumbnail" viewBox="{view}"><polygon points="{turned}"/></svg>'


def _link(record: Record) -> str:
    """The input's name, linking to its report, or to its first output when it has none."""
    name = html.escape(printable(record.input))
    names = sorted((file.name for file in record.outputs), key=lambda n: not n.endswith(".html"))
    if not names:
        return name
    target = (PurePosixPath(record.key).parent / names[0]).as_posix()
    return f'<a href="{html.escape(quote(target.encode("utf-8", "surrogatepass")))}">{name}</a>'


def _developability(record: Record) -> _Cell:
    value = record.figures.get("developability")
    if not isinstance(value, int | float) or not math.isfinite(value):
        return _Cell("", "-1", "number")
    bar = f'<span class="bar"><i style="width:{min(max(value, 0.0), 100.0):.1f}%"></i></span>'
    return _Cell(f"{value:.1f}% {bar}", f"{value:.6f}", "number")


def _number(record: Record, name: str, form: str) -> _Cell:
    value = record.figures.get(name)
    if not isinstance(value, int | float) or not math.isfinite(value):
        return _Cell("", "-1", "number")
    return _Cell(form.format(value), f"{value:.6f}", "number")


def _outcome(record: Record) -> _Cell:
    if record.outcome == WAITING:
        return _Cell(html.escape(printable(_waiting_text(record))), WAITING, "outcome")
    if not record.is_done:
        text = html.escape(printable(f"failed: {record.message}"))
        return _Cell(f'<span class="failed">{text}</span>', "failed", "outcome")
    if record.missed_limits:
        text = html.escape(printable("FAIL: " + "; ".join(record.missed_limits)))
        return _Cell(f'<span class="failed">{text}</span>', "done, misses a limit", "outcome")
    if record.figures.get("limits"):
        return _Cell('<span class="passed">PASS</span>', "done", "outcome")
    return _Cell("done", "done", "outcome")


def _waiting_text(record: Record) -> str:
    """What an earlier batch made of a file that this one was not come to."""
    if record.message:
        return f"not come to; failed in an earlier batch: {record.message}"
    return "not come to; done by an earlier batch" if record.outputs else "not come to"

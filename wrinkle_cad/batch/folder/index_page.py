"""DIR/index.html: every file of a batch on one page, with links to the reports."""

from __future__ import annotations

import base64
import hashlib
import html
import math
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import Final
from urllib.parse import quote

from wrinkle_cad.files.names import printable
from wrinkle_cad.files.own import write_own

from .events import BatchSummary
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
:root {{ color-scheme: light dark; font: 15px/1.45 system-ui, sans-serif; }}
body {{ margin: 1.5rem auto; max-width: 75rem; padding: 0 1rem; }}
.scroll {{ overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; }}
th, td {{ text-align: left; padding: .35rem .6rem; border-bottom: 1px solid #8884; }}
td {{ vertical-align: top; overflow-wrap: anywhere; }}
td:first-child {{ min-width: 16rem; }}
th button {{ all: unset; cursor: pointer; font-weight: 600; }}
th button:focus-visible {{ outline: 2px solid; }}
.number {{ text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }}
.bar {{ display: inline-block; width: 5rem; height: .55rem; background: #8884; }}
.bar i {{ display: block; height: 100%; background: #2a8a4a; }}
.failed {{ color: #c0392b; }}
</style></head><body>
<h1>wrinkle_cad batch</h1>
<p>{counts}</p>
<div class="scroll"><table><thead><tr>{header}</tr></thead>
<tbody>
{rows}
</tbody></table></div>
<script>
document.querySelectorAll("th button").forEach(function (button) {{
  button.addEventListener("click", function () {{
    var head = button.parentElement, column = head.cellIndex;
    var direction = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    document.querySelectorAll("th").forEach(function (other) {{
      other.removeAttribute("aria-sort");
    }});
    head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    var body = document.querySelector("tbody");
    Array.from(body.rows).sort(function (first, second) {{
      var a = first.cells[column].dataset.key, b = second.cells[column].dataset.key;
      var by = isNaN(a) || isNaN(b) || a === "" || b === "" ? a.localeCompare(b) : a - b;
      return by * direction;
    }}).forEach(function (row) {{ body.appendChild(row); }});
  }});
}});
</script></body></html>
"""
_SCRIPT: Final = _PAGE.partition("<script>")[2].partition("</script>")[0].format()
_SCRIPT_HASH: Final = base64.b64encode(hashlib.sha256(_SCRIPT.encode()).digest()).decode("ascii")
"""The only script that a browser may run there, whatever a name smuggles in."""
BEGINNINGS: Final = (_PAGE[: _PAGE.index('batch">')].encode("ascii"),)
"""What a page begins with: its generator's name is in it."""
_HEADER: Final = (
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
    return _PAGE.format(
        script_hash=_SCRIPT_HASH,
        counts=html.escape(counts),
        header="".join(
            f'<th scope="col"><button type="button">{html.escape(title)}</button></th>'
            for title in _HEADER
        ),
        rows="\n".join(_row(record) for record in ordered),
    )


def _rank(record: Record) -> tuple[bool, float, str]:
    return (not record.is_done, -float(record.figures.get("developability", -1.0)), record.input)


def _row(record: Record) -> str:
    state = printable(str(record.figures.get("state", "")))
    cells = [
        _cell(_link(record), record.input),
        _cell(html.escape(state), state),
        _developability(record),
        _number(record, "max_strain_percent", "{:.3f}%"),
        _number(record, "max_crease_deg", "{:.1f}&deg;"),
        _number(record, "inner_bend_radius_mm", "{:.2f} mm"),
        _number(record, "max_twist_deg", "{:.2f}&deg;"),
        _number(record, "cut_longer_percent", "{:.1f}%"),
        _number(record, "area_pattern_mm2", "{:.1f} mm&sup2;"),
        _cell(f"{total_seconds(record):.2f}", f"{total_seconds(record):.6f}", "number"),
        _outcome(record),
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _link(record: Record) -> str:
    """The input's name, linking to its report, or to its first output when it has none."""
    name = html.escape(printable(record.input))
    names = sorted((file.name for file in record.outputs), key=lambda n: not n.endswith(".html"))
    if not names:
        return name
    target = (PurePosixPath(record.key).parent / names[0]).as_posix()
    return f'<a href="{html.escape(quote(target.encode("utf-8", "surrogatepass")))}">{name}</a>'


def _developability(record: Record) -> str:
    value = record.figures.get("developability")
    if not isinstance(value, int | float) or not math.isfinite(value):
        return _cell("", "-1", "number")
    bar = f'<span class="bar"><i style="width:{min(max(value, 0.0), 100.0):.1f}%"></i></span>'
    return _cell(f"{value:.1f}% {bar}", f"{value:.6f}", "number")


def _number(record: Record, name: str, form: str) -> str:
    value = record.figures.get(name)
    if not isinstance(value, int | float) or not math.isfinite(value):
        return _cell("", "-1", "number")
    return _cell(form.format(value), f"{value:.6f}", "number")


def _outcome(record: Record) -> str:
    if record.outcome == WAITING:
        return _cell(html.escape(printable(_waiting_text(record))), WAITING)
    if not record.is_done:
        text = html.escape(printable(f"failed: {record.message}"))
        return _cell(f'<span class="failed">{text}</span>', "failed")
    if record.missed_limits:
        text = html.escape(printable("FAIL: " + "; ".join(record.missed_limits)))
        return _cell(f'<span class="failed">{text}</span>', "done, misses a limit")
    return _cell("done", "done")


def _waiting_text(record: Record) -> str:
    """What an earlier batch made of a file that this one was not come to."""
    if record.message:
        return f"not come to; failed in an earlier batch: {record.message}"
    return "not come to; done by an earlier batch" if record.outputs else "not come to"


def _cell(content: str, key: str, kind: str = "text") -> str:
    return f'<td class="{kind}" data-key="{html.escape(printable(key))}">{content}</td>'

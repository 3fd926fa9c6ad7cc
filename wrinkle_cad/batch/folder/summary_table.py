"""DIR/summary.csv: a batch as a table that a spreadsheet opens and never executes."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.files.names import printable
from wrinkle_cad.files.own import write_own

from .manifest import Record

TABLE_NAME: Final = "summary.csv"

FIGURES: Final = (
    "strips",
    "state",
    "developability",
    "max_strain_percent",
    "max_crease_deg",
    "inner_bend_radius_mm",
    "max_twist_deg",
    "cut_longer_percent",
    "interior_bridges",
    "invalid_bridges",
    "inflection_bridges",
    "area_3d_mm2",
    "area_pattern_mm2",
    "max_fold_deg",
    "overlaps",
)
"""Names of a record's figures, in the order of the columns."""

_HEADER: Final = (
    "input",
    "outcome",
    *FIGURES,
    "missed_limits",
    "seconds",
    "outputs",
    "phase",
    "error",
    "message",
)
BEGINNINGS: Final = ((",".join(_HEADER[:3]) + ",").encode("utf-8-sig"),)
"""What a table begins with."""

_FORMULA_STARTS: Final = ("=", "+", "-", "@", "\t", "\r", "\uff1d", "\uff0b", "\uff0d", "\uff20")


def write_summary_table(folder: Path, records: Sequence[Record]) -> None:
    """Writes the table, one row per record, in UTF-8 with the mark that spreadsheets look for.

    Raises:
        JobError: a file of somebody else has its name.
        OSError: it cannot be written; an earlier table stays.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(_HEADER)
    writer.writerows([safe_cell(value) for value in _row(record)] for record in records)
    write_own(folder / TABLE_NAME, text.getvalue().encode("utf-8-sig"), BEGINNINGS)


def safe_cell(value: Any) -> Any:
    """A cell that no spreadsheet takes for a formula: such text gets a quote in front."""
    if not isinstance(value, str):
        return value
    text = printable(value)
    return f"'{text}" if text.startswith(_FORMULA_STARTS) else text


def total_seconds(record: Record) -> float:
    """Seconds that a job took, over all its phases."""
    return float(sum(record.seconds.values()))


def _row(record: Record) -> list[Any]:
    return [
        record.input,
        record.outcome,
        *(_number(record.figures.get(name)) for name in FIGURES),
        "; ".join(record.missed_limits),
        round(total_seconds(record), 3),
        f"{record.key}.*" if record.is_done else "",
        record.phase,
        record.error,
        record.message,
    ]


def _number(value: Any) -> Any:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return round(value, 6) if isinstance(value, float) else value

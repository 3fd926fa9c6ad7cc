"""What a person sees on a terminal: progress, tables, one safe line."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from wrinkle_cad.files.names import one_line

if TYPE_CHECKING:
    from wrinkle_cad.job.inspection import Inspection
    from wrinkle_cad.job.outcome import Progress
    from wrinkle_cad.report.material import Material


@contextmanager
def progress_on_screen(*, is_wanted: bool) -> Iterator[Progress | None]:
    """Shows phase, counter and seconds on stderr while a job runs; nothing off a terminal."""
    if not (is_wanted and sys.stderr.isatty()):
        yield None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("start", total=None)

        def show(phase: str, done: int, total: int) -> None:
            bar.update(task, description=one_line(phase), completed=done, total=total)

        yield show


def print_inspection(inspection: Inspection) -> None:
    """Prints the shapes of a file as a table, then which of them would be taken, and why."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(soft_wrap=not sys.stdout.isatty(), highlight=False)
    console.print(Text(f"{one_line(inspection.file)}: {inspection.format}, {inspection.unit}"))
    table = Table("index", "name", "kind", "measure", "taken as")
    for row in inspection.rows:
        table.add_row(
            str(row.index),
            Text(one_line(row.name)),
            row.kind,
            f"{row.measure:.3f} {row.measure_unit}",
            Text(one_line(row.taken_as)),
        )
    console.print(table)
    for reason in inspection.reasons:
        console.print(Text(one_line(reason)))


def print_comparison(summary: Mapping[str, Any]) -> None:
    """Prints the methods of each strip as a table."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(soft_wrap=not sys.stdout.isatty(), highlight=False)
    for strip in summary["strips"]:
        console.print(Text(one_line(strip["name"])))
        columns = ("method", "valid bridges", "energy", "area mm2", "largest fold deg", "seconds")
        table = Table(*columns)
        for row in strip["methods"]:
            table.add_row(
                row["method"],
                f"{row['valid_bridges']} of {row['bridges']}",
                f"{row['bending']:.4g}",
                f"{row['area_mm2']:.2f}",
                f"{row['max_fold_deg']:.2f}",
                f"{row['seconds']:.4f}",
            )
        console.print(table)


def material_lines(material: Material) -> Iterator[str]:
    """A material as lines: its name, what is known of it, and where that comes from."""
    yield material.name
    radius, across = (
        material.smallest_bend_radius_mm,
        material.smallest_bend_radius_across_grain_mm,
    )
    along = "" if across is None else " along the grain"
    facts = (
        ("{:g} mm thick", material.thickness_mm),
        ("bends to {:g} mm" + along, radius),
        ("bends to {:g} mm across the grain", across),
        ("gives {:g}%", material.largest_strain_percent),
        ("twists by {:g} deg", material.largest_twist_deg),
        ("K-factor {:g}", material.k_factor),
    )
    known = [words.format(fact) for words, fact in facts if fact is not None]
    yield f"    {', '.join(known)}"
    yield f"    {material.source}"

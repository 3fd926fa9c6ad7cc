"""A batch on a terminal: a live display while it runs, a table at its end."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from wrinkle_cad.batch.folder.events import (
    BatchEvent,
    BatchSummary,
    FileFinished,
    FilePhase,
    FileSkipped,
    Listener,
)
from wrinkle_cad.batch.folder.index_page import PAGE_NAME
from wrinkle_cad.batch.folder.summary_table import TABLE_NAME
from wrinkle_cad.files.names import printable


@contextmanager
def live_display(total: int, console: Console | None = None) -> Iterator[Listener]:
    """Shows counts, rate, time left and what each worker does; failures scroll by above.

    Args:
        total: files in all.
        console: where to show it; stderr when None.

    Yields:
        A listener for the batch's events.
    """
    screen = console or Console(stderr=True, highlight=False)
    display = _Display(total)
    with Live(display, console=screen, refresh_per_second=8, transient=True):

        def listen(event: BatchEvent) -> None:
            display.take(event)
            if isinstance(event, FileFinished) and not event.record.is_done:
                screen.print(Text(f"{event.label}: {event.record.message}", style="red"))

        yield listen


def print_summary(summary: BatchSummary, console: Console | None = None) -> None:
    """Prints the counts of a batch and where its table and page are."""
    screen = console or Console(soft_wrap=not sys.stdout.isatty(), highlight=False)
    table = Table("files", "", title="batch", title_justify="left")
    table.columns[1].justify = "right"
    rows = (
        ("done", summary.done),
        ("failed", summary.failed),
        ("done before", summary.skipped),
        ("not come to", summary.left),
        ("miss a limit", summary.missed_limits),
    )
    for name, count in rows:
        if count or name in ("done", "failed"):
            table.add_row(name, str(count))
    worked = summary.done + summary.failed
    rate = 60.0 * worked / summary.seconds if summary.seconds else 0.0
    table.add_row("seconds", f"{summary.seconds:.1f}")
    table.add_row("files per minute", f"{rate:.1f}")
    screen.print(table)
    if summary.sheets:
        screen.print(Text(printable(summary.sheets)))
    for name in (TABLE_NAME, PAGE_NAME):
        screen.print(Text(str(summary.folder / name)))


class _Display:
    """What the terminal shows; rich asks for it several times per second."""

    def __init__(self, total: int) -> None:
        self._bar = Progress(
            TextColumn("{task.fields[counts]}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self._task = self._bar.add_task("files", total=total, counts="", rate="")
        self._total = total
        self._done = self._failed = self._skipped = 0
        self._phases: dict[str, str] = {}
        self._show()

    def take(self, event: BatchEvent) -> None:
        """Takes an event into account."""
        if isinstance(event, FilePhase):
            self._phases[event.label] = f"{event.phase} {event.done}/{event.total}"
            return
        if isinstance(event, FileSkipped):
            self._skipped += 1
        elif isinstance(event, FileFinished):
            self._phases.pop(event.label, None)
            self._done += event.record.is_done
            self._failed += not event.record.is_done
        self._show()

    def __rich__(self) -> Group:
        lines = [Text(f"  {phase}  {label}") for label, phase in self._phases.items()]
        return Group(self._bar, *lines)

    def _show(self) -> None:
        settled = self._done + self._failed + self._skipped
        elapsed = self._bar.tasks[0].elapsed or 0.0
        worked = self._done + self._failed
        rate = f"{60.0 * worked / elapsed:.0f} files/min" if elapsed > 1.0 else ""
        counts = f"{self._done} done, {self._failed} failed, {self._total - settled} left"
        self._bar.update(self._task, completed=settled, counts=counts, rate=rate)

"""What a batch tells while it runs, and what it was in the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .manifest import Record


@dataclass(frozen=True, slots=True)
class BatchStarted:
    """The batch has its folder to itself and begins."""

    total: int
    """Files in all."""


@dataclass(frozen=True, slots=True)
class FileSkipped:
    """A file is done already, and nothing about it has changed."""

    label: str
    """Folder and name of the input."""
    record: Record
    """From the batch that did it."""


@dataclass(frozen=True, slots=True)
class FilePhase:
    """A file under way has reached a phase."""

    label: str
    """Folder and name of the input."""
    phase: str
    """Name of the phase."""
    done: int
    """How many of its parts are done."""
    total: int
    """How many parts there are."""


@dataclass(frozen=True, slots=True)
class FileFinished:
    """A file has been done or has failed."""

    label: str
    """Folder and name of the input."""
    record: Record
    """What became of it."""


BatchEvent = BatchStarted | FileSkipped | FilePhase | FileFinished
Listener = Callable[[BatchEvent], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchSummary:
    """A whole batch in numbers."""

    folder: Path
    """The folder of the outputs."""
    done: int
    """Files done by this batch."""
    failed: int
    """Files that failed."""
    skipped: int
    """Files that were done before."""
    left: int
    """Files not come to, because the disk was full."""
    missed_limits: int
    """Files done, now or before, that miss a limit that was given."""
    strict_misses: int = 0
    """Those of them whose settings say that this is a failure."""
    seconds: float
    """Wall-clock seconds."""
    sheets: str = ""
    """The sheets that the pieces of all files lie on, on one line; empty when none are wanted."""
    sheet_failures: tuple[str, ...] = ()
    """What is on none of them, and why; one line each."""
    stopped_by: str = ""
    """Why files are left, on one line."""
    is_over: bool = True
    """Whether the batch has ended; False on a page that is written under way."""

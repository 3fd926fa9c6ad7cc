"""Why files of a batch failed: grouped by cause, with what helps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from .manifest import Record


class Cause(NamedTuple):
    """One kind of failure and the files that it befell."""

    title: str
    """What happened, in a few words."""
    hint: str
    """What to do about it."""
    records: tuple[Record, ...]
    """The files, in their order."""


_INPUT: Final = (
    "The file, or the curves in it, cannot be used",
    "Each line says what was found. wrinkle-cad inspect FILE lists what is in a file.",
)
_BY_ERROR: Final = {
    "InputError": _INPUT,
    "JobError": (
        "The settings do not fit the file",
        "Each line names the setting; job.toml beside the file goes before the batch's own.",
    ),
    "ConstraintError": (
        "No strip keeps the constraints",
        "Each line names the constraint that fails: loosen that one.",
    ),
    "CadError": (
        "The CAD kernel could not make the shape",
        "Try other waves, a wider margin or another tolerance for these files.",
    ),
    "ExportError": (
        "The outputs could not be written",
        "Look at the folder's rights and at the space on its disk, then run the batch again.",
    ),
    "TimeLimit": (
        "The time for one file was up",
        "Give more with --timeout, or a coarser --tolerance.",
    ),
    "MemoryLimit": (
        "The memory for one file was used up",
        "Give more with --memory, or a coarser --tolerance.",
    ),
}
USER_ERRORS: Final = frozenset({"InputError", "JobError", "ConstraintError", "ExportError"})
"""Whose one line says it all: where in the program it was found helps nobody."""
_OTHER: Final = (
    "The job's process ended",
    "batch.log has what it said last. Please report it with the file.",
)


def causes_of(records: Sequence[Record]) -> list[Cause]:
    """Groups the failed files by cause, the most frequent first.

    Args:
        records: of all files; those that did not fail are left out.
    """
    groups: dict[tuple[str, str], list[Record]] = {}
    for record in records:
        if record.outcome == "failed":
            groups.setdefault(_BY_ERROR.get(record.error, _OTHER), []).append(record)
    found = [Cause(title, hint, tuple(own)) for (title, hint), own in groups.items()]
    return sorted(found, key=lambda cause: (-len(cause.records), cause.title))

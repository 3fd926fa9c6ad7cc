"""DIR/batch.log: what happened when, one line each, for whoever reads it the next morning."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from wrinkle_cad.files.names import printable
from wrinkle_cad.files.own import append_own

LOG_NAME: Final = "batch.log"
BEGINNINGS: Final = (b"wrinkle_cad batch log, times in UTC\n",)
"""What a log begins with."""


class Journal:
    """A log file that is only ever added to.

    Args:
        folder: the batch's folder.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / LOG_NAME

    def write(self, text: str) -> None:
        """Adds a line with the time in UTC; line breaks in the text become escapes.

        Raises:
            JobError: a file of somebody else has taken its name.
            OSError: the disk is full.
        """
        now = datetime.now(UTC).isoformat(timespec="seconds")
        self._add(f"{now} {printable(text)}\n")

    def write_detail(self, text: str) -> None:
        """Adds the lines of a text (a traceback, what a crashed kernel printed), indented.

        Raises:
            JobError: a file of somebody else has taken its name.
            OSError: the disk is full.
        """
        if text:
            self._add("".join(f"    {printable(line)}\n" for line in text.splitlines()))

    def _add(self, lines: str) -> None:
        append_own(self.path, lines.encode("utf-8", "backslashreplace"), BEGINNINGS)

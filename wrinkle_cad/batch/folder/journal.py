"""DIR/batch.log: what happened when, one line each, for whoever reads it the next morning."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from wrinkle_cad.files.names import printable

LOG_NAME: Final = "batch.log"


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
            OSError: the disk is full.
        """
        now = datetime.now(UTC).isoformat(timespec="seconds")
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(f"{now} {printable(text)}\n")

    def write_detail(self, text: str) -> None:
        """Adds the lines of a text (a traceback, what a crashed kernel printed), indented.

        Raises:
            OSError: the disk is full.
        """
        with self.path.open("a", encoding="utf-8") as stream:
            stream.writelines(f"    {printable(line)}\n" for line in text.splitlines())

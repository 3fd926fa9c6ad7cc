"""The batch's table and page, kept true while it runs: written from what is known of each file."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from .events import BatchSummary
from .index_page import write_index_page
from .manifest import Record
from .summary_table import write_summary_table

_INTERVAL_S: Final = 10.0
"""Seconds after which a batch under way writes its table and its page again."""
_COST_SHARE: Final = 20
"""Writing may take one part in so many of the time."""


class Pages:
    """Writes the table and the page now and then.

    Args:
        folder: the batch's.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._due = 0.0

    def write_if_due(self, state: Callable[[], tuple[Sequence[Record], BatchSummary]]) -> None:
        """Writes both if they were last written some time ago.

        Raises:
            OSError: as `write` says.
        """
        if time.monotonic() >= self._due:
            self.write(*state())

    def write(self, records: Sequence[Record], summary: BatchSummary) -> None:
        """Writes both.

        Raises:
            JobError: a file of somebody else has taken one of the names.
            OSError: they cannot be written; earlier ones stay.
        """
        start = time.monotonic()
        write_summary_table(self._folder, records)
        write_index_page(self._folder, records, summary)
        end = time.monotonic()
        self._due = end + max(_INTERVAL_S, _COST_SHARE * (end - start))

"""Whether the disk has room for what a batch will write."""

from __future__ import annotations

import shutil
from pathlib import Path

from wrinkle_cad import settings
from wrinkle_cad.errors import ExportError

_MIB = 1 << 20


def check_disk_space(folder: Path, *, least_mib: int = settings.BATCH_DISK_FREE_MIB) -> None:
    """Checks that an existing folder's disk has at least ``least_mib`` MiB left.

    Raises:
        ExportError: it has less; the message tells how much.
    """
    free = shutil.disk_usage(folder).free
    if free < least_mib * _MIB:
        raise ExportError(
            folder,
            "folder",
            f"its disk has {free / _MIB:.0f} MiB free, at least {least_mib} MiB are needed. Make"
            " room and run the same command again: it goes on where it stopped.",
        )

"""One batch per folder: a lock that ends with the process that holds it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable
from wrinkle_cad.files.own import open_own

LOCK_NAME: Final = ".wrinkle_cad.lock"
_BEGINNING: Final = b"wrinkle_cad lock, process "


@contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Holds a folder for this process; the system gives it free when the process ends, however.

    Args:
        folder: an existing folder that can be written to.

    Raises:
        InputError: another process holds it, the system has no such locks (Windows), or somebody
            else's file has the lock's name.
        OSError: the lock file cannot be made.
    """
    try:
        import fcntl
    except ImportError as error:
        raise InputError(
            "batch needs the file locks of Linux or macOS. On this system, use run for each file,"
            " or run_batch with an executor of your own."
        ) from error
    handle = open_own(folder / LOCK_NAME, [_BEGINNING])
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            said = os.read(handle, 100).removeprefix(_BEGINNING).decode("ascii", "replace")
            holder = printable(said.strip()) or "unknown"
            raise InputError(
                f"Another batch is writing to the output folder {folder.name} (process {holder})."
                " Wait for it or give another -o DIR."
            ) from error
        os.ftruncate(handle, 0)
        os.write(handle, _BEGINNING + f"{os.getpid()}\n".encode("ascii"))
        # The file stays: removing it would let a third process lock a new file of that name
        # while a second one still waits on the old.
        yield
    finally:
        os.close(handle)

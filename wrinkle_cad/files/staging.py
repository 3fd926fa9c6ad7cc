"""The outputs of one job appear together: made aside, committed by one rename, then moved.

A job works in a hidden folder beside its final names. When everything in it is on the disk, the
folder is renamed; that rename is the commit. Moving the files to their names comes after it, and
whoever finds a committed folder (after a crash) finishes the move. Before the commit there is
nothing.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

PART_PREFIX: Final = ".wrinkle_cad-part-"
READY_PREFIX: Final = ".wrinkle_cad-ready-"
RECORD_NAME: Final = ".record.json"


def open_staging(folder: Path) -> Path:
    """Makes an empty hidden folder for one job inside the folder of its outputs.

    Raises:
        OSError: the folder cannot be made or written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    return Path(tempfile.mkdtemp(prefix=PART_PREFIX, dir=folder))


def commit_staging(staging: Path, record_line: str) -> Path:
    """Declares the files in a staging folder final; from here on they will get their names.

    Args:
        staging: from `open_staging`, holding the outputs and nothing else, all on the disk.
        record_line: the line of the manifest about them, kept with them until they are in place.

    Returns:
        The committed folder, for `move_into_place`.

    Raises:
        OSError: the disk is full; nothing is committed.
    """
    with (staging / RECORD_NAME).open("xb") as stream:
        stream.write(record_line.encode("ascii"))
        stream.flush()
        os.fsync(stream.fileno())
    flush_folder(staging)
    ready = staging.with_name(READY_PREFIX + staging.name.removeprefix(PART_PREFIX))
    # Not flushed: a power cut that undoes the rename leaves a job to be done again, no more.
    staging.rename(ready)
    return ready


def move_into_place(ready: Path) -> None:
    """Moves the files of a committed folder to their final names beside it; safe to do again.

    Raises:
        OSError: a name cannot be taken (a folder has it); the committed folder stays for later.
    """
    for path in sorted(ready.iterdir()):
        if path.name != RECORD_NAME:
            path.replace(ready.parent / path.name)
    # Not flushed: a power cut that undoes moves leaves a committed folder to be moved again.
    (ready / RECORD_NAME).unlink(missing_ok=True)
    ready.rmdir()


def discard_staging(staging: Path) -> None:
    """Removes a staging folder and what a job left in it; nothing happens when it is gone."""
    shutil.rmtree(staging, ignore_errors=True)


def leftovers(folder: Path) -> Iterator[tuple[Path, str | None]]:
    """Finds what a killed batch left in and below a folder; links are not followed.

    Yields:
        ``(path, None)`` for a folder that was never committed, ``(path, record line)`` for a
        committed one that was not moved in full.
    """
    for root, folders, _ in os.walk(folder):
        for name in [name for name in folders if name.startswith((PART_PREFIX, READY_PREFIX))]:
            folders.remove(name)
            path = Path(root, name)
            yield path, _record_line(path) if name.startswith(READY_PREFIX) else None


def flush_files(folder: Path, names: Sequence[str]) -> None:
    """Makes the content of files of a folder, by name, survive a power cut.

    Raises:
        OSError: the disk refuses.
    """
    # Side by side: the disk takes them in one go.
    with ThreadPoolExecutor(max(1, len(names))) as threads:
        for _ in threads.map(lambda name: _flush(folder / name, os.O_RDONLY), names):
            pass


def flush_folder(folder: Path) -> None:
    """Makes the names in a folder survive a power cut, where the system can do that."""
    if hasattr(os, "O_DIRECTORY"):
        _flush(folder, os.O_RDONLY | os.O_DIRECTORY)


def _record_line(ready: Path) -> str:
    try:
        return (ready / RECORD_NAME).read_text(encoding="ascii")
    except FileNotFoundError:
        # The record goes last, after every file is in place.
        return ""


def _flush(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

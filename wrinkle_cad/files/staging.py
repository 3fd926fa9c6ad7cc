"""The outputs of one job appear together: made aside, committed by one rename, then moved.

A job works in a hidden folder beside its final names. When everything in it is on the disk, the
folder is renamed; that rename is the commit. Moving the files to their names comes after it, and
whoever finds a committed folder (after a crash) finishes the move. Before the commit there is
nothing.

A hidden folder is ours by the mark inside it, not by its name, and in use as long as a process
holds the mark's lock, which ends with the process, however that ends.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from .atomic import replace_together
from .regular import is_regular, read_regular

PART_PREFIX: Final = ".wrinkle_cad-part-"
READY_PREFIX: Final = ".wrinkle_cad-ready-"
RECORD_NAME: Final = ".record.json"
MARK_NAME: Final = ".mark"
MARK: Final = b"wrinkle_cad: files under way, removed when the job ends\n"

_RECORD_LIMIT: Final = 1 << 20
_held: dict[Path, int] = {}
"""The open mark of each folder of this process: its lock ends when it is closed."""


def open_staging(folder: Path) -> Path:
    """Makes a hidden folder for one job inside the folder of its outputs, empty but for its mark.

    Raises:
        OSError: the folder cannot be made or written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with _while_marking(folder, is_alone=False):
        staging = Path(tempfile.mkdtemp(prefix=PART_PREFIX, dir=folder))
        handle = os.open(staging / MARK_NAME, os.O_RDWR | os.O_CREAT | os.O_EXCL | _CLOSED, 0o600)
        _held[staging] = handle
        _lock(handle)
        try:
            os.write(handle, MARK)
        except OSError:
            discard_staging(staging)
            raise
    return staging


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
    if staging in _held:
        _held[ready] = _held.pop(staging)
    return ready


def staged_files(staging: Path) -> list[Path]:
    """The outputs in a hidden folder, by name, without what is kept beside them (hidden, too)."""
    return [path for path in sorted(staging.iterdir()) if not path.name.startswith(".")]


def move_into_place(ready: Path, may_replace: Callable[[Path], bool]) -> None:
    """Moves the files of a committed folder to their final names beside it; safe to do again.

    Args:
        ready: the committed folder; gone when this returns.
        may_replace: whether a file that has one of the names is ours to replace.

    Raises:
        OSError: a name cannot be taken, or somebody else's file has it; every name holds what it
            held before, and the committed folder is what is left of it.
    """
    pairs = [(path, ready.parent / path.name) for path in staged_files(ready)]
    replace_together(pairs, may_replace=may_replace, is_resumed=True)
    # Not flushed: a power cut that undoes moves leaves a committed folder to be moved again.
    discard_staging(ready)


def discard_staging(staging: Path) -> None:
    """Removes a staging folder and what a job left in it; nothing happens when it is gone."""
    # The mark goes last: a folder that loses it half-way would be nobody's.
    with contextlib.suppress(OSError):
        for path in staging.iterdir():
            if path.name == MARK_NAME:
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()
        (staging / MARK_NAME).unlink(missing_ok=True)
        staging.rmdir()
    release_staging(staging)


def release_staging(staging: Path) -> None:
    """Leaves a hidden folder, as it is, to whoever looks for leftovers."""
    handle = _held.pop(staging, None)
    if handle is not None:
        os.close(handle)


def leftovers(folder: Path, *, below: bool = True) -> Iterator[tuple[Path, str | None]]:
    """Finds what killed processes left in a folder; links are not followed.

    Args:
        folder: where outputs go.
        below: whether the folders in it are searched too.

    Yields:
        ``(path, None)`` for a folder that was never committed, ``(path, record line)`` for a
        committed one that was not moved in full. Folders without our mark, of another user, or
        still in use are nobody's leftovers.
    """
    for root, folders, _ in os.walk(folder):
        for name in [name for name in folders if name.startswith((PART_PREFIX, READY_PREFIX))]:
            folders.remove(name)
            path = Path(root, name)
            if _is_abandoned(path):
                yield path, _record_line(path) if name.startswith(READY_PREFIX) else None
        if not below:
            return


def clear_abandoned(folder: Path, finish: Callable[[Path], None] | None = None) -> None:
    """Removes uncommitted hidden folders that killed processes left right in a folder.

    Args:
        folder: where outputs go.
        finish: called with each of them before it goes.
    """
    for path, record in list(leftovers(folder, below=False)):
        if record is None:
            if finish is not None:
                finish(path)
            discard_staging(path)


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


_CLOSED: Final = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)


def _lock(handle: int) -> bool:
    """Whether this process has the lock of an open file now; False where there are no locks."""
    return _flock(handle, is_alone=True)


def _flock(handle: int, *, is_alone: bool) -> bool:
    try:
        import fcntl
    except ImportError:
        return False
    try:
        # Never waited for: anybody may hold a lock on a file that he can read.
        fcntl.flock(handle, (fcntl.LOCK_EX if is_alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


@contextlib.contextmanager
def _while_marking(folder: Path, *, is_alone: bool) -> Iterator[bool]:
    """Holds a lock on a folder of outputs while a hidden folder in it is made and marked.

    Without it, whoever clears up could not tell a folder that has no mark yet from one whose
    process was killed before it had one.

    Args:
        folder: of the outputs.
        is_alone: whether nobody may be making one at the same time.

    Yields:
        Whether the lock was given; it is not where a system has none.
    """
    handle = os.open(folder, os.O_RDONLY | getattr(os, "O_CLOEXEC", 0))
    try:
        yield _flock(handle, is_alone=is_alone)
    finally:
        os.close(handle)


def _is_abandoned(staging: Path) -> bool:
    if staging in _held:
        return False
    try:
        found = staging.lstat()
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
            return False
        handle = os.open(staging / MARK_NAME, os.O_RDONLY | os.O_NONBLOCK | _CLOSED)
    except FileNotFoundError:
        return _was_never_marked(staging)
    except OSError:
        return False
    try:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            return False
        mark = os.read(handle, len(MARK) + 1)
        if mark == MARK:
            return _lock(handle)
    except OSError:
        return False
    finally:
        os.close(handle)
    return MARK.startswith(mark) and _was_never_marked(staging)


def _was_never_marked(staging: Path) -> bool:
    """Whether a hidden folder's process was killed before it had marked it in full."""
    try:
        with _while_marking(staging.parent, is_alone=True) as is_alone:
            names = {path.name for path in staging.iterdir()}
            mark = staging / MARK_NAME
            is_torn = not names or (is_regular(mark) and mark.stat().st_size < len(MARK))
            # Anything else in it came after a whole mark, or is somebody's.
            return is_alone and is_torn and names <= {MARK_NAME}
    except OSError:
        return False


def _record_line(ready: Path) -> str:
    try:
        return read_regular(ready / RECORD_NAME, size_limit=_RECORD_LIMIT).decode("ascii")
    except (OSError, UnicodeDecodeError):
        # The record goes last, after every file is in place.
        return ""


def _flush(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

"""Reading of files that others name: regular files only, of sane size, and never for ever.

A pipe, a device, a socket or a directory under the name of an input would hold up whoever opens or
hashes it; a share whose server is gone stalls in the middle of a read. So a file is opened without
waiting, looked at, and read in a thread that is given up when it makes no progress.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, TypeVar

T = TypeVar("T")

STALL_S: Final = 10.0
"""Seconds without a byte after which the reading of a file is given up."""
HASHED_SIZE_LIMIT: Final = 16 * 2**30
"""Bytes; no file is hashed that is larger."""

_CHUNK: Final = 1 << 20
_READ: Final = os.O_RDONLY | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
# Neither a pipe without a writer nor a terminal may hold us up.
_AT_ONCE: Final = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)


class IrregularFileError(OSError):
    """What stands under a name is no regular file, or not one of sane size."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(errno.EINVAL, reason, str(path))


def read_regular(path: Path, *, size_limit: int) -> bytes:
    """Returns the content of a regular file.

    Args:
        path: the file; a link to one is followed.
        size_limit: bytes; a larger file is not read.

    Raises:
        IrregularFileError: it is no regular file, larger than the limit, or holds more than it says
            (as some files of ``/proc`` do).
        TimeoutError: nothing came for ``STALL_S`` seconds.
        OSError: it cannot be opened or read, or its name cannot be one.
    """
    content = bytearray()
    _take(path, content.extend, size_limit)
    return bytes(content)


def hash_regular(path: Path, *, size_limit: int = HASHED_SIZE_LIMIT) -> str:
    """Returns the SHA-256 of a regular file's content, in hexadecimal.

    Raises:
        OSError: as `read_regular` says.
    """
    digest = hashlib.sha256()
    _take(path, digest.update, size_limit)
    return digest.hexdigest()


def is_regular(path: Path) -> bool:
    """Whether a regular file, not a link to one, stands under a name."""
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except (OSError, ValueError):
        return False


def within(seconds: float, work: Callable[[Callable[[], None]], T], what: str) -> T:
    """Runs work in a thread and gives it up when it makes no progress.

    Args:
        seconds: how long it may do nothing.
        work: called with a function that it calls whenever it has got on.
        what: names the work in the error's message.

    Raises:
        TimeoutError: it did nothing for so long; its thread is left to itself.
        BaseException: whatever the work raised.

    Example:
        >>> within(1.0, lambda got_on: 6 * 7, "an easy question")
        42
    """
    ended, beats = threading.Event(), [0]
    results: list[T] = []
    errors: list[BaseException] = []

    def beat() -> None:
        beats[0] += 1

    def run() -> None:
        try:
            results.append(work(beat))
        except BaseException as error:
            # Nobody sees what ends a thread: whoever waits for it raises it.
            errors.append(error)
        ended.set()

    threading.Thread(target=run, name="reads a file", daemon=True).start()
    before = -1
    while not ended.wait(seconds):
        if beats[0] == before:
            raise TimeoutError(errno.ETIMEDOUT, f"{what} stalls: nothing for {seconds:g} s")
        before = beats[0]
    if errors:
        raise errors[0]
    return results[0]


def _take(path: Path, take: Callable[[bytes], Any], size_limit: int) -> None:
    def work(got_on: Callable[[], None]) -> None:
        with _opened(path, size_limit) as (handle, size):
            left = size + 1
            while left and (chunk := os.read(handle, min(_CHUNK, left))):
                left -= len(chunk)
                take(chunk)
                got_on()
            if not left:
                raise IrregularFileError(path, "holds more than its size says")

    try:
        within(STALL_S, work, f"reading {path.name!r}")
    except TimeoutError as error:
        raise TimeoutError(errno.ETIMEDOUT, error.strerror, str(path)) from error
    except BlockingIOError as error:
        raise IrregularFileError(path, "is not a regular file") from error


@contextmanager
def _opened(path: Path, size_limit: int) -> Iterator[tuple[int, int]]:
    try:
        # Looked at before, too: opening alone makes some devices act.
        _check(path, path.stat(), size_limit)
        handle = os.open(path, _READ | _AT_ONCE)
    except ValueError as error:
        raise IrregularFileError(path, "has a name that no file can have") from error
    try:
        found = os.fstat(handle)
        _check(path, found, size_limit)
        yield handle, found.st_size
    finally:
        os.close(handle)


def _check(path: Path, found: os.stat_result, size_limit: int) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise IrregularFileError(path, "is a directory")
    if not stat.S_ISREG(found.st_mode):
        raise IrregularFileError(path, "is not a regular file")
    if found.st_size > size_limit:
        raise IrregularFileError(
            path,
            f"is {found.st_size / 2**20:.1f} MiB large, the limit is {size_limit / 2**20:.1f} MiB",
        )

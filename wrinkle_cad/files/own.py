"""Files with fixed names beside the outputs (a log, a page): ours by their beginning.

A name alone makes nothing ours. Whoever finds a link, a second name for the same file, or a file of
another beginning under such a name says so before the work begins and leaves it as it is.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from wrinkle_cad.errors import JobError

from .atomic import replace_together
from .names import printable
from .staging import discard_staging, open_staging

_FLAGS: Final = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)
# A pipe under the name must not hold us up.
_AT_ONCE: Final = getattr(os, "O_NONBLOCK", 0)


def check_own(path: Path, beginnings: Sequence[bytes]) -> None:
    """Checks that a file is not there, empty, or ours.

    Args:
        path: the file; its folder may be missing.
        beginnings: what a file of ours begins with, one of these.

    Raises:
        JobError: it is a link, has a second name, is no regular file, or begins with something
            else.
    """
    try:
        found = path.lstat()
    except FileNotFoundError:
        return
    except OSError as error:
        raise _foreign(path, error.strerror or str(error)) from error
    if stat.S_ISLNK(found.st_mode):
        raise _foreign(path, "is a link")
    if not stat.S_ISREG(found.st_mode):
        raise _foreign(path, "is no regular file")
    if found.st_nlink > 1:
        raise _foreign(path, f"is one file under {found.st_nlink} names")
    if found.st_size and not _begins_with(path, beginnings):
        raise _foreign(path, "was not written by this program")


def write_own(path: Path, content: bytes, beginnings: Sequence[bytes]) -> None:
    """Replaces a file of ours whole; nothing is half-written and nothing foreign replaced.

    Raises:
        JobError: what stands under the name is not ours, as `check_own` says.
        OSError: it cannot be written; what stood there stays.
    """
    check_own(path, beginnings)
    staging = open_staging(path.parent)
    try:
        part = staging / path.name
        with part.open("xb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        replace_together([(part, path)])
    finally:
        discard_staging(staging)


def open_own(path: Path, beginnings: Sequence[bytes]) -> int:
    """Opens a file of ours to read and write, made when missing; links are not followed.

    One that a power cut left with a torn beginning is begun again: nothing else was in it.

    Returns:
        A handle of the system; whoever asked for it closes it.

    Raises:
        JobError: what stands under the name is not ours, as `check_own` says.
        OSError: it cannot be opened.
    """
    check_own(path, beginnings)
    handle = os.open(path, os.O_RDWR | os.O_CREAT | _FLAGS | _AT_ONCE, 0o644)
    found = os.fstat(handle)
    if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
        os.close(handle)
        raise _foreign(path, "is no regular file of one name")
    head = os.pread(handle, max(map(len, beginnings)), 0)
    if not _is_beginning(head, beginnings):
        os.close(handle)
        raise _foreign(path, "was not written by this program")
    if not any(head.startswith(own) for own in beginnings):
        # Torn: what is added to it now would follow a beginning that is nobody's.
        os.ftruncate(handle, 0)
    return handle


def append_own(path: Path, content: bytes, beginnings: Sequence[bytes]) -> None:
    """Adds to a file of ours; a new one gets the first of the beginnings before the content.

    Raises:
        JobError: what stands under the name is not ours, as `check_own` says.
        OSError: it cannot be written.
    """
    handle = open_own(path, beginnings)
    try:
        end = os.lseek(handle, 0, os.SEEK_END)
        write_all(handle, content if end else beginnings[0] + content)
    finally:
        os.close(handle)


def write_all(handle: int, content: bytes) -> None:
    """Writes every byte to a handle of the system.

    Raises:
        OSError: the disk is full.
    """
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(handle, rest) :]


def _begins_with(path: Path, beginnings: Sequence[bytes]) -> bool:
    try:
        handle = os.open(path, os.O_RDONLY | _FLAGS | _AT_ONCE)
    except OSError as error:
        raise _foreign(path, error.strerror or str(error)) from error
    try:
        head = os.read(handle, max(map(len, beginnings)))
    finally:
        os.close(handle)
    return _is_beginning(head, beginnings)


def _is_beginning(head: bytes, beginnings: Sequence[bytes]) -> bool:
    # A beginning that a power cut tore is still ours.
    return any(head.startswith(own) or own.startswith(head) for own in beginnings)


def _foreign(path: Path, reason: str) -> JobError:
    return JobError(
        f"{printable(path.name)} in the output folder {reason}. A batch replaces only files of its"
        " own: move it away or give another -o DIR."
    )

"""Standard streams that may be closed, full, or of another encoding than the names we print."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Final

_STREAMS: Final = ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w"))


def open_streams() -> None:
    """Gives a process that was started with closed streams others, and all of them every name.

    A file or a pipe that is opened later would else get the number of a closed stream, and be
    written to by whoever means that stream: the kernel, a worker process.
    """
    for number, name, mode in _STREAMS:
        try:
            os.fstat(number)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_RDWR), number)
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, mode, closefd=False))
        stream = getattr(sys, name)
        if mode == "w" and hasattr(stream, "reconfigure"):
            # Names of files may not fit the terminal's encoding.
            stream.reconfigure(errors="backslashreplace")


def complain(sentence: str) -> None:
    """Writes a line to stderr; where that cannot be written, the exit code has to do."""
    with suppress(OSError, ValueError):
        sys.stderr.write(f"{sentence}\n")
        sys.stderr.flush()


def flushed() -> None:
    """Writes out what stdout holds back.

    Raises:
        OSError: it cannot be written: its disk is full, its reader went away.
    """
    sys.stdout.flush()


def give_up_stdout() -> None:
    """Lets what is still held back go nowhere, so that Python does not complain once more."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())

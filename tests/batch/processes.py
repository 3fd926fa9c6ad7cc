"""Whether processes have ended."""

from __future__ import annotations

import time
from collections.abc import Sequence

import psutil


def assert_all_end(processes: Sequence[psutil.Process], seconds: float = 2.0) -> None:
    """All have ended in time; one that nobody has collected yet (a zombie) has ended too."""
    deadline = time.monotonic() + seconds
    alive = list(processes)
    while alive and time.monotonic() < deadline:
        alive = [process for process in alive if is_alive(process)]
        time.sleep(0.02)
    assert not alive


def is_alive(process: psutil.Process) -> bool:
    """Whether a process still runs."""
    try:
        return process.status() not in (psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD)
    except psutil.NoSuchProcess:
        return False

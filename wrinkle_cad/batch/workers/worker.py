"""One worker process, seen from inside: it sets its own limits, then runs task after task.

An exception that a job lets through ends the worker after it has told about it: a process that met
a bug or ran out of memory is not trusted with the next file.
"""

from __future__ import annotations

import ctypes
import faulthandler
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Final

from wrinkle_cad.errors import WrinkleError

from .task import Task, run_task

_THREAD_SETTINGS: Final = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
_PARENT_CHECK_S: Final = 0.5
_PHASE_INTERVAL_S: Final = 0.1
_SET_DEATH_SIGNAL: Final = 1
"""PR_SET_PDEATHSIG of <sys/prctl.h>."""


@dataclass(frozen=True, slots=True)
class Began:
    """The worker has taken the task that it was given."""


@dataclass(frozen=True, slots=True)
class PhaseReached:
    """A job tells where it is."""

    name: str
    """Name of the phase."""
    done: int
    """How many of its parts are done."""
    total: int
    """How many parts there are."""
    at: float
    """s on the clock that this machine's processes share."""


@dataclass(frozen=True, slots=True)
class WorkerFault:
    """An exception that ends the worker."""

    error: str
    """Name of its class."""
    message: str
    """Its text."""
    is_expected: bool
    """Whether it is one of this package's own, with a message for the user."""
    peak_bytes: int
    """Most address space that the process had."""


def serve(tasks: Connection, stderr: Connection, memory_bytes: int | None, parent_pid: int) -> None:
    """Runs in a new process: takes tasks from a pipe until the other end is closed.

    Args:
        tasks: tasks come in; `Began`, `PhaseReached`, `TaskResult` and `WorkerFault` go out.
        stderr: gets what anything in this process writes to stderr; stdout is thrown away.
        memory_bytes: limit of the address space; none when None.
        parent_pid: the process without which this one must not live.
    """
    end_with_parent(parent_pid)
    # Ctrl-C reaches the whole group; the parent decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _redirect(stderr)
    one_thread()
    _limit_memory(memory_bytes)
    while True:
        try:
            task: Task = tasks.recv()
        except EOFError:
            return
        with _FaultReport(tasks):
            tasks.send(Began())
            tasks.send(run_task(task, _phase_sender(tasks)))


def end_with_parent(parent_pid: int) -> None:
    """Makes this process end within a second of another, even when that one is killed.

    Linux sends a signal that nothing can hold up; a thread watches too, for other systems.

    Args:
        parent_pid: its parent, or the parent of the fork server that is its parent.
    """
    die_with_parent()
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent and _is_alive(parent_pid):
            time.sleep(_PARENT_CHECK_S)
        os._exit(1)

    if not _is_alive(parent_pid):
        os._exit(1)
    threading.Thread(target=watch, name="parent watch", daemon=True).start()


def die_with_parent() -> None:
    """Has Linux kill this process when its parent ends; of no effect elsewhere."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)


def one_thread() -> None:
    """Says to libraries that are loaded after this that there is one thread for each worker."""
    for name in _THREAD_SETTINGS:
        os.environ[name] = "1"


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True


def peak_bytes(pid: int | str = "self") -> int:
    """Most address space that a process ever had; 0 where the system does not tell."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return 0
    for line in status.splitlines():
        if line.startswith("VmPeak:"):
            return int(line.split()[1]) * 1024
    return 0


class _FaultReport:
    """Tells the parent about an exception that leaves the block; does not hold it up."""

    def __init__(self, tasks: Connection) -> None:
        self._tasks = tasks

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            is_expected = issubclass(kind, WrinkleError)
            self._tasks.send(WorkerFault(kind.__name__, str(error), is_expected, peak_bytes()))


def _redirect(stderr: Connection) -> None:
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    os.dup2(stderr.fileno(), 2)
    os.close(nowhere)
    faulthandler.enable(file=2)


def _limit_memory(memory_bytes: int | None) -> None:
    if sys.platform == "win32":
        return
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if memory_bytes is not None:
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        soft = memory_bytes if hard == resource.RLIM_INFINITY else min(memory_bytes, hard)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _phase_sender(tasks: Connection) -> Callable[[str, int, int], None]:
    last_name, last_time = "", 0.0

    def tell(name: str, done: int, total: int) -> None:
        nonlocal last_name, last_time
        now = time.monotonic()
        if name != last_name or now - last_time > _PHASE_INTERVAL_S:
            last_name, last_time = name, now
            tasks.send(PhaseReached(name, done, total, now))

    return tell

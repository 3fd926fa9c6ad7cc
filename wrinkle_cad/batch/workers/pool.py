"""Worker processes with limits: one process and one pipe each, so that none can hold up another.

Why not a ready-made pool: those share one queue and one lock among all workers. Tried with pebble
5.2, a worker that leaves with exit code 0 hangs its task until the time limit, and one that is
killed while idle breaks the pool for all; `concurrent.futures` gives up the pool at the first
death. The standard library's `Process`, `Pipe` and `wait` suffice.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import connection
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Final, Protocol

from wrinkle_cad import settings
from wrinkle_cad.job.outcome import JobDone

from .ending import MEMORY_ERRORS, Ending, WorkerLimits, failure_of
from .task import Task, TaskResult
from .worker import Began, PhaseReached, WorkerFault, peak_bytes, serve

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerContext, SpawnContext

_GOODBYE_S: Final = 2.0
_PRELOAD: Final = "wrinkle_cad.batch.workers.preload"
_KEPT_BYTES: Final = 4000
_INTERRUPTING: Final = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
_LONGEST_COMPILATION_S: Final = 600.0
"""s; so long may a job compile without that counting as its time."""


@dataclass(frozen=True, slots=True)
class Phase:
    """A job under way tells where it is."""

    key: int
    """The job's number."""
    name: str
    """Name of the phase."""
    done: int
    """How many of its parts are done."""
    total: int
    """How many parts there are."""


@dataclass(frozen=True, slots=True)
class Finished:
    """A job has come to its end, good or bad."""

    key: int
    """The job's number."""
    result: TaskResult
    """What came of it."""


Event = Phase | Finished


class Pool(Protocol):
    """Whoever runs tasks."""

    def has_room(self) -> bool:
        """Whether another task would be taken now."""

    def is_busy(self) -> bool:
        """Whether any task is under way."""

    def give(self, key: int, task: Task) -> None:
        """Hands a task over; only when there is room."""

    def wait(self, patience: float) -> Sequence[Event]:
        """Waits some seconds at most and returns what has happened, possibly nothing."""

    def close(self) -> None:
        """Lets idle workers go; the pool takes no more tasks."""

    def kill(self) -> None:
        """Ends everything at once."""


class _Worker:
    """A worker process and what is known about it."""

    def __init__(self, limits: WorkerLimits, *, is_forked: bool) -> None:
        context: ForkServerContext | SpawnContext
        context = _fork_server() if is_forked else multiprocessing.get_context("spawn")
        self.pipe, tasks = context.Pipe()
        self.stderr, stderr = context.Pipe(duplex=False)
        self.process = context.Process(
            target=serve,
            args=(tasks, stderr, limits.memory_bytes, os.getpid()),
            name="wrinkle_cad worker",
            daemon=True,
        )
        self.process.start()
        # With our copies closed, the pipe ends with the worker.
        tasks.close()
        stderr.close()
        self.last_output: deque[bytes] = deque()
        self.key: int | None = None
        self.task: Task | None = None
        self.rest()

    def rest(self) -> None:
        """Forgets the task that it had."""
        self.key = self.task = None
        self.fault: WorkerFault | None = None
        self.began = False
        self.phase = ""
        self.since = 0.0
        self.compiled_s = 0.0
        self.compiling_since: float | None = None
        self.peak_bytes = 0
        self.last_output.clear()

    def give(self, key: int, task: Task) -> None:
        self.rest()
        self.key, self.task, self.since = key, task, time.monotonic()
        # A worker that died idle is noticed by the next look at it.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            self.pipe.send(task)

    def reach(self, phase: PhaseReached) -> None:
        """Takes note of a phase; what it compiles is no fault of its file."""
        self.phase = phase.name
        if self.compiling_since is not None:
            self.compiled_s += phase.at - self.compiling_since
        self.compiling_since = phase.at if phase.name == settings.COMPILE_PHASE else None

    def worked_s(self) -> float:
        """Seconds that the job took so far, but for what it compiled."""
        now = time.monotonic()
        compiling = 0.0 if self.compiling_since is None else now - self.compiling_since
        return now - self.since - min(self.compiled_s + compiling, _LONGEST_COMPILATION_S)

    def read_stderr(self) -> None:
        """Takes what it wrote to stderr and keeps the end of it."""
        with contextlib.suppress(OSError):
            while self.stderr.poll():
                piece = os.read(self.stderr.fileno(), 1 << 16)
                if not piece:
                    return
                self.last_output.append(piece[-_KEPT_BYTES:])
                while (
                    len(self.last_output) > 1 and sum(map(len, self.last_output)) > 2 * _KEPT_BYTES
                ):
                    self.last_output.popleft()

    def messages(self) -> Iterator[object]:
        """Takes what it has sent; ends quietly where it died in the middle of a message."""
        with contextlib.suppress(EOFError, OSError):
            while self.pipe.poll():
                yield self.pipe.recv()

    def end(self) -> None:
        """Kills the process and frees what belongs to it."""
        self.process.kill()
        self.process.join()
        self.read_stderr()
        self.pipe.close()
        self.stderr.close()

    def ending(self, *, is_late: bool) -> Ending:
        return Ending(
            exit_code=self.process.exitcode,
            is_late=is_late,
            phase=self.phase,
            fault=self.fault,
            peak_bytes=self.peak_bytes,
            seconds=self.worked_s(),
            stderr=b"".join(self.last_output)[-_KEPT_BYTES:].decode("utf-8", "replace"),
        )


@contextlib.contextmanager
def _undisturbed() -> Iterator[None]:
    """Puts off Ctrl-C and its like until the block is over.

    A process whose start is interrupted half-way is in nobody's list: nobody would end it, and it
    would complain on our stderr that it was told nothing.
    """
    held: list[int] = []
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for number in _INTERRUPTING:
                handler = signal.getsignal(number)
                if callable(handler):
                    before[number] = handler
                    signal.signal(number, lambda got, _: held.append(got))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    for number in held:
        signal.raise_signal(number)


def _fork_server() -> ForkServerContext:
    """Workers are forked from a process that has loaded what jobs need."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([_PRELOAD])
    return context


class WorkerPool:
    """Worker processes on this machine, each with a limit of time and memory.

    Args:
        count: how many at a time, 1 or more.
        limits: for each job.
        is_forked: whether workers are forked from a process that has loaded what they need, which
            makes all but the first start at once; a single job is not worth that process.
    """

    def __init__(self, count: int, limits: WorkerLimits, *, is_forked: bool = True) -> None:
        self._count = count
        self._is_forked = is_forked
        self._limits = limits
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []
        self._starts: dict[int, int] = {}

    def has_room(self) -> bool:
        """Whether another task would be taken now."""
        return len(self._busy) < self._count

    def is_busy(self) -> bool:
        """Whether any task is under way."""
        return bool(self._busy)

    def give(self, key: int, task: Task) -> None:
        """Hands a task to an idle worker or a new one."""
        with _undisturbed():
            worker = self._idle.pop() if self._idle else self._started()
            self._busy.append(worker)
        self._starts[key] = self._starts.get(key, 0) + 1
        worker.give(key, task)

    def _started(self) -> _Worker:
        if self._is_forked:
            try:
                return _Worker(self._limits, is_forked=True)
            except (EOFError, OSError):
                # The server died of what it loads; a worker of its own can say what that is.
                self._is_forked = False
        return _Worker(self._limits, is_forked=False)

    def wait(self, patience: float) -> Sequence[Event]:
        """Waits until a worker says something, at most ``patience`` seconds."""
        watched: list[Connection | int] = []
        for worker in self._busy:
            watched += [worker.pipe, worker.stderr, worker.process.sentinel]
        connection.wait(watched, timeout=patience)
        return [event for worker in tuple(self._busy) for event in self._look_at(worker)]

    def close(self) -> None:
        """Lets idle workers go."""
        for worker in self._idle:
            worker.pipe.close()
        for worker in self._idle:
            worker.process.join(_GOODBYE_S)
            worker.end()
        self._idle.clear()

    def kill(self) -> None:
        """Ends every worker at once."""
        for worker in (*self._busy, *self._idle):
            worker.process.kill()
        for worker in (*self._busy, *self._idle):
            worker.end()
        self._busy.clear()
        self._idle.clear()

    def _look_at(self, worker: _Worker) -> Iterator[Event]:
        key = worker.key
        assert key is not None
        is_alive = worker.process.is_alive()
        worker.peak_bytes = max(worker.peak_bytes, peak_bytes(worker.process.pid or 0))
        worker.read_stderr()
        for message in worker.messages():
            if isinstance(message, Began):
                worker.began = True
            elif isinstance(message, PhaseReached):
                worker.reach(message)
                yield Phase(key, message.name, message.done, message.total)
            elif isinstance(message, WorkerFault):
                worker.fault = message
            elif isinstance(message, TaskResult):
                yield self._finish(worker, key, message, is_alive=is_alive)
                return
        limit = self._limits.timeout_s
        is_late = limit is not None and worker.worked_s() > limit
        if not is_alive or is_late:
            yield from self._end(worker, key, is_late=is_late and is_alive)

    def _finish(self, worker: _Worker, key: int, result: TaskResult, *, is_alive: bool) -> Finished:
        self._busy.remove(worker)
        self._starts.pop(key)
        outcome = result.outcome
        if isinstance(outcome, JobDone) or outcome.error not in MEMORY_ERRORS:
            if is_alive:
                worker.rest()
                self._idle.append(worker)
            else:
                worker.end()
            return Finished(key, result)
        if self._limits.memory_bytes is not None:
            worker.fault = WorkerFault(outcome.error, outcome.message, True, worker.peak_bytes)
            failure = failure_of(outcome.job, worker.ending(is_late=False), self._limits)
            result = TaskResult(outcome=failure)
        # A process that ran out of memory is not trusted with the next file.
        worker.end()
        return Finished(key, result)

    def _end(self, worker: _Worker, key: int, *, is_late: bool) -> Iterator[Event]:
        task, began = worker.task, worker.began
        assert task is not None
        worker.end()
        self._busy.remove(worker)
        if not began and not is_late and self._starts[key] < settings.BATCH_STARTS:
            # The job was never begun: it is not what ended the process.
            self.give(key, task)
            return
        self._starts.pop(key)
        failure = failure_of(task.job, worker.ending(is_late=is_late), self._limits)
        yield Finished(key, TaskResult(outcome=failure))

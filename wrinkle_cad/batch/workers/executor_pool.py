"""A caller's own executor as a pool: no limits, since they could not be kept."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)

from wrinkle_cad import settings
from wrinkle_cad.files.names import printable
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobFailed

from .pool import Event, Finished
from .task import Task, TaskResult, run_task


class ExecutorPool:
    """Runs tasks on any `concurrent.futures.Executor`, which stays the caller's.

    Args:
        executor: threads, processes or a cluster; where tasks run, the package is installed.
        in_flight: how many tasks are handed out at a time.
    """

    def __init__(self, executor: Executor, in_flight: int = settings.BATCH_IN_FLIGHT) -> None:
        self._executor = executor
        self._in_flight = in_flight
        self._keys: dict[Future[TaskResult], int] = {}
        self._jobs: dict[int, Job] = {}

    def has_room(self) -> bool:
        """Whether another task would be taken now."""
        return len(self._keys) < self._in_flight

    def is_busy(self) -> bool:
        """Whether any task is under way."""
        return bool(self._keys)

    def give(self, key: int, task: Task) -> None:
        """Hands a task to the executor."""
        future: Future[TaskResult]
        try:
            future = self._executor.submit(run_task, task)
        except BrokenExecutor as error:
            future = Future()
            future.set_exception(error)
        self._keys[future] = key
        self._jobs[key] = task.job

    def wait(self, patience: float) -> Sequence[Event]:
        """Waits until a task has ended, at most ``patience`` seconds."""
        done, _ = wait(self._keys, patience, FIRST_COMPLETED)
        return [self._finish(future) for future in sorted(done, key=self._keys.__getitem__)]

    def close(self) -> None:
        """Leaves the executor to the caller."""

    def kill(self) -> None:
        """Takes back what has not begun; what runs, runs on."""
        for future in self._keys:
            future.cancel()
        self._keys.clear()

    def _finish(self, future: Future[TaskResult]) -> Finished:
        key = self._keys.pop(future)
        job = self._jobs.pop(key)
        if future.cancelled():
            return Finished(key, TaskResult(outcome=_failure(job, CancelledError())))
        error = future.exception()
        if error is not None:
            return Finished(key, TaskResult(outcome=_failure(job, error)))
        return Finished(key, future.result())


def _failure(job: Job, error: BaseException) -> JobFailed:
    name = type(error).__name__
    text = printable(" ".join(str(error).split())) or "no message"
    is_lost = isinstance(error, BrokenExecutor | CancelledError) or name == "KilledWorker"
    if is_lost:
        message = f"The worker was lost ({name}: {text}). Look at the executor's log."
    else:
        message = f"The worker raised {name} ({text}). Try the file alone with run."
    return JobFailed(
        job=job, phase="worker", error="WorkerKilled" if is_lost else name, message=message
    )

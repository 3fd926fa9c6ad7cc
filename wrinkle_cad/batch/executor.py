"""run_batch: many jobs from Python, on worker processes or on an executor of the caller's."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.batch.folder.delivery import deliver
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.executor_pool import ExecutorPool
from wrinkle_cad.batch.workers.pool import Event, Finished, Pool, WorkerPool
from wrinkle_cad.batch.workers.task import JobFunction, Task
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import collision_key
from wrinkle_cad.files.staging import discard_staging, open_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed

_MOST_WORKERS: Final = 1000
"""More processes at a time are surely a slip of the pen."""


class _End:
    """No more tasks."""


_END: Final = _End()


def run_batch(
    jobs: Iterable[Job],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    timeout: float | None = None,
    memory: float | None = None,
    job_function: JobFunction | None = None,
) -> tuple[JobDone | JobFailed, ...]:
    """Runs jobs side by side; a job that crashes, hangs or needs too much costs only itself.

    Without an executor, each job runs in a worker process of its own making, with limits; such
    processes import the caller's main module, so a script needs ``if __name__ == "__main__":``.
    With an executor the jobs run there, and limits, which could not be kept, are refused.

    Args:
        jobs: the jobs; no two may write the same files.
        executor: any `concurrent.futures.Executor`; it is not shut down. The jobs' files must be
            reachable from where it runs them.
        workers: how many processes at a time; the cores this process may use when None.
        timeout: seconds per job; 600 when None.
        memory: GiB of address space per job, 2 at least; 4 when None.
        job_function: what to run for each job, importable by its name; `run_job` when None.

    Returns:
        An outcome for each job, in their order.

    Raises:
        InputError: two jobs write the same files, a limit is out of its range or was given
            together with an executor.

    Example:
        >>> from concurrent.futures import ThreadPoolExecutor
        >>> from wrinkle_cad import Job, JobFailed
        >>> with ThreadPoolExecutor() as pool:
        ...     outcomes = run_batch([Job(input=Path("gone.step"))], executor=pool)
        >>> isinstance(outcomes[0], JobFailed)
        True
    """
    todo = tuple(jobs)
    _check_distinct(todo)
    pool = make_pool(executor=executor, workers=workers, timeout=timeout, memory=memory)
    outcomes: dict[int, JobDone | JobFailed] = {}
    stagings: dict[int, Path] = {}
    try:
        for event in run_tasks(pool, _tasks(todo, stagings, outcomes, job_function)):
            if isinstance(event, Finished):
                staging = stagings.pop(event.key)
                outcomes[event.key] = deliver(todo[event.key], staging, event.result)
        pool.close()
    finally:
        pool.kill()
        for staging in stagings.values():
            discard_staging(staging)
    return tuple(outcomes[key] for key in range(len(todo)))


def make_pool(
    *,
    executor: Executor | None,
    workers: int | None,
    timeout: float | None,
    memory: float | None,
    in_flight: int = settings.BATCH_IN_FLIGHT,
    is_forked: bool = True,
) -> Pool:
    """Makes the pool that `run_batch`'s arguments ask for.

    Raises:
        InputError: a limit is out of its range or was given together with an executor.
    """
    if executor is not None:
        for name, value in (("workers", workers), ("timeout", timeout), ("memory", memory)):
            if value is not None:
                raise InputError(
                    f"{name} cannot be {value:g} together with an executor, where it is not kept:"
                    " set it up in the executor, or leave the executor out."
                )
        return ExecutorPool(executor, in_flight)
    if sys.platform == "win32":
        raise InputError(
            "The limits of worker processes need Linux or macOS. On this system, give run_batch an"
            " executor of your own."
        )
    if workers is not None and not 1 <= workers <= _MOST_WORKERS:
        found = f"{workers}" if abs(workers) < 10**9 else "so large a number"
        raise InputError(
            f"--workers cannot be {found}: give a whole number from 1 to {_MOST_WORKERS}."
        )
    limits = WorkerLimits(
        timeout_s=settings.BATCH_TIMEOUT_S if timeout is None else timeout,
        memory_gib=settings.BATCH_MEMORY_GIB if memory is None else memory,
    )
    return WorkerPool(workers or core_count(), limits, is_forked=is_forked)


def run_tasks(pool: Pool, tasks: Iterator[tuple[int, Task] | None]) -> Iterator[Event]:
    """Keeps a pool busy until the tasks are used up; tasks are asked for as room is made.

    Args:
        pool: who does the work.
        tasks: number and task, or None for "nothing yet, ask again", so that a long search for the
            next task does not keep the pool waiting.

    Yields:
        What happens.
    """
    is_more = True
    while is_more or pool.is_busy():
        if is_more and pool.has_room():
            following = next(tasks, _END)
            if isinstance(following, _End):
                is_more = False
            elif following is not None:
                pool.give(*following)
        if pool.is_busy():
            is_idle = is_more and pool.has_room()
            yield from pool.wait(0.0 if is_idle else settings.BATCH_TICK_S)


def core_count() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _tasks(
    jobs: tuple[Job, ...],
    stagings: dict[int, Path],
    outcomes: dict[int, JobDone | JobFailed],
    job_function: JobFunction | None,
) -> Iterator[tuple[int, Task]]:
    for key, job in enumerate(jobs):
        try:
            stagings[key] = open_staging(job.output_dir)
        except OSError as error:
            message = (
                f"The output folder {job.output_dir.name} cannot be written to ({error.strerror})."
                " Give another one."
            )
            outcomes[key] = JobFailed(
                job=job, phase="write", error=type(error).__name__, message=message
            )
            continue
        aside = replace(job, input=job.input.absolute(), output_dir=stagings[key].absolute())
        yield key, Task(job=aside, job_function=job_function)


def _check_distinct(jobs: Iterable[Job]) -> None:
    seen: set[str] = set()
    for job in jobs:
        key = collision_key(PurePosixPath((job.output_dir.absolute() / job.name).as_posix()))
        if key in seen:
            raise InputError(
                f"Two jobs would write {job.name} into {job.output_dir.name}. Give them different"
                " names or folders."
            )
        seen.add(key)

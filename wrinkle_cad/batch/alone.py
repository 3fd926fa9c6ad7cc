"""One job in a process of its own: a crash of the CAD kernel, too much time or memory is a failure.

The process costs about a tenth of a second; what it saves is a program that ends without a word.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from wrinkle_cad.batch.executor import make_pool, run_tasks
from wrinkle_cad.batch.workers.pool import Finished, Phase, Pool
from wrinkle_cad.batch.workers.task import JobFunction, Task
from wrinkle_cad.errors import JobError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.job.outputs import clear_killed
from wrinkle_cad.job.phases import PhaseClock
from wrinkle_cad.job.workflow import run_job

Answer = TypeVar("Answer")


def run_alone(
    job: Job,
    *,
    timeout: float | None = None,
    memory: float | None = None,
    progress: Progress | None = None,
    job_function: JobFunction | None = None,
) -> JobDone | JobFailed:
    """Runs one job in a worker process; on Windows, which has no such limits, in this one.

    Hidden folders that killed runs left in the output folder are removed before and after.

    Args:
        job: its settings.
        timeout: seconds; 600 when None.
        memory: GiB of address space, 2 at least; 4 when None.
        progress: called with (phase, phases done, phases in all) as the job proceeds.
        job_function: what to run, importable by its name; `run_job` when None.

    Returns:
        What was made, or why nothing was: a crash, too.

    Raises:
        InputError: a limit is out of its range.
    """
    if sys.platform == "win32":
        return run_job(job, progress=progress)
    pool = _pool(timeout, memory)
    here = replace(job, input=job.input.absolute(), output_dir=job.output_dir.absolute())
    clear_killed(here.output_dir)
    try:
        outcome = _outcome_of(pool, Task(job=here, job_function=job_function), progress)
        return _as_asked(job, outcome)
    finally:
        clear_killed(here.output_dir)


def answer_alone(
    path: Path,
    question: Callable[[Path], Answer],
    *,
    timeout: float | None = None,
    memory: float | None = None,
) -> Answer:
    """Calls a function with a file's path in a worker process; on Windows in this one.

    Args:
        path: the file.
        question: the function, importable by its name, or a partial of such a one; it only reads.
        timeout: seconds; 600 when None.
        memory: GiB of address space, 2 at least; 4 when None.

    Returns:
        What the function returns.

    Raises:
        JobError: the function raised, the process crashed or met a limit; a sentence says which.
        InputError: a limit is out of its range.
    """
    if sys.platform == "win32":
        return question(path)
    pool = _pool(timeout, memory)
    # Some file names are no good names for outputs, and there are none.
    job = Job(input=path.absolute(), name="answer")
    outcome = _outcome_of(pool, Task(job=job, job_function=partial(_answered, question)), None)
    if isinstance(outcome, JobFailed):
        raise JobError(outcome.message)
    answer: Answer = outcome.summary["answer"]
    return answer


def _answered(
    question: Callable[[Path], object], job: Job, *, progress: Progress | None = None
) -> JobDone:
    from wrinkle_cad.strip.compiled import compiling_told

    clock = PhaseClock(progress, 1)
    with compiling_told(clock.tell_compiling), clock.phase("read"):
        return JobDone(job=job, outputs=(), summary={"answer": question(job.input)}, seconds={})


def _pool(timeout: float | None, memory: float | None) -> Pool:
    return make_pool(executor=None, workers=1, timeout=timeout, memory=memory, is_forked=False)


def _outcome_of(pool: Pool, task: Task, progress: Progress | None) -> JobDone | JobFailed:
    try:
        for event in run_tasks(pool, iter([(0, task)])):
            if isinstance(event, Finished):
                return event.result.outcome
            if isinstance(event, Phase) and progress is not None:
                progress(event.name, event.done, event.total)
    finally:
        pool.kill()
    raise AssertionError("a pool that is busy finishes its task")


def _as_asked(job: Job, outcome: JobDone | JobFailed) -> JobDone | JobFailed:
    """The outcome with the paths that were asked for, instead of absolute ones."""
    if isinstance(outcome, JobFailed):
        return replace(outcome, job=job)
    outputs = tuple(job.output_dir / path.name for path in outcome.outputs)
    return replace(outcome, job=job, outputs=outputs)

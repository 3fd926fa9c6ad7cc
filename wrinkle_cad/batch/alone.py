"""One job in a process of its own: a crash of the CAD kernel, too much time or memory is a failure.

The process costs about a tenth of a second; what it saves is a program that ends without a word.
"""

from __future__ import annotations

import sys
from dataclasses import replace

from wrinkle_cad.batch.executor import make_pool, run_tasks
from wrinkle_cad.batch.workers.pool import Finished, Phase
from wrinkle_cad.batch.workers.task import JobFunction, Task
from wrinkle_cad.files.staging import clear_abandoned
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.job.workflow import run_job


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
    pool = make_pool(executor=None, workers=1, timeout=timeout, memory=memory)
    here = replace(job, input=job.input.absolute(), output_dir=job.output_dir.absolute())
    clear_abandoned(here.output_dir)
    try:
        for event in run_tasks(pool, iter([(0, Task(job=here, job_function=job_function))])):
            if isinstance(event, Finished):
                return _as_asked(job, event.result.outcome)
            if isinstance(event, Phase) and progress is not None:
                progress(event.name, event.done, event.total)
    finally:
        pool.kill()
        clear_abandoned(here.output_dir)
    raise AssertionError("a pool that is busy finishes its task")


def _as_asked(job: Job, outcome: JobDone | JobFailed) -> JobDone | JobFailed:
    """The outcome with the paths that were asked for, instead of absolute ones."""
    if isinstance(outcome, JobFailed):
        return replace(outcome, job=job)
    outputs = tuple(job.output_dir / path.name for path in outcome.outputs)
    return replace(outcome, job=job, outputs=outputs)

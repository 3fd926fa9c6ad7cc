"""What a worker is given and what it gives back; runs in the worker, wherever that is."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from wrinkle_cad.batch.folder.manifest import OutputFile
from wrinkle_cad.errors import JobError
from wrinkle_cad.files.regular import hash_regular
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.report.versions import installed_versions

JobFunction = Callable[..., JobDone | JobFailed]
"""Called as ``job_function(job, progress=...)``; found by its name in a worker."""

_COMPARED_VERSIONS: Final = ("wrinkle-cad", "build123d")


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """One job for one worker."""

    job: Job
    """The settings; its output folder is an empty one that belongs to this task."""
    job_function: JobFunction | None = None
    """What to run; `run_job` when None."""
    input_bytes: bytes | None = None
    """The input's content, when the worker shares no folder with us."""
    versions: Mapping[str, str] | None = None
    """Versions that the worker must have too; anything goes when None."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskResult:
    """What came of a task."""

    outcome: JobDone | JobFailed
    """The outcome; paths in it lie in the task's output folder."""
    outputs: tuple[OutputFile, ...] = ()
    """The files written."""
    output_bytes: Mapping[str, bytes] = field(default_factory=dict)
    """Their content by name, when the input came as bytes."""


def run_task(task: Task, progress: Progress | None = None) -> TaskResult:
    """Runs a task in this process.

    Raises:
        JobError: this machine has other versions than the task wants.
        OSError: an output cannot be read back.
    """
    _check_versions(task.versions)
    if task.input_bytes is None:
        return _run_in_place(task, progress)
    with tempfile.TemporaryDirectory(prefix="wrinkle_cad-") as name:
        folder = Path(name)
        (folder / "in").mkdir()
        (folder / "out").mkdir()
        input_path = folder / "in" / task.job.input.name
        input_path.write_bytes(task.input_bytes)
        job = replace(task.job, input=input_path, output_dir=folder / "out")
        result = _run_in_place(replace(task, job=job), progress)
        content = {file.name: (folder / "out" / file.name).read_bytes() for file in result.outputs}
        return replace(result, output_bytes=content)


def _run_in_place(task: Task, progress: Progress | None) -> TaskResult:
    outcome = _function_of(task)(task.job, progress=progress)
    if isinstance(outcome, JobFailed):
        return TaskResult(outcome=outcome)
    folder = task.job.output_dir
    paths = [folder / path.name for path in outcome.outputs]
    files = tuple(OutputFile(path.name, path.stat().st_size, hash_regular(path)) for path in paths)
    return TaskResult(outcome=outcome, outputs=files)


def _function_of(task: Task) -> JobFunction:
    if task.job_function is not None:
        return task.job_function
    from wrinkle_cad.job.workflow import run_job

    return run_job


def _check_versions(wanted: Mapping[str, str] | None) -> None:
    if wanted is None:
        return
    here = installed_versions()
    for name in _COMPARED_VERSIONS:
        if here.get(name) != wanted.get(name):
            raise JobError(
                f"The worker has {name} {here.get(name)}, and the batch was started with"
                f" {wanted.get(name)}. Install the same versions everywhere."
            )

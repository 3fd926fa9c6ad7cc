"""From a worker's result to files under their final names, and the record about it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from wrinkle_cad import settings
from wrinkle_cad.batch.workers.task import TaskResult
from wrinkle_cad.errors import JobError, WrinkleError
from wrinkle_cad.files.names import error_words, printable
from wrinkle_cad.files.staging import (
    commit_staging,
    discard_staging,
    flush_files,
    move_into_place,
    release_staging,
)
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed
from wrinkle_cad.job.outputs import check_outputs_are_ours

from .manifest import Record, is_plain_name, record_to_line
from .ownership import Hashes, may_replace

_SUMS: Final = ("interior_bridges", "invalid_bridges", "inflection_bridges")
_SUMMED_MEASURES: Final = ("area_3d_mm2", "area_pattern_mm2")
_LARGEST: Final = ("max_strain_percent", "max_twist_deg", "max_fold_deg")


def deliver(
    job: Job,
    staging: Path,
    result: TaskResult,
    *,
    base: Record | None = None,
    known: Hashes | None = None,
    on_commit: Callable[[Record], None] | None = None,
) -> JobDone | JobFailed:
    """Gives the outputs of a task their final names, all together or, after a failure, none.

    Args:
        job: with the final output folder.
        staging: the folder in which the task worked; gone when this returns.
        result: what came of the task.
        base: the record to complete and keep with the files; none is kept when None.
        known: what earlier batches wrote under these names, ours to replace as long as it is that.
        on_commit: called with the complete record once the outcome is certain.

    Returns:
        The outcome, with the final paths.

    Raises:
        OSError: raised by ``on_commit``.
    """
    outcome = result.outcome
    record = base
    ready = None
    is_ours = may_replace(job.output_dir, job.name, known or {})
    if isinstance(outcome, JobDone):
        try:
            _check_names(job, result)
            kinds = tuple(file.name.removeprefix(f"{job.name}.") for file in result.outputs)
            check_outputs_are_ours(job, kinds, is_ours=is_ours)
            _unpack(staging, result.output_bytes)
            flush_files(staging, [file.name for file in result.outputs])
            record = None if base is None else _done_record(base, result, outcome)
            line = "" if record is None else record_to_line(record)
            ready = commit_staging(staging, line)
        except (OSError, WrinkleError) as error:
            outcome = _write_failure(job, outcome, error)
    if isinstance(outcome, JobFailed):
        discard_staging(staging)
        record = None if base is None else failed_record(base, outcome)
    try:
        if record is not None and on_commit is not None:
            on_commit(record)
        if ready is None or isinstance(outcome, JobFailed):
            return replace(outcome, job=job)
        return _moved(job, replace(outcome, outputs=_paths(job, result)), ready, is_ours)
    finally:
        if ready is not None:
            # What was committed and could not be moved is the next batch's to finish.
            release_staging(ready)


def _moved(
    job: Job, outcome: JobDone, ready: Path, is_ours: Callable[[Path], bool]
) -> JobDone | JobFailed:
    try:
        move_into_place(ready, is_ours)
    except OSError as error:
        discard_staging(ready)
        return _write_failure(job, outcome, error)
    return replace(outcome, job=job)


def _paths(job: Job, result: TaskResult) -> tuple[Path, ...]:
    return tuple(job.output_dir / file.name for file in result.outputs)


def failed_record(base: Record, failure: JobFailed) -> Record:
    """Completes a record with a failure."""
    return replace(
        base,
        outcome="failed",
        phase=failure.phase,
        error=failure.error,
        message=printable(failure.message),
        seconds=dict(failure.seconds),
        finished=_now(),
    )


def figures_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """The figures of a job that a table of many jobs shows, over all its strips.

    Counts and areas are summed. ``state`` is the worst, the measures are the largest, the radius is
    the smallest and ``developability``, in per cent of the rails, the least of the wrinkles; of the
    bands only where there is no wrinkle.
    """
    strips = [strip for strip in summary.get("strips", ()) if isinstance(strip, Mapping)]
    if not strips:
        return {}
    figures: dict[str, Any] = {"strips": len(strips)}
    for name in _SUMS:
        figures[name] = sum(int(strip.get(name, 0)) for strip in strips)
    for name in _SUMMED_MEASURES:
        figures[name] = math.fsum(float(strip.get(name, 0.0)) for strip in strips)
    figures["overlaps"] = any(bool(strip.get("overlaps")) for strip in strips)
    leading = [strip for strip in strips if strip.get("role") != "band"] or strips
    states = [strip.get("state", settings.STATES[0]) for strip in leading]
    figures["state"] = max(states, key=settings.STATES.index)
    for name in _LARGEST:
        figures[name] = max(float(strip.get(name, 0.0)) for strip in leading)
    creases = [crease for strip in leading for crease in strip.get("creases", ())]
    figures["max_crease_deg"] = max((float(each["angle_deg"]) for each in creases), default=0.0)
    longer = [strip.get("cut", {}).get("longer_percent", 0.0) for strip in leading]
    figures["cut_longer_percent"] = max((abs(float(each)) for each in longer), default=0.0)
    radii = [strip.get("inner_bend_radius_mm") for strip in leading]
    bent = [float(radius) for radius in radii if radius is not None]
    figures["inner_bend_radius_mm"] = min(bent) if bent else None
    shares = [float(strip.get("developable_share", 1.0)) for strip in leading]
    figures["developability"] = 100.0 * min(shares)
    figures["limits"] = len(summary.get("verdict", {}).get("limits", ()))
    outline = [(float(x), float(y)) for x, y in summary.get("outline_mm", ())]
    figures["outline"] = " ".join(f"{x:.6g},{y:.6g}" for x, y in outline)
    return figures


def _done_record(base: Record, result: TaskResult, outcome: JobDone) -> Record:
    try:
        return replace(
            base,
            outcome="done",
            outputs=result.outputs,
            figures={**base.figures, **figures_of(outcome.summary)},
            missed_limits=tuple(printable(line) for line in outcome.missed_limits),
            seconds=dict(outcome.seconds),
            finished=_now(),
        )
    except (TypeError, ValueError, LookupError, AttributeError, ArithmeticError) as error:
        # What came back from a worker may be a stranger's, and of any form.
        raise JobError(
            f"The worker's figures of {printable(base.key)} are of no known form"
            f" ({error_words(error)}). Look at who runs the workers, and at their versions."
        ) from error


def _check_names(job: Job, result: TaskResult) -> None:
    """Checks what came back from a worker, which may be a stranger's: its names lead nowhere."""
    prefix = f"{job.name}."
    names = {file.name for file in result.outputs}
    for name in (*names, *result.output_bytes):
        if not is_plain_name(name) or not name.startswith(prefix) or name not in names:
            raise JobError(
                f"A worker named an output {printable(str(name))}, and names must begin with"
                f" {printable(prefix)}. Look at who runs the workers."
            )


def _unpack(staging: Path, content: Mapping[str, bytes]) -> None:
    for name, data in content.items():
        (staging / name).write_bytes(data)


def _write_failure(job: Job, outcome: JobDone, error: Exception) -> JobFailed:
    message = str(error)
    if isinstance(error, OSError):
        message = (
            f"The outputs of {job.name} cannot be written ({error.strerror or error})."
            " See that the folder can be written and has room, and run the same command again."
        )
    return JobFailed(
        job=job,
        phase="write",
        error=type(error).__name__,
        message=message,
        seconds=outcome.seconds,
    )


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")

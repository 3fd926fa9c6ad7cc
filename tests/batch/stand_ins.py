"""Job functions that stand in for the real one: what they do is written in the input file.

The input's text is ``ACTION@PHASE``; any other text is a good job.
"""

from __future__ import annotations

import ctypes
import errno
import json
import os
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path

from wrinkle_cad.errors import CadError, ExportError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.settings import COMPILE_PHASE

PHASES = ("read", "strip", "surface", "write", "page")
KINDS = ("step", "dxf", "json", "html")
GIB = 1 << 30


def job_by_content(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Writes four files, or does in a phase what the input says."""
    action, _, moment = job.input.read_text().strip().partition("@")
    for number, phase in enumerate(PHASES):
        if progress is not None:
            progress(phase, number, len(PHASES))
        if phase == "write":
            outputs = tuple(_write(job, kind) for kind in KINDS)
        if phase == moment:
            failure = _act(action, job, phase)
            if failure is not None:
                return failure
    return JobDone(
        job=job,
        outputs=outputs,
        summary={"strips": [{"name": job.name, "interior_bridges": 20, "invalid_bridges": 5}]},
        seconds=dict.fromkeys(PHASES, 0.01),
    )


def compiling_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Takes long to compile, then as long as its input says."""
    assert progress is not None
    progress("strip", 0, 1)
    progress(COMPILE_PHASE, 0, 1)
    time.sleep(3.5)
    progress("strip", 0, 1)
    time.sleep(float(job.input.read_text()))
    return JobDone(job=job, outputs=(), summary={}, seconds={})


def slow_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Takes 30 ms, half of it between its files."""
    time.sleep(0.015)
    outputs = []
    for kind in KINDS:
        outputs.append(_write(job, kind))
        time.sleep(0.004)
    return JobDone(job=job, outputs=tuple(outputs), summary={}, seconds={"write": 0.03})


def talkative_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Prints on both streams, as Python and as the kernel does."""
    sys.stdout.write("python on stdout\n")
    sys.stdout.flush()
    os.write(1, b"kernel on stdout\n" * 5000)
    os.write(2, b"kernel on stderr\n" * 20000)
    ctypes.CDLL(None).puts(b"C library on stdout")
    return job_by_content(job, progress=progress)


def worker_id_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Writes down which process it ran in, and that process's settings."""
    path = job.output_dir / f"{job.name}.json"
    threads = {name: os.environ.get(name) for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS")}
    path.write_text(json.dumps({"pid": os.getpid(), "threads": threads}))
    return JobDone(job=job, outputs=(path,), summary={}, seconds={})


def limits_missed_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Is done and misses a limit."""
    outcome = job_by_content(job, progress=progress)
    assert isinstance(outcome, JobDone)
    return replace(outcome, missed_limits=("fold - 9 deg - 8 deg",))


def stranger_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Writes its files and tells the figures that the input names, in forms of its own."""
    outcome = job_by_content(job, progress=progress)
    assert isinstance(outcome, JobDone)
    strips: dict[str, object] = {
        "number": 5,
        "words": [{"interior_bridges": "many"}],
        "state": [{"state": "splendid"}],
        "creases": [{"creases": [{}]}],
        "shares": [{"developable_share": None}],
    }
    return replace(outcome, summary={"strips": strips[job.input.read_text()]})


def _write(job: Job, kind: str) -> Path:
    path = job.output_dir / f"{job.name}.{kind}"
    path.write_text(f"{kind} of {job.input.name}: {job.input.read_text()} END\n" * 50)
    return path


def _act(action: str, job: Job, phase: str) -> JobFailed | None:
    if action == "fail":
        return JobFailed(
            job=job, phase=phase, error="InputError", message="There are no curves. Draw two."
        )
    if action == "hang":
        time.sleep(3600)
    if action == "hold":
        # Holds the interpreter's lock, as a kernel that hangs does.
        ctypes.PyDLL(None).sleep(3600)
    if action == "raise":
        raise ZeroDivisionError("one\ntwo")
    if action == "cad":
        raise CadError("sew", "left open")
    if action == "memory":
        import numpy as np

        np.ones(64 * GIB, dtype=np.uint8)
    if action == "creep":
        _creep(lambda: os.kill(os.getpid(), signal.SIGABRT))
    if action == "refused":
        return JobFailed(job=job, phase=phase, error="MemoryError", message="out of memory")
    if action == "full":
        raise ExportError(job.output_dir / "x", "STEP", os.strerror(errno.ENOSPC))
    if action == "leave":
        os._exit(0)
    if action == "quit":
        sys.exit(3)
    if action in signal.Signals.__members__:
        os.kill(os.getpid(), signal.Signals[action])
        time.sleep(60)
    return None


def _creep(end: object) -> None:
    """Takes memory in pieces until there is none, then crashes as the kernel does."""
    import numpy as np

    pieces = []
    while True:
        try:
            pieces.append(np.empty(GIB // 16, dtype=np.uint8))
        except MemoryError:
            time.sleep(0.2)
            end()  # type: ignore[operator]
        time.sleep(0.002)

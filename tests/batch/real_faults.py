"""The real job with a fault in one of its phases; the input's name says which: FAULT-MOMENT."""

from __future__ import annotations

import os
import resource
import signal

import numpy as np

from wrinkle_cad.errors import CadError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed
from wrinkle_cad.job.workflow import run_job


def faulty_job(job: Job, *, progress: object = None) -> JobDone | JobFailed:
    """Runs the real job; ``room-N`` lets no file written grow beyond N bytes."""
    fault, _, moment = job.input.stem.partition("-")
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

    def act(phase: str, done: int, total: int) -> None:
        if fault == "room" and phase == "write":
            resource.setrlimit(resource.RLIMIT_FSIZE, (int(moment), resource.RLIM_INFINITY))
        if phase != moment:
            return
        if fault == "cad":
            raise CadError("do it", phase)
        if fault == "memory":
            np.ones(1 << 40)
        if fault in signal.Signals.__members__:
            os.kill(os.getpid(), signal.Signals[fault])

    try:
        return run_job(job, progress=act)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))

"""Why a worker ended before its job did: which signal, which limit, in one line."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobFailed

from .worker import WorkerFault

GIB: Final = 1 << 30
_TIMEOUTS_S: Final = (0.1, 1e7)
"""s; the shortest and the longest time that a file may be given: 16 weeks."""
_LARGEST_MEMORY_GIB: Final = 1e6
"""GiB; more than any machine has, and still a number of bytes that systems take."""
_READING: Final = "read"
"""The phase in which only the reader works on the file."""
_CRASHES: Final = tuple(
    -number
    for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
)
"""Exit codes of a program that its own fault ended; other signals come from somebody else."""
_MEMORY_SIGNALS: Final = (signal.SIGSEGV, signal.SIGABRT)
MEMORY_ERRORS: Final = ("MemoryError", "_ArrayMemoryError")
"""Names of the errors that Python and numpy raise when they are refused memory."""


@dataclass(frozen=True, slots=True)
class WorkerLimits:
    """Limits of one job; None is no limit."""

    timeout_s: float | None = settings.BATCH_TIMEOUT_S
    """Seconds from when a worker is given the job."""
    memory_gib: float | None = settings.BATCH_MEMORY_GIB
    """GiB of address space of the worker."""

    def __post_init__(self) -> None:
        """Checks the limits.

        Raises:
            InputError: one is out of its range.
        """
        shortest, longest = _TIMEOUTS_S
        if self.timeout_s is not None and not shortest <= self.timeout_s <= longest:
            raise InputError(
                f"--timeout cannot be {self.timeout_s:g} s: give {shortest:g} to {longest:.0f} s."
            )
        least, most = settings.BATCH_LEAST_MEMORY_GIB, _LARGEST_MEMORY_GIB
        if self.memory_gib is not None and not least <= self.memory_gib <= most:
            raise InputError(
                f"--memory cannot be {self.memory_gib:g} GiB: give {least:g} to {most:.0f} GiB. The"
                " CAD kernel needs more than half of the least before it reads a file."
            )

    @property
    def memory_bytes(self) -> int | None:
        """The memory limit in bytes."""
        return None if self.memory_gib is None else int(self.memory_gib * GIB)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How a worker ended."""

    exit_code: int | None
    """As `multiprocessing` tells it: negative for a signal."""
    is_late: bool
    """Whether it was killed because its time was up."""
    phase: str
    """The phase that its job had reached."""
    fault: WorkerFault | None
    """The exception that ended it."""
    peak_bytes: int
    """Most address space that it was seen to have."""
    seconds: float
    """How long it had the job."""
    stderr: str
    """The end of what it wrote to stderr."""


def failure_of(job: Job, ending: Ending, limits: WorkerLimits) -> JobFailed:
    """Names the signal or the limit that ended a worker."""
    error, message = _cause(ending, limits)
    return JobFailed(
        job=job,
        phase=(ending.phase or "worker") if error == _raised_name(ending) else "worker",
        error=error,
        message=message,
        seconds={"total": ending.seconds},
        trace=ending.stderr,
    )


def _cause(ending: Ending, limits: WorkerLimits) -> tuple[str, str]:
    where = f" in phase {ending.phase}" if ending.phase else " before the first phase"
    if ending.is_late:
        return "TimeLimit", (
            f"The time was up{where}: {ending.seconds:.1f} s, the limit is {limits.timeout_s:g} s."
            " Give more with --timeout or a coarser --tolerance."
        )
    if _hit_memory(ending, limits):
        peak = max(ending.peak_bytes, ending.fault.peak_bytes if ending.fault else 0)
        return "MemoryLimit", (
            f"The memory was used up{where}: {peak / GIB:.2f} GiB were mapped when more was asked"
            f" for ({_manner(ending)}), the limit is {limits.memory_gib or 0:g} GiB. Give more with"
            " --memory or a coarser --tolerance."
        )
    if ending.fault is not None:
        text = printable(" ".join(ending.fault.message.split())) or "no message"
        if ending.fault.is_expected:
            return ending.fault.error, text
        return ending.fault.error, (
            f"An internal error happened{where} ({ending.fault.error}: {text}). Please report it"
            " with the file."
        )
    if ending.phase == _READING and ending.exit_code in _CRASHES:
        return "WorkerKilled", (
            f"The worker was ended{where} by {_manner(ending)}: the file is damaged in a way that"
            " its reader does not survive. Export it again."
        )
    return "WorkerKilled", (
        f"The worker was ended{where} by {_manner(ending)}. Try the file alone with run, and with"
        " another --tolerance; export it again if inspect fails on it, too."
    )


def _hit_memory(ending: Ending, limits: WorkerLimits) -> bool:
    if limits.memory_bytes is None:
        return False
    if _raised_name(ending) in MEMORY_ERRORS:
        # With a limit set, Python is refused memory by nothing else.
        return True
    is_memory_signal = ending.exit_code is not None and -ending.exit_code in _MEMORY_SIGNALS
    return is_memory_signal and ending.peak_bytes > settings.BATCH_MEMORY_HIT * limits.memory_bytes


def _raised_name(ending: Ending) -> str:
    return "" if ending.fault is None else ending.fault.error


def _manner(ending: Ending) -> str:
    if ending.fault is not None:
        return ending.fault.error
    code = ending.exit_code
    if code is None or code >= 0:
        return f"leaving with exit code {code}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    if name == "SIGKILL":
        return "SIGKILL (somebody, or the system being out of memory)"
    return name

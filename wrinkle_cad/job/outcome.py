"""What a job ends as: done or failed, both plain values that can be pickled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wrinkle_cad.errors import Finding

from .job import Job

Progress = Callable[[str, int, int], None]
"""Called with the phase's name, how many of its parts are done and how many there are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JobDone:
    """A job whose outputs are all written.

    Example:
        >>> from wrinkle_cad import Job, Part, run_job, write_step
        >>> from build123d import Edge
        >>> p, q = Edge.make_line((0, 0), (90, 0)), Edge.make_line((0, 20), (90, 30))
        >>> write_step(Path("lace.step"), [Part(p.wrapped, "P"), Part(q.wrapped, "Q")])
        >>> done = run_job(Job(input=Path("lace.step")))
        >>> done.summary["strips"][0]["state"], done.missed_limits
        ('developable', ())
    """

    job: Job
    """The settings that were used."""
    outputs: tuple[Path, ...]
    """The files written, in the order STEP, STL, DXF, JSON, HTML, others."""
    summary: Mapping[str, Any]
    """What NAME.json holds."""
    findings: tuple[Finding, ...] = ()
    """What was noticed on the way."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall-clock seconds by phase."""
    missed_limits: tuple[str, ...] = ()
    """One line for each limit that the result misses; the outputs are written all the same."""

    def __repr__(self) -> str:
        names = ", ".join(path.name for path in self.outputs)
        return f"JobDone({self.job.name!r}: {names})"


@dataclass(frozen=True, slots=True, kw_only=True)
class JobFailed:
    """A job that wrote nothing.

    Example:
        >>> from wrinkle_cad import run_job
        >>> failed = run_job(Job(input=Path("gone.step")))
        >>> failed.phase, failed.error
        ('read', 'InputError')
    """

    job: Job
    """The settings that were used."""
    phase: str
    """The phase in which it failed: "read", "strip", "surface", "pattern", "judge", "write" or
    "page"."""
    error: str
    """Name of the error's class."""
    message: str
    """One line: what is wrong, what was found with its unit, what is allowed, what to do."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall-clock seconds by phase."""
    trace: str = ""
    """The traceback, for a log or --debug."""

    def __repr__(self) -> str:
        return f"JobFailed({self.job.name!r} in phase {self.phase!r}: {self.message[:80]})"

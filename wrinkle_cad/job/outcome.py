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
    """A job whose outputs are all written."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class JobFailed:
    """A job that wrote nothing."""

    job: Job
    """The settings that were used."""
    phase: str
    """The phase in which it failed ("read", "sample", "search", "surface", "write", ...)."""
    error: str
    """Name of the error's class."""
    message: str
    """One line: what is wrong, what was found with its unit, what is allowed, what to do."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall-clock seconds by phase."""
    trace: str = ""
    """The traceback, for a log or --debug."""

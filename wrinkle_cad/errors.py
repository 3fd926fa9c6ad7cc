"""Every error class of the package, and ``Finding`` for what does not stop a job.

A message is one line of sentences that a newcomer understands: what is wrong, what was found (with
its unit), what is allowed, what to do.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Severity = Literal["info", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Finding:
    """What a step noticed without stopping: it goes into the result, not to the screen."""

    code: str
    """Short kebab-case key, stable between versions ("rails-turned-alike")."""
    severity: Severity
    """``info``, ``warning`` or ``error``."""
    message: str
    """One line: what is wrong, what was found with its unit, what is allowed, what to do."""


class WrinkleError(Exception):
    """Base of every error that this package raises on purpose."""


class WrinkleWarning(UserWarning):
    """Something about a strip is unsure; it says what its findings say, once for each strip."""


class InputError(WrinkleError, ValueError):
    """Something handed in cannot be used: a curve, an array, a file, an option."""


class JobError(InputError):
    """The settings of a job contradict each other or do not fit the input file."""


class CadError(WrinkleError):
    """The CAD kernel could not do a step.

    Args:
        step: what was being done, in words a user knows ("sew the strip to the body").
        message: what was found, what is allowed, what to do; it goes on from a colon.
    """

    def __init__(self, step: str, message: str) -> None:
        super().__init__(f"Cannot {step}: {message}")
        self.step = step
        self.message = message

    def __reduce__(self) -> tuple[type[CadError], tuple[str, str]]:
        return type(self), (self.step, self.message)


class ExportError(WrinkleError):
    """A file could not be written; what stood there before is untouched.

    Args:
        path: the file that was to be written.
        format: its format ("STEP", "STL", "DXF", ...).
        message: what was found, what to do; it goes on from a colon.
    """

    def __init__(self, path: Path, format: str, message: str) -> None:  # noqa: A002 - the field's word
        super().__init__(f"Cannot write {format} {path.name}: {message}")
        self.path = path
        self.format = format
        self.message = message

    def __reduce__(self) -> tuple[type[ExportError], tuple[Path, str, str]]:
        return type(self), (self.path, self.format, self.message)

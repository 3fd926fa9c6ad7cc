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
    """What a step noticed without stopping: it goes into the result, not to the screen.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> WrinkleStrip(p, q[::-1]).findings[0].code
        'rails-turned-alike'
    """

    code: str
    """Short kebab-case key, stable between versions ("rails-turned-alike")."""
    severity: Severity
    """``info``, ``warning`` or ``error``."""
    message: str
    """One line: what is wrong, what was found with its unit, what is allowed, what to do."""


class WrinkleError(Exception):
    """Base of every error that this package raises on purpose.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> try:
        ...     WrinkleStrip([[0, 0, 0]], [[0, 1, 0], [9, 1, 0]], tolerance=-1)
        ... except WrinkleError as error:
        ...     print(error)
        tolerance cannot be -1 mm: give a number from 1e-09 to 1000 mm.
    """


class WrinkleWarning(UserWarning):
    """Something about a strip is unsure; it says what its findings say, once for each strip.

    Example:
        >>> import warnings
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> with warnings.catch_warnings(record=True) as caught:
        ...     warnings.simplefilter("always", WrinkleWarning)
        ...     strip = WrinkleStrip(p, q[::-1])
        >>> any(warning.category is WrinkleWarning for warning in caught)
        True
    """


class InputError(WrinkleError, ValueError):
    """Something handed in cannot be used: a curve, an array, a file, an option.

    Example:
        >>> issubclass(InputError, ValueError)
        True
    """


class ConstraintError(InputError):
    """No strip between two rails keeps what was asked of its rulings.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> try:
        ...     WrinkleStrip(p, q, max_ruling=20)
        ... except ConstraintError as error:
        ...     print(str(error)[:69])
        No strip between these rails keeps max_ruling of 20 mm: the longest r
    """


class JobError(InputError):
    """The settings of a job contradict each other or do not fit the input file.

    Example:
        >>> from pathlib import Path
        >>> from wrinkle_cad import Job
        >>> Job(input=Path("shoe.step"), tolerance=0)
        Traceback (most recent call last):
        wrinkle_cad.errors.JobError: tolerance cannot be 0 mm: give a number from 1e-09 to 1000 mm.
    """


class CadError(WrinkleError):
    """The CAD kernel could not do a step.

    Args:
        step: what was being done, in words a user knows ("sew the strip to the body").
        message: what was found, what is allowed, what to do; it goes on from a colon.

    Example:
        >>> error = CadError("sew the strip to the body", "they are 3 mm apart. Move the rails.")
        >>> str(error)
        'Cannot sew the strip to the body: they are 3 mm apart. Move the rails.'
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

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> try:
        ...     WrinkleStrip(p, q).export_stl("no such folder/tent.stl")
        ... except ExportError as error:
        ...     print(error.path.name, error.format)
        tent.stl STL
    """

    def __init__(self, path: Path, format: str, message: str) -> None:  # noqa: A002 - the field's word
        super().__init__(f"Cannot write {format} {path.name}: {message}")
        self.path = path
        self.format = format
        self.message = message

    def __reduce__(self) -> tuple[type[ExportError], tuple[Path, str, str]]:
        return type(self), (self.path, self.format, self.message)

"""One job: the frozen settings of one run, from keywords, a TOML file or both.

Precedence: keywords (the command line's flags) over the TOML file over the defaults.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final

from . import settings
from .errors import JobError

_PATH_FIELDS: Final = ("input", "output_dir", "material")
_CHOICES: Final[dict[str, tuple[str, ...]]] = {
    "surface": ("cones", "facets"),
    "search": ("global", "local"),
    "energy": ("hinge", "paper"),
    "step_schema": ("AP214", "AP242"),
    "unit": ("mm", "cm", "m", "inch", "ft"),
}
_POSITIVE: Final = ("tolerance", "max_chord", "planarity", "waves", "max_fold_deg")
_NOT_NEGATIVE: Final = ("height", "margin", "max_twist_deg", "max_invalid_percent")
_NAME_LIMIT: Final = 200
_EPOCH_LIMIT: Final = 253_402_300_800
"""The year 10000, which no date format of the outputs can hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """The settings of one run; lengths in mm unless a name says otherwise."""

    input: Path
    """The STEP, IGES or BREP file to read."""
    output_dir: Path = Path("out")
    """Folder that receives the outputs; made when it is missing."""
    name: str = ""
    """Stem of the outputs; the input's stem when empty."""
    p: str | None = None
    """Directrix P: its name in the file or its index as ``inspect`` prints it."""
    q: str | None = None
    """Directrix Q, likewise."""
    upper: str | None = None
    """The upper surface, likewise."""
    unit: str | None = None
    """Unit of a file that states none."""
    tolerance: float = settings.TOLERANCE
    """How far a chord may lie from its curve."""
    max_chord: float | None = None
    """Longest chord; unlimited when None."""
    planarity: float | None = None
    """How far a neighbour may lie on the wrong side of a tangent plane; derived when None."""
    surface: str = settings.SURFACE
    """``cones`` (banks are the exact curves) or ``facets``."""
    criteria: tuple[str, ...] = settings.CRITERIA
    """What the search minimises, most important first."""
    search: str = settings.SEARCH
    """``global`` or ``local``."""
    energy: str = settings.ENERGY
    """``hinge`` or ``paper``."""
    step_schema: str = settings.STEP_SCHEMA
    """``AP214`` or ``AP242``."""
    rulings: bool = False
    """Whether the pattern shows the rulings as a layer of their own."""
    source_date_epoch: int | None = None
    """Seconds since 1970 (UTC) that stand as the time in every output; now when None."""

    def __post_init__(self) -> None:
        """Checks every setting by itself.

        Raises:
            JobError: a setting is out of its range; the message names it.
        """
        for field in _PATH_FIELDS:
            if getattr(self, field, None) is not None:
                object.__setattr__(self, field, Path(getattr(self, field)))
        object.__setattr__(self, "criteria", tuple(self.criteria))
        object.__setattr__(self, "name", self.name or _stem_of(self.input))
        _check_name(self.name)
        for field, choices in _CHOICES.items():
            value = getattr(self, field)
            if value is not None and value not in choices:
                raise JobError(f"{field} - {value!r} - one of {', '.join(choices)}")
        for field in (*_POSITIVE, *_NOT_NEGATIVE):
            _check_number(field, getattr(self, field, None), may_be_zero=field in _NOT_NEGATIVE)
        epoch = self.source_date_epoch
        if epoch is not None and not 0 <= epoch < _EPOCH_LIMIT:
            raise JobError(f"source_date_epoch - {epoch} s - 0 to {_EPOCH_LIMIT - 1} - correct it")


def make_job(
    input_path: Path, keywords: Mapping[str, Any] | None = None, toml_path: Path | None = None
) -> Job:
    """Joins keywords, a TOML file and the defaults into a job.

    Args:
        input_path: the file to read.
        keywords: settings by name; a None counts as not given.
        toml_path: a ``job.toml`` whose keys are the names of the settings.

    Raises:
        JobError: the TOML file cannot be read, or a setting is unknown or out of range.
    """
    merged = read_job_toml(toml_path) if toml_path is not None else {}
    merged.update({key: value for key, value in (keywords or {}).items() if value is not None})
    merged.pop("input", None)
    _check_known(merged, "settings")
    return Job(input=input_path, **merged)


def read_job_toml(path: Path) -> dict[str, Any]:
    """Reads the settings of a ``job.toml``; relative paths in it start at its folder.

    Raises:
        JobError: not TOML, an unknown key or a value of the wrong type.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise JobError(
            f"{path.name} - cannot be read as TOML: {error} - correct the file"
        ) from error
    _check_known(table, path.name)
    for field in _PATH_FIELDS:
        if field in table:
            table[field] = path.parent / str(table[field])
    return table


def _check_known(table: Mapping[str, Any], source: str) -> None:
    known = {field.name for field in fields(Job)}
    for key in table:
        if key not in known:
            raise JobError(
                f"{source} - unknown setting {key!r} - known: {', '.join(sorted(known))}"
            )


def _stem_of(path: Path) -> str:
    stem = path.name
    for suffix in (".gz", ".step", ".stp", ".p21", ".iges", ".igs", ".brep", ".brp"):
        if stem.lower().endswith(suffix) and len(stem) > len(suffix):
            stem = stem[: -len(suffix)]
    return stem


def _check_name(name: str) -> None:
    if name in ("", ".", "..") or any(c in "/\\:\0" or ord(c) < 32 for c in name):
        raise JobError(
            f"name - {name!r} - the stem of a file, without folders or control characters"
        )
    if len(name.encode()) > _NAME_LIMIT:
        raise JobError(
            f"name - {len(name.encode())} bytes - at most {_NAME_LIMIT} - give a shorter --name"
        )


def _check_number(field: str, value: Any, *, may_be_zero: bool) -> None:
    if value is None:
        return
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise JobError(f"{field} - {value!r} - a finite number")
    if value < 0 or (value == 0 and not may_be_zero):
        raise JobError(f"{field} - {value:g} - {'at least' if may_be_zero else 'above'} 0")

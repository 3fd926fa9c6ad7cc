"""One job: the frozen settings of one run, from keywords, a TOML file or both.

Precedence: keywords (the command line's flags) over the TOML file over the defaults. The settings
themselves stand in the classes that ``Job`` joins, one place for each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.cad.upper.options import WaveSettings, check_waves
from wrinkle_cad.errors import InputError, JobError
from wrinkle_cad.files.names import split_name
from wrinkle_cad.files.toml import read_toml
from wrinkle_cad.options.checking import check_known, check_options
from wrinkle_cad.options.option import option, options_of
from wrinkle_cad.options.signature import knows_its_options
from wrinkle_cad.pattern.piece.options import PieceOptions, check_piece
from wrinkle_cad.wrinkle.options import StripSettings

from .options import FileSettings, JudgingSettings, ShapeSettings

_NAME_LIMIT: Final = 200
_LATEST_EPOCH: Final = 253_402_300_799
"""The last second of the year 9999; no date format of the outputs can hold a later one."""


@dataclass(frozen=True, kw_only=True)
class Job(
    ShapeSettings,
    StripSettings,
    WaveSettings,
    PieceOptions,
    FileSettings,
    JudgingSettings,
):
    """The settings of one run; lengths in mm unless a name says otherwise.

    Inherits the settings of all that a run does, so that every option is one keyword, one attribute
    and one key of a job file, and is stated in one class only.

    Example:
        >>> job = Job(input=Path("shoe.step"), waves=5, height=(2, 3), seam_allowance=6)
        >>> job.name, job.waves, job.seam_allowance
        ('shoe', (5.0, 5.0), (6.0, 6.0, 6.0, 6.0))
    """

    input: Path = field(metadata=option("STEP, IGES or BREP file", flag=None))
    output_dir: Path = field(
        default=Path("out"),
        metadata=option("folder for the outputs, made when it is missing", flag=None),
    )
    name: str = field(
        default="", metadata=option("stem of the outputs; the input's when empty", flag=None)
    )
    source_date_epoch: int | None = field(
        default=None,
        metadata=option(
            "seconds since 1970 (UTC) that stand as the time in every output",
            unit="s",
            least=0,
            most=_LATEST_EPOCH,
            when_none="now",
            flag=None,
        ),
    )

    def __post_init__(self) -> None:
        """Checks every setting by itself.

        Raises:
            JobError: a setting is out of its range; the message names it.
        """
        check_options(self, JobError)
        object.__setattr__(self, "name", self.name or _stem_of(self.input))
        _check_name(self.name)
        check_waves(self, JobError)
        check_piece(self, JobError)


setattr(Job, "__init__", knows_its_options(Job.__init__, "Job"))  # noqa: B010 - mypy's wish


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

    Example:
        >>> _ = Path("job.toml").write_text("tolerance = 0.1")
        >>> make_job(Path("shoe.step"), {"max_fold_deg": 45}, Path("job.toml")).tolerance
        0.1
    """
    merged = read_job_toml(toml_path) if toml_path is not None else {}
    merged.update({key: value for key, value in (keywords or {}).items() if value is not None})
    merged.pop("input", None)
    _check_known(merged, "a job")
    return Job(input=input_path, **merged)


def read_job_toml(path: Path) -> dict[str, Any]:
    """Reads the settings of a ``job.toml``; relative paths in it start at its folder.

    Raises:
        JobError: not TOML, or an unknown key.
    """
    try:
        table = read_toml(path)
    except InputError as error:
        raise JobError(str(error)) from error
    _check_known(table, path.name)
    for name, value in table.items():
        setting = options_of(Job)[name]
        if isinstance(value, str) and setting.is_path(value):
            inside = path.parent / value
            table[name] = inside if setting.kind.base is Path else str(inside)
    return table


def _check_known(table: Mapping[str, Any], source: str) -> None:
    check_known(table, (setting.name for setting in fields(Job)), source, JobError)


def _stem_of(path: Path) -> str:
    return split_name(path.name)[0]


def _check_name(name: str) -> None:
    if name in ("", ".", "..") or any(c in "/\\:\0" or ord(c) < 32 for c in name):
        raise JobError(
            f"name cannot be {name!r}: give the stem of a file, without folders, colons or control"
            " characters."
        )
    if len(name.encode()) > _NAME_LIMIT:
        raise JobError(
            f"name is {len(name.encode())} bytes long, and at most {_NAME_LIMIT} are allowed:"
            " give a shorter --name."
        )

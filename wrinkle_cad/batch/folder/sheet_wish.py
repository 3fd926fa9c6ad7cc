"""What a file of a batch wants of the sheets on which its pieces are nested with all others."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from wrinkle_cad import settings
from wrinkle_cad.files.regular import hash_regular
from wrinkle_cad.job.job import Job
from wrinkle_cad.options.option import options_of


@dataclass(frozen=True, slots=True)
class SheetWish:
    """Pieces come on one sheet when these are equal."""

    size: tuple[float, float]
    """Mm, length along the grain and width."""
    seconds: int
    """S of a further search."""
    profile: str
    """Of the DXF."""
    version: settings.DxfVersion | None
    """Of the DXF."""
    curves: settings.Curves
    """What cut lines are written as."""
    material: str | None
    """As the settings name it."""
    thickness: float | None
    """Mm, where it is not the material's."""
    epoch: int | None
    """S since 1970 that stand as the time in the file, now when None."""

    def to_hash(self) -> dict[str, Any]:
        """The wish as plain values, files by their content.

        Raises:
            OSError: such a file cannot be read.
        """
        values: dict[str, Any] = asdict(self)
        options = options_of(Job)
        for name in ("profile", "material"):
            if values[name] is not None and options[name].is_path(values[name]):
                values[name] = hash_regular(Path(values[name]))
        return values


def wish_of(job: Job) -> SheetWish | None:
    """What a job wants of the sheets, None if it wants none."""
    if job.sheet is None:
        return None
    return SheetWish(
        size=job.sheet,
        seconds=job.nest_seconds,
        profile=job.profile,
        version=job.dxf_version,
        curves=job.curves,
        material=job.material,
        thickness=job.thickness,
        epoch=job.source_date_epoch,
    )


def job_without_sheets(job: Job) -> Job:
    """The job as its worker does it: it keeps its pieces where sheets are made of them later."""
    if job.sheet is None:
        return job
    return replace(job, sheet=None, nest_seconds=settings.NESTING_SECONDS, pieces_file=True)


def text_of(wish: dict[str, Any]) -> str:
    """Plain values as one text, the same for the same values."""
    return json.dumps(wish, sort_keys=True, ensure_ascii=True)

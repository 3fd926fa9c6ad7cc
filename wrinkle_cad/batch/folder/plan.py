"""What a batch is going to do: for each input its settings, its outputs' names, or why not."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, Final, NamedTuple

from wrinkle_cad import settings
from wrinkle_cad.errors import JobError
from wrinkle_cad.files.names import (
    apply_mask,
    check_mask,
    collision_key,
    printable,
    safe_folder,
    safe_name,
    split_name,
)
from wrinkle_cad.files.regular import STALL_S, within
from wrinkle_cad.job.job import Job, make_job, read_job_toml

from .index_page import PAGE_NAME
from .inputs import FoundFile
from .sheet_wish import SheetWish, job_without_sheets, wish_of

SHEETS_NAME: Final = "batch.sheets"
"""Stem of the sheets on which the pieces of all files are nested."""
FOLDER_TOML: Final = "job.toml"
FILE_TOML: Final = ".job.toml"

_SHEETS: Final = f"{SHEETS_NAME}."


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedJob:
    """One input of a batch and what will be done with it."""

    source: FoundFile
    """The input."""
    key: str
    """Folder and stem of its outputs below the batch's folder; unique among those that run."""
    job: Job
    """The settings; the defaults where the input's own settings cannot be used."""
    sheet: SheetWish | None = None
    """What it wants of the sheets that are made of all files' pieces."""
    refusal: str = ""
    """Why it cannot be done, on one line; empty when it can."""


class _Layers(NamedTuple):
    """Settings of the whole batch: below and above those of a file."""

    common: dict[str, Any]
    flags: dict[str, Any]


def plan_batch(
    sources: Sequence[FoundFile],
    output_dir: Path,
    *,
    keywords: Mapping[str, Any] | None = None,
    mask: str | None = None,
    common: Mapping[str, Any] | None = None,
) -> tuple[PlannedJob, ...]:
    """Plans a batch; a file that cannot be done is planned with the reason.

    The keywords go before a file's own settings, and those before the common ones. A file's own
    settings are those in ``STEM.job.toml`` beside it, then those in ``job.toml`` in its folder
    (unless that names another file as its ``input``). The folder of the
    outputs is always the batch's. Of files whose outputs would have the same name, in the order
    given, only the first is done; one that has the name from its own settings comes after others.

    Args:
        sources: the inputs.
        output_dir: the batch's folder.
        keywords: settings for every file; a None counts as not given.
        mask: names of the outputs, as `check_mask` takes it; ``name`` in a file's own settings
            goes before the default mask but not before this one.
        common: settings as `read_job_toml` gives them.

    Raises:
        JobError: the mask is broken.
    """
    if mask is not None:
        check_mask(mask)
    taken: dict[str, FoundFile] = {}
    flags = {key: value for key, value in (keywords or {}).items() if value is not None}
    layers = _Layers(_without_paths(common or {}), flags)
    numbered = list(enumerate(sources, start=1))
    found = [_plan_one(source, number, output_dir, layers, mask) for number, source in numbered]
    planned = [entry for entry, _ in found]
    # A name that a file's settings choose yields to the file that is called so.
    for key in sorted(range(len(found)), key=lambda key: found[key][1]):
        entry = planned[key]
        first = taken.setdefault(collision_key(PurePosixPath(entry.key)), entry.source)
        if first is not entry.source and not entry.refusal:
            refusal = (
                f"The outputs of {first.label} would be called {entry.key} too, and each file"
                ' needs a name of its own: give --name "{stem}-{suffix}" or "{folder}-{stem}".'
            )
            planned[key] = replace(entry, sheet=None, refusal=refusal)
    return tuple(planned)


def _plan_one(
    source: FoundFile, number: int, output_dir: Path, layers: _Layers, mask: str | None
) -> tuple[PlannedJob, bool]:
    """The plan of a file, and whether its own settings choose the name of its outputs."""
    stem, suffix = split_name(source.path.name)
    fill = partial(apply_mask, stem=stem, suffix=suffix, folder=source.folder, number=number)
    folder = safe_folder(source.folder)
    target = output_dir / folder
    called = default_name = fill(mask or settings.BATCH_NAME_MASK)
    refusal = _unreadable_name(source)
    try:
        # On a share that is gone even the question whether a file is there stalls.
        found = within(STALL_S, lambda _: _own_settings(source, stem), "the search for settings")
        own = {**layers.common, **found}
        if mask is None and "name" in own:
            default_name = safe_name(_text(own, "name"))
        merged = {**own, **layers.flags, "name": default_name, "output_dir": target}
        job = make_job(source.path, merged)
    except Exception as error:
        # Settings are a stranger's, of any form: whatever they raise is one file's trouble.
        refusal = refusal or _line_of(error, source)
        job = Job(input=source.path, name=default_name, output_dir=target)
    if not refusal and folder == PurePosixPath() and default_name == Path(PAGE_NAME).stem:
        refusal = (
            f"The outputs would be called {default_name}, and {PAGE_NAME} is the batch's own page."
            ' Give another name, for example with --name "{stem}-{suffix}".'
        )
    if not refusal and folder == PurePosixPath() and f"{default_name}.".startswith(_SHEETS):
        refusal = (
            f"The outputs would be called {default_name}, and a batch's sheets have such names."
            ' Give another name, for example with --name "{stem}-{suffix}".'
        )
    if not refusal and not target.resolve().is_relative_to(output_dir.resolve()):
        refusal = (
            f"The output folder {folder} is a link that leads out of {output_dir.name}, and"
            " outputs stay inside. Remove the link."
        )
    key = (folder / default_name).as_posix()
    if refusal:
        return PlannedJob(source=source, key=key, job=job, refusal=refusal), default_name != called
    entry = PlannedJob(source=source, key=key, job=job_without_sheets(job), sheet=wish_of(job))
    return entry, default_name != called


def _line_of(error: Exception, source: FoundFile) -> str:
    """Why settings cannot be used: our own sentence, or what no code foresaw in one line."""
    if isinstance(error, JobError):
        return str(error)
    said = printable(" ".join(str(error).split())[:200]) or "no message"
    return (
        f"The settings of {source.label} cannot be used ({type(error).__name__}: {said})."
        f" Look at {FOLDER_TOML} and {FILE_TOML} beside it."
    )


def _unreadable_name(source: FoundFile) -> str:
    """Why outputs could not mention the input, or nothing when they can."""
    try:
        str(source.path).encode("utf-8")
    except UnicodeEncodeError:
        return (
            f"The path of {source.label} has bytes that are not UTF-8, and outputs name their"
            " input. Rename it."
        )
    return ""


def _own_settings(source: FoundFile, stem: str) -> dict[str, Any]:
    own: dict[str, Any] = {}
    for path in (source.path.parent / FOLDER_TOML, source.path.parent / (stem + FILE_TOML)):
        # What is there and no regular file is told; a name too long for one is not there.
        if not os.path.lexists(path):
            continue
        table = read_job_toml(path)
        meant = table.get("input")
        if meant is not None and not isinstance(meant, Path):
            raise JobError(f"input cannot be {_shown(meant)}: give the path of a file.")
        if meant is None or meant.resolve() == source.path.resolve():
            own.update(table)
    return _without_paths(own)


def _text(table: Mapping[str, Any], name: str) -> str:
    value = table[name]
    if not isinstance(value, str):
        raise JobError(f"{name} cannot be {_shown(value)}: give a text.")
    return value


def _shown(value: object) -> str:
    return printable(repr(value)[:60])


def _without_paths(table: Mapping[str, Any]) -> dict[str, Any]:
    """Settings but for those that the batch decides itself."""
    return {key: value for key, value in table.items() if key not in ("input", "output_dir")}

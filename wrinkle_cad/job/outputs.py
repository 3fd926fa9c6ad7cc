"""The files of one job: their names, whose they are, and how they appear all together."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.errors import ExportError, JobError
from wrinkle_cad.files.atomic import replace_together
from wrinkle_cad.files.regular import hash_regular, is_regular, read_regular
from wrinkle_cad.files.staging import clear_abandoned, discard_staging, open_staging, staged_files

from .job import Job

SCHEMA: Final = "wrinkle_cad/job"
SCHEMA_VERSION: Final = 1
PAGE_MARK: Final = '<meta name="generator" content="wrinkle_cad'

_LOOKED_AT_LIMIT: Final = 64 * 2**20
"""Bytes; the largest file that is read to tell whether it is one of our JSON files or pages."""
_SCHEMAS: Final = "wrinkle_cad/"
_STEM_LIMIT: Final = 1000
"""Bytes."""
_MOVING_NAME: Final = ".moving"
"""Stands beside outputs that are all written, as soon as some may have their final names; holds
their stem."""


def output_paths(job: Job, kinds: tuple[str, ...]) -> dict[str, Path]:
    """The final path of each kind of output ("step", "stl", ...)."""
    return {kind: job.output_dir / f"{job.name}.{kind}" for kind in kinds}


def check_outputs_are_ours(
    job: Job, kinds: tuple[str, ...], *, is_ours: Callable[[Path], bool] | None = None
) -> None:
    """Raises a ``JobError`` when an output would replace the input or a file of somebody else.

    Args:
        job: its output folder and name are looked at.
        kinds: endings of the outputs.
        is_ours: whether an existing file is ours to replace; as `ownership_of` says when None. A
            JSON file is ours by its schema, a page by its generator; any other file when NAME.json
            lists it with the hash that it has.
    """
    is_ours = is_ours or ownership_of(job.output_dir, job.name)
    for path in output_paths(job, kinds).values():
        if not path.exists() and not path.is_symlink():
            continue
        if path.exists() and job.input.exists() and path.samefile(job.input):
            raise JobError(
                f"Output {path.name} would replace the input {job.input.name}: give another folder"
                " (-o DIR) or another --name."
            )
        if not is_ours(path):
            raise JobError(
                f"Output {path.name} cannot be written: a file of that name is there and was not"
                " written by this program, or was changed since. Only own outputs are replaced:"
                " move it away, or give another -o DIR."
            )


def ownership_of(folder: Path, name: str) -> Callable[[Path], bool]:
    """Returns the test whether a file is an output of this program under a stem, as it wrote it."""
    listed = _listed_outputs(folder / f"{name}.json")
    return lambda path: _is_ours(path, listed)


def hashes_of(paths: Mapping[str, Path]) -> dict[str, dict[str, Any]]:
    """Size and SHA-256 of files, by their kind."""
    return {
        kind: {"file": path.name, "bytes": path.stat().st_size, "sha256": hash_regular(path)}
        for kind, path in paths.items()
    }


@contextmanager
def outputs_together(job: Job, kinds: tuple[str, ...]) -> Iterator[dict[str, Path]]:
    """Yields paths to write to; on a clean exit the files appear under their final names.

    The paths lie in a hidden folder inside the output folder, so the last step is a rename. What an
    earlier run wrote under the same stem and this one does not make is removed, if it is as it was
    written: nobody should cut by it.

    Raises:
        ExportError: the output folder cannot be written; nothing was changed.
    """
    try:
        aside = open_staging(job.output_dir)
    except OSError as error:
        message = f"{error.strerror or error}. Give a folder that can be written with -o DIR."
        raise ExportError(job.output_dir, "folder", message) from error
    try:
        written = {kind: aside / f"{job.name}.{kind}" for kind in kinds}
        yield written
        finals = output_paths(job, kinds)
        # The JSON goes last: while it is the old one, it tells whose the other old ones are.
        pairs = [(written[kind], finals[kind]) for kind in sorted(kinds, key="json".__eq__)]
        is_ours, stale = ownership_of(job.output_dir, job.name), _no_longer_made(job, finals)
        (aside / _MOVING_NAME).write_text(job.name, encoding="utf-8")
        try:
            # Asked again: a file may have appeared while the job ran.
            replace_together(pairs, may_replace=is_ours)
        except FileExistsError as error:
            name = Path(error.filename2 or error.filename).name
            raise ExportError(
                job.output_dir / name,
                "output",
                "a file of somebody else got that name meanwhile. It is kept, nothing was written."
                " Move it away, or give another -o DIR.",
            ) from error
        for path in stale:
            if is_ours(path):
                path.unlink(missing_ok=True)
    finally:
        discard_staging(aside)


def clear_killed(folder: Path) -> None:
    """Removes hidden folders that killed runs left right in a folder of outputs.

    Outputs of which some had their final names already get the others too, where these are free or
    ours: a set is never left in halves.
    """
    clear_abandoned(folder, finish_moving)


def finish_moving(aside: Path) -> None:
    """Gives the outputs that a killed run had begun to move their final names, where it may."""
    try:
        stem = read_regular(aside / _MOVING_NAME, size_limit=_STEM_LIMIT).decode("utf-8")
        left = [path for path in staged_files(aside) if path.name.startswith(f"{stem}.")]
        left.sort(key=lambda path: path.suffix == ".json")
        pairs = [(path, aside.parent / path.name) for path in left if is_regular(path)]
        is_listed = ownership_of(aside.parent, stem)
        # A file may have both names, if it was killed between getting one and losing the other.
        replace_together(
            pairs, may_replace=lambda path: is_listed(path) or path.samefile(aside / path.name)
        )
    except (OSError, UnicodeDecodeError):
        # It had not begun, or somebody took a name meanwhile: what has its name keeps it.
        return


def _no_longer_made(job: Job, finals: Mapping[str, Path]) -> list[Path]:
    """The outputs that the JSON of an earlier run lists beside those that are made now."""
    listed = _listed_outputs(job.output_dir / f"{job.name}.json")
    current = {path.name for path in finals.values()}
    return [
        job.output_dir / name
        for name in listed
        if name not in current and name.startswith(f"{job.name}.") and Path(name).name == name
    ]


def _listed_outputs(json_path: Path) -> dict[str, Any]:
    listed = _own_json(json_path).get("outputs", {})
    entries = listed.values() if isinstance(listed, dict) else ()
    return {
        str(entry.get("file")): entry.get("sha256") for entry in entries if isinstance(entry, dict)
    }


def _own_json(path: Path) -> dict[str, Any]:
    """What a JSON file of this program holds; nothing if it is not one."""
    try:
        content = json.loads(read_regular(path, size_limit=_LOOKED_AT_LIMIT))
    except (OSError, ValueError, RecursionError):
        # No regular file, no JSON, or such as only somebody else writes: a number of 5,000 digits.
        return {}
    is_ours = isinstance(content, dict) and str(content.get("schema")).startswith(_SCHEMAS)
    return content if is_ours else {}


def _is_ours(path: Path, listed: Mapping[str, Any]) -> bool:
    if not is_regular(path):
        # A link is not ours either: we never make one.
        return False
    if path.suffix == ".json":
        return bool(_own_json(path))
    try:
        if path.suffix == ".html":
            # The page shows seconds, so its hash is not in the JSON.
            return PAGE_MARK.encode() in read_regular(path, size_limit=_LOOKED_AT_LIMIT)
        return path.name in listed and listed[path.name] == hash_regular(path)
    except OSError:
        return False

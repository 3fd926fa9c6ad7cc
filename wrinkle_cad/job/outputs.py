"""The files of one job: their names, whose they are, and how they appear all together."""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.errors import ExportError, JobError
from wrinkle_cad.files.atomic import replace_together

from .job import Job

SCHEMA: Final = "wrinkle_cad/job"
SCHEMA_VERSION: Final = 1
PAGE_MARK: Final = '<meta name="generator" content="wrinkle_cad'

_SCHEMAS: Final = "wrinkle_cad/"
_HASH_CHUNK: Final = 1 << 20


def output_paths(job: Job, kinds: tuple[str, ...]) -> dict[str, Path]:
    """The final path of each kind of output ("step", "stl", ...)."""
    return {kind: job.output_dir / f"{job.name}.{kind}" for kind in kinds}


def check_outputs_are_ours(job: Job, kinds: tuple[str, ...]) -> None:
    """Raises a ``JobError`` when an output would replace the input or a file of somebody else.

    A JSON file is ours by its schema, a page by its generator; any other file when NAME.json lists
    it with the hash that it has.
    """
    listed = _listed_outputs(job.output_dir / f"{job.name}.json")
    for path in output_paths(job, kinds).values():
        if not path.exists() and not path.is_symlink():
            continue
        if path.exists() and job.input.exists() and path.samefile(job.input):
            raise JobError(
                f"Output {path.name} would replace the input {job.input.name}: give another folder"
                " (-o DIR) or another --name."
            )
        if not _is_ours(path, listed):
            raise JobError(
                f"Output {path.name} cannot be written: a file of that name is there and was not"
                " written by this program, or was changed since. Only own outputs are replaced:"
                " move it away, or give another -o DIR."
            )


def hashes_of(paths: Mapping[str, Path]) -> dict[str, dict[str, Any]]:
    """Size and SHA-256 of files, by their kind."""
    return {
        kind: {"file": path.name, "bytes": path.stat().st_size, "sha256": _sha256(path)}
        for kind, path in paths.items()
    }


@contextmanager
def outputs_together(job: Job, kinds: tuple[str, ...]) -> Iterator[dict[str, Path]]:
    """Yields paths to write to; on a clean exit the files appear under their final names.

    The paths lie in a hidden folder inside the output folder, so the last step is a rename.

    Raises:
        ExportError: the output folder cannot be written; nothing was changed.
    """
    try:
        job.output_dir.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".wrinkle_cad-", dir=job.output_dir))
    except OSError as error:
        message = f"{error.strerror or error}. Give a folder that can be written with -o DIR."
        raise ExportError(job.output_dir, "folder", message) from error
    try:
        written = {kind: aside / f"{job.name}.{kind}" for kind in kinds}
        yield written
        finals = output_paths(job, kinds)
        replace_together([(written[kind], finals[kind]) for kind in kinds])
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def _listed_outputs(json_path: Path) -> dict[str, Any]:
    listed = _own_json(json_path).get("outputs", {})
    return {entry["file"]: entry["sha256"] for entry in listed.values()}


def _own_json(path: Path) -> dict[str, Any]:
    """What a JSON file of this program holds; nothing if it is not one."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError):
        return {}
    is_ours = isinstance(content, dict) and str(content.get("schema")).startswith(_SCHEMAS)
    return content if is_ours else {}


def _is_ours(path: Path, listed: Mapping[str, Any]) -> bool:
    if not path.is_file():
        return False
    if path.suffix == ".json":
        return bool(_own_json(path))
    if path.suffix == ".html":
        # The page shows seconds, so its hash is not in the JSON.
        return PAGE_MARK in path.read_text(encoding="utf-8", errors="replace")
    return path.name in listed and listed[path.name] == _sha256(path)


def _sha256(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_HASH_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()

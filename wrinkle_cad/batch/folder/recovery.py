"""What a killed batch left in hidden folders: finished where it was certain, else removed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from wrinkle_cad.files.regular import hash_regular, is_regular
from wrinkle_cad.files.staging import (
    discard_staging,
    leftovers,
    move_into_place,
    staged_files,
)
from wrinkle_cad.job.outputs import finish_moving

from .manifest import Manifest, Record, record_from_line
from .ownership import may_replace


def recover(folder: Path, manifest: Manifest, tell: Callable[[str], None]) -> None:
    """Puts in place what was committed and removes what was not.

    A committed folder counts only if its record names exactly the files in it, with their hashes:
    any other is left alone.

    Args:
        folder: the batch's; whoever calls holds its lock.
        manifest: gets the records of what is put in place.
        tell: is given a sentence about each.

    Raises:
        OSError: the manifest cannot be written.
    """
    for path, line in list(leftovers(folder)):
        if line is None:
            finish_moving(path)
            discard_staging(path)
            tell("removed what an earlier batch left unfinished")
        elif not staged_files(path):
            discard_staging(path)
        else:
            tell(_finish(folder, path, record_from_line(line), manifest))


def _finish(folder: Path, ready: Path, record: Record | None, manifest: Manifest) -> str:
    if record is None or not _is_what_it_says(folder, ready, record):
        return f"{ready.name} holds other files than its record says: left alone"
    target = folder / record.key
    known = dict(manifest.outputs_of(record.key))
    for file in record.outputs:
        known[file.name] = known.get(file.name, frozenset()) | {file.sha256}
    try:
        move_into_place(ready, may_replace(target.parent, target.name, known))
    except OSError as error:
        discard_staging(ready)
        return f"{record.key}: finished by an earlier batch, not put in place: {error.strerror}"
    if manifest.latest(record.key, record.input) != record:
        manifest.append(record)
    return f"{record.key}: put in place what an earlier batch had finished"


def _is_what_it_says(folder: Path, ready: Path, record: Record) -> bool:
    """Whether the files left in a committed folder are some of its record's, as they were."""
    if ready.parent != (folder / record.key).parent:
        return False
    hashes = {file.name: file.sha256 for file in record.outputs}
    try:
        return all(
            is_regular(path) and hashes.get(path.name) == hash_regular(path)
            for path in staged_files(ready)
        )
    except OSError:
        return False

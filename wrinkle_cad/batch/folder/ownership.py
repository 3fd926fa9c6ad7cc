"""Which files in a batch's folder are ours: the batch's own, and the outputs of its jobs."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from wrinkle_cad.files.own import check_own
from wrinkle_cad.files.regular import hash_regular, is_regular
from wrinkle_cad.job.outputs import ownership_of

from . import index_page, journal, summary_table
from .manifest import Record, check_manifest

OUTDATED_SUFFIX: Final = ".outdated"
"""Added to the names of outputs whose input or settings have changed to something that fails."""

_OWN: Final = (
    (index_page.PAGE_NAME, index_page.BEGINNINGS),
    (summary_table.TABLE_NAME, summary_table.BEGINNINGS),
    (journal.LOG_NAME, journal.BEGINNINGS),
)
Hashes = Mapping[str, frozenset[str]]
"""Names of files and every content (SHA-256) that we gave them."""


def check_own_files(folder: Path) -> str:
    """Checks, before any work, that the batch's own files are its own to write.

    Returns:
        The name under which a damaged manifest was set aside; empty when there was none.

    Raises:
        JobError: one of the names is taken by a link or by somebody else's file.
    """
    for name, beginnings in _OWN:
        check_own(folder / name, beginnings)
    return check_manifest(folder)


def may_replace(folder: Path, name: str, known: Hashes) -> Callable[[Path], bool]:
    """Returns the test whether an output is ours to replace.

    Args:
        folder: of the outputs.
        name: their stem.
        known: what earlier batches wrote, from the manifest.
    """
    is_listed = ownership_of(folder, name)
    return lambda path: is_as_written(path, known) or is_listed(path)


def is_as_written(path: Path, known: Hashes) -> bool:
    """Whether a regular file has a content that a batch gave it."""
    hashes = known.get(path.name.removesuffix(OUTDATED_SUFFIX))
    if not hashes or not is_regular(path):
        return False
    try:
        return hash_regular(path) in hashes
    except OSError:
        return False


def is_up_to_date(earlier: Record | None, base: Record, folder: Path) -> bool:
    """Whether a file was done with the same input and settings and its outputs are still there."""
    if earlier is None or not earlier.is_done:
        return False
    if earlier.input_sha256 != base.input_sha256:
        return False
    if earlier.settings_sha256 != base.settings_sha256:
        return False
    target = (folder / base.key).parent
    try:
        return all(
            (target / file.name).stat().st_size == file.bytes
            and hash_regular(target / file.name) == file.sha256
            for file in earlier.outputs
        )
    except OSError:
        return False


def set_outdated(folder: Path, record: Record, known: Hashes) -> tuple[str, ...]:
    """Renames the outputs of a record so that nobody cuts them; only what is as we wrote it.

    Returns:
        The names that they have now.

    Raises:
        OSError: the folder cannot be written to.
    """
    renamed = []
    for file in record.outputs:
        path = folder / file.name
        outdated = path.with_name(path.name + OUTDATED_SUFFIX)
        is_free = not os.path.lexists(outdated) or is_as_written(outdated, known)
        if is_as_written(path, known) and is_free:
            path.replace(outdated)
            renamed.append(outdated.name)
    return tuple(renamed)


def remove_stale(folder: Path, record: Record, known: Hashes) -> tuple[str, ...]:
    """Removes what earlier runs wrote under an outputs' name and the last one did not write.

    Returns:
        Names of such files that were changed since, and therefore kept.

    Raises:
        OSError: the folder cannot be written to.
    """
    current = {file.name for file in record.outputs}
    kept = []
    for name in known:
        for path in (folder / name, folder / (name + OUTDATED_SUFFIX)):
            if path.name in current or not os.path.lexists(path):
                continue
            if is_as_written(path, known):
                path.unlink()
            else:
                kept.append(path.name)
    return tuple(kept)

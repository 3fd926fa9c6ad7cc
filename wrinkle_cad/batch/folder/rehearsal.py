"""What a batch would do, without doing any of it: nothing is written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable
from wrinkle_cad.report.versions import installed_versions

from .conversion import base_record, trouble_of
from .manifest import MANIFEST_NAME, Manifest
from .ownership import is_up_to_date
from .plan import PlannedJob

DONE_BEFORE = "done before"
TO_DO = "to do"


def rehearse(
    planned: Sequence[PlannedJob], folder: Path, *, force: bool = False
) -> Iterator[tuple[PlannedJob, str]]:
    """Tells for each planned file whether it is to be done, done before or cannot be done.

    Args:
        planned: from `plan_batch`, with the same folder.
        folder: the batch's folder; need not exist.
        force: whether files that are done already would be done again.

    Yields:
        The planned file, and `TO_DO`, `DONE_BEFORE` or why it cannot be done.

    Raises:
        InputError: there is a manifest that cannot be read.
    """
    try:
        manifest = Manifest(folder)
    except OSError as error:
        raise InputError(
            f"{MANIFEST_NAME} in {printable(folder.name)} {error.strerror}. It cannot be resumed"
            " from: move it away or give another -o DIR."
        ) from error
    versions = installed_versions()
    for entry in planned:
        if entry.refusal:
            yield entry, entry.refusal
            continue
        try:
            base = base_record(entry, versions)
            earlier = manifest.latest(base.key, base.input)
            is_done = not force and is_up_to_date(earlier, base, folder)
        except OSError as error:
            yield entry, f"{entry.source.label} cannot be read ({error.strerror}). Check the file."
            continue
        except Exception as error:
            # As in the batch itself: one file's trouble, whatever it is.
            yield entry, trouble_of(entry.source, error)
            continue
        yield entry, DONE_BEFORE if is_done else TO_DO

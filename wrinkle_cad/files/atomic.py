"""Files that appear whole or not at all.

A file is written under a temporary name in its own folder, flushed to the disk and then renamed, so
that no reader and no power cut ever meets a half-written file under a final name. Temporary names
start with ``.`` and end in ``.part``.
"""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

from wrinkle_cad.errors import ExportError

PART_SUFFIX: Final = ".part"
_BACKUP_SUFFIX: Final = ".kept"


def write_atomically(path: Path, content: bytes) -> None:
    """Writes a file so that it holds either all of the content or what stood there before.

    Args:
        path: the file; its folder must exist.
        content: every byte of it.

    Raises:
        OSError: the folder does not exist or cannot be written to, or the disk is full; nothing
            is left behind.
    """
    replace_together([(write_aside(path, content), path)])


def write_export(path: Path, form: str, content: bytes) -> None:
    """Writes what a user asked for as a file; see ``write_atomically``.

    Args:
        path: the file; its folder must exist.
        form: its format, for the message.
        content: every byte of it.

    Raises:
        ExportError: it cannot be written; what stood there before is untouched.
    """
    try:
        write_atomically(path, content)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ExportError(
            path, form, f"{reason}. Nothing was written: free some space or choose another folder."
        ) from error


def write_aside(path: Path, content: bytes) -> Path:
    """Writes and flushes a temporary file beside ``path``, for `replace_together`.

    Args:
        path: the file that the content is meant for; it is not touched.
        content: every byte of it.

    Returns:
        The temporary file, in the same folder.

    Raises:
        OSError: it cannot be written; nothing is left behind.
    """
    part = _beside(path, PART_SUFFIX)
    try:
        with part.open("xb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
    except BaseException:
        # Ctrl-C leaves half a file as surely as a full disk does.
        part.unlink(missing_ok=True)
        raise
    return part


def replace_together(
    pairs: Iterable[tuple[Path, Path]],
    *,
    may_replace: Callable[[Path], bool] | None = None,
    is_resumed: bool = False,
) -> None:
    """Renames files written aside to their final names, all of them or none.

    What stood under a final name is kept beside the temporary file until every file is in place. If
    one rename fails, all that happened is undone and the temporary files are removed. A crash in
    the middle leaves whole files only, some of them from before; the kept ones end in ``.kept``.

    Args:
        pairs: ``(temporary, final)``, both on one file system, final names distinct.
        may_replace: asked about each file under a final name, right before it is replaced; all may
            be when None. A file that appears after that is not replaced either.
        is_resumed: whether an interrupted call (Ctrl-C) leaves the rest for a later one, instead of
            undoing what it did.

    Raises:
        FileExistsError: a final name is held by what may not be replaced.
        OSError: a rename failed; every final name holds what it held before.
        ValueError: two pairs have the same final name.
    """
    todo = list(pairs)
    finals = [final for _, final in todo]
    if len(set(finals)) != len(finals):
        _remove(part for part, _ in todo)
        raise ValueError("two files are meant for the same name")
    kept: dict[Path, Path | None] = {}
    try:
        for part, final in todo:
            asked_about = _identity(final)
            is_free = asked_about is None
            if not is_free and may_replace is not None and not may_replace(final):
                raise _foreign(final)
            if final.is_dir() and not final.is_symlink():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(final))
            if may_replace is not None and _identity(final) != asked_about:
                # Another one by now: telling whose a file is takes as long as reading it.
                raise _foreign(final)
            kept[final] = None if is_free or len(todo) == 1 else _keep(final, part)
            if is_free and may_replace is not None:
                _take_free_name(part, final)
            else:
                part.replace(final)
    except Exception:
        # Of the question whether a file may be replaced, too, which is the caller's.
        _undo(todo, kept)
        raise
    except BaseException:
        # Ctrl-C is no fault of the files.
        if not is_resumed:
            _undo(todo, kept)
        raise
    _remove(backup for backup in kept.values() if backup is not None)
    for folder in sorted({final.parent for final in finals}):
        _flush_folder(folder)


def _identity(path: Path) -> tuple[int, int, int, int] | None:
    """What tells a file from any other, and from itself before a change; None where none is."""
    try:
        found = path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


def _foreign(path: Path) -> FileExistsError:
    return FileExistsError(errno.EEXIST, "a file of somebody else is there", str(path))


def _take_free_name(part: Path, final: Path) -> None:
    """Gives a file a name that nothing has; nothing is replaced that appears meanwhile."""
    try:
        os.link(part, final)
    except FileExistsError:
        raise
    except OSError:
        # File systems without hard links (FAT, some network shares).
        part.rename(final)
    else:
        part.unlink()


def _beside(path: Path, suffix: str) -> Path:
    # A name of its own length: the final name may be as long as the file system allows.
    return path.with_name(f".{secrets.token_hex(8)}{suffix}")


def _keep(final: Path, part: Path) -> Path:
    """Gives what stands under a final name a second name, beside the file that replaces it."""
    backup = _beside(part, _BACKUP_SUFFIX)
    try:
        os.link(final, backup, follow_symlinks=False)
    except OSError:
        # File systems without hard links (FAT, some network shares).
        final.replace(backup)
    return backup


def _undo(todo: list[tuple[Path, Path]], kept: dict[Path, Path | None]) -> None:
    for part, final in todo:
        is_moved = final in kept and not part.exists()
        backup = kept.get(final)
        if backup is not None:
            backup.replace(final)
            backup.unlink(missing_ok=True)
        elif is_moved and len(todo) > 1:
            final.unlink(missing_ok=True)
        part.unlink(missing_ok=True)


def _remove(paths: Iterable[Path]) -> None:
    for path in paths:
        path.unlink(missing_ok=True)


def _flush_folder(folder: Path) -> None:
    """Makes the renames themselves survive a power cut, where the system can do that."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

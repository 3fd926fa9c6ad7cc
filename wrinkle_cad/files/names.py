"""Names of outputs that are safe on every system, whatever the input files are called."""

from __future__ import annotations

import hashlib
import string
import unicodedata
from pathlib import PurePosixPath
from typing import Final

from wrinkle_cad.errors import JobError

NAME_FIELDS: Final = ("stem", "suffix", "folder", "number")
LONGEST_NAME: Final = 150
"""Bytes of UTF-8: leaves room for suffixes and temporary names below the 255 of file systems."""

_RESERVED_CHARACTERS: Final = frozenset('<>:"/\\|?*')
_DEVICE_NAMES: Final = frozenset(
    {"con", "prn", "aux", "nul", "conin$", "conout$", "clock$"}
    | {f"{port}{digit}" for port in ("com", "lpt") for digit in "0123456789¹²³"}
)
_DIGEST_LENGTH: Final = 12


def safe_name(text: str) -> str:
    r"""Turns any text into the name of a file or folder that every system takes.

    Control characters, bytes that are no text, and ``<>:"/\|?*`` become ``_``, dots and spaces at
    the end go, names of Windows devices get a ``_``, a long name keeps its beginning and gets a
    digest of the whole. A name that is safe already comes back as it is (in Unicode's composed
    form). Two different texts can become the same name: who needs them apart compares.
    """
    composed = unicodedata.normalize("NFC", text)
    name = "".join("_" if _is_unsafe(character) else character for character in composed)
    name = name.rstrip(". ").lstrip(" ")
    if name.startswith("."):
        # Hidden names are ours: temporary folders, the lock.
        name = f"_{name[1:]}"
    if not name:
        name = "_"
    if name.split(".")[0].rstrip(" ").lower() in _DEVICE_NAMES:
        name = f"_{name}"
    if len(name.encode()) > LONGEST_NAME:
        name = _shortened(name, composed)
    return name


def safe_folder(folder: PurePosixPath) -> PurePosixPath:
    """Makes every part of a relative folder safe; ``..`` and roots become plain names."""
    return PurePosixPath(*(safe_name(part) for part in folder.parts if part != "."))


def check_mask(mask: str) -> None:
    """Checks a name mask such as ``{folder}-{stem}``.

    Raises:
        JobError: broken braces, an unknown field, or no field at all (all files would collide).
    """
    try:
        fields = [field for _, field, _, _ in string.Formatter().parse(mask) if field is not None]
    except ValueError as error:
        raise JobError(f"--name - {mask!r}: {error} - fields in braces - correct it") from error
    known = ", ".join(f"{{{field}}}" for field in NAME_FIELDS)
    for field in fields:
        if field not in NAME_FIELDS:
            raise JobError(f"--name - unknown field {field!r} - known: {known} - correct it")
    if not fields:
        raise JobError(
            f"--name - {mask!r} is the same for every file - use at least one of {known}"
        )


def apply_mask(mask: str, *, stem: str, suffix: str, folder: PurePosixPath, number: int) -> str:
    """Fills in a mask that `check_mask` accepts; the result is a safe name.

    Args:
        mask: text with ``{stem}``, ``{suffix}``, ``{folder}``, ``{number}``.
        stem: the input's name without its suffixes.
        suffix: the input's suffixes without the first dot ("step", "stp.gz").
        folder: the input's folder below the batch's; its parts are joined by ``-``.
        number: position of the input in the batch, from 1; four digits at least.
    """
    values = {
        "stem": stem,
        "suffix": suffix,
        "folder": "-".join(folder.parts),
        "number": f"{number:04d}",
    }
    pieces = []
    for literal, field, _, _ in string.Formatter().parse(mask):
        pieces.append(literal)
        if field is not None:
            pieces.append(values[field])
    return safe_name("".join(pieces))


def collision_key(path: PurePosixPath) -> str:
    """What two paths share when some file system takes them for the same."""
    return unicodedata.normalize("NFC", path.as_posix()).casefold()


def printable(text: str) -> str:
    """The text on one line: control characters and bytes that are no text are shown as escapes."""
    return "".join(
        character.encode("unicode_escape", "backslashreplace").decode("ascii")
        if unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp")
        else character
        for character in text
    )


def _is_unsafe(character: str) -> bool:
    # Cc and Cf: controls, among them those that turn the reading direction; Cs: undecodable bytes.
    return character in _RESERVED_CHARACTERS or unicodedata.category(character) in (
        "Cc",
        "Cf",
        "Cs",
        "Zl",
        "Zp",
    )


def _shortened(name: str, whole: str) -> str:
    digest = hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGEST_LENGTH]
    head = name.encode()[: LONGEST_NAME - _DIGEST_LENGTH - 1].decode("utf-8", "ignore")
    return f"{head.rstrip('. ')}-{digest}"

"""Texts and names from outside: what may stand in a line, in a file, and as a file's name.

One policy for all of them: a character that is no letter, sign or blank (a control, a line end, one
that turns the reading direction, a byte that is no text) never reaches a screen, a file or a name.
"""

from __future__ import annotations

import hashlib
import string
import unicodedata
from pathlib import PurePosixPath
from typing import Final

from wrinkle_cad.errors import JobError

CAD_SUFFIXES: Final = (".step", ".stp", ".p21", ".iges", ".igs", ".brep", ".brp")
"""What CAD files are called; each also with ``.gz`` behind it."""
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
    name = "".join(
        "_" if character in _RESERVED_CHARACTERS or is_control(character) else character
        for character in composed
    )
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
        raise JobError(
            f"--name cannot be {mask!r} ({error}): fields stand in braces, as in {{stem}}."
        ) from error
    known = ", ".join(f"{{{field}}}" for field in NAME_FIELDS)
    for field in fields:
        if field not in NAME_FIELDS:
            raise JobError(f"--name has no field {field!r}: use some of {known}.")
    if not fields:
        raise JobError(
            f"--name cannot be {mask!r}, the same for every file: use at least one of {known}."
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


def is_control(character: str) -> bool:
    """Tells whether a character has no place in a line of text.

    Controls and line ends, those that turn the reading direction, lone surrogates (which stand for
    bytes that are no text), and the non-characters that XML forbids.

    Example:
        >>> [is_control(character) for character in ("a", " ", chr(10), chr(0x202E))]
        [False, False, True, True]
    """
    return (
        unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp")
        or ord(character) & 0xFFFE == 0xFFFE
    )


def one_line(text: str) -> str:
    """Returns a text from a file, with a blank for every control character.

    Example:
        >>> one_line("left" + chr(10) + "vamp")
        'left vamp'
    """
    return "".join(" " if is_control(character) else character for character in text)


def printable(text: str) -> str:
    """Returns a file's name for people to read: control characters are shown as escapes.

    Two names that differ stay different.

    Example:
        >>> len(printable(chr(10))), printable("two words")
        (2, 'two words')
    """
    return "".join(
        character.encode("unicode_escape", "backslashreplace").decode("ascii")
        if is_control(character)
        else character
        for character in text
    )


def error_words(error: BaseException) -> str:
    """Returns what an exception says, on one line; the name of its class where it says nothing.

    Example:
        >>> error_words(ValueError("no  such" + chr(10) + "thing")), error_words(KeyError())
        ('no such thing', 'KeyError')
    """
    return " ".join(one_line(str(error)).split()) or type(error).__name__


def split_name(name: str) -> tuple[str, str]:
    """Returns the stem of a CAD file's name, and its suffixes without the first dot.

    Example:
        >>> split_name("vamp.left.STP.gz"), split_name("notes.txt")
        (('vamp.left', 'STP.gz'), ('notes.txt', ''))
    """
    stem, tail = name, ""
    if stem.lower().endswith(".gz") and len(stem) > len(".gz"):
        stem, tail = stem[: -len(".gz")], stem[-len(".gz") :]
    for suffix in CAD_SUFFIXES:
        if stem.lower().endswith(suffix) and len(stem) > len(suffix):
            return stem[: -len(suffix)], (stem[-len(suffix) :] + tail).lstrip(".")
    return stem, tail.lstrip(".")


def _shortened(name: str, whole: str) -> str:
    digest = hashlib.sha256(whole.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGEST_LENGTH]
    head = name.encode()[: LONGEST_NAME - _DIGEST_LENGTH - 1].decode("utf-8", "ignore")
    return f"{head.rstrip('. ')}-{digest}"

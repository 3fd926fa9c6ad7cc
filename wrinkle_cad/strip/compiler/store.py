"""Machine code that is kept on disk for later processes.

A file holds the code and all that it was made from. It is written whole, under a name that no
other program version, processor or compiler has, so that two of them never meet in one file.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from .folders import is_writable
from .kinds import Kind


@dataclass(frozen=True, slots=True)
class Kept:
    """Machine code of one compiled function, and what it was made from."""

    code: bytes
    """An object file."""
    result: Kind
    """What the function returns."""
    files: tuple[tuple[str, str], ...]
    """Source files and their digests."""
    constants: tuple[tuple[str, str, str], ...]
    """Module, name and spelling of every constant that the code holds."""


@cache
def _digest(path: str) -> str | None:
    try:
        return hashlib.blake2b(Path(path).read_bytes(), digest_size=16).hexdigest()
    except OSError:
        return None


@cache
def _compiler_digest() -> str:
    own = sorted(Path(__file__).parent.glob("*.py"))
    return "".join(str(_digest(str(path))) for path in own)


class Store:
    """Reads and writes kept machine code of one kind of processor."""

    def __init__(self, folders: tuple[Path, ...], target: tuple[str, ...]) -> None:
        """``target`` names what code must have been made by and for."""
        self._target = "\n".join((*target, _compiler_digest(), sys.version.split()[0]))
        self._folders = folders
        self._to_write: Path | bool | None = False

    @property
    def is_kept(self) -> bool:
        """Whether anything can be written."""
        return self._folder is not None

    @property
    def _folder(self) -> Path | None:
        if isinstance(self._to_write, bool):
            writable = (folder for folder in self._folders if is_writable(folder))
            self._to_write = next(writable, None)
        return self._to_write

    def name_of(self, function: str, kinds: tuple[Kind, ...]) -> str:
        """Name of the file for a function and the kinds of its arguments."""
        text = f"{self._target}\n{function}\n{kinds!r}"
        return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()

    def read(self, name: str) -> Kept | None:
        """What is kept under a name, if it is whole and its sources are what they were."""
        for folder in self._folders:
            try:
                content = (folder / name).read_bytes()
            except OSError:
                continue
            kept = _unpacked(content)
            if kept is not None and _is_valid(kept):
                return kept
        return None

    def write(self, name: str, code: bytes, result: Kind, made_from: Any) -> None:
        """Keeps machine code; if that cannot be, it is compiled again next time."""
        digests = tuple((path, _digest(path)) for path in sorted(made_from.files))
        if self._folder is None or any(digest is None for _, digest in digests):
            return
        known = tuple(sorted(made_from.constants))
        body = pickle.dumps(Kept(code, result, digests, known))  # type: ignore[arg-type]
        try:
            with tempfile.NamedTemporaryFile(dir=self._folder, delete=False) as file:
                file.write(hashlib.blake2b(body, digest_size=16).digest() + body)
            os.replace(file.name, self._folder / name)  # noqa: PTH105
        except OSError:
            self._to_write = None


def spelled(value: object) -> str:
    """A constant as a text that no other one has."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    return repr(value)


def _unpacked(content: bytes) -> Kept | None:
    if hashlib.blake2b(content[16:], digest_size=16).digest() != content[:16]:
        return None
    try:
        kept: Kept = pickle.loads(content[16:])  # the user's own file, as machine code is
    except (AttributeError, ImportError, TypeError, pickle.UnpicklingError):
        return None
    return kept


def _is_valid(kept: Kept) -> bool:
    if any(_digest(path) != digest for path, digest in kept.files):
        return False
    for module, name, text in kept.constants:
        if spelled(getattr(sys.modules.get(module), name, None)) != text:
            return False
    return True

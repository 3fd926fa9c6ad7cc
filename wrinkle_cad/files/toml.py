"""TOML files that others wrote: settings, materials, tables of layers."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.errors import InputError

from .names import printable
from .regular import read_regular

SIZE_LIMIT: Final = 2**20
"""Bytes; the largest file of settings, of a material or of layers that is read."""


def read_toml(path: Path) -> dict[str, Any]:
    """Returns what a TOML file holds.

    Raises:
        InputError: there is no regular file of sane size, or it is no TOML.
    """
    try:
        content = read_regular(path, size_limit=SIZE_LIMIT)
        # Some editors put a mark of the encoding before the text.
        return tomllib.loads(content.decode("utf-8-sig"))
    except RecursionError as error:
        raise _unreadable(path, "its values are nested too deeply") from error
    except OSError as error:
        reason = printable(error.strerror or str(error))
        raise InputError(
            f"{printable(path.name)} cannot be read ({reason}): give a TOML file."
        ) from error
    except ValueError as error:
        # Not UTF-8, not TOML, or a number of more digits than Python converts.
        raise _unreadable(path, " ".join(str(error).split())) from error


def _unreadable(path: Path, reason: str) -> InputError:
    return InputError(
        f"{printable(path.name)} cannot be read as TOML ({printable(reason)}): correct the file."
    )

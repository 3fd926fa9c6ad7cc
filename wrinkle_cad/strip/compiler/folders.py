"""Where machine code is kept."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Final

CACHE_VARIABLE: Final = "WRINKLE_CAD_CACHE_DIR"
"""Environment variable that names the folder for machine code."""
_PACKAGE: Final = Path(__file__).parents[2]
_OWN_FOLDER: Final = "wrinkle_cad_compiled"


def cache_folders(environment: Mapping[str, str]) -> tuple[Path, ...]:
    """Where machine code may be kept, the first writable one is taken.

    Args:
        environment: of the process; WRINKLE_CAD_CACHE_DIR, if set, is the only place.

    Returns:
        Beside the program, so that all users share it, then the user's folder for such files.
    """
    chosen = environment.get(CACHE_VARIABLE)
    if chosen:
        return (Path(chosen),)
    home = environment.get("XDG_CACHE_HOME") or environment.get("LOCALAPPDATA")
    # Path.expanduser raises where there is no home.
    user = Path(home) if home else Path(os.path.expanduser("~")) / ".cache"  # noqa: PTH111
    return (_PACKAGE / "__pycache__" / _OWN_FOLDER, user / _OWN_FOLDER)


def is_writable(folder: Path) -> bool:
    """Whether files can be made in a folder, which is made if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def sentence_if_nothing_is_kept(environment: Mapping[str, str]) -> str | None:
    """What a user should know whose machine code is compiled anew in every process."""
    folders = cache_folders(environment)
    if any(is_writable(folder) or any(folder.glob("*")) for folder in folders):
        return None
    listed = ", ".join(str(folder) for folder in folders)
    return (
        f"Compiled code cannot be kept: none of {listed} is writable. Every run compiles anew,"
        f" some seconds: set {CACHE_VARIABLE} to a writable folder."
    )

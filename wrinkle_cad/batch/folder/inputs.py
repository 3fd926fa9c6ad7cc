"""Files, folders and patterns -> the input files of a batch and where their outputs belong."""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import CAD_SUFFIXES, printable, split_name
from wrinkle_cad.files.regular import STALL_S, within

LookAt = Callable[[str | Path], None]
"""Told what is looked at next."""


@dataclass(frozen=True, slots=True)
class FoundFile:
    """One input file of a batch."""

    path: Path
    """The file."""
    folder: PurePosixPath
    """Its folder below the deepest folder that holds every argument: outputs mirror it."""

    @property
    def label(self) -> str:
        """Folder and name, for people: one line."""
        return printable((self.folder / self.path.name).as_posix())


@dataclass(frozen=True, slots=True)
class Sources:
    """What a search for input files found."""

    files: tuple[FoundFile, ...]
    """The files, ordered by folder and name."""
    notes: tuple[str, ...]
    """One line for each folder that could not be read."""


def find_sources(arguments: Sequence[str], output_dir: Path) -> Sources:
    """Finds the input files that files, folders and glob patterns name.

    A folder stands for every CAD file in and below it, hidden ones left out and links to folders
    not followed; a file named outright is taken whatever its suffix. The output folder is never
    searched. A file that is named twice counts once.

    Args:
        arguments: paths or patterns (``**`` matches folders of any depth).
        output_dir: where the outputs of the batch go; need not exist.

    Raises:
        InputError: an argument names nothing, the output folder is one of the folders named, or a
            folder does not answer.
    """
    place = [""]

    def search(got_on: Callable[[], None]) -> Sources:
        def look_at(path: str | Path) -> None:
            place[0] = str(path)
            got_on()

        return _found(arguments, output_dir, look_at)

    try:
        return within(STALL_S, search, "the search")
    except TimeoutError as error:
        raise InputError(
            f"The search for files stalls at {printable(place[0])}: nothing came for {STALL_S:g} s."
            " A disk or a share there does not answer: mount it again, or leave it out."
        ) from error


def _found(arguments: Sequence[str], output_dir: Path, look_at: LookAt) -> Sources:
    notes: list[str] = []
    found: dict[str, Path] = {}
    roots: list[Path] = []
    for argument in arguments:
        look_at(argument)
        root, paths = _expand(argument, output_dir.resolve(), notes, look_at)
        roots.append(root)
        for path in paths:
            look_at(path)
            found.setdefault(os.fspath(path.resolve()), path.absolute())
    base = Path(os.path.commonpath([os.path.normpath(root.absolute()) for root in roots]))
    sources = [_source(path, base) for path in found.values()]
    sources.sort(key=lambda source: (source.folder.parts, os.fsencode(source.path.name)))
    return Sources(tuple(sources), tuple(notes))


def _expand(
    argument: str, output_dir: Path, notes: list[str], look_at: LookAt
) -> tuple[Path, Iterable[Path]]:
    path = Path(argument)
    if path.is_dir():
        if path.resolve() == output_dir:
            raise InputError(
                f"The output folder {printable(argument)} is also an input folder, and inputs are"
                " never written to. Give another -o DIR."
            )
        return path, list(_files_below(path, output_dir, notes, look_at))
    if path.exists():
        return path.parent, [path]
    if not glob.has_magic(argument):
        raise InputError(f"There is no file or folder {printable(argument)}. Check the path.")
    files = []
    for match in glob.iglob(argument, recursive=True):  # noqa: PTH207 - Path.glob takes no absolute patterns
        look_at(match)
        if _is_input(Path(match), output_dir):
            files.append(Path(match))
    if not files:
        raise InputError(f"No CAD file matches {printable(argument)}. Check the pattern.")
    return _fixed_part(argument), files


def _files_below(
    folder: Path, output_dir: Path, notes: list[str], look_at: LookAt
) -> Iterator[Path]:
    def note(error: OSError) -> None:
        where = printable(str(error.filename))
        notes.append(f"The folder {where} was left out ({error.strerror}). Check its permissions.")

    for root, folders, names in os.walk(folder, onerror=note):
        here = Path(root)
        look_at(here)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and (here / name).resolve() != output_dir
        )
        for path in (here / name for name in names):
            look_at(path)
            if _is_input(path, output_dir):
                yield path


def _is_input(path: Path, output_dir: Path) -> bool:
    _, suffixes = split_name(path.name)
    is_cad = f".{suffixes.split('.')[0].lower()}" in CAD_SUFFIXES
    is_visible = not path.name.startswith(".")
    return (
        is_visible and is_cad and path.is_file() and not path.resolve().is_relative_to(output_dir)
    )


def _fixed_part(pattern: str) -> Path:
    """The folder of a pattern down to its first part with a wildcard."""
    fixed: list[str] = []
    for part in Path(pattern).parts[:-1]:
        if glob.has_magic(part):
            break
        fixed.append(part)
    return Path(*fixed)


def _source(path: Path, base: Path) -> FoundFile:
    folder = Path(os.path.normpath(path.parent))
    relative = folder.relative_to(base) if folder.is_relative_to(base) else Path()
    return FoundFile(path, PurePosixPath(relative.as_posix()))

"""DIR/manifest.jsonl: what became of each file; a later batch resumes from it.

One line per finished file, appended and flushed to the disk; the last line about a file counts. A
line that a power cut tore, or that is no record, is left out when reading; a whole file that is
none of our manifests but looks like one that was damaged is set aside under another name.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path, PurePosixPath
from typing import Any, Final

from wrinkle_cad.errors import JobError
from wrinkle_cad.files.own import check_own, open_own, write_all
from wrinkle_cad.files.regular import is_regular, read_regular

MANIFEST_NAME: Final = "manifest.jsonl"
SCHEMA_VERSION: Final = 1
BEGINNINGS: Final = (b'{"schema": "wrinkle_cad/batch", "version": 1}\n', b'{"schema": 1, "key": ')
"""What a manifest begins with; the second, what they began with before they had a first line."""

WAITING: Final = "waiting"
"""The outcome, in tables only, of a file that the batch has not come to."""

_SIZE_LIMIT: Final = 1 << 30
_TEXTS: Final = ("key", "input", "input_sha256", "settings_sha256", "outcome")
_TEXT_FIGURES: Final = ("state", "outline")
_MORE_TEXTS: Final = ("phase", "error", "message", "finished")


@dataclass(frozen=True, slots=True)
class OutputFile:
    """One file that a job wrote."""

    name: str
    """Its name, without folders."""
    bytes: int
    """Its size."""
    sha256: str
    """Hash of its content."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """What became of one input file."""

    key: str
    """Folder and stem of its outputs below the batch's folder, with ``/``."""
    input: str
    """Folder and name of the input below the batch's inputs."""
    input_sha256: str
    """Hash of the input's content; empty when it could not be read."""
    settings_sha256: str
    """Hash of the settings and versions."""
    outcome: str
    """``done`` or ``failed``."""
    phase: str = ""
    """Where it failed."""
    error: str = ""
    """Class of the error."""
    message: str = ""
    """The failure on one line."""
    outputs: tuple[OutputFile, ...] = ()
    """The files written."""
    figures: Mapping[str, Any] = field(default_factory=dict)
    """What the summary shows: counts of bridges, areas, folds."""
    missed_limits: tuple[str, ...] = ()
    """One line for each limit given that the result misses."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Seconds by phase."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Versions of the packages at work."""
    finished: str = ""
    """When, in UTC (ISO 8601)."""

    @property
    def is_done(self) -> bool:
        """Whether the outputs were written."""
        return self.outcome == "done"


def record_to_line(record: Record) -> str:
    """The record as one line of JSON, ASCII only, without the line break."""
    return json.dumps({"schema": SCHEMA_VERSION, **asdict(record)}, ensure_ascii=True)


def record_from_line(line: str) -> Record | None:
    """Reads a line of the manifest; None when it is torn or of another schema."""
    try:
        values = json.loads(line)
        if not isinstance(values, dict) or values.pop("schema", None) != SCHEMA_VERSION:
            return None
        known = {field.name for field in fields(Record)}
        values = {name: value for name, value in values.items() if name in known}
        values["outputs"] = tuple(OutputFile(**entry) for entry in values.get("outputs", ()))
        values["missed_limits"] = tuple(values.get("missed_limits", ()))
        record = Record(**values)
    except (ValueError, TypeError, RecursionError):
        return None
    return record if _is_sound(record) else None


def _is_sound(record: Record) -> bool:
    """Whether every value is of its kind and no name leads out of the batch's folder."""
    tables = (record.seconds, record.figures, record.versions)
    if not all(isinstance(table, dict) for table in tables):
        return False
    texts = [getattr(record, name) for name in (*_TEXTS, *_MORE_TEXTS)]
    texts += [*record.missed_limits, *record.versions, *record.versions.values()]
    for file in record.outputs:
        texts += [file.name, file.sha256]
        if not isinstance(file.bytes, int) or not is_plain_name(file.name):
            return False
    numbers = [*record.seconds.values()]
    for name, figure in record.figures.items():
        if name in _TEXT_FIGURES:
            texts.append(figure)
        elif figure is not None:
            numbers.append(figure)
    parts = PurePosixPath(record.key).parts if isinstance(record.key, str) else ("..",)
    return (
        all(isinstance(text, str) for text in texts)
        and all(isinstance(number, int | float) and _is_finite(number) for number in numbers)
        and record.outcome in ("done", "failed")
        and ".." not in parts
        and not PurePosixPath(record.key).is_absolute()
    )


def is_plain_name(name: object) -> bool:
    """Whether a text is the name of a file in a folder, and no way to another folder."""
    return (
        isinstance(name, str)
        and name not in ("", ".", "..")
        and not any(character in name for character in "/\\\0")
    )


def _is_finite(number: float) -> bool:
    # An integer of more than 308 digits is no float, and no figure of ours.
    return abs(number) < 1e300


class Manifest:
    """The manifest of a batch's folder, held in memory and appended to on disk.

    Args:
        folder: the batch's folder; whoever writes holds its lock.

    Raises:
        OSError: there is one and it cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / MANIFEST_NAME
        self.torn_lines = 0
        self._records: dict[tuple[str, str], Record] = {}
        self._outputs: dict[str, dict[str, set[str]]] = {}
        for line in self._lines():
            record = record_from_line(line)
            if record is None:
                self.torn_lines += 1
            else:
                self._remember(record)

    def latest(self, key: str, input_label: str) -> Record | None:
        """The last record about an input and its outputs' name."""
        return self._records.get((key, input_label))

    def records(self) -> tuple[Record, ...]:
        """The last record about each input, in the order of the inputs."""
        return tuple(sorted(self._records.values(), key=lambda record: (record.input, record.key)))

    def outputs_of(self, key: str) -> Mapping[str, frozenset[str]]:
        """Names and hashes of all files ever written under an outputs' name, whatever the input."""
        return {name: frozenset(hashes) for name, hashes in self._outputs.get(key, {}).items()}

    def append(self, record: Record) -> None:
        """Adds a record; when this returns it is on the disk.

        Raises:
            JobError: a file of somebody else has taken its name.
            OSError: it cannot be written; the manifest on disk is as before.
        """
        line = record_to_line(record).encode("ascii") + b"\n"
        handle = open_own(self.path, BEGINNINGS)
        try:
            size = os.lseek(handle, 0, os.SEEK_END)
            if not size:
                line = BEGINNINGS[0] + line
            elif os.pread(handle, 1, size - 1) != b"\n":
                # A torn last line ends here, so that it spoils itself only.
                line = b"\n" + line
            try:
                write_all(handle, line)
                os.fsync(handle)
            except OSError:
                os.ftruncate(handle, size)
                raise
        finally:
            os.close(handle)
        self._remember(record)

    def _remember(self, record: Record) -> None:
        self._records[record.key, record.input] = record
        if record.is_done:
            names = self._outputs.setdefault(record.key, {})
            for file in record.outputs:
                names.setdefault(file.name, set()).add(file.sha256)

    def _lines(self) -> list[str]:
        try:
            content = read_regular(self.path, size_limit=_SIZE_LIMIT)
        except FileNotFoundError:
            return []
        lines = content.decode("ascii", "replace").split("\n")
        first = BEGINNINGS[0].decode("ascii").strip()
        return [line for line in lines if line.strip() and line.strip() != first]


def check_manifest(folder: Path) -> str:
    """Checks that a batch may add to the manifest of its folder.

    Returns:
        The name that a damaged manifest was given, so that a new one can be begun; else empty.

    Raises:
        JobError: a link or a file of somebody else has its name.
    """
    path = folder / MANIFEST_NAME
    try:
        check_own(path, BEGINNINGS)
    except JobError:
        if not is_regular(path) or path.lstat().st_nlink > 1 or not _looks_damaged(path):
            raise
        for number in range(1, 1000):
            aside = path.with_name(f"{MANIFEST_NAME}.damaged-{number}")
            if not os.path.lexists(aside):
                path.rename(aside)
                return aside.name
        raise
    return ""


def _looks_damaged(path: Path) -> bool:
    """Whether the first line is no JSON at all: another program's table would begin with some."""
    try:
        first = read_regular(path, size_limit=_SIZE_LIMIT).lstrip().partition(b"\n")[0]
        json.loads(first)
    except (ValueError, RecursionError):
        return True
    except OSError:
        return False
    return False

"""DIR/manifest.jsonl: what became of each file; a later batch resumes from it.

One line per finished file, appended and flushed to the disk; the last line about a file counts. A
line that a power cut tore is left out when reading.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, Final

MANIFEST_NAME: Final = "manifest.jsonl"
SCHEMA_VERSION: Final = 1


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
        return Record(**values)
    except (ValueError, TypeError):
        return None


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
        self._outputs: dict[str, set[str]] = {}
        for line in self._lines():
            record = record_from_line(line)
            if record is None:
                self.torn_lines += 1
            else:
                self._remember(record)

    def latest(self, key: str, input_label: str) -> Record | None:
        """The last record about an input and its outputs' name."""
        return self._records.get((key, input_label))

    def outputs_of(self, key: str) -> frozenset[str]:
        """Names of all files that were ever written under an outputs' name, whatever the input."""
        return frozenset(self._outputs.get(key, ()))

    def append(self, record: Record) -> None:
        """Adds a record; when this returns it is on the disk.

        Raises:
            OSError: it cannot be written; the manifest on disk is as before.
        """
        line = record_to_line(record).encode("ascii") + b"\n"
        handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            size = os.lseek(handle, 0, os.SEEK_END)
            if size and os.pread(handle, 1, size - 1) != b"\n":
                # A torn last line ends here, so that it spoils itself only.
                line = b"\n" + line
            try:
                _write_all(handle, line)
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
            names = self._outputs.setdefault(record.key, set())
            names.update(file.name for file in record.outputs)

    def _lines(self) -> list[str]:
        try:
            content = self.path.read_bytes()
        except FileNotFoundError:
            return []
        lines = content.decode("ascii", "replace").split("\n")
        return [line for line in lines if line.strip()]


def _write_all(handle: int, content: bytes) -> None:
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(handle, rest) :]

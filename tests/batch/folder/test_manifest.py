"""The manifest on disk."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder.manifest import (
    Manifest,
    OutputFile,
    Record,
    record_from_line,
    record_to_line,
)

RECORD = Record(
    key="x/a",
    input="x/靴\\udcff.step",
    input_sha256="1",
    settings_sha256="2",
    outcome="done",
    outputs=(OutputFile("a.step", 3, "4"),),
    figures={"developability": 97.5},
    missed_limits=("fold",),
    seconds={"read": 0.5},
    versions={"numpy": "2"},
    finished="2026-01-01T00:00:00+00:00",
)


def test_a_record_survives_a_round_trip(tmp_path: Path) -> None:
    Manifest(tmp_path).append(RECORD)
    read = Manifest(tmp_path).latest(RECORD.key, RECORD.input)
    assert read == RECORD
    assert read != replace(RECORD, seconds={"read": 0.6})


def test_a_record_is_one_line_of_ascii() -> None:
    line = record_to_line(replace(RECORD, message="a\nb\u2028c"))
    line.encode("ascii")
    assert len(line.splitlines()) == 1


def test_the_last_record_about_a_file_counts(tmp_path: Path) -> None:
    manifest = Manifest(tmp_path)
    manifest.append(RECORD)
    manifest.append(replace(RECORD, outcome="failed", outputs=()))
    read = Manifest(tmp_path)
    latest = read.latest(RECORD.key, RECORD.input)
    assert latest is not None
    assert latest.outcome == "failed"
    assert read.outputs_of("x/a") == {"a.step": {"4"}}


@pytest.mark.parametrize("kept", range(0, 200, 7))
def test_a_torn_last_line_spoils_itself_only(tmp_path: Path, kept: int) -> None:
    first, second = Manifest(tmp_path), replace(RECORD, key="b")
    first.append(RECORD)
    whole = first.path.read_bytes()
    first.path.write_bytes(whole + record_to_line(second).encode()[:kept])
    resumed = Manifest(tmp_path)
    assert resumed.torn_lines == (kept > 0)
    resumed.append(second)
    read = Manifest(tmp_path)
    assert read.latest("x/a", RECORD.input) == RECORD
    assert read.latest("b", RECORD.input) == second


def test_a_write_that_fails_leaves_the_manifest_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    manifest = Manifest(tmp_path)
    manifest.append(RECORD)
    before = manifest.path.read_bytes()
    real_write = os.write

    for allowed in (0, 1, 50):
        room = [allowed]

        def write(handle: int, data: bytes, room: list[int] = room) -> int:
            if not room[0]:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            count = real_write(handle, bytes(data)[: room[0]])
            room[0] -= count
            return count

        monkeypatch.setattr(os, "write", write)
        with pytest.raises(OSError, match="No space"):
            manifest.append(replace(RECORD, key="c"))
        monkeypatch.undo()
        assert manifest.path.read_bytes() == before
        assert manifest.latest("c", RECORD.input) is None


@pytest.mark.parametrize(
    "line", ["", "[]", "null", '{"schema": 99}', '{"schema": 1}', '{"schema": 1, "outputs": [1]}']
)
def test_a_line_that_is_no_record_is_none(line: str) -> None:
    assert record_from_line(line) is None


def test_a_field_of_a_later_version_is_left_out() -> None:
    line = record_to_line(RECORD).replace('"key"', '"novelty": 1, "key"', 1)
    assert record_from_line(line) == RECORD

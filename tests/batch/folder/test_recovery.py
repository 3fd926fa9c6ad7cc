"""What a killed batch committed is finished; what is planted is left alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder.manifest import Manifest, OutputFile, Record, record_to_line
from wrinkle_cad.batch.folder.recovery import recover
from wrinkle_cad.files.regular import hash_regular
from wrinkle_cad.files.staging import (
    READY_PREFIX,
    RECORD_NAME,
    commit_staging,
    open_staging,
    release_staging,
)

BLANK = Record(key="a", input="a.step", input_sha256="1", settings_sha256="2", outcome="done")


def committed(folder: Path, record: Record = BLANK) -> Path:
    staging = open_staging(folder)
    path = staging / "a.dxf"
    path.write_text("new")
    output = OutputFile("a.dxf", 3, hash_regular(path))
    ready = commit_staging(staging, record_to_line(replace(record, outputs=(output,))))
    release_staging(ready)
    return ready


def recovered(folder: Path) -> list[str]:
    said: list[str] = []
    recover(folder, Manifest(folder), said.append)
    return said


def test_a_committed_folder_is_put_in_place_and_recorded(tmp_path: Path) -> None:
    committed(tmp_path)
    assert recovered(tmp_path) == ["a: put in place what an earlier batch had finished"]
    assert (tmp_path / "a.dxf").read_text() == "new"
    assert Manifest(tmp_path).latest("a", "a.step") is not None
    assert not list(tmp_path.glob(".wrinkle_cad-*"))


def test_an_uncommitted_folder_goes(tmp_path: Path) -> None:
    staging = open_staging(tmp_path)
    (staging / "a.dxf").write_text("half")
    release_staging(staging)
    assert recovered(tmp_path) == ["removed what an earlier batch left unfinished"]
    assert not list(tmp_path.iterdir())


def test_a_file_of_somebody_else_keeps_its_name(tmp_path: Path) -> None:
    committed(tmp_path)
    (tmp_path / "a.dxf").write_text("somebody's")
    (line,) = recovered(tmp_path)
    assert "not put in place" in line
    assert (tmp_path / "a.dxf").read_text() == "somebody's"
    assert not list(tmp_path.glob(".wrinkle_cad-*"))


@pytest.mark.parametrize("change", ["content", "name", "record", "folder", "key", "deep", "link"])
def test_a_folder_that_is_not_what_its_record_says_is_left_alone(
    tmp_path: Path, change: str
) -> None:
    (tmp_path / "x").mkdir()
    ready = committed(tmp_path / "x" if change == "folder" else tmp_path)
    if change == "content":
        (ready / "a.dxf").write_text("other")
    elif change == "name":
        (ready / "a.dxf").rename(ready / "b.dxf")
    elif change == "record":
        (ready / RECORD_NAME).write_text("{}")
    elif change == "deep":
        (ready / RECORD_NAME).write_text("[" * 100_000)
    elif change == "key":
        line = (ready / RECORD_NAME).read_text()
        (ready / RECORD_NAME).write_text(line.replace('"key": "a"', '"key": "../a"'))
    elif change == "link":
        content = (ready / "a.dxf").rename(tmp_path / "elsewhere")
        (ready / "a.dxf").symlink_to(content)
    before = sorted(path.name for path in ready.iterdir())
    (line,) = recovered(tmp_path)
    assert "left alone" in line
    assert sorted(path.name for path in ready.iterdir()) == before
    assert not (tmp_path / "a.dxf").exists()


def test_a_planted_folder_moves_nothing(tmp_path: Path) -> None:
    planted = tmp_path / f"{READY_PREFIX}x"
    planted.mkdir()
    for name in ("report.html", "a.dxf"):
        (planted / name).write_text("planted")
    assert recovered(tmp_path) == []
    assert sorted(path.name for path in tmp_path.iterdir()) == [planted.name]

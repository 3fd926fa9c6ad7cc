"""Outputs appear together or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from wrinkle_cad.files.staging import (
    RECORD_NAME,
    commit_staging,
    discard_staging,
    leftovers,
    move_into_place,
    open_staging,
)


def stage(folder: Path) -> Path:
    staging = open_staging(folder)
    for kind in ("step", "dxf"):
        (staging / f"a.{kind}").write_text(kind)
    return staging


def test_nothing_has_a_final_name_before_the_commit_and_everything_after_the_move(
    tmp_path: Path,
) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    assert not list(tmp_path.glob("a.*"))
    move_into_place(ready)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "a.step": "step",
        "a.dxf": "dxf",
    }


def test_earlier_outputs_are_replaced(tmp_path: Path) -> None:
    (tmp_path / "a.step").write_text("old")
    move_into_place(commit_staging(stage(tmp_path), ""))
    assert (tmp_path / "a.step").read_text() == "step"


def test_an_interrupted_move_can_be_finished(tmp_path: Path) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    (ready / "a.dxf").rename(tmp_path / "a.dxf")
    assert list(leftovers(tmp_path)) == [(ready, "record")]
    move_into_place(ready)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dxf", "a.step"]


def test_a_move_that_lost_only_its_last_step_can_be_finished(tmp_path: Path) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    for name in ("a.dxf", "a.step"):
        (ready / name).rename(tmp_path / name)
    (ready / RECORD_NAME).unlink()
    assert list(leftovers(tmp_path)) == [(ready, "")]
    move_into_place(ready)
    assert not list(leftovers(tmp_path))


def test_leftovers_are_found_in_every_folder_and_only_ours(tmp_path: Path) -> None:
    deep = stage(tmp_path / "x" / "y")
    (tmp_path / ".git").mkdir()
    assert list(leftovers(tmp_path)) == [(deep, None)]
    discard_staging(deep)
    assert not list(leftovers(tmp_path))
    assert (tmp_path / ".git").is_dir()


def test_a_name_that_a_folder_has_keeps_the_committed_files(tmp_path: Path) -> None:
    (tmp_path / "a.step").mkdir()
    ready = commit_staging(stage(tmp_path), "record")
    with pytest.raises(OSError, match="step"):
        move_into_place(ready)
    assert (ready / "a.step").read_text() == "step"


def test_two_jobs_in_one_folder_do_not_meet(tmp_path: Path) -> None:
    assert open_staging(tmp_path) != open_staging(tmp_path)

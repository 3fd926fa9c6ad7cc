"""Outputs appear together or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from wrinkle_cad.files.staging import (
    MARK,
    MARK_NAME,
    PART_PREFIX,
    READY_PREFIX,
    RECORD_NAME,
    clear_abandoned,
    commit_staging,
    discard_staging,
    leftovers,
    move_into_place,
    open_staging,
    release_staging,
)


def anything(_: Path) -> bool:
    return True


def nothing(_: Path) -> bool:
    return False


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
    move_into_place(ready, anything)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "a.step": "step",
        "a.dxf": "dxf",
    }


def test_earlier_outputs_are_replaced(tmp_path: Path) -> None:
    (tmp_path / "a.step").write_text("old")
    move_into_place(commit_staging(stage(tmp_path), ""), anything)
    assert (tmp_path / "a.step").read_text() == "step"


def test_an_interrupted_move_can_be_finished(tmp_path: Path) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    (ready / "a.dxf").rename(tmp_path / "a.dxf")
    release_staging(ready)
    assert list(leftovers(tmp_path)) == [(ready, "record")]
    move_into_place(ready, anything)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dxf", "a.step"]


def test_a_move_that_lost_only_its_last_step_can_be_finished(tmp_path: Path) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    for name in ("a.dxf", "a.step"):
        (ready / name).rename(tmp_path / name)
    (ready / RECORD_NAME).unlink()
    release_staging(ready)
    assert list(leftovers(tmp_path)) == [(ready, "")]
    move_into_place(ready, anything)
    assert not list(leftovers(tmp_path))


def test_leftovers_are_found_in_every_folder_and_only_ours(tmp_path: Path) -> None:
    deep = stage(tmp_path / "x" / "y")
    (tmp_path / ".git").mkdir()
    assert not list(leftovers(tmp_path)), "it is in use"
    release_staging(deep)
    assert list(leftovers(tmp_path)) == [(deep, None)]
    discard_staging(deep)
    assert not list(leftovers(tmp_path))
    assert (tmp_path / ".git").is_dir()


def test_a_name_that_a_folder_has_leaves_every_name_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "a.step").mkdir()
    (tmp_path / "a.dxf").write_text("old")
    ready = commit_staging(stage(tmp_path), "record")
    with pytest.raises(IsADirectoryError):
        move_into_place(ready, anything)
    assert (tmp_path / "a.dxf").read_text() == "old"
    assert not list((tmp_path / "a.step").iterdir())


def test_a_file_that_is_not_ours_keeps_its_name_and_nothing_moves(tmp_path: Path) -> None:
    (tmp_path / "a.step").write_text("somebody's")
    ready = commit_staging(stage(tmp_path), "record")
    with pytest.raises(FileExistsError):
        move_into_place(ready, nothing)
    assert (tmp_path / "a.step").read_text() == "somebody's"
    assert not (tmp_path / "a.dxf").exists()


def test_a_file_that_appears_during_the_move_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ready = commit_staging(stage(tmp_path), "record")
    real = os.link

    def race(source: Path, target: Path, **keywords: bool) -> None:
        if Path(target).name == "a.step":
            Path(target).write_text("somebody's")
        real(source, target, **keywords)

    monkeypatch.setattr(os, "link", race)
    with pytest.raises(FileExistsError):
        move_into_place(ready, anything)
    assert (tmp_path / "a.step").read_text() == "somebody's"
    assert not (tmp_path / "a.dxf").exists()


@pytest.mark.parametrize("prefix", [PART_PREFIX, READY_PREFIX])
def test_a_folder_of_that_name_without_our_mark_is_nobodys_leftover(
    tmp_path: Path, prefix: str
) -> None:
    planted = tmp_path / f"{prefix}x"
    planted.mkdir()
    (planted / "a.step").write_text("somebody's")
    assert not list(leftovers(tmp_path))
    (planted / MARK_NAME).write_text("some mark")
    assert not list(leftovers(tmp_path))
    (planted / MARK_NAME).unlink()
    os.mkfifo(planted / MARK_NAME)
    assert not list(leftovers(tmp_path))
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / MARK_NAME).write_bytes(MARK)
    (tmp_path / f"{prefix}link").symlink_to(elsewhere)
    assert not list(leftovers(tmp_path))


@pytest.mark.parametrize("mark", [None, b"", MARK[:10]])
def test_what_was_killed_while_it_marked_its_folder_is_cleared(
    tmp_path: Path, mark: bytes | None
) -> None:
    folder = tmp_path / f"{PART_PREFIX}x"
    folder.mkdir()
    if mark is not None:
        (folder / MARK_NAME).write_bytes(mark)
    clear_abandoned(tmp_path)
    assert not folder.exists()


def test_a_folder_with_a_torn_mark_and_anything_else_in_it_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / f"{PART_PREFIX}x"
    folder.mkdir()
    (folder / MARK_NAME).write_bytes(MARK[:10])
    (folder / "mine").write_text("somebody's")
    clear_abandoned(tmp_path)
    assert (folder / "mine").exists()


def test_a_folder_that_another_process_is_marking_is_not_cleared_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.open

    def slow(path: object, *arguments: int, **keywords: int) -> int:
        if str(path).endswith(MARK_NAME) and arguments[0] & os.O_CREAT:
            # A second process that clears up finds the folder without a mark.
            code = "import sys; from pathlib import Path; from wrinkle_cad.files import staging;"
            code += "staging.clear_abandoned(Path(sys.argv[1]))"
            subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True)
        return real(path, *arguments, **keywords)  # type: ignore[arg-type]

    monkeypatch.setattr(os, "open", slow)
    staging = open_staging(tmp_path)
    assert (staging / MARK_NAME).read_bytes() == MARK


def test_what_a_killed_process_left_is_cleared_and_what_runs_is_not(tmp_path: Path) -> None:
    mine = open_staging(tmp_path)
    code = (
        "import os, sys; from pathlib import Path; from wrinkle_cad.files.staging import *;"
        "path = open_staging(Path(sys.argv[1])); (path / 'half.step').write_text('x');"
        "os.kill(os.getpid(), 9)"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False)
    assert ended.returncode == -9
    assert len(list(tmp_path.iterdir())) == 2
    clear_abandoned(tmp_path)
    assert list(tmp_path.iterdir()) == [mine]


def test_two_jobs_in_one_folder_do_not_meet(tmp_path: Path) -> None:
    assert open_staging(tmp_path) != open_staging(tmp_path)

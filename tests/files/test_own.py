"""Files with fixed names are ours by their beginning, or not touched."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from wrinkle_cad.errors import JobError
from wrinkle_cad.files.own import append_own, check_own, open_own, write_own

MARK = (b"ours 1\n",)


def foreign(folder: Path, kind: str) -> Path:
    """Something of somebody else under the name of a log; returns the name."""
    path, victim = folder / "batch.log", folder / "victim"
    victim.write_bytes(MARK[0])
    if kind == "link":
        path.symlink_to(victim)
    elif kind == "dangling link":
        path.symlink_to(folder / "nowhere")
    elif kind == "second name":
        os.link(victim, path)
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "directory":
        path.mkdir()
    else:
        path.write_text("a log of somebody else")
    return path


KINDS = ["link", "dangling link", "second name", "pipe", "directory", "file"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "touch",
    [
        lambda path: check_own(path, MARK),
        lambda path: write_own(path, MARK[0] + b"new", MARK),
        lambda path: append_own(path, b"new", MARK),
        lambda path: open_own(path, MARK),
    ],
    ids=["check", "write", "append", "open"],
)
def test_what_is_not_ours_is_refused_and_left(
    tmp_path: Path, kind: str, touch: Callable[[Path], object]
) -> None:
    path = foreign(tmp_path, kind)
    before = {each.name: each.lstat().st_mtime_ns for each in tmp_path.iterdir()}
    with pytest.raises(JobError, match=r"batch\.log in the output folder"):
        touch(path)
    assert {each.name: each.lstat().st_mtime_ns for each in tmp_path.iterdir()} == before
    assert (tmp_path / "victim").read_bytes() == MARK[0]


def test_a_new_file_begins_with_the_mark_and_grows(tmp_path: Path) -> None:
    path = tmp_path / "batch.log"
    append_own(path, b"one\n", MARK)
    append_own(path, b"two\n", MARK)
    assert path.read_bytes() == MARK[0] + b"one\ntwo\n"
    write_own(path, MARK[0] + b"whole", MARK)
    assert path.read_bytes() == MARK[0] + b"whole"
    assert [each.name for each in tmp_path.iterdir()] == ["batch.log"]


@pytest.mark.parametrize("length", [0, 3])
def test_a_beginning_that_a_power_cut_tore_is_ours(tmp_path: Path, length: int) -> None:
    path = tmp_path / "batch.log"
    path.write_bytes(MARK[0][:length])
    check_own(path, MARK)


def test_a_torn_beginning_is_begun_again(tmp_path: Path) -> None:
    path = tmp_path / "batch.log"
    path.write_bytes(MARK[0][:3])
    append_own(path, b"first\n", MARK)
    append_own(path, b"second\n", MARK)
    assert path.read_bytes() == MARK[0] + b"first\nsecond\n"

"""Files that appear whole or not at all, with failures injected at each step."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from wrinkle_cad.files.atomic import replace_together, write_aside, write_atomically


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_a_file_is_written_and_replaced(tmp_path: Path) -> None:
    path = tmp_path / "a.step"
    write_atomically(path, b"one")
    write_atomically(path, b"two")
    assert path.read_bytes() == b"two"
    assert names_in(tmp_path) == {"a.step"}


def test_a_name_as_long_as_the_file_system_allows_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 255)
    write_atomically(path, b"x")
    assert path.read_bytes() == b"x"


def test_a_missing_folder_is_an_error_and_not_made(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "no" / "a.step", b"x")
    assert names_in(tmp_path) == set()


@pytest.mark.parametrize("failing", ["fsync", "write"])
def test_a_full_disk_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    path = tmp_path / "a.step"
    path.write_bytes(b"old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    if failing == "fsync":
        monkeypatch.setattr(os, "fsync", full)
        content: object = b"new"
    else:
        content = "not bytes"
    with pytest.raises((OSError, TypeError)):
        write_atomically(path, content)  # type: ignore[arg-type]
    assert path.read_bytes() == b"old"
    assert names_in(tmp_path) == {"a.step"}


def test_several_files_appear_together(tmp_path: Path) -> None:
    finals = [tmp_path / name for name in ("a.step", "a.stl", "a.dxf")]
    finals[1].write_bytes(b"old")
    replace_together([(write_aside(final, final.name.encode()), final) for final in finals])
    assert [final.read_bytes() for final in finals] == [b"a.step", b"a.stl", b"a.dxf"]
    assert names_in(tmp_path) == {"a.step", "a.stl", "a.dxf"}


@pytest.mark.parametrize("failing", [0, 1, 2])
def test_when_one_of_several_renames_fails_all_are_undone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int
) -> None:
    finals = [tmp_path / name for name in ("a.step", "a.stl", "a.dxf")]
    finals[0].write_bytes(b"old")
    finals[2].write_bytes(b"old")
    pairs = [(write_aside(final, b"new"), final) for final in finals]
    replace = Path.replace

    def failing_replace(self: Path, target: Path) -> Path:
        if self == pairs[failing][0]:
            raise PermissionError(13, "Permission denied")
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", failing_replace)
    with pytest.raises(PermissionError):
        replace_together(pairs)
    assert names_in(tmp_path) == {"a.step", "a.dxf"}
    assert finals[0].read_bytes() == finals[2].read_bytes() == b"old"


def test_a_part_file_that_vanished_undoes_the_rest(tmp_path: Path) -> None:
    finals = [tmp_path / "a", tmp_path / "b"]
    finals[1].write_bytes(b"old")
    pairs = [(write_aside(final, b"new"), final) for final in finals]
    pairs[1][0].unlink()
    with pytest.raises(FileNotFoundError):
        replace_together(pairs)
    assert names_in(tmp_path) == {"b"}
    assert finals[1].read_bytes() == b"old"


def test_without_hard_links_old_files_survive_a_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    finals = [tmp_path / "a", tmp_path / "b"]
    for final in finals:
        final.write_bytes(b"old")
    pairs = [(write_aside(final, b"new"), final) for final in finals]

    def no_links(*_: object, **__: object) -> None:
        raise OSError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_links)
    pairs[1][0].unlink()
    with pytest.raises(FileNotFoundError):
        replace_together(pairs)
    assert [final.read_bytes() for final in finals] == [b"old", b"old"]
    assert names_in(tmp_path) == {"a", "b"}


def test_two_files_for_one_name_are_refused_and_removed(tmp_path: Path) -> None:
    final = tmp_path / "a"
    with pytest.raises(ValueError, match="same name"):
        replace_together([(write_aside(final, b"1"), final), (write_aside(final, b"2"), final)])
    assert names_in(tmp_path) == set()


def test_a_file_that_is_exchanged_while_it_is_asked_about_is_kept(tmp_path: Path) -> None:
    final = tmp_path / "a.step"
    final.write_text("ours")

    def exchanged(path: Path) -> bool:
        (tmp_path / "theirs").write_text("somebody's")
        (tmp_path / "theirs").replace(path)
        return True

    pairs = [(write_aside(final, b"new"), final), (write_aside(final, b"x"), tmp_path / "a.dxf")]
    with pytest.raises(FileExistsError):
        replace_together(pairs, may_replace=exchanged)
    assert final.read_text() == "somebody's"
    assert names_in(tmp_path) == {"a.step"}

"""Which files a batch takes, and where their outputs belong."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder import inputs
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.errors import InputError


def put(folder: Path, *names: str) -> None:
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("x")


def labels(folder: Path, *arguments: str | Path) -> list[str]:
    found = find_sources([str(argument) for argument in arguments], folder / "out")
    return [source.label for source in found.files]


def test_a_folder_stands_for_the_cad_files_in_and_below_it(tmp_path: Path) -> None:
    put(tmp_path, "in/b.STEP", "in/a.stp", "in/x/c.igs", "in/x/d.brep", "in/e.step.gz", "in/f.p21")
    put(tmp_path, "in/notes.txt", "in/.hidden.step", "in/.git/g.step", "in/job.toml")
    assert labels(tmp_path, tmp_path / "in") == [
        "a.stp",
        "b.STEP",
        "e.step.gz",
        "f.p21",
        "x/c.igs",
        "x/d.brep",
    ]


def test_several_folders_are_told_apart_by_their_names(tmp_path: Path) -> None:
    put(tmp_path, "in/left/a.step", "in/right/a.step")
    found = labels(tmp_path, tmp_path / "in/left", tmp_path / "in/right")
    assert found == ["left/a.step", "right/a.step"]


def test_a_pattern_is_mirrored_below_its_fixed_part(tmp_path: Path) -> None:
    put(tmp_path, "in/x/a.step", "in/y/z/b.step", "in/y/c.txt")
    assert labels(tmp_path, tmp_path / "in" / "**" / "*.step") == ["x/a.step", "y/z/b.step"]


def test_a_relative_pattern_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put(tmp_path, "a1.step", "a2.step", "b.step")
    monkeypatch.chdir(tmp_path)
    assert labels(tmp_path, "a*.step") == ["a1.step", "a2.step"]
    assert labels(tmp_path, ".") == ["a1.step", "a2.step", "b.step"]


def test_a_file_named_outright_is_taken_whatever_its_suffix(tmp_path: Path) -> None:
    put(tmp_path, "in/strip.dat", "in/[1].step")
    found = labels(tmp_path, tmp_path / "in/strip.dat", tmp_path / "in/[1].step")
    assert found == ["[1].step", "strip.dat"]


def test_a_file_that_is_named_twice_counts_once(tmp_path: Path) -> None:
    put(tmp_path, "in/a.step")
    (tmp_path / "in/link.step").symlink_to("a.step")
    assert len(labels(tmp_path, tmp_path / "in", tmp_path / "in/a.step")) == 1


def test_the_output_folder_is_never_searched(tmp_path: Path) -> None:
    put(tmp_path, "a.step", "out/a.step", "out/x/b.step")
    assert labels(tmp_path, tmp_path) == ["a.step"]
    assert labels(tmp_path, tmp_path / "**/*.step") == ["a.step"]


def test_links_to_folders_are_not_followed(tmp_path: Path) -> None:
    put(tmp_path, "in/a.step")
    (tmp_path / "in/loop").symlink_to(tmp_path / "in", target_is_directory=True)
    assert labels(tmp_path, tmp_path / "in") == ["a.step"]


def test_the_order_does_not_depend_on_the_arguments(tmp_path: Path) -> None:
    put(tmp_path, "in/a.step", "in/b.step")
    paths = (tmp_path / "in/b.step", tmp_path / "in/a.step")
    assert labels(tmp_path, *paths) == labels(tmp_path, *reversed(paths)) == ["a.step", "b.step"]


def test_a_name_that_is_no_text_is_found_and_can_be_shown(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    with open(os.fsencode(tmp_path / "in") + b"/\xff\n.step", "wb") as stream:  # noqa: PTH123
        stream.write(b"x")
    (label,) = labels(tmp_path, tmp_path / "in")
    assert label == "\\udcff\\n.step"


@pytest.mark.parametrize("argument", ["none.step", "none*.step", "none/"])
def test_an_argument_that_names_nothing_is_refused(tmp_path: Path, argument: str) -> None:
    with pytest.raises(InputError, match="none"):
        find_sources([str(tmp_path / argument)], tmp_path / "out")


def test_a_folder_cannot_be_input_and_output(tmp_path: Path) -> None:
    put(tmp_path, "out/a.step")
    with pytest.raises(InputError, match="inputs are never written to"):
        find_sources([str(tmp_path / "out")], tmp_path / "out")


def test_a_folder_that_does_not_answer_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "in" / "share").mkdir(parents=True)
    (tmp_path / "in" / "a.step").write_text("1")
    answered, real = threading.Event(), os.scandir

    def stalled(path: str) -> object:
        if str(path).endswith("share"):
            answered.wait(30.0)
        return real(path)

    monkeypatch.setattr(os, "scandir", stalled)
    monkeypatch.setattr(inputs, "STALL_S", 0.2)
    with pytest.raises(InputError, match=r"stalls at .*nothing came for 0\.2 s"):
        find_sources([str(tmp_path / "in")], tmp_path / "out")
    answered.set()

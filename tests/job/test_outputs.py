from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from wrinkle_cad.errors import ExportError, JobError
from wrinkle_cad.files.staging import open_staging, release_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outputs import (
    PAGE_MARK,
    SCHEMA,
    check_outputs_are_ours,
    clear_killed,
    hashes_of,
    output_paths,
    outputs_together,
)

KINDS = ("step", "json", "html")


@pytest.fixture
def job(tmp_path: Path) -> Job:
    source = tmp_path / "in" / "shoe.step"
    source.parent.mkdir()
    source.write_text("ISO-10303-21;")
    return Job(input=source, output_dir=tmp_path / "out")


def write_all(job: Job, content: str = "made") -> None:
    with outputs_together(job, KINDS) as paths:
        paths["step"].write_text(content)
        paths["html"].write_text(f'{PAGE_MARK} 1">')
        listed = {"schema": SCHEMA, "outputs": hashes_of({"step": paths["step"]})}
        paths["json"].write_text(json.dumps(listed))


def test_outputs_appear_under_their_names_and_leave_nothing_else(job: Job) -> None:
    write_all(job)
    assert sorted(path.name for path in job.output_dir.iterdir()) == [
        "shoe.html",
        "shoe.json",
        "shoe.step",
    ]


def test_own_earlier_outputs_are_replaced(job: Job) -> None:
    write_all(job, "first")
    check_outputs_are_ours(job, KINDS)
    write_all(job, "second")
    assert (job.output_dir / "shoe.step").read_text() == "second"


def test_nothing_appears_when_writing_fails_and_the_old_outputs_stay(job: Job) -> None:
    write_all(job, "first")

    def write_half() -> None:
        with outputs_together(job, KINDS) as paths:
            paths["step"].write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        write_half()
    assert (job.output_dir / "shoe.step").read_text() == "first"
    assert len(list(job.output_dir.iterdir())) == 3


def test_when_one_output_cannot_take_its_name_all_stay_as_they_were(job: Job) -> None:
    write_all(job, "first")

    def write_without_a_page() -> None:
        with outputs_together(job, KINDS) as paths:
            paths["step"].write_text("second")
            paths["json"].write_text("{}")

    with pytest.raises(FileNotFoundError):
        write_without_a_page()
    assert (job.output_dir / "shoe.step").read_text() == "first"
    assert (job.output_dir / "shoe.json").read_text() != "{}"
    check_outputs_are_ours(job, KINDS)
    assert len(list(job.output_dir.iterdir())) == 3


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_of_somebody_else_is_not_replaced(job: Job, kind: str) -> None:
    job.output_dir.mkdir()
    output_paths(job, KINDS)[kind].write_text("{}")
    with pytest.raises(JobError, match=rf"shoe\.{kind}"):
        check_outputs_are_ours(job, KINDS)


def test_an_own_output_that_was_changed_since_is_not_replaced(job: Job) -> None:
    write_all(job)
    (job.output_dir / "shoe.step").write_text("edited by hand")
    with pytest.raises(JobError, match="changed since"):
        check_outputs_are_ours(job, KINDS)


def test_the_input_is_never_replaced(job: Job) -> None:
    beside = Job(input=job.input, output_dir=job.input.parent)
    with pytest.raises(JobError, match="replace the input"):
        check_outputs_are_ours(beside, KINDS)


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path, job: Job) -> None:
    (tmp_path / "file").write_text("")
    blocked = Job(input=job.input, output_dir=tmp_path / "file" / "out")
    with pytest.raises(ExportError, match="out"), outputs_together(blocked, KINDS):
        pass


def test_what_an_earlier_run_made_and_this_one_does_not_goes_unless_it_was_changed(
    tmp_path: Path,
) -> None:
    job = Job(input=tmp_path / "in.step", output_dir=tmp_path / "out", name="a")

    def write(*kinds: str) -> None:
        with outputs_together(job, (*kinds, "json")) as paths:
            for kind in kinds:
                paths[kind].write_text(f"{kind} of ours")
            listed = {
                "schema": "wrinkle_cad/job",
                "outputs": hashes_of({k: paths[k] for k in kinds}),
            }
            paths["json"].write_text(json.dumps(listed))

    write("dxf", "sheet1.dxf", "sheet2.dxf", "sheet3.dxf")
    (job.output_dir / "a.sheet3.dxf").write_text("marked by hand")
    (job.output_dir / "a.sheet4.dxf").write_text("somebody else's")
    write("dxf", "sheet1.dxf")
    names = sorted(path.name for path in job.output_dir.iterdir())
    assert names == ["a.dxf", "a.json", "a.sheet1.dxf", "a.sheet3.dxf", "a.sheet4.dxf"]


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("moment", range(1, 9))
def test_a_run_that_is_killed_while_files_get_their_names_is_finished_by_the_next(
    job: Job, moment: int, is_first: bool
) -> None:
    if not is_first:
        write_all(job, "first")
    child = os.fork()
    if not child:
        calls = 0

        def counted(real: Callable[..., object]) -> Callable[..., object]:
            def call(*arguments: object, **keywords: object) -> object:
                nonlocal calls
                calls += 1
                if calls == moment:
                    os._exit(0)
                return real(*arguments, **keywords)

            return call

        for name in ("link", "replace", "rename", "unlink"):
            setattr(os, name, counted(getattr(os, name)))
        write_all(job, "second")
        os._exit(0)
    os.waitpid(child, 0)
    clear_killed(job.output_dir)
    assert not [path for path in job.output_dir.iterdir() if path.name.startswith(".")]
    assert (job.output_dir / "shoe.step").read_text() == "second"
    check_outputs_are_ours(job, KINDS)
    write_all(job, "third")
    assert (job.output_dir / "shoe.step").read_text() == "third"


def test_what_is_planted_as_half_moved_replaces_nothing_foreign(job: Job, tmp_path: Path) -> None:
    write_all(job, "first")
    (job.output_dir / "mine.step").write_text("mine")
    planted = open_staging(job.output_dir)
    for name, content in (("mine.step", "new"), ("shoe.step", "new"), (".moving", "mine")):
        (planted / name).write_text(content)
    release_staging(planted)
    clear_killed(job.output_dir)
    assert (job.output_dir / "mine.step").read_text() == "mine"
    assert (job.output_dir / "shoe.step").read_text() == "first"
    assert not planted.exists()

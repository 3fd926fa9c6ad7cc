"""A batch resumes, records, and never leaves half of anything."""

from __future__ import annotations

import errno
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.batch.conftest import Bench
from tests.batch.stand_ins import KINDS, job_by_content, limits_missed_job
from wrinkle_cad.batch.folder import delivery
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchSummary, FileFinished, FileSkipped
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.lock import locked_folder
from wrinkle_cad.batch.folder.manifest import Manifest
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool
from wrinkle_cad.errors import ExportError, InputError
from wrinkle_cad.files import staging


def counts(summary: BatchSummary) -> tuple[int, int, int]:
    return summary.done, summary.failed, summary.skipped


def test_a_second_run_does_only_what_is_missing_changed_or_failed(bench: Bench) -> None:
    bench.put(a="1", b="2", c="3", d="4", e="fail@read")
    assert counts(bench.run()) == (4, 1, 0)
    bench.put(b="changed", f="new")
    (bench.outputs / "c.dxf").unlink()
    (bench.outputs / "d.dxf").unlink()
    (bench.outputs / "d.step").unlink()
    assert counts(bench.run()) == (4, 1, 1)
    redone = {event.label for event in bench.events if isinstance(event, FileFinished)}
    assert redone == {"b.step", "c.step", "d.step", "e.step", "f.step"}
    assert counts(bench.run()) == (0, 1, 5)
    assert b"4 END" in bench.files()["d.dxf"]


def test_other_settings_make_everything_again(bench: Bench) -> None:
    bench.put(a="1", b="2")
    bench.run()
    assert counts(bench.run(keywords={"tolerance": 0.04})) == (2, 0, 0)
    assert counts(bench.run(keywords={"tolerance": 0.04})) == (0, 0, 2)


def test_other_versions_make_everything_again(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.put(a="1")
    bench.run()
    versions = {**conversion_versions(), "shapely": "99"}
    monkeypatch.setattr("wrinkle_cad.batch.folder.conversion.installed_versions", lambda: versions)
    assert counts(bench.run()) == (1, 0, 0)


def conversion_versions() -> dict[str, str]:
    from wrinkle_cad.report.versions import installed_versions

    return installed_versions()


def test_force_does_everything_again(bench: Bench) -> None:
    bench.put(a="1")
    bench.run()
    assert counts(bench.run(force=True)) == (1, 0, 0)


def test_the_manifest_records_what_was_done(bench: Bench) -> None:
    bench.put(a="1", b="raise@write")
    bench.run()
    mark, *lines = (bench.outputs / "manifest.jsonl").read_text().splitlines()
    assert json.loads(mark) == {"schema": "wrinkle_cad/batch", "version": 1}
    done, failed = sorted((json.loads(line) for line in lines), key=lambda entry: entry["key"])
    assert len(done["input_sha256"]) == len(done["settings_sha256"]) == 64
    assert done["versions"]["wrinkle-cad"]
    assert {entry["name"] for entry in done["outputs"]} == {f"a.{kind}" for kind in KINDS}
    assert done["outputs"][0]["bytes"] == len(bench.files()["a.step"])
    assert done["seconds"]["read"] == 0.01
    assert (failed["outcome"], failed["phase"]) == ("failed", "write")


def test_outputs_of_a_file_that_fails_now_are_there_but_nobody_cuts_them(bench: Bench) -> None:
    bench.put(a="1")
    bench.run()
    before = bench.files()
    bench.put(a="SIGKILL@page")
    bench.run()
    assert bench.files() == {f"{name}.outdated": content for name, content in before.items()}
    bench.run()
    assert len(bench.files()) == len(KINDS)
    bench.put(a="2")
    assert counts(bench.run()) == (1, 0, 0)
    assert set(bench.files()) == {f"a.{kind}" for kind in KINDS}


def test_an_output_that_was_changed_since_is_kept_and_costs_its_file(bench: Bench) -> None:
    bench.put(a="1", b="2")
    bench.run()
    (bench.outputs / "a.dxf").write_text("edited by hand")
    bench.put(a="changed")
    assert counts(bench.run()) == (0, 1, 1)
    assert bench.files()["a.dxf"] == b"edited by hand"
    (event,) = [event for event in bench.events if isinstance(event, FileFinished)]
    assert "a.dxf" in event.record.message
    bench.put(a="fail@read")
    bench.run()
    assert bench.files()["a.dxf"] == b"edited by hand"


def test_outputs_that_are_not_written_again_go(bench: Bench) -> None:
    bench.put(a="1")
    bench.run()
    bench.run(force=True, job_function=_one_output_job)
    assert set(bench.files()) == {"a.json"}


def _one_output_job(job: object, *, progress: object = None) -> object:
    from tests.batch.stand_ins import worker_id_job

    return worker_id_job(job)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", [f"a.{kind}" for kind in KINDS])
def test_a_file_of_somebody_else_is_never_replaced(bench: Bench, name: str) -> None:
    bench.put(a="1")
    bench.outputs.mkdir()
    (bench.outputs / name).write_text("not ours")
    assert counts(bench.run()) == (0, 1, 0)
    assert bench.files() == {name: b"not ours"}
    (event,) = [event for event in bench.events if isinstance(event, FileFinished)]
    assert name in event.record.message


def test_files_that_would_collide_are_told_apart_in_the_manifest(bench: Bench) -> None:
    bench.put(a="1")
    (bench.inputs / "A.stp").write_text("2")
    assert counts(bench.run()) == (1, 1, 0)
    assert counts(bench.run()) == (0, 1, 1)
    page = (bench.outputs / "index.html").read_text()
    assert "A.stp" in page
    assert "a.step" in page


def test_output_folders_mirror_input_folders(bench: Bench) -> None:
    bench.put(**{"x/y/a": "1", "b": "2"})
    bench.run()
    assert {"x/y/a.step", "b.step"} <= set(bench.files())


@pytest.mark.parametrize("name", ["material", "profile"])
def test_a_setting_that_is_a_file_counts_by_its_content(bench: Bench, name: str) -> None:
    bench.put(a="1")
    path = bench.inputs.parent / "settings.toml"
    path.write_text("a = 1")
    keywords = {name: str(path)}
    assert counts(bench.run(keywords=keywords)) == (1, 0, 0)
    assert counts(bench.run(keywords=keywords)) == (0, 0, 1)
    path.write_text("a = 2")
    assert counts(bench.run(keywords=keywords)) == (1, 0, 0)
    path.unlink()
    assert counts(bench.run(keywords=keywords)) == (0, 1, 0)
    (event,) = [event for event in bench.events if isinstance(event, FileFinished)]
    assert "settings.toml cannot be read (No such file" in event.record.message


def test_limits_missed_fail_the_batch_only_where_that_is_asked_for(bench: Bench) -> None:
    bench.put(a="1", b="2")
    (bench.inputs / "b.job.toml").write_text("strict = true")
    summary = bench.run(job_function=limits_missed_job)
    assert (summary.done, summary.missed_limits, summary.strict_misses) == (2, 2, 1)


def test_a_folder_in_use_is_refused(bench: Bench) -> None:
    bench.put(a="1")
    bench.outputs.mkdir()
    with locked_folder(bench.outputs), pytest.raises(InputError, match="Another batch"):
        bench.run()


def test_an_unreadable_input_costs_itself(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    from wrinkle_cad.batch.folder import conversion

    real = conversion.hash_regular

    def refuse(path: Path, **limits: int) -> str:
        if path.name == "a.step" and path.parent == bench.inputs:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return real(path, **limits)

    monkeypatch.setattr(conversion, "hash_regular", refuse)
    bench.put(a="1", b="2")
    assert counts(bench.run()) == (1, 1, 0)


def test_a_full_disk_stops_the_batch_before_files_fail(bench: Bench) -> None:
    bench.put(a="1")
    with pytest.raises(ExportError, match="MiB free"):
        bench.run(least_disk_mib=10**9)
    assert not bench.files()


def test_a_disk_that_fills_up_stops_the_batch_which_goes_on_later(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.put(a="1", b="2", c="3", d="4")
    usage = shutil.disk_usage(bench.inputs)
    looks = iter([usage.free] * 3)

    def fill(path: object) -> object:
        return usage._replace(free=next(looks, 0))

    monkeypatch.setattr("wrinkle_cad.batch.folder.disk_space.shutil.disk_usage", fill)
    summary = bench.run()
    assert (summary.done, summary.left) == (2, 2)
    assert "0 MiB free" in summary.stopped_by
    monkeypatch.undo()
    assert counts(bench.run()) == (2, 0, 2)


@pytest.mark.parametrize("room", [0, 100, 5000, 40_000])
def test_a_small_disk_leaves_nothing_half_written(bench: Bench, room: int) -> None:
    """The outputs' disk takes ``room`` bytes more, by a limit on the size of files."""
    bench.put(a="x" * 400, b="y" * 10)
    summary = bench.run(job_function=_with_room(room))
    assert summary.done + summary.failed == 2
    files = bench.files()
    for name in ("a", "b"):
        whole = {key for key in files if key.startswith(f"{name}.")}
        assert whole in (set(), {f"{name}.{kind}" for kind in KINDS})
    assert all(content.endswith(b"END\n") for content in files.values())
    assert not list(staging.leftovers(bench.outputs))


class _with_room:  # noqa: N801 - reads as a function
    """A job whose process may write files of a size at most."""

    def __init__(self, room: int) -> None:
        self.room = room

    def __call__(self, job: object, *, progress: object = None) -> object:
        import resource
        import signal

        from tests.batch.stand_ins import job_by_content

        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (self.room, resource.RLIM_INFINITY))
        try:
            return job_by_content(job)  # type: ignore[arg-type]
        finally:
            resource.setrlimit(
                resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY)
            )


@pytest.mark.parametrize("step", ["commit_staging", "check_outputs_are_ours"])
def test_a_commit_that_fails_costs_one_file(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    bench.put(a="1", b="2")
    real: Callable[..., object] = getattr(delivery, step)
    calls = iter([True, False])

    def fail_once(*arguments: object, **keywords: object) -> object:
        if next(calls):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(*arguments, **keywords)

    monkeypatch.setattr(delivery, step, fail_once)
    assert counts(bench.run()) == (1, 1, 0)
    assert set(bench.files()) == {f"b.{kind}" for kind in KINDS}
    monkeypatch.undo()
    assert counts(bench.run()) == (1, 0, 1)


def test_a_manifest_that_cannot_be_written_stops_the_batch_and_loses_nothing(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.put(a="1", b="2")

    def fail(self: Manifest, record: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Manifest, "append", fail)
    with pytest.raises(ExportError, match="No space left"):
        bench.run()
    assert not bench.files()
    monkeypatch.undo()
    assert counts(bench.run()) == (1, 0, 1)
    assert len(bench.files()) == 2 * len(KINDS)
    assert any(isinstance(event, FileSkipped) for event in bench.events)


@pytest.mark.parametrize("moment", range(len(KINDS)))
def test_a_move_that_stops_half_way_is_finished_by_the_next_run(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, moment: int
) -> None:
    bench.put(a="1")
    real = os.link
    moves = iter(range(100))

    def stop(source: Path, target: Path, **keywords: bool) -> None:
        if Path(target).name.startswith("a.") and next(moves) == moment:
            raise KeyboardInterrupt
        real(source, target, **keywords)

    monkeypatch.setattr(os, "link", stop)
    with pytest.raises(KeyboardInterrupt):
        bench.run()
    monkeypatch.undo()
    assert counts(bench.run()) == (0, 0, 1)
    assert set(bench.files()) == {f"a.{kind}" for kind in KINDS}


def test_a_size_or_a_name_that_ends_like_a_file_is_text(bench: Bench) -> None:
    bench.put(a="1")
    assert counts(bench.run(keywords={"size": "42.toml", "name": "a.toml"})) == (1, 0, 0)


def test_files_that_an_interrupted_batch_did_not_come_to_are_shown_as_they_were_left(
    bench: Bench,
) -> None:
    bench.put(a="1", b="fail@read", c="2")
    bench.run()
    bench.put(d="3")

    def interrupt(event: object) -> None:
        if isinstance(event, FileSkipped):
            raise KeyboardInterrupt

    planned = plan_batch(find_sources([str(bench.inputs)], bench.outputs).files, bench.outputs)
    options = ConversionOptions(job_function=job_by_content)
    with pytest.raises(KeyboardInterrupt):
        convert(planned, bench.outputs, WorkerPool(1, WorkerLimits()), interrupt, options)
    page = (bench.outputs / "index.html").read_text()
    assert page.count("not come to; done by an earlier batch") == 1
    assert page.count("not come to; failed in an earlier batch: There are no curves.") == 1
    assert 'href="a.html"' in page
    table = (bench.outputs / "summary.csv").read_text(encoding="utf-8-sig").splitlines()
    assert [line.split(",")[1] for line in table[1:]] == ["done", *["waiting"] * 3]


def test_earlier_outputs_that_cannot_be_set_aside_cost_no_other_file(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.put(a="1", b="2")
    bench.run()
    bench.put(a="fail@read", b="3")

    def refuse(path: Path, target: Path) -> Path:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    def only_outdated(path: Path, target: Path) -> Path:
        return refuse(path, target) if str(target).endswith(".outdated") else real(path, target)

    real = Path.replace
    monkeypatch.setattr(Path, "replace", only_outdated)
    summary = bench.run()
    assert (summary.done, summary.failed) == (1, 1)
    assert "NOT marked as outdated (Permission denied)" in (bench.outputs / "batch.log").read_text()

"""The pieces of a whole batch on sheets: when they are made, made again, outdated and removed."""

from __future__ import annotations

import csv
import json
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import ezdxf
import pytest
import shapely

from tests.batch.conftest import Bench
from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.batch.folder import delivery
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchSummary
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.lock import LOCK_NAME
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.executor_pool import ExecutorPool
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.piece_file import write_pieces
from wrinkle_cad.pattern.piece.options import PieceSettings

SHEET: dict[str, object] = {"sheet": (300.0, 100.0), "source_date_epoch": 0}


def strap_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Its input says how long and wide the strap is and how many are wanted."""
    try:
        length, width, count = map(float, job.input.read_text().split())
    except ValueError as error:
        return JobFailed(job=job, phase="read", error="InputError", message=f"No strap. {error}")
    settings = PieceSettings(quantity=int(count))
    pieces = make_pieces(*strips.rectangle(length, width), name="toe", settings=settings)
    paths = [job.output_dir / f"{job.name}.dxf"]
    paths[0].write_text(job.input.read_text())
    if job.pieces_file:
        paths.append(job.output_dir / f"{job.name}.pieces")
        write_pieces(paths[1], pieces)
    return JobDone(job=job, outputs=tuple(paths), summary={})


def run(bench: Bench, *, keywords: dict[str, object] = SHEET, workers: int = 1) -> BatchSummary:
    """In threads of this process, which start at once."""
    sources = find_sources([str(bench.inputs)], bench.outputs)
    planned = plan_batch(sources.files, bench.outputs, keywords=keywords)
    with ThreadPoolExecutor(workers) as pool:
        pool = ExecutorPool(pool, workers)
        options = ConversionOptions(job_function=strap_job)
        return convert(planned, bench.outputs, pool, bench.events.append, options)


def sheets(bench: Bench) -> dict[str, bytes]:
    return {name: data for name, data in bench.files().items() if name.startswith("batch.sheets")}


def test_the_pieces_of_all_files_lie_on_sheets_once_for_every_copy(bench: Bench) -> None:
    bench.put(a="120 40 4", b="80 30 4", c="60 20 4")
    summary = run(bench)
    names = [f"batch.sheets.{number}.dxf" for number in (1, 2)]
    assert sorted(sheets(bench)) == [*names, "batch.sheets.csv"]
    assert summary.sheets.startswith("2 sheets: ")
    assert summary.sheet_failures == ()
    found: Counter[float] = Counter()
    for name in names:
        assert judge_dxf(bench.outputs / name).is_clean
        space = ezdxf.readfile(bench.outputs / name).modelspace()
        regions = [
            shapely.Polygon(line.get_points("xy")) for line in space.query("*[layer=='CUT']")
        ]
        assert all(shapely.box(0.0, 0.0, 300.0, 100.0).contains(region) for region in regions)
        first, second = shapely.STRtree(regions).query(regions, "dwithin", distance=1.5)
        assert first.tolist() == second.tolist()
        found.update(round(region.area) for region in regions)
        assert {text.dxf.text for text in space.query("TEXT")} >= {"SIZE M"}
    assert found == {4800: 4, 2400: 4, 1200: 4}
    with (bench.outputs / "batch.sheets.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    copies: Counter[tuple[str, str]] = Counter()
    for row in rows:
        copies[row["input"], row["piece"]] += int(row["copies"])
    assert copies == {("a.step", "a toe"): 4, ("b.step", "b toe"): 4, ("c.step", "c toe"): 4}
    assert summary.sheets.split("used to ")[1].startswith(rows[0]["used_percent"])
    assert summary.sheets in (bench.outputs / "index.html").read_text()
    assert summary.sheets in (bench.outputs / "batch.log").read_text()


def test_sheets_are_the_same_bytes_however_the_batch_went(bench: Bench, tmp_path: Path) -> None:
    bench.put(a="120 40 4", b="nothing", c="60 20 4")
    run(bench, workers=2)
    bench.put(b="80 30 4")
    run(bench)
    (tmp_path / "other").mkdir()
    other = Bench(tmp_path / "other")
    other.put(a="120 40 4", b="80 30 4", c="60 20 4")
    run(other, workers=2)
    assert sheets(bench) == sheets(other)


def test_sheets_are_made_again_when_a_piece_or_a_wish_changes_and_only_then(bench: Bench) -> None:
    bench.put(a="120 40 4", b="80 30 4")
    first = run(bench)
    stamps = {path: path.stat().st_mtime_ns for path in bench.outputs.glob("batch.sheets.*")}
    again = run(bench)
    assert (again.skipped, again.sheets) == (2, first.sheets)
    assert {path: path.stat().st_mtime_ns for path in stamps} == stamps
    # Another sheet needs no file to be done again.
    wider = run(bench, keywords={**SHEET, "sheet": (300.0, 200.0)})
    assert (wider.done, wider.skipped) == (0, 2)
    assert wider.sheets.startswith("1 sheet: ")
    assert sorted(sheets(bench)) == ["batch.sheets.1.dxf", "batch.sheets.csv"]
    bench.put(b="90 30 2")
    changed = run(bench, keywords={**SHEET, "sheet": (300.0, 200.0)})
    assert (changed.done, changed.skipped) == (1, 1)
    assert changed.sheets != wider.sheets
    (bench.outputs / "batch.sheets.1.dxf").unlink()
    run(bench, keywords={**SHEET, "sheet": (300.0, 200.0)})
    assert (bench.outputs / "batch.sheets.1.dxf").is_file()


def test_a_file_that_fails_is_missing_on_the_sheets_and_they_say_so(bench: Bench) -> None:
    bench.put(a="120 40 1", b="80 30 1")
    run(bench)
    bench.put(b="nothing")
    summary = run(bench)
    assert summary.failed == 1
    assert summary.sheets.endswith("Without the pieces of 1 files that failed.")
    assert "b.step" not in (bench.outputs / "batch.sheets.csv").read_text("utf-8-sig")


def test_a_piece_that_fits_on_no_sheet_costs_itself_only(bench: Bench) -> None:
    bench.put(a="120 40 1", b="500 30 1")
    for _ in range(2):
        summary = run(bench)
        (failure,) = summary.sheet_failures
        assert failure.startswith("b.step is not whole on the sheets. b toe is 500.0 x 30.0 mm")
        assert summary.sheets.startswith("1 sheet: 1 pieces")


def test_pieces_of_different_materials_come_on_different_sheets(bench: Bench) -> None:
    bench.put(a="120 40 1", b="80 30 1")
    (bench.inputs / "b.job.toml").write_text("thickness = 1.5\n")
    summary = run(bench)
    assert summary.sheets.startswith("2 sheets: 1 pieces")


def test_a_profile_without_sheets_is_told(bench: Bench) -> None:
    bench.put(a="120 40 1")
    summary = run(bench, keywords={**SHEET, "profile": "aama"})
    assert "Choose the profile cutter" in summary.sheet_failures[0]


def test_without_the_option_there_are_no_sheets_and_earlier_ones_are_outdated(bench: Bench) -> None:
    bench.put(a="120 40 1")
    run(bench, keywords={})
    assert list(bench.files()) == ["a.dxf"]
    run(bench)
    run(bench, keywords={})
    assert sorted(sheets(bench)) == ["batch.sheets.1.dxf.outdated", "batch.sheets.csv.outdated"]
    assert "a.pieces" not in bench.files()


def test_sheets_are_outdated_as_soon_as_a_file_is_done_anew(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.put(a="120 40 1", b="80 30 1")
    run(bench)
    bench.put(a="130 40 1")
    monkeypatch.setattr("wrinkle_cad.batch.folder.sheets.BatchSheets.make", _interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(bench)
    assert sorted(sheets(bench)) == ["batch.sheets.1.dxf.outdated", "batch.sheets.csv.outdated"]
    monkeypatch.undo()
    run(bench)
    assert sorted(sheets(bench)) == ["batch.sheets.1.dxf", "batch.sheets.csv"]


def _interrupted(*arguments: object, **options: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("moment", ["flush_files", "commit_staging", "move_into_place"])
def test_a_batch_that_ends_while_it_writes_sheets_has_all_of_them_or_none(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    bench.put(a="120 40 4", b="80 30 4")
    run(bench, keywords={"pieces_file": True, "source_date_epoch": 0})
    monkeypatch.setattr(delivery, moment, _interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(bench)
    monkeypatch.undo()
    assert sheets(bench) == {}
    run(bench)
    assert len(sheets(bench)) == 3
    assert [path.name for path in bench.outputs.glob(".wrinkle*")] == [LOCK_NAME]


def test_a_file_of_somebody_else_under_a_sheets_name_stays(bench: Bench) -> None:
    bench.put(a="120 40 1")
    bench.outputs.mkdir()
    theirs = bench.outputs / "batch.sheets.1.dxf"
    theirs.write_text("mine")
    summary = run(bench)
    assert theirs.read_text() == "mine"
    assert "was not written by this program" in summary.sheet_failures[0]
    assert summary.done == 1


def test_an_input_with_the_sheets_name_is_refused_with_the_reason(bench: Bench) -> None:
    bench.put(**{"batch.sheets.1": "120 40 1", "a": "80 30 1"})
    summary = run(bench)
    assert (summary.done, summary.failed) == (1, 1)
    lines = (bench.outputs / "manifest.jsonl").read_text().splitlines()[1:]
    assert any("such names" in json.loads(line)["message"] for line in lines)


def test_a_damaged_file_of_pieces_is_made_anew(bench: Bench) -> None:
    bench.put(a="120 40 1")
    run(bench)
    (bench.outputs / "a.pieces").write_text("{}")
    with pytest.raises(InputError):
        _read(bench.outputs / "a.pieces")
    summary = run(bench)
    # What was changed by somebody else is not replaced, and the sheets lack it.
    assert summary.failed == 1
    assert summary.sheets == ""


def _read(path: Path) -> object:
    from wrinkle_cad.pattern.formats.piece_file import read_pieces

    return read_pieces(path)

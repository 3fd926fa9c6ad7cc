"""What is tried where a strip is not developable or misses a limit."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from build123d import Edge, Face, Line

from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.trials import levers_of
from wrinkle_cad.job.workflow import run_job


def rails_file(folder: Path, p: Any, q: Any) -> Path:
    path = folder / "rails.step"
    write_step(path, [Part(p.wrapped, "P"), Part(q.wrapped, "Q")])
    return path


def skew_file(folder: Path) -> Path:
    return rails_file(folder, Line((0, 0, 0), (100, 0, 0)), Line((0, 20, 0), (100, 20, 53)))


def upper_file(folder: Path) -> Path:
    rails = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
    shapes = zip([Face.make_rect(100, 60), *rails], ["upper", "P", "Q"], strict=True)
    path = folder / "upper.step"
    write_step(path, [Part(shape.wrapped, name) for shape, name in shapes])
    return path


def strips_of(job: Job) -> list[dict[str, Any]]:
    done = run_job(job)
    assert isinstance(done, JobDone), done
    text = next(path for path in done.outputs if path.suffix == ".json").read_text("utf-8")
    return json.loads(text)["strips"]


def test_a_developable_strip_that_misses_nothing_is_not_tried_on(tmp_path: Path) -> None:
    flat = rails_file(tmp_path, Line((0, 0, 0), (80, 0, 0)), Line((0, 20, 0), (80, 20, 0)))
    (strip,) = strips_of(Job(input=flat, output_dir=tmp_path / "out", max_strain_percent=1.0))
    assert strip["passed"] is True
    assert strip["trials"] == []


def test_a_stretched_strip_is_tried_with_a_finer_tolerance_and_without_a_price(
    tmp_path: Path,
) -> None:
    (strip,) = strips_of(Job(input=skew_file(tmp_path), output_dir=tmp_path / "out"))
    assert [trial["change"] for trial in strip["trials"]] == [
        "--tolerance 0.0125",
        "--price none",
        "--criteria bending",
        "--surface smooth",
    ]
    for trial in strip["trials"]:  # neither can help: there is no developable strip
        assert trial["state"] == "stretched"
        assert trial["max_strain_percent"] == pytest.approx(strip["max_strain_percent"], rel=0.01)
        assert trial["passed"] is None


def test_trials_can_be_left_out(tmp_path: Path) -> None:
    job = Job(input=skew_file(tmp_path), output_dir=tmp_path / "out", no_trials=True)
    (strip,) = strips_of(job)
    assert strip["state"] == "stretched"
    assert strip["trials"] == []


def test_a_missed_limit_says_what_was_tried_on_the_waves(tmp_path: Path) -> None:
    job = Job(
        input=upper_file(tmp_path),
        output_dir=tmp_path / "out",
        waves=3,
        height=2,
        margin=16,
        min_radius_mm=30.0,
    )
    done = run_job(job)
    assert isinstance(done, JobDone), done
    wrinkle, *bands = done.summary["strips"]
    assert wrinkle["passed"] is False
    trials = {trial["change"]: trial for trial in wrinkle["trials"]}
    assert list(trials) == [
        "--height 1",
        "--margin 24",
        "--fade 0.45",
        "--tolerance 0.0125",
        "--price none",
    ]
    radius = trials["--height 1"]["inner_bend_radius_mm"]
    # Waves half as high bend half as sharply.
    assert radius == pytest.approx(2.0 * wrinkle["inner_bend_radius_mm"], rel=0.1)
    (reason,) = done.missed_limits
    assert f"--height 1 gives {radius:.1f} mm" in reason
    # So wide an opening leaves the upper.
    assert "failed" in trials["--margin 24"]
    for band in bands:
        if band["passed"] is False:
            # Tolerance, price and criteria leave a band's rails what they are.
            assert [trial["change"] for trial in band["trials"]] == list(trials)[:3]


@pytest.mark.parametrize(
    ("options", "changes"),
    [
        ({"price": None}, ["--tolerance 0.0125"]),
        ({"search": "local"}, ["--tolerance 0.0125"]),
        ({"criteria": ("bending",)}, ["--tolerance 0.0125"]),
        ({"tolerance": 0.2}, ["--tolerance 0.05", "--price none"]),
    ],
)
def test_a_lever_that_would_change_nothing_is_not_tried(
    options: dict[str, Any], changes: list[str]
) -> None:
    job = Job(input=Path("strip.step"), **options)
    assert [lever.words for lever in levers_of(job, on_upper=False)] == changes


def test_where_the_piece_is_not_the_surface_judged_what_cuts_that_is_tried() -> None:
    job = Job(input=Path("strip.step"))
    words = [lever.words for lever in levers_of(job, on_upper=False, piece_differs=True)]
    assert words[2:] == ["--criteria bending", "--surface smooth"]
    job = Job(input=Path("strip.step"), surface="smooth", criteria=("bending",))
    assert [lever.words for lever in levers_of(job, on_upper=False, piece_differs=True)] == [
        "--tolerance 0.0125"
    ]


def test_smooth_faces_are_tried_where_nothing_else_makes_the_piece_the_surface(
    tmp_path: Path,
) -> None:
    vamp = Path(__file__).parents[2] / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
    (strip,) = strips_of(Job(input=vamp, output_dir=tmp_path / "out"))
    assert strip["cut"]["differs"]
    differs = {trial["change"]: trial["cut_differs"] for trial in strip["trials"]}
    assert differs == {
        "--tolerance 0.0125": False,
        "--price none": True,
        "--criteria bending": False,
    }


def test_on_an_upper_the_levers_are_those_of_the_waves() -> None:
    job = Job(input=Path("shoe.step"), waves=5, height=(3, 2), phase_deg=(0, 60), fade=0.4)
    words = [lever.words for lever in levers_of(job, on_upper=True)]
    assert words[:4] == ["--height 1.5,1", "--margin 4.5", "--fade 0.5", "--phase-deg 0"]


def test_the_gap_of_a_run_says_which_rail_to_turn(tmp_path: Path) -> None:
    (strip,) = strips_of(Job(input=skew_file(tmp_path), output_dir=tmp_path / "out"))
    (gap,) = strip["gaps"]
    turn = gap["turn"]
    assert abs(turn["turn_deg"]) == pytest.approx(math.degrees(math.atan(0.53)), rel=0.01)
    assert turn["strain_percent"] <= 0.1
    assert f"Turn {turn['rail']} by 27.9°" in gap["advice"]


@pytest.mark.slow
def test_what_a_trial_says_is_what_a_run_with_that_change_gives(tmp_path: Path) -> None:
    asked: dict[str, Any] = {
        "input": upper_file(tmp_path),
        "waves": 3,
        "height": 2,
        "min_radius_mm": 30.0,
    }
    tried = strips_of(Job(output_dir=tmp_path / "out", **asked))[0]["trials"]
    trials = {trial["change"]: trial for trial in tried}
    for change, setting in (
        ("--height 1", {"height": 1}),
        ("--fade 0.45", {"fade": 0.45}),
        ("--price none", {"price": None}),
    ):
        job = Job(output_dir=tmp_path / "again", no_trials=True, **{**asked, **setting})
        strip = strips_of(job)[0]
        for key in ("inner_bend_radius_mm", "max_strain_percent", "developable_share"):
            assert trials[change][key] == pytest.approx(strip[key], rel=1e-6, abs=1e-9)

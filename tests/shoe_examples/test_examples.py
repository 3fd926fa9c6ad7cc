"""Every example on the shoe upper: built anew, run as a user would, its result judged."""

from __future__ import annotations

import importlib
import json
import runpy
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image

from shoe_examples.rails import rail_points
from shoe_examples.upper import section_poles, upper_face
from tests.cad.measuring import bounding_box
from tests.cad.stitch_checks import freecad_report, reread, shell_faults
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.kernel.measures import face_areas, is_valid
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges
from wrinkle_cad.job.job import make_job
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.workflow import run_job
from wrinkle_cad.pattern.check.judging import judge_dxf

FOLDER = Path(__file__).parents[2] / "shoe_examples"
OUTPUTS = {".step", ".stl", ".dxf", ".json", ".html"}
EXAMPLES = ("one_wrinkle", "three_wrinkles", "across_seam", "feather_to_feather")
RUN = [
    "feather_to_feather",
    *(
        pytest.param(name, marks=pytest.mark.slow)
        for name in ("one_wrinkle", "three_wrinkles", "across_seam", "cuff")
    ),
]
"""By default one whose seams are not measured by default; rings are tried elsewhere."""


@pytest.fixture(scope="module")
def folder_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Runs an example when it is first asked for; returns the folder with its outputs."""

    @cache
    def run(name: str) -> Path:
        folder = tmp_path_factory.mktemp(name)
        keywords, toml = {"output_dir": folder}, FOLDER / name / "job.toml"
        outcome = run_job(make_job(FOLDER / name / f"{name}.step", keywords, toml))
        assert isinstance(outcome, JobDone), outcome
        assert {path.suffix for path in outcome.outputs} >= OUTPUTS
        return folder

    return run


def test_the_upper_is_a_last_of_size_42() -> None:
    face = upper_face()
    low, high = bounding_box(face)
    assert len(section_poles()) >= 8
    assert high[0] - low[0] == pytest.approx(280.0, abs=4.0)
    assert high[1] - low[1] == pytest.approx(100.0, abs=3.0)
    assert is_valid(face)
    assert len(free_edges(face)) == 2
    smaller = bounding_box(upper_face(39))
    assert smaller[1][0] - smaller[0][0] == pytest.approx((high[0] - low[0]) * 39 / 42)


def test_the_instep_girth_is_that_of_size_42() -> None:
    """Over the instep from feather edge to feather edge, and back under the foot."""
    over = rail_points(upper_face(), 150.0, reach_deg=(-88.0, 88.0))
    girth = np.linalg.norm(np.diff(over, axis=0), axis=1).sum() + np.linalg.norm(over[-1] - over[0])
    assert girth == pytest.approx(250.0, abs=12.0)


@pytest.mark.parametrize("name", RUN)
def test_an_example_runs_and_its_shell_is_sound(
    name: str, folder_of: Callable[[str], Path]
) -> None:
    folder = folder_of(name)
    (upper,) = read_cad(FOLDER / name / f"{name}.step").surfaces()
    report = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))["stitch"]
    shell = reread(folder / f"{name}.step")
    assert shell_faults(shell, report["faces"], upper.shape) == []
    assert report["is_valid"]
    assert report["max_edge_tolerance_mm"] <= 1e-3
    assert abs(report["area_balance_mm2"]) <= 1e-5 * upper.measure
    assert report["free_length_after_mm"] == pytest.approx(
        report["free_length_before_mm"], abs=1e-3
    )


@pytest.mark.parametrize("name", ["one_wrinkle", "feather_to_feather"])
def test_without_waves_the_rails_on_the_upper_are_sewn_directly(name: str, tmp_path: Path) -> None:
    step = FOLDER / name / f"{name}.step"
    outcome = run_job(make_job(step, {"output_dir": tmp_path, "allow_split": True}))
    assert isinstance(outcome, JobDone), outcome
    assert [strip["name"] for strip in outcome.summary["strips"]] == [name]
    (upper,) = read_cad(step).surfaces()
    faces = outcome.summary["stitch"]["faces"]
    assert shell_faults(reread(tmp_path / f"{name}.step"), faces, upper.shape) == []


@pytest.mark.freecad
def test_freecad_reads_every_example(
    freecadcmd: str, tmp_path: Path, folder_of: Callable[[str], Path]
) -> None:
    paths, expected = [], []
    for name in EXAMPLES:
        paths.append(folder_of(name) / f"{name}.step")
        summary = paths[-1].with_suffix(".json").read_text(encoding="utf-8")
        report = json.loads(summary)["stitch"]
        expected.append(f"1 {report['faces']} True {round(report['free_length_before_mm'], 2)}")
    assert freecad_report(freecadcmd, paths, tmp_path) == expected


STRIPS = ("square_to_round", "lampshade", "boat_plank", "auger")


@pytest.mark.parametrize("name", [*EXAMPLES, "cuff", *STRIPS])
def test_the_committed_input_is_what_its_script_builds(name: str, tmp_path: Path) -> None:
    built = tmp_path / f"{name}.step"
    kept = (FOLDER / name / built.name).read_bytes()
    write_step(built, importlib.import_module(f"shoe_examples.{name}.build").parts())
    assert [line for line in built.read_bytes().splitlines() if b"FILE_NAME" not in line] == [
        line for line in kept.splitlines() if b"FILE_NAME" not in line
    ]


@pytest.mark.parametrize("name", [*EXAMPLES, "cuff"])
def test_the_picture_shows_the_upper_from_two_views(name: str) -> None:
    picture = image.imread(FOLDER / name / "picture.png")[..., :3]
    is_drawn = picture.min(axis=2) < 0.9
    half = picture.shape[1] // 2
    assert is_drawn[:, :half].mean() > 0.1
    assert is_drawn[:, half:].mean() > 0.1
    assert is_drawn[:, :2].mean() == is_drawn[:, -2:].mean() == 0.0
    # Shaded, not flat: many tones.
    assert len(np.unique((picture[is_drawn] * 40).astype(int), axis=0)) > 50


def test_the_cuff_that_is_kept_is_watertight() -> None:
    folder = FOLDER / "cuff"
    (upper,) = read_cad(folder / "cuff.step").surfaces()
    shell = reread(folder / "stitched.step")
    assert shell_faults(shell, len(faces_of(shell)), upper.shape) == []
    assert judge_dxf(folder / "pattern.dxf").is_clean


def test_the_duct_that_is_kept_has_four_planes_and_four_cones() -> None:
    folder = FOLDER / "square_to_round"
    shell = reread(folder / "duct.step")
    assert len(faces_of(shell)) == 8
    assert sum(face_areas(faces_of(shell), relative_error=1e-8)) == pytest.approx(
        89_811.953498, rel=1e-5
    )
    assert judge_dxf(folder / "duct.dxf").is_clean


def test_the_picture_of_the_states_shows_a_strip_of_each() -> None:
    script = runpy.run_path(str(FOLDER / "states" / "picture.py"))
    states = ("developable", "stretched", "creased", "folded")
    strips = {
        state: WrinkleStrip(*script["rails"]()[state], criteria=("bending",)) for state in states
    }
    assert {state: strip.report.state for state, strip in strips.items()} == {s: s for s in states}
    assert (FOLDER / "states" / "picture.png").stat().st_size < 200_000

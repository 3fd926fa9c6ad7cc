from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import pytest

from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed
from wrinkle_cad.job.workflow import run_job

EXAMPLE = Path(__file__).parents[2] / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
BAD_FILES = (
    "Ad014.stp",
    "Gn002.stp",
    "N010.stp",
    "empty_0byte.step",
    "not_a_step_file.step",
    "wigley_is_gzip.step",
    "wigley_lfs_pointer.step",
    "wigley_truncated60.step",
)


def run(job: Job) -> JobDone:
    outcome = run_job(job)
    assert isinstance(outcome, JobDone), outcome.message
    return outcome


def fail(job: Job) -> JobFailed:
    outcome = run_job(job)
    assert isinstance(outcome, JobFailed)
    assert "\n" not in outcome.message
    return outcome


def test_the_json_holds_the_contract(tmp_path: Path) -> None:
    done = run(Job(input=EXAMPLE, output_dir=tmp_path, source_date_epoch=0))
    told = json.loads((tmp_path / "vamp_strip.json").read_text())
    for key in ("input", "settings", "versions", "strips", "findings", "seconds"):
        assert key in told
    (strip,) = told["strips"]
    assert strip["interior_bridges"] == strip["samples_p"] + strip["samples_q"] - 3
    assert strip["inflection_bridges"] <= strip["invalid_bridges"] <= strip["interior_bridges"]
    assert strip["area_pattern_mm2"] == pytest.approx(strip["area_3d_mm2"], rel=1e-6)
    for rail in ("p", "q"):
        lengths = strip["seam_lengths_mm"][rail]
        assert lengths["pattern"] == pytest.approx(lengths["space"], rel=1e-6)
    assert told["strips"] == json.loads(json.dumps(done.summary["strips"]))


def test_the_same_job_gives_the_same_bytes(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        run(Job(input=EXAMPLE, output_dir=tmp_path / folder, source_date_epoch=1_700_000_000))
    for kind in ("step", "stl", "dxf"):
        first, second = (tmp_path / f / f"vamp_strip.{kind}" for f in ("a", "b"))
        assert first.read_bytes() == second.read_bytes(), kind
    first_json, second_json = (
        json.loads((tmp_path / f / "vamp_strip.json").read_text()) for f in ("a", "b")
    )
    first_json.pop("seconds")
    second_json.pop("seconds")
    assert first_json == second_json


def test_the_time_in_the_outputs_is_the_one_given(tmp_path: Path) -> None:
    for folder, epoch in (("a", 0), ("b", 86_400 * 365)):
        run(Job(input=EXAMPLE, output_dir=tmp_path / folder, source_date_epoch=epoch))
    assert b"1970-01-01" in (tmp_path / "a" / "vamp_strip.step").read_bytes()
    assert b"1971-01-01" in (tmp_path / "b" / "vamp_strip.step").read_bytes()


def test_progress_tells_every_phase_in_turn(tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    run_job(
        Job(input=EXAMPLE, output_dir=tmp_path),
        progress=lambda phase, done, total: told.append((phase, done, total)),
    )
    counts = [done for _, done, _ in told]
    assert counts == sorted(counts)
    assert counts[-1] == told[-1][2]
    assert {"read", "strip", "surface", "write"} <= {phase for phase, _, _ in told}


def test_a_missing_file_fails_in_one_line(tmp_path: Path) -> None:
    failed = fail(Job(input=tmp_path / "gone.step", output_dir=tmp_path))
    assert failed.phase == "read"
    assert "gone.step" in failed.message


def test_outputs_of_somebody_else_stop_the_job_before_any_work(tmp_path: Path) -> None:
    (tmp_path / "vamp_strip.step").write_text("mine")
    failed = fail(Job(input=EXAMPLE, output_dir=tmp_path))
    assert "vamp_strip.step" in failed.message
    assert (tmp_path / "vamp_strip.step").read_text() == "mine"
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.realdata
def test_each_bad_file_fails_with_its_own_cause(realdata: Path, tmp_path: Path) -> None:
    messages = {}
    for name in (*BAD_FILES, "../machined_part_inch.step"):
        failed = fail(Job(input=realdata / "bad" / name, output_dir=tmp_path / "out"))
        messages[name] = failed.message.replace(Path(name).name, "")
    assert len(set(messages.values())) == len(messages)
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())
    for name, word in {
        "empty_0byte.step": "empty",
        "not_a_step_file.step": "not a STEP",
        "wigley_lfs_pointer.step": "pointer",
        "wigley_truncated60.step": "truncated",
        "wigley_is_gzip.step": "compressed",
        "../machined_part_inch.step": "curve",
    }.items():
        assert word.lower() in messages[name].lower(), messages[name]


PAIRS = [
    ("bellyfairing_guides.brep", "1", "2"),
    ("nacelle_guides.brep", "1", "2"),
    *(
        pytest.param("nacelle_guides.brep", str(i), str(j), marks=pytest.mark.slow)
        for i, j in [*combinations(range(1, 5), 2)][1:]
    ),
    ("spiralwing_guides.brep", "1", "2"),
    ("spiralwing_guides.brep", "2", "3"),
]


@pytest.mark.realdata
@pytest.mark.parametrize(("file", "p", "q"), PAIRS)
def test_real_rails_become_a_valid_shell_that_survives_its_file(
    realdata: Path, tmp_path: Path, file: str, p: str, q: str
) -> None:
    from tests.cad.measuring import area_of
    from wrinkle_cad.cad.exchange.read import read_cad
    from wrinkle_cad.cad.kernel.measures import is_valid, tolerance_of
    from wrinkle_cad.cad.kernel.topology import faces_of

    done = run(Job(input=realdata / file, output_dir=tmp_path, p=p, q=q))
    again = read_cad(next(path for path in done.outputs if path.suffix == ".step"))
    (shell,) = again.shapes
    assert shell.kind == "shell"
    assert shell.name == done.summary["strips"][0]["name"]
    assert is_valid(shell.shape)
    assert tolerance_of(shell.shape) <= 1e-3
    assert area_of(shell.shape) == pytest.approx(done.summary["strips"][0]["area_3d_mm2"], rel=1e-6)
    assert len(faces_of(shell.shape)) == done.summary["strips"][0]["faces"]


@pytest.mark.realdata
def test_a_pair_of_coinciding_rails_is_refused(realdata: Path, tmp_path: Path) -> None:
    job = Job(input=realdata / "spiralwing_guides.brep", output_dir=tmp_path, p="1", q="3")
    assert "same curve" in fail(job).message


ON_UPPER = EXAMPLE.parent.parent / "one_wrinkle" / "one_wrinkle.step"


def on_upper(folder: Path, **options: object) -> Job:
    return Job(input=ON_UPPER, output_dir=folder, **options)


@pytest.fixture(scope="module")
def designed(tmp_path_factory: pytest.TempPathFactory) -> JobDone:
    folder = tmp_path_factory.mktemp("designed")
    return run(on_upper(folder, waves=5, height=3, margin=4, notches=3, svg=True, pdf=True))


def test_waves_on_an_upper_give_one_watertight_shell(designed: JobDone) -> None:
    stitch = designed.summary["stitch"]
    assert stitch["is_valid"]
    assert stitch["free_edges_after"] == stitch["free_edges_before"]
    assert stitch["max_edge_tolerance_mm"] <= 1e-3
    assert abs(stitch["area_balance_mm2"]) <= 1e-5 * stitch["area_mm2"]
    roles = [strip["role"] for strip in designed.summary["strips"]]
    assert roles == ["strip", "band", "band"]


def test_the_step_holds_the_shell_and_the_notches_by_name(designed: JobDone) -> None:
    from wrinkle_cad.cad.exchange.read import read_cad

    shapes = read_cad(next(path for path in designed.outputs if path.suffix == ".step")).shapes
    assert [shape.kind for shape in shapes].count("shell") == 1
    names = {shape.name for shape in shapes}
    for number in (1, 2, 3):
        assert f"one_wrinkle P notch {number}" in names
        assert f"one_wrinkle band Q opening notch {number}" in names


def test_svg_and_pdf_are_written_on_request(designed: JobDone) -> None:
    by_kind = {path.suffix: path.read_bytes() for path in designed.outputs}
    assert by_kind[".pdf"].startswith(b"%PDF")
    assert b"<svg" in by_kind[".svg"]
    assert list(by_kind) == [".step", ".stl", ".dxf", ".json", ".html", ".svg", ".pdf"]


def test_the_stl_of_a_stitched_upper_is_open_at_the_uppers_border_only(
    designed: JobDone,
) -> None:
    import numpy as np
    import trimesh

    mesh = trimesh.load(next(path for path in designed.outputs if path.suffix == ".stl"))
    edges, uses = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    assert uses.max() == 2
    border = mesh.vertices[edges[uses == 1]]
    length = np.linalg.norm(border[:, 1] - border[:, 0], axis=1).sum()
    assert length == pytest.approx(designed.summary["stitch"]["free_length_after_mm"], rel=2e-3)
    assert mesh.is_winding_consistent


def test_drawn_profiles_off_the_upper_are_stitched_as_they_are(tmp_path: Path) -> None:
    from wrinkle_cad.cad.build123d_objects import to_build123d
    from wrinkle_cad.cad.exchange.read import read_cad
    from wrinkle_cad.cad.exchange.shapes import Part
    from wrinkle_cad.cad.exchange.write import write_step
    from wrinkle_cad.cad.upper.carve import carve
    from wrinkle_cad.cad.upper.profiles import wrinkle_profiles

    given = {shape.name: shape.shape for shape in read_cad(ON_UPPER).shapes}
    opening = carve(given["upper"], given["P"], given["Q"], margin=4)
    p, q = wrinkle_profiles(opening, waves=5, height=3)
    drawn = tmp_path / "drawn.step"
    parts = [Part(given["upper"], "upper"), Part(p.wrapped, "P"), Part(q.wrapped, "Q")]
    write_step(drawn, parts)
    done = run(Job(input=drawn, output_dir=tmp_path / "out"))
    assert done.summary["stitch"]["is_valid"]
    assert {finding.code for finding in done.findings} >= {"rail-off-upper"}
    wrinkle = done.summary["strips"][0]
    for rail, edge in (("p", p), ("q", q)):
        own = to_build123d(edge.wrapped)
        assert wrinkle["seam_lengths_mm"][rail]["space"] == pytest.approx(own.length, rel=1e-3)


def test_waves_without_an_upper_are_refused(tmp_path: Path) -> None:
    failed = fail(Job(input=EXAMPLE, output_dir=tmp_path, waves=5, height=3))
    assert "no upper" in failed.message


def test_missed_limits_are_told_and_the_outputs_written(tmp_path: Path) -> None:
    done = run(Job(input=EXAMPLE, output_dir=tmp_path, max_fold_deg=1.0, max_twist_deg=80.0))
    assert len(done.missed_limits) == 1
    assert "fold" in done.missed_limits[0]
    assert done.summary["verdict"]["passed"] is False
    assert len(done.outputs) == 5


def test_a_materials_thickness_reaches_the_pattern(tmp_path: Path) -> None:
    material = tmp_path / "calf.toml"
    material.write_text('name = "calf"\nthickness_mm = 2.0\nsmallest_bend_radius_mm = 100.0\n')
    done = run(
        Job(
            input=EXAMPLE,
            output_dir=tmp_path / "out",
            material=str(material),
            surface_side="inside",
        )
    )
    assert any("bend radius" in line for line in done.missed_limits)
    assert "calf" in (tmp_path / "out" / "vamp_strip.dxf").read_text()


def test_sheets_of_nested_pieces_are_outputs_like_the_others(tmp_path: Path) -> None:
    job = Job(input=EXAMPLE, output_dir=tmp_path, sheet=(300.0, 200.0), nest_seconds=0, quantity=2)
    done = run(job)
    sheet = tmp_path / "vamp_strip.sheet1.dxf"
    assert sheet in done.outputs
    told = json.loads((tmp_path / "vamp_strip.json").read_text())
    assert told["outputs"]["sheet1.dxf"]["bytes"] == sheet.stat().st_size
    assert "Sheet 1 of" in next(f["message"] for f in told["findings"] if f["code"] == "nested")
    run(job)
    sheet.write_text("somebody else's")
    assert "sheet1.dxf" in fail(job).message


def test_a_bend_table_is_an_output_with_a_row_for_every_bend(tmp_path: Path) -> None:
    done = run(Job(input=EXAMPLE, output_dir=tmp_path, equal_bends=6))
    table = tmp_path / "vamp_strip.bends.csv"
    assert table in done.outputs
    rows = table.read_text().splitlines()
    assert rows[0].startswith("piece,bend,direction,angle_deg,radius_mm")
    assert len(rows) >= 1 + 6
    assert "bends-reduced" in [finding.code for finding in done.findings]

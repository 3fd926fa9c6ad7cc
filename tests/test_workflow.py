from __future__ import annotations

import json
from pathlib import Path

import pytest

from wrinkle_cad.job import Job
from wrinkle_cad.outcome import JobDone, JobFailed
from wrinkle_cad.workflow import run_job

EXAMPLE = Path(__file__).parent.parent / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
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
    *(("nacelle_guides.brep", str(i), str(j)) for i, j in ((1, 2), (2, 3), (3, 4), (4, 1))),
    ("spiralwing_guides.brep", "1", "2"),
    ("spiralwing_guides.brep", "2", "3"),
]


@pytest.mark.realdata
@pytest.mark.parametrize(("file", "p", "q"), PAIRS)
def test_real_rails_become_a_valid_shell_that_survives_its_file(
    realdata: Path, tmp_path: Path, file: str, p: str, q: str
) -> None:
    from wrinkle_cad.cad.kernel import area_of, faces_of, is_valid, tolerance_of
    from wrinkle_cad.cad.read import read_cad

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

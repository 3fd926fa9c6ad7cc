from __future__ import annotations

import math
from pathlib import Path

import pytest

from wrinkle_cad.errors import JobError
from wrinkle_cad.job.job import Job, make_job, read_job_toml


def test_the_outputs_are_named_after_the_input_without_its_suffixes() -> None:
    assert Job(input=Path("a/shoe 42.step")).name == "shoe 42"
    assert Job(input=Path("shoe.stp.gz")).name == "shoe"
    assert Job(input=Path("v1.2.IGES")).name == "v1.2"
    assert Job(input=Path("no_suffix")).name == "no_suffix"


def test_keywords_go_before_the_file_and_the_file_before_the_defaults(tmp_path: Path) -> None:
    toml = tmp_path / "job.toml"
    toml.write_text('tolerance = 0.2\nsurface = "facets"\n')
    job = make_job(Path("x.step"), {"tolerance": 0.1, "surface": None}, toml)
    assert job.tolerance == 0.1
    assert job.surface == "facets"
    assert job.search == "global"


def test_paths_in_a_job_file_start_at_its_folder(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text('output_dir = "made"\n')
    assert read_job_toml(tmp_path / "job.toml")["output_dir"] == tmp_path / "made"


def test_one_number_stands_for_both_rails_and_for_all_sides() -> None:
    job = Job(input=Path("x.step"), waves=5, height=[2, 3], seam_allowance=6)
    assert job.waves == (5.0, 5.0)
    assert job.height == (2.0, 3.0)
    assert job.seam_allowance == (6.0, 6.0, 6.0, 6.0)


def test_positions_and_holes_become_tuples() -> None:
    job = Job(input=Path("x.step"), notch_at_p=[10, 20], drill_holes=[[0.5, 0.25]])
    assert job.notch_at_p == (10.0, 20.0)
    assert job.drill_holes == ((0.5, 0.25),)


def test_a_profile_file_in_a_job_file_starts_at_its_folder(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text('profile = "our_layers.toml"\n')
    read = read_job_toml(tmp_path / "job.toml")
    assert read["profile"] == str(tmp_path / "our_layers.toml")


def test_a_job_file_may_say_that_validity_has_no_price(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text('price = "none"\n')
    assert make_job(Path("x.step"), None, tmp_path / "job.toml").price is None
    assert make_job(Path("x.step"), {"price": 3.0}, tmp_path / "job.toml").price == 3.0
    assert make_job(Path("x.step")).price == 50.0


def test_criteria_from_a_job_file_become_a_tuple(tmp_path: Path) -> None:
    (tmp_path / "job.toml").write_text('criteria = ["area"]\n')
    assert make_job(Path("x.step"), None, tmp_path / "job.toml").criteria == ("area",)


@pytest.mark.parametrize(
    ("keywords", "named"),
    [
        ({"tolerance": 0.0}, "tolerance"),
        ({"tolerance": -1.0}, "tolerance"),
        ({"tolerance": math.nan}, "tolerance"),
        ({"tolerance": math.inf}, "tolerance"),
        ({"tolerance": "0.1"}, "tolerance"),
        ({"tolerance": True}, "tolerance"),
        ({"max_chord": 0}, "max_chord"),
        ({"surface": "nurbs"}, "surface"),
        ({"search": "best"}, "search"),
        ({"energy": "none"}, "energy"),
        ({"step_schema": "AP203"}, "step_schema"),
        ({"unit": "furlong"}, "unit"),
        ({"name": "../x"}, "name"),
        ({"name": ".."}, "name"),
        ({"name": "a\nb"}, "name"),
        ({"name": "é" * 101}, "name"),
        ({"colour": "red"}, "colour"),
        ({"waves": 5}, "height"),
        ({"height": 5}, "waves"),
        ({"waves": (1, 2, 3), "height": 1}, "waves"),
        ({"waves": "many", "height": 1}, "waves"),
        ({"seam_allowance": (1, 2)}, "seam_allowance"),
        ({"seam_allowance": (1, 2, 3, math.nan)}, "seam_allowance"),
        ({"grain": 1}, "grain"),
        ({"notch_at_p": "10"}, "notch_at_p"),
        ({"notch_at_q": (1, math.inf)}, "notch_at_q"),
        ({"drill_holes": ((0.5,),)}, "drill_holes"),
        ({"mitre_limit": 0}, "mitre_limit"),
        ({"notch_kind": "round"}, "notch_kind"),
        ({"notches": -1}, "notches"),
        ({"notches": 1.5}, "notches"),
        ({"quantity": 0}, "quantity"),
        ({"side": "up"}, "side"),
        ({"dxf_version": "R14"}, "dxf_version"),
        ({"max_fold_deg": -1}, "max_fold_deg"),
        ({"source_date_epoch": -1}, "source_date_epoch"),
        ({"source_date_epoch": 10**15}, "source_date_epoch"),
    ],
)
def test_a_setting_out_of_its_range_is_named(keywords: dict[str, object], named: str) -> None:
    with pytest.raises(JobError, match=named) as caught:
        make_job(Path("x.step"), keywords)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text", ["tolerance = ", "colour = 1\n", "\ud800".encode("utf-8", "replace")]
)
def test_a_job_file_that_cannot_be_used_is_named(tmp_path: Path, text: str | bytes) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(JobError, match=r"bad\.toml"):
        read_job_toml(path)


def test_a_job_file_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(JobError, match=r"gone\.toml"):
        read_job_toml(tmp_path / "gone.toml")

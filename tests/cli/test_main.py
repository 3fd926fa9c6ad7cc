"""The command line as a user meets it: every test is a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "shoe_examples" / "vamp_strip" / "vamp_strip.step"


def wrinkle_cad(*arguments: str | Path, **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "wrinkle_cad", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        env={**os.environ, **more},
    )


def test_run_writes_the_five_files_and_prints_where(tmp_path: Path) -> None:
    done = wrinkle_cad("run", EXAMPLE, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {f"vamp_strip.{kind}" for kind in ("step", "stl", "dxf", "json", "html")}
    for name in names:
        assert name in done.stdout
    assert done.stderr == ""


def test_quiet_prints_nothing(tmp_path: Path) -> None:
    done = wrinkle_cad("run", EXAMPLE, "-o", tmp_path, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_a_failure_is_one_line_and_leaves_no_file(tmp_path: Path) -> None:
    bad = tmp_path / "bad.step"
    bad.write_text("not a step file")
    done = wrinkle_cad("run", bad, "-o", tmp_path / "out")
    assert done.returncode == 1
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert "bad.step" in done.stderr
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def test_debug_adds_the_traceback(tmp_path: Path) -> None:
    done = wrinkle_cad("run", tmp_path / "gone.step", "-o", tmp_path, "--debug")
    assert done.returncode == 1
    assert "Traceback" in done.stderr


def test_wrong_usage_ends_with_two() -> None:
    assert wrinkle_cad("run").returncode == 2
    assert wrinkle_cad("run", EXAMPLE, "--surface", "nurbs").returncode == 2
    assert wrinkle_cad("fly").returncode == 2


@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_a_tolerance_out_of_range_is_refused(tmp_path: Path, value: str) -> None:
    done = wrinkle_cad("run", EXAMPLE, "-o", tmp_path, "--tolerance", value)
    assert done.returncode == 1
    assert "tolerance" in done.stderr


def test_version_names_this_program_and_the_kernel() -> None:
    done = wrinkle_cad("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("wrinkle-cad ")
    assert "build123d" in done.stdout


def test_inspect_lists_the_shapes_and_what_would_be_taken() -> None:
    done = wrinkle_cad("inspect", EXAMPLE)
    assert done.returncode == 0, done.stderr
    assert "P" in done.stdout
    assert "Q" in done.stdout
    told = json.loads(wrinkle_cad("inspect", EXAMPLE, "--json").stdout)
    assert [row["taken_as"] for row in told["rows"]] == ["P", "Q"]
    assert told["rows"][0]["measure"] == pytest.approx(170.95, abs=0.01)
    assert told["unit"] == "mm"


def test_doctor_finds_nothing_wrong_here() -> None:
    done = wrinkle_cad("doctor")
    assert done.returncode == 0, done.stdout
    assert "PROBLEM" not in done.stdout


def test_doctor_says_when_the_cache_cannot_be_written() -> None:
    done = wrinkle_cad("doctor", NUMBA_CACHE_DIR="/dev/null/cache")
    assert done.returncode == 1
    assert "compile cache" in done.stdout


def test_a_wrong_source_date_epoch_is_named(tmp_path: Path) -> None:
    done = wrinkle_cad("run", EXAMPLE, "-o", tmp_path, SOURCE_DATE_EPOCH="yesterday")
    assert done.returncode == 1
    assert "SOURCE_DATE_EPOCH" in done.stderr

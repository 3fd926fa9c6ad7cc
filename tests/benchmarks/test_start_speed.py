"""How fast the program starts; run with: pytest tests/benchmarks --benchmark-only."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

EXAMPLE = Path(__file__).parents[2] / "shoe_examples" / "vamp_strip" / "vamp_strip.step"

FIRST_BYTE = """
import sys, time
started, path = float(sys.argv[1]), sys.argv[2]
def watch(event, arguments):
    if event == "open" and str(arguments[0]) == path:
        print(time.time() - started, file=sys.stderr)
sys.addaudithook(watch)
from wrinkle_cad.cli import main
main(["run", path, "-o", sys.argv[3], "--quiet"])
"""


def run(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, *arguments], check=True, capture_output=True, text=True, env=os.environ
    )
    return done.stderr


def test_importing_the_package(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(run, ("-c", "import wrinkle_cad"), rounds=5, warmup_rounds=1)
    assert benchmark.stats.stats.median < 0.3


def test_the_help(benchmark: BenchmarkFixture) -> None:
    benchmark.pedantic(run, ("-m", "wrinkle_cad", "--help"), rounds=5, warmup_rounds=1)
    assert benchmark.stats.stats.median < 0.5


def test_from_the_start_of_a_run_to_the_first_byte_read(
    benchmark: BenchmarkFixture, tmp_path: Path
) -> None:
    waits: list[float] = []

    def one_run() -> None:
        told = run("-c", FIRST_BYTE, str(time.time()), str(EXAMPLE), str(tmp_path))
        waits.append(float(told.splitlines()[0]))

    benchmark.pedantic(one_run, rounds=5, warmup_rounds=1)
    median = sorted(waits[1:])[2]
    benchmark.extra_info["first_byte_s"] = median
    assert median < 1.5


@pytest.mark.parametrize("surface", ["cones", "facets"])
def test_a_whole_run_in_a_fresh_process(
    benchmark: BenchmarkFixture, tmp_path: Path, surface: str
) -> None:
    arguments = ("-m", "wrinkle_cad", "run", str(EXAMPLE), "-o", str(tmp_path), "--quiet")
    benchmark.pedantic(run, (*arguments, "--surface", surface), rounds=5, warmup_rounds=1)
    assert (tmp_path / "vamp_strip.step").stat().st_size > 0

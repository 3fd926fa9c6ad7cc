"""How fast strips are searched, and in how much memory; run with --benchmark-only."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from wrinkle_cad.strip import triangulate

CODE = """
import psutil
from tests.benchmarks.test_search_speed import wavy_strip
from wrinkle_cad.strip import triangulate

triangulate(*wavy_strip(50))
p, q = wavy_strip(5000)
process = psutil.Process()
before = process.memory_info().rss
triangulate(p, q)
import resource
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print((peak - before) / 1e6)
"""


def wavy_strip(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Rails that wave out of phase: the search has to look everywhere."""
    t = np.linspace(0.0, 1.0, count)
    p = np.stack((100 * t, 0 * t, 3 * np.sin(25 * t)), axis=1)
    return p, np.stack((100 * t, 10 + 0 * t, 3 * np.sin(25 * t + 1)), axis=1)


@pytest.mark.benchmark(group="search")
@pytest.mark.parametrize(
    "criteria",
    [("invalid", "bending"), ("bending",), ("area",), ("invalid", "bending", "area", "length")],
    ids="+".join,
)
def test_a_million_bridges(benchmark, criteria: tuple[str, ...]) -> None:
    strip = wavy_strip(1000)
    triangulate(*strip, criteria=criteria)
    benchmark(triangulate, *strip, criteria=criteria)
    if criteria == ("invalid", "bending"):
        assert benchmark.stats.stats.median < 0.15


@pytest.mark.benchmark(group="search")
def test_twenty_five_million_bridges(benchmark) -> None:
    strip = wavy_strip(5000)
    triangulate(*wavy_strip(50))
    benchmark.pedantic(triangulate, strip, rounds=3)
    assert benchmark.stats.stats.median < 4.0


@pytest.mark.benchmark(group="search")
def test_the_local_search(benchmark) -> None:
    strip = wavy_strip(1000)
    triangulate(*strip, search="local")
    found = benchmark(triangulate, *strip, search="local")
    assert found.search == "local"


@pytest.mark.benchmark(group="search")
def test_memory_for_twenty_five_million_bridges(benchmark) -> None:
    def peak() -> float:
        result = subprocess.run(
            [sys.executable, "-c", CODE], check=True, capture_output=True, text=True, env=os.environ
        )
        return float(result.stdout)

    megabytes = benchmark.pedantic(peak, rounds=1)
    benchmark.extra_info["megabytes"] = megabytes
    assert megabytes < 400

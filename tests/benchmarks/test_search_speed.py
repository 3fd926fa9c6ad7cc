"""How fast strips are searched, and in how much memory; run with --benchmark-only."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time

import numpy as np
import pytest

from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.bars import Bars
from wrinkle_cad.strip.folding import HINGE
from wrinkle_cad.strip.global_search import best_steps
from wrinkle_cad.strip.objective import weights_of
from wrinkle_cad.strip.rails import default_planarity, round_off

CODE = """
import psutil
from tests.benchmarks.test_search_speed import wavy_strip
from wrinkle_cad.strip import triangulate

triangulate(*wavy_strip(600))
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


def cylinder_strip(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Rails on a cylinder: hardly any bridge is looked at."""
    t = np.linspace(0.0, 3.0, count)
    x, y = 30 * np.cos(t), 30 * np.sin(t)
    p = np.stack((x, y, 4 * np.sin(5 / 3 * t)), axis=1)
    return p, np.stack((x, y, 40 + 4 * np.cos(4 / 3 * t)), axis=1)


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
    triangulate(*wavy_strip(600))
    benchmark.pedantic(triangulate, strip, rounds=3)
    assert benchmark.stats.stats.median < 4.0


def full_program(p: np.ndarray, q: np.ndarray) -> None:
    """Bars that bar nothing send the search over all bridges, row by row."""
    weights = weights_of(("invalid", "bending"), bridge_count=len(p) + len(q))
    planarity, nothing = default_planarity(p, q), round_off(p, q)
    bars = Bars(np.zeros((len(p), len(q)), dtype=np.bool_), -2.0)
    best_steps(p, q, weights, planarity=planarity, nothing=nothing, energy=HINGE, bars=bars)


@pytest.mark.benchmark(group="search", timer=time.process_time)
@pytest.mark.parametrize(("price", "times"), [(50.0, 2.0), (None, 2.5)])
def test_the_whole_search_is_faster_than_the_program_over_all_bridges(
    benchmark, price: float | None, times: float
) -> None:
    strip = wavy_strip(1000)
    full_program(*strip)
    triangulate(*strip, price=price)
    taken = []
    for _ in range(3):
        before = time.process_time()
        full_program(*strip)
        taken.append(time.process_time() - before)
    benchmark(triangulate, *strip, price=price)
    ratio = min(taken) / benchmark.stats.stats.min
    benchmark.extra_info["times as fast"] = ratio
    assert ratio > times


@pytest.mark.benchmark(group="search", timer=time.process_time)
def test_time_grows_with_the_samples_of_a_developable_strip(benchmark) -> None:
    triangulate(*cylinder_strip(600), price=None)
    taken = {}
    for count in (1000, 10_000):
        times = []
        for _ in range(3):
            before = time.process_time()
            triangulate(*cylinder_strip(count), price=None)
            times.append(time.process_time() - before)
        taken[count] = min(times)
    long = cylinder_strip(100_000)
    benchmark.pedantic(triangulate, long, {"price": None}, rounds=2)
    seconds = benchmark.stats.stats.min
    benchmark.extra_info["exponent"] = exponent = math.log(seconds / taken[1000]) / math.log(100)
    assert seconds < 2.0
    assert exponent < 1.1


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
    assert megabytes < 40

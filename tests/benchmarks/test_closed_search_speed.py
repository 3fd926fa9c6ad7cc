"""How much longer a closed strip takes than one open search; run with --benchmark-only."""

from __future__ import annotations

import time

import numpy as np
import pytest

from wrinkle_cad.strip import triangulate

Rails = tuple[np.ndarray, np.ndarray]
TIMES = {"smooth": 10.0, "planar": 25.0, "noisy": 25.0}


def ring(
    count: int, radius: float, height: float, *, waves: int, rise: float, bulge: float
) -> np.ndarray:
    t = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    r = radius + bulge * np.sin(waves * t)
    return np.stack((r * np.cos(t), r * np.sin(t), height + rise * np.sin(waves * t)), axis=1)


def closed_rails(kind: str, m: int, n: int) -> Rails:
    if kind == "planar":
        return (
            ring(m, 50.0, 0.0, waves=7, rise=0.0, bulge=3.0),
            np.roll(ring(n, 35.0, 0.0, waves=5, rise=0.0, bulge=3.0), n // 7, axis=0),
        )
    p = ring(m, 50.0, 0.0, waves=5, rise=4.0, bulge=0.0)
    q = np.roll(ring(n, 40.0, 60.0, waves=3, rise=4.0, bulge=0.0), n // 7, axis=0)
    if kind == "smooth":
        return p, q
    random = np.random.default_rng(3)
    return p + random.normal(0.0, 0.5, p.shape), q + random.normal(0.0, 0.5, q.shape)


def seconds_of_an_open_search(p: np.ndarray, q: np.ndarray) -> float:
    """The least processor time of three, of the rails cut where they happen to begin."""
    opened = [np.concatenate((rail, rail[:1])) for rail in (p, q)]
    taken = []
    for _ in range(4):
        before = time.process_time()
        triangulate(*opened)
        taken.append(time.process_time() - before)
    return min(taken[1:])


@pytest.mark.benchmark(group="closed search", timer=time.process_time)
@pytest.mark.parametrize("kind", TIMES)
def test_a_closed_strip_against_one_open_search(benchmark, kind: str) -> None:
    p, q = closed_rails(kind, 180, 240)
    triangulate(p, q, closed=True)
    once = seconds_of_an_open_search(p, q)
    benchmark.pedantic(triangulate, (p, q), {"closed": True}, rounds=5)
    times = benchmark.stats.stats.median / once
    benchmark.extra_info["open searches"] = times
    assert times <= TIMES[kind]


@pytest.mark.benchmark(group="closed search", timer=time.process_time)
@pytest.mark.parametrize("kind", TIMES)
@pytest.mark.parametrize("count", [250, 500, 1000, 2000])
def test_growth_of_the_closed_search(benchmark, kind: str, count: int) -> None:
    p, q = closed_rails(kind, count, count)
    triangulate(*closed_rails(kind, 60, 60), closed=True)
    once = seconds_of_an_open_search(p, q)
    found = benchmark.pedantic(triangulate, (p, q), {"closed": True}, rounds=1)
    benchmark.extra_info["open searches"] = times = benchmark.stats.stats.median / once
    assert found.interior_count == 2 * count
    assert times <= TIMES[kind]

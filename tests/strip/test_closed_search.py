from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations, pairwise, permutations

import numpy as np
import pytest

from tests.strip import brute_force
from wrinkle_cad.strip.closed_search import ClosedPath, closed_steps
from wrinkle_cad.strip.folding import ENERGIES
from wrinkle_cad.strip.objective import weights_of

NAMES = ("invalid", "bending", "area", "length")
LISTS = [names for count in range(1, 5) for names in permutations(NAMES, count)]
PRICED = [names for names in LISTS if names[:2] == ("invalid", "bending")]
CHOICES = [
    *((names, energy, None) for names in LISTS for energy in ("hinge", "paper")),
    *((names, "hinge", price) for names in PRICED for price in (1.0, 50.0)),
]
USUAL = [(("invalid", "bending"), "hinge", price) for price in (None, 1.0, 50.0)]


class Around(list):
    """A closed rail as a list that goes on for ever, in both directions."""

    def __init__(self, points: np.ndarray) -> None:
        super().__init__(points.tolist())
        self.count = len(points)

    def __getitem__(self, index: int) -> list[float]:
        return super().__getitem__(index % self.count)

    def __len__(self) -> int:
        return 10**9


def ways_around(m: int, n: int) -> Iterator[tuple[tuple[int, int], ...]]:
    """The bridges of every closed triangulation, from the P-step that leaves i = 0."""
    for start in range(n):
        for chosen in combinations(range(m + n - 1), m - 1):
            path = [(0, start), (1, start)]
            for step in range(m + n - 1):
                i, j = path[-1]
                path.append((i + 1, j) if step in chosen else (i, j + 1))
            yield tuple(path)


def every_way_around(p: np.ndarray, q: np.ndarray, energy: str, ways: dict | None = None) -> dict:
    """What each closed triangulation measures, by its triangles; its bridges go into `ways`."""
    m, n = len(p), len(q)
    lines = Around(p), Around(q)
    shift = 10 * m, 10 * n
    known: dict = {}

    def bent(a: tuple, b: tuple, c: tuple) -> tuple[float, int, int]:
        key = (a[0] - b[0], c[0] - b[0], b[0] % m, b[1] % n)
        if key not in known:
            known[key] = brute_force.bend(*lines, a, b, c, energy)
        return known[key]

    valid = {
        (i, j): brute_force.is_valid(*lines, shift[0] + i, shift[1] + j)
        for i in range(m)
        for j in range(n)
    }
    tried = {}
    for way in ways_around(m, n):
        path = [(i + shift[0], j + shift[1]) for i, j in way]
        before = (path[-2][0] - m, path[-2][1] - n)
        around = [before, *path]
        bends = [bent(*around[k - 1 : k + 2]) for k in range(1, len(around) - 1)]
        corners = [brute_force.third(*lines, *path[k : k + 2]) for k in range(len(path) - 1)]
        if ways is not None:
            ways[triangles_of(way, m, n)] = list(way)
        tried[triangles_of(way, m, n)] = {
            "fold-backs": sum(back for _, _, back in bends),
            "degenerate": sum(brute_force.is_flat(three) for three in corners),
            "invalid": sum(
                not valid[i % m, j % n] and bool(bend)
                for (i, j), (_, bend, _) in zip(way[:-1], bends, strict=True)
            ),
            "bending": math.fsum(bending for bending, _, _ in bends),
            "area": math.fsum(map(brute_force.area_of, corners)),
            "length": math.fsum(
                brute_force.norm(brute_force.minus(lines[1][j], lines[0][i])) for i, j in path[:-1]
            ),
        }
    return tried


def triangles_of(way: tuple[tuple[int, int], ...], m: int, n: int) -> frozenset:
    """Which steps leave which bridges; the same however one counts around."""
    steps = pairwise(way)
    return frozenset((a[0] % m, a[1] % n, b[0] - a[0]) for a, b in steps)


def way_of(found: ClosedPath) -> tuple[tuple[int, int], ...]:
    path = [found.start]
    for step in found.steps.tolist():
        i, j = path[-1]
        path.append((i + 1 - step, j + step))
    return tuple(path)


def ring(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Two closed rails: rough, on a grid of integers, flat, prisms, or on a cone."""
    random = np.random.default_rng([41, seed])
    m, n = random.integers(2, 7, 2)
    kind = seed % 5
    if kind == 1:
        n = m
    turns = [np.sort(random.uniform(0, 2 * np.pi, k)) for k in (m, n)]
    p, q = (np.stack((np.cos(t), np.sin(t), 0 * t), axis=1) for t in turns)
    above = np.array([0.0, 0.0, 1.0])
    if kind == 0:
        q = q + above
        return p + random.normal(0, 0.3, p.shape), q + random.normal(0, 0.3, q.shape)
    if kind == 1:
        return p, p + above
    if kind == 2:
        return np.round(2 * p), np.round(2 * q) + above
    if kind == 3:
        return 2 * p, q
    return 2 * p, q + above


def cost_of_invalid(tried: dict, price: float, interior: int) -> float:
    fewest = min((one["fold-backs"], one["degenerate"]) for one in tried.values())
    return (
        price
        / interior
        * min(
            one["bending"]
            for one in tried.values()
            if (one["fold-backs"], one["degenerate"]) == fewest
        )
    )


def assert_none_is_better(seed: int, choices: list) -> None:
    p, q = ring(seed)
    interior = len(p) + len(q)
    tried = {energy: every_way_around(p, q, energy) for energy in ("hinge", "paper")}
    for criteria, energy, price in choices:
        every = tried[energy]
        cost = None if price is None else cost_of_invalid(every, price, interior)
        found = closed_steps(
            p,
            q,
            weights_of(criteria, bridge_count=interior + 1, invalid_cost=cost),
            planarity=brute_force.PLANARITY,
            nothing=1e-14,
            energy=ENERGIES[energy],
        )
        way = way_of(found)
        assert way[-1] == (way[0][0] + len(p), way[0][1] + len(q))
        least = brute_force.best(
            [brute_force.cost_of(one, criteria, cost) for one in every.values()]
        )
        one = every[triangles_of(way, len(p), len(q))]
        for part, best in zip(brute_force.cost_of(one, criteria, cost), least, strict=True):
            assert brute_force.is_close(part, best), (seed, criteria, energy, price, part, least)


@pytest.mark.parametrize("seed", range(5))
def test_no_way_around_a_small_closed_strip_is_better(seed: int) -> None:
    assert_none_is_better(seed, CHOICES)


@pytest.mark.parametrize("seed", range(5, 20))
def test_no_way_around_is_better_by_the_usual_objectives(seed: int) -> None:
    assert_none_is_better(seed, USUAL)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 120))
def test_no_way_around_many_closed_strips_is_better(seed: int) -> None:
    assert_none_is_better(seed, CHOICES)

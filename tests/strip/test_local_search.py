from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.strip import brute_force, exact_strips
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate, validity_matrix


def easier(p: list, q: list, before: tuple | None, i: int, j: int, energy: str) -> int:
    """The step that bends bridge (i, j) less, in plain Python."""
    costs = []
    for after in ((i + 1, j), (i, j + 1)):
        flat = brute_force.is_flat(brute_force.third(p, q, (i, j), after))
        bent, _, back = (
            brute_force.bend(p, q, before, (i, j), after, energy) if before else (0.0, 0, 0)
        )
        length = brute_force.norm(brute_force.minus(q[after[1]], p[after[0]]))
        costs.append((back, flat, bent, length))
    return 0 if costs[0] <= costs[1] else 1


def nearest(valid: np.ndarray, i: int, j: int) -> tuple[int, int]:
    m, n = valid.shape
    targets = [
        ((k - i) + (h - j), -k, (k, h))
        for k in range(i + 1, m)
        for h in range(j + 1, n)
        if valid[k, h] or (k, h) == (m - 1, n - 1)
    ]
    return min(targets)[2]


def by_the_paper(p: np.ndarray, q: np.ndarray, energy: str, *, lodt: bool) -> Iterator[int]:
    """LODT+LMBT or LMBT, written from section 4 of the paper."""
    valid = validity_matrix(p, q).copy()
    m, n = valid.shape
    valid[-1, -1] = True
    points = p.tolist(), q.tolist()
    path = [(0, 0)]
    goal = None if lodt else (m - 1, n - 1)
    while path[-1] != (m - 1, n - 1):
        i, j = path[-1]
        before = path[-2] if len(path) > 1 else None
        if goal == (i, j):
            goal = None
        if goal is None and i < m - 1 and j < n - 1 and not (valid[i + 1, j] or valid[i, j + 1]):
            goal = nearest(valid, i, j)
        last_i, last_j = goal or (m - 1, n - 1)
        if i == last_i or j == last_j:
            step = 1 if i == last_i else 0
        elif goal is None and valid[i + 1, j] != valid[i, j + 1]:
            step = 0 if valid[i + 1, j] else 1
        else:
            step = easier(*points, before, i, j, energy)
        path.append((i + 1 - step, j + step))
        yield step


@pytest.mark.parametrize("energy", ["hinge", "paper"])
@pytest.mark.parametrize("first", ["invalid", "bending"])
def test_the_steps_are_those_of_the_paper(first: str, energy: str) -> None:
    stalls = 0
    for seed in range(12):
        if seed < 6:
            p, q = exact_strips.random_points(seed, 15, 12)
        else:
            strip = exact_strips.wrinkled(seed).sampled(1e-2)
            p, q = strip.p, strip.q
        found = triangulate(p, q, criteria=(first, "area"), search="local", energy=energy)
        expected = list(by_the_paper(p, q, energy, lodt=first == "invalid"))
        assert found.steps.tolist() == expected
        stalls += found.invalid_count
    assert stalls > 20


def test_global_is_never_worse_and_often_better() -> None:
    better = 0
    for seed in range(10):
        strip = exact_strips.wrinkled(seed).sampled(1e-2)
        best = triangulate(strip.p, strip.q, price=None)
        local = triangulate(strip.p, strip.q, search="local")
        assert (best.counted_invalid_count, best.bending) <= (
            local.counted_invalid_count,
            local.bending,
        )
        better += best.invalid_count < local.invalid_count
        least = triangulate(strip.p, strip.q, criteria=("bending",))
        greedy = triangulate(strip.p, strip.q, criteria=("bending",), search="local")
        assert least.bending <= greedy.bending * (1 + 1e-12)
    assert better >= 5


def test_both_searches_find_a_developable_strip() -> None:
    strip = exact_strips.convex_cylinder(1).sampled(1e-3)
    assert triangulate(strip.p, strip.q, search="local").invalid_count == 0


def test_the_result_says_how_it_was_found() -> None:
    strip = exact_strips.convex_cylinder(1).sampled(1e-2)
    found = triangulate(strip.p, strip.q, criteria=["bending"], search="local", energy="paper")
    assert (found.criteria, found.search, found.energy) == (("bending",), "local", "paper")


@pytest.mark.parametrize("first", ["area", "length"])
def test_local_search_by_other_criteria_is_refused(first: str) -> None:
    strip = exact_strips.convex_cylinder(1).sampled(1e-2)
    with pytest.raises(InputError, match=f"local search cannot start with the criterion {first}"):
        triangulate(strip.p, strip.q, criteria=(first,), search="local")


def test_an_unknown_search_is_refused() -> None:
    strip = exact_strips.convex_cylinder(1).sampled(1e-2)
    with pytest.raises(InputError, match="search cannot be 'fast': choose one of global, local"):
        triangulate(strip.p, strip.q, search="fast")

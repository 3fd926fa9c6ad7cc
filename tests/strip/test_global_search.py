from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from tests.strip import brute_force, exact_strips
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import Triangulation, triangulate
from wrinkle_cad.strip.global_search import weights_of

NAMES = ("invalid", "bending", "area", "length")
LISTS = [names for count in range(1, 5) for names in permutations(NAMES, count)]
PLANARITY = 1e-13


def value_of(found: Triangulation, part: str) -> float:
    counts = {"invalid": found.invalid_count, "degenerate": found.degenerate_count}
    return counts[part] if part in counts else getattr(found, part)


def small_strip(seed: int) -> tuple[np.ndarray, np.ndarray]:
    m, n = np.random.default_rng([9, seed]).integers(2, 8, 2)
    return exact_strips.random_points(seed, int(m), int(n))


@pytest.mark.parametrize("energy", ["hinge", "paper"])
@pytest.mark.parametrize("decade", range(20))
def test_no_triangulation_of_a_small_strip_is_better(decade: int, energy: str) -> None:
    for seed in range(10 * decade, 10 * decade + 10):
        p, q = small_strip(seed)
        tried = brute_force.every_triangulation(p.tolist(), q.tolist(), energy)
        for criteria in LISTS:
            found = triangulate(p, q, criteria=criteria, energy=energy, planarity=PLANARITY)
            for part, least in brute_force.best(tried, criteria)[0]:
                value = value_of(found, part)
                assert brute_force.is_close(value, least), (seed, criteria, part, value, least)


def test_the_comparison_with_every_triangulation_can_fail() -> None:
    differs = 0
    for seed in range(20):
        p, q = small_strip(seed)
        tried = brute_force.every_triangulation(p.tolist(), q.tolist(), "hinge")
        found = triangulate(p, q, criteria=("area",), planarity=PLANARITY)
        values, _ = brute_force.best(tried, ("bending",))
        differs += any(not brute_force.is_close(value_of(found, part), v) for part, v in values)
    assert differs > 10


def test_few_of_the_small_strips_are_ties() -> None:
    ties = 0
    for seed in range(40):
        p, q = small_strip(seed)
        tried = brute_force.every_triangulation(p.tolist(), q.tolist(), "hinge")
        ties += brute_force.best(tried, ("invalid", "bending"))[1]
    assert ties < 12


def test_a_count_before_the_bending_is_never_paid_for_with_energy() -> None:
    for seed in range(6):
        strip = exact_strips.wrinkled(seed).sampled(1e-2)
        both = triangulate(strip.p, strip.q)
        bending = triangulate(strip.p, strip.q, criteria=("bending",))
        assert both.invalid_count <= bending.invalid_count
        assert both.bending >= bending.bending * (1 - 1e-12)


def test_equal_continuations_take_the_p_step() -> None:
    grid = np.arange(4.0)
    p = np.stack((grid, 0 * grid, 0 * grid), axis=1)
    found = triangulate(p, p + np.array([0.0, 1.0, 0.0]))
    assert found.bending == 0.0
    assert found.invalid_count == 0
    assert found.steps.tolist() == [0, 0, 0, 1, 1, 1]


def test_a_later_criterion_breaks_exact_ties() -> None:
    grid = np.arange(4.0)
    p = np.stack((grid, 0 * grid, 0 * grid), axis=1)
    found = triangulate(p, p + np.array([0.0, 1.0, 0.0]), criteria=("invalid", "bending", "length"))
    assert found.steps.tolist() == [0, 1, 0, 1, 0, 1]


def test_counts_are_compared_before_everything_behind_them() -> None:
    assert weights_of(("invalid", "bending")) == (
        (2.0**26, 1.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 1.0, 0.0, 0.0),
    )
    assert weights_of(("area", "bending")) == (
        (0.0, 0.0, 0.0, 1.0, 0.0),
        (0.0, 1.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 1.0, 0.0, 0.0),
    )


@pytest.mark.parametrize("criteria", [(), ("invalid", "invalid"), ("beauty",), ("area", "size")])
def test_criteria_that_are_no_ordered_choice_are_refused(criteria: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match=r"criteria - .* - an ordered choice of invalid"):
        weights_of(criteria)

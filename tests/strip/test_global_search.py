from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from tests.strip import brute_force, exact_strips
from tests.strip.small_strips import makes_a_strip, small_strip
from wrinkle_cad.strip import Triangulation, triangulate

NAMES = ("invalid", "bending", "area", "length")
LISTS = [names for count in range(1, 5) for names in permutations(NAMES, count)]
PRICED = [names for names in LISTS if names[:2] == ("invalid", "bending")]
CHOICES = [
    *((names, energy, None) for names in LISTS for energy in ("hinge", "paper")),
    *((names, "hinge", price) for names in PRICED for price in (1.0, 50.0)),
]


def assert_none_is_better(seed: int, choices: list = CHOICES) -> None:
    """Compares with every triangulation of a small strip."""
    p, q = small_strip(seed)
    tried = {
        energy: brute_force.every_triangulation(p.tolist(), q.tolist(), energy)
        for energy in ("hinge", "paper")
    }
    for criteria, energy, price in choices:
        found = triangulate(
            p, q, criteria=criteria, energy=energy, price=price, planarity=brute_force.PLANARITY
        )
        measured = tried[energy]
        cost = None if price is None else brute_force.invalid_cost(measured, price)
        least = brute_force.best(
            [brute_force.cost_of(one, criteria, cost) for one in measured.values()]
        )
        one = measured[tuple(map(tuple, found.bridges.tolist()))]
        for part, best in zip(brute_force.cost_of(one, criteria, cost), least, strict=True):
            assert brute_force.is_close(part, best), (seed, criteria, energy, price, part, least)
        assert_measured(found, one)


def assert_measured(found: Triangulation, one: brute_force.Measures) -> None:
    assert found.fold_back_count == one["fold-backs"]
    assert found.degenerate_count == one["degenerate"]
    assert found.counted_invalid_count == one["invalid"]
    assert found.invalid_count == one["all invalid"]
    for part in ("bending", "area", "length"):
        assert brute_force.is_close(getattr(found, part), one[part]), part


@pytest.mark.parametrize("seed", makes_a_strip(range(24)))
def test_no_triangulation_of_a_small_strip_is_better(seed: int) -> None:
    assert_none_is_better(seed)


@pytest.mark.parametrize("seed", makes_a_strip(range(24, 64)))
def test_no_triangulation_of_a_small_strip_is_better_by_the_usual_objectives(seed: int) -> None:
    usual = [choice for choice in CHOICES if choice[:2] == (("invalid", "bending"), "hinge")]
    assert_none_is_better(seed, usual)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(40))
def test_no_triangulation_of_many_small_strips_is_better(block: int) -> None:
    for seed in makes_a_strip(range(24 + 8 * block, 32 + 8 * block)):
        assert_none_is_better(seed)


def test_the_comparison_with_every_triangulation_can_fail() -> None:
    differs = 0
    for seed in range(24):
        p, q = small_strip(seed)
        tried = brute_force.every_triangulation(p.tolist(), q.tolist(), "hinge")
        costs = [brute_force.cost_of(one, ("area",), None) for one in tried.values()]
        worst = max(costs)
        differs += not all(map(brute_force.is_close, worst, brute_force.best(costs)))
    assert differs > 12


def test_every_count_occurs_among_the_best_of_the_small_strips() -> None:
    found = [triangulate(*small_strip(seed)) for seed in makes_a_strip(range(80))]
    for name in ("fold_back_count", "degenerate_count", "counted_invalid_count"):
        assert sum(getattr(one, name) > 0 for one in found) >= 3, name
    assert sum(one.invalid_count > one.counted_invalid_count for one in found) >= 3


def test_without_a_price_a_valid_bridge_is_never_given_up_for_energy() -> None:
    for seed in range(6):
        strip = exact_strips.wrinkled(seed).sampled(1e-2)
        both = triangulate(strip.p, strip.q, price=None)
        bending = triangulate(strip.p, strip.q, criteria=("bending",))
        assert both.counted_invalid_count <= bending.counted_invalid_count
        assert both.bending >= bending.bending * (1 - 1e-12)


def test_a_higher_price_buys_valid_bridges_with_bending() -> None:
    bought = 0
    for seed in range(6):
        strip = exact_strips.wrinkled(seed).sampled(1e-2)
        prices = (0.0, 0.3, 1.0, 3.0, 10.0, 50.0, None)
        found = [triangulate(strip.p, strip.q, price=price) for price in prices]
        counts = [one.counted_invalid_count for one in found]
        energies = [one.bending for one in found]
        assert counts == sorted(counts, reverse=True)
        assert energies == sorted(energies)
        bending = triangulate(strip.p, strip.q, criteria=("bending",))
        assert energies[0] == pytest.approx(bending.bending, rel=1e-12)
        bought += len(set(counts))
    assert bought >= 18


def test_of_equal_continuations_the_shorter_bridge_is_taken_then_the_p_step() -> None:
    along = np.arange(4.0)
    p = exact_strips.stack(along, 0 * along, 0 * along)
    assert triangulate(p, p + np.array([0.0, 1.0, 0.0])).steps.tolist() == [0, 1, 0, 1, 0, 1]
    assert triangulate(p, p + np.array([0.1, 1.0, 0.0])).steps.tolist() == [0, 1, 0, 1, 0, 1]
    assert triangulate(p, p - [0.1, 1.0, 0.0]).steps.tolist() == [1, 0, 1, 0, 1, 0]


def test_round_off_does_not_decide_between_equal_triangulations() -> None:
    turns = np.linspace(0.0, 3.0, 12)
    p = exact_strips.stack(5 * np.cos(turns), 5 * np.sin(turns), 0 * turns)
    q = p + np.array([0.3, 0.2, 4.0])
    i, j = triangulate(p, q).bridges.T
    shorter = [
        int(np.linalg.norm(q[k] - p[k + 1]) > np.linalg.norm(q[k + 1] - p[k])) for k in range(11)
    ]
    assert (np.abs(i - j) <= 1).all()
    assert triangulate(p, q).steps[::2].tolist() == shorter

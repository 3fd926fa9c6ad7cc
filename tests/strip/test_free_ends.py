"""Free ends, against every triangulation of every shortened small strip."""

from __future__ import annotations

import math
from itertools import accumulate, pairwise

import numpy as np
import pytest

from tests.seeds import seeds
from tests.strip import brute_force
from tests.strip.small_strips import makes_a_strip, small_strip
from wrinkle_cad.strip import Triangulation, triangulate
from wrinkle_cad.strip.validity_price import GIVE_UP_PRICE

CHOICES = [
    (("invalid", "bending"), "hinge", 50.0),
    (("invalid", "bending"), "hinge", None),
    (("bending",), "hinge", None),
    (("bending", "invalid"), "paper", None),
    (("invalid", "bending", "area"), "hinge", 1.0),
    (("area", "length"), "hinge", None),
    (("length", "invalid"), "hinge", None),
]


def arcs_of(rail: list) -> list[float]:
    steps = [brute_force.norm(brute_force.minus(b, a)) for a, b in pairwise(rail)]
    return [0.0, *accumulate(steps)]


def ends_of(rail: list, give_up: float) -> list[tuple[int, int, float]]:
    """First and last sample that a shortened rail may have, and the mm that it loses."""
    arcs = arcs_of(rail)
    if len(rail) == 1:
        return [(0, 0, 0.0)]
    return [
        (a, b, arcs[a] + arcs[-1] - arcs[b])
        for a in range(len(rail))
        for b in range(a + 1, len(rail))
        if arcs[a] <= give_up and arcs[-1] - arcs[b] <= give_up
    ]


def cost_of(one: dict, criteria, cost: float | None, per_mm: float | None) -> list[float]:
    """The parts of a cost in order: unused rail in bending and next to it, or behind the counts."""
    parts = brute_force.cost_of(one, criteria, cost)
    if cost is not None or (per_mm is not None and criteria[0] == "bending"):
        parts[2] += per_mm * one["unused"]
        return [*parts[:3], one["unused"], *parts[3:]]
    at = {"invalid": 2, "bending": 2}.get(criteria[0], 1)
    return [*parts[:at], one["unused"], *parts[at:]]


def every_shortened(p: list, q: list, energy: str, give_up: float) -> dict:
    tried = {}
    for a, b, p_lost in ends_of(p, give_up):
        for c, d, q_lost in ends_of(q, give_up):
            every = brute_force.every_triangulation(p[a : b + 1], q[c : d + 1], energy)
            for path, one in every.items():
                moved = tuple((i + a, j + c) for i, j in path)
                tried[moved] = {**one, "unused": p_lost + q_lost}
    return tried


def path_of(found: Triangulation) -> tuple[tuple[int, int], ...]:
    return tuple(map(tuple, (found.bridges + found.first_samples).tolist()))


@pytest.mark.parametrize("seed", seeds(100, default=6))
def test_no_triangulation_of_a_shortened_strip_is_better(seed: int) -> None:
    seed = makes_a_strip(range(300))[seed]
    p, q = (rail.tolist() for rail in small_strip(seed))
    random = np.random.default_rng([53, seed])
    shorter = min(arcs_of(rail)[-1] for rail in (p, q) if len(rail) > 1)
    if shorter == 0.0:
        return
    give_up = float(random.uniform(0.0, 0.5)) * shorter
    total = arcs_of(p)[-1] + arcs_of(q)[-1]
    for criteria, energy, price in CHOICES if seed < 60 else CHOICES[:3]:
        whole = brute_force.every_triangulation(p, q, energy)
        cost = None if price is None else brute_force.invalid_cost(whole, price)
        per_mm = None
        if energy == "hinge":
            least = brute_force.invalid_cost(whole, 1.0) * (len(p) + len(q) - 3)
            per_mm = GIVE_UP_PRICE * least / total
        settings = {"criteria": criteria, "energy": energy, "price": price}
        found = triangulate(
            p, q, planarity=brute_force.PLANARITY, ends="free", give_up=give_up, **settings
        )
        every = every_shortened(p, q, energy, give_up)
        least_cost = brute_force.best(
            [cost_of(one, criteria, cost, per_mm) for one in every.values()]
        )
        one = every[path_of(found)]
        assert math.fsum(found.unused) == pytest.approx(one["unused"], rel=1e-12, abs=1e-14)
        for part, best in zip(cost_of(one, criteria, cost, per_mm), least_cost, strict=True):
            assert brute_force.is_close(part, best), (seed, criteria, price, part, least_cost)


def tube_with_tail(turn_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """A cylinder between square cuts; Q goes on by 8 mm, out of that cut by an angle."""
    t = np.linspace(0.0, 2.0, 60)
    p = np.stack((30 * np.sin(t), 0 * t, 30 * np.cos(t)), axis=1)
    q = p + np.array([0.0, 25.0, 0.0])
    ahead = np.array([math.cos(2.0), 0.0, -math.sin(2.0)])
    out = np.array([math.sin(2.0), 0.0, math.cos(2.0)])
    turn = math.radians(turn_deg)
    way = math.cos(turn) * ahead + math.sin(turn) * out
    return p, np.vstack((q, q[-1] + np.linspace(1.0, 8.0, 8)[:, None] * way))


@pytest.mark.parametrize(("turn_deg", "left"), [(0, 0), (10, 0), (20, 8), (45, 8), (-90, 8)])
def test_a_tail_is_given_up_where_it_turns_out_of_the_sheet(turn_deg: float, left: float) -> None:
    found = triangulate(*tube_with_tail(turn_deg), ends="free", give_up=8.0)
    assert found.unused == pytest.approx((0.0, 0.0, 0.0, left), abs=1e-9)


@pytest.mark.parametrize("seed", range(30))
def test_a_piece_of_a_cone_keeps_all_its_rail(seed: int) -> None:
    random = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.0, 60)
    radius, taper = random.uniform(20, 60), random.uniform(0.4, 1.0)
    p = np.stack((radius * np.cos(t), radius * np.sin(t), 0 * t), axis=1)
    t = np.linspace(random.uniform(0, 0.25), 2 - random.uniform(0, 0.25), 50)
    height = random.uniform(10, 40)
    q = np.stack((taper * radius * np.cos(t), taper * radius * np.sin(t), height + 0 * t), axis=1)
    assert triangulate(p, q, ends="free", give_up=8.0).unused == (0.0, 0.0, 0.0, 0.0)

"""Searches that look at few bridges take the same steps as the program over all of them."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import numpy.typing as npt
import pytest

from tests.seeds import seeds
from tests.strip import exact_strips
from wrinkle_cad.strip import narrow_search
from wrinkle_cad.strip.bars import Bars
from wrinkle_cad.strip.folding import HINGE
from wrinkle_cad.strip.global_search import best_steps
from wrinkle_cad.strip.objective import weights_of
from wrinkle_cad.strip.rails import default_planarity, round_off
from wrinkle_cad.strip.validity_price import invalid_cost, least_bending

Floats = npt.NDArray[np.float64]
Rails = tuple[Floats, Floats]
NAMES = ("invalid", "bending", "area", "length")
LISTS = [names for count in range(1, 5) for names in permutations(NAMES, count)]
PRICES = (0.0, 1.0, 50.0, 1e4)
KINDS = ("smooth", "noisy", "planar", "lattice", "straight", "meeting", "twisted", "developable")


@pytest.fixture(autouse=True)
def count_in_small_strips(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(narrow_search, "SMALL", 0)


def waves(random: np.random.Generator, count: int, rise: float) -> tuple[Floats, Floats]:
    t = np.linspace(0.0, 1.0, count)
    height = sum(rise / k * np.sin(2 * np.pi * k * t * random.uniform(0.5, 1.5)) for k in (1, 2, 3))
    return t, np.asarray(height * random.uniform(0.5, 1.5))


def strip_of(kind: str, seed: int) -> Rails:
    """A strip of 60 to 140 samples a side, of the kinds that theory and practice know."""
    random = np.random.default_rng([31, seed])
    counts = random.integers(60, 140, 2)
    if kind == "developable":
        families = exact_strips.wrinkled, exact_strips.cylinder, exact_strips.cone
        strip = families[seed // len(KINDS) % 3](seed)
        sampled = strip.sampled(float(10.0 ** -random.uniform(2.0, 4.0)))
        return sampled.p, sampled.q
    rails = []
    for side, count in enumerate(counts):
        t, height = waves(random, int(count), 0.0 if kind in ("planar", "straight") else 3.0)
        _, across = waves(random, int(count), 0.0 if kind in ("straight", "twisted") else 2.0)
        rail = np.column_stack((100 * t, 25.0 * side + across, height))
        if kind == "noisy":
            rail += random.normal(0.0, 0.05, rail.shape)
        if kind == "lattice":
            rail = np.round(rail / 4)
        if kind == "twisted" and side == 1:
            rail[:, 1:] = 25.0 * np.column_stack((np.cos(t), np.sin(t)))
        rails.append(rail)
    if kind == "straight" and seed % 2:
        _, rails[1][:, 2] = waves(random, int(counts[1]), 3.0)
    if kind == "meeting":
        rails[1][0], rails[1][-1] = rails[0][0], rails[0][-1]
    return rails[0], rails[1]


def assert_same_steps(p: Floats, q: Floats, planarity: float, names: list[tuple[str, ...]]) -> None:
    """Compares with the program over all bridges, which runs where bars are given that bar none."""
    nothing = round_off(p, q)
    limits = {"planarity": planarity, "nothing": nothing, "energy": HINGE}
    least = least_bending(p, q, planarity=planarity, nothing=nothing)
    for criteria in names:
        prices = PRICES if criteria[:2] == ("invalid", "bending") else ()
        for price in (None, *prices):
            cost = None if price is None else invalid_cost(price, *least)
            weights = weights_of(criteria, bridge_count=len(p) + len(q), invalid_cost=cost)
            no_bar = Bars(np.zeros((len(p), len(q)), dtype=np.bool_), -2.0)
            found = best_steps(p, q, weights, **limits)
            assert (found == best_steps(p, q, weights, **limits, bars=no_bar)).all(), (
                criteria,
                price,
            )


@pytest.mark.parametrize("seed", seeds(1000, 16))
def test_a_narrow_search_takes_the_steps_of_the_whole_program(seed: int) -> None:
    p, q = strip_of(KINDS[seed % len(KINDS)], seed)
    share = 10.0 ** np.random.default_rng([32, seed]).integers(-3, 4)
    planarity = default_planarity(p, q) * (1.0 if seed % 2 else share)
    usual = [("invalid", "bending"), ("bending",), ("invalid", "area")]
    assert_same_steps(p, q, planarity, usual if seed < 16 else LISTS)

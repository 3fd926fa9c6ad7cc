from __future__ import annotations

import numpy as np
import pytest

from tests.strip import exact_strips
from tests.strip.test_plain_strips import saddle
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.validity_price import thinned_rail


@pytest.mark.parametrize("count", [1, 2, 249, 250, 251, 252, 499, 500, 1000, 4321])
def test_a_long_rail_is_thinned_to_250_samples_alike_from_both_ends(count: int) -> None:
    rail = np.random.default_rng(1).normal(size=(count, 3))
    thin = thinned_rail(rail)
    assert len(thin) == min(count, 250)
    assert (thin[[0, -1]] == rail[[0, -1]]).all()
    assert (thinned_rail(rail[::-1]) == thin[::-1]).all()
    numbers = thinned_rail(np.arange(3.0 * count).reshape(count, 3))[:, 0] / 3
    assert np.ptp(np.diff(numbers)) <= 1.0 if count > 250 else (np.diff(numbers) == 1.0).all()


def test_the_least_bending_is_that_of_the_least_bending_triangulation() -> None:
    strip = exact_strips.wrinkled(1).sampled(1e-3)
    least = triangulate(strip.p, strip.q, criteria=("bending",))
    assert triangulate(strip.p, strip.q).least_bending == pytest.approx(least.bending, rel=1e-12)


def test_the_least_bending_of_a_long_strip_is_taken_on_250_samples_a_side() -> None:
    t = np.linspace(0.0, 10.0, 400)
    strip = exact_strips.wrinkled(1)
    found = triangulate(strip.p_at(t), strip.q_at(t), planarity=1e-7)
    thin = [thinned_rail(curve(t)) for curve in (strip.p_at, strip.q_at)]
    least = triangulate(*thin, criteria=("bending",), planarity=1e-7)
    assert found.least_bending == pytest.approx(least.bending, rel=1e-12)


@pytest.mark.parametrize("count", [12, 17, 26, 37, 52, 77, 250, 500])
def test_the_price_keeps_a_saddle_from_folding_whatever_the_sampling(count: int) -> None:
    p, q = saddle(count)
    for price, bound in ((1.0, 40.0), (50.0, 55.0)):
        assert np.degrees(np.abs(triangulate(p, q, price=price).fold).max()) < bound


def test_where_nothing_need_bend_an_invalid_bridge_is_worth_nothing() -> None:
    t = np.linspace(0.0, 1.0, 9)
    found = triangulate(exact_strips.stack(t, 0 * t, 0 * t), exact_strips.stack(t, 1 + t, 0 * t))
    assert (found.price, found.least_bending) == (50.0, 0.0)
    assert (found.bending, found.counted_invalid_count) == (0.0, 0)


@pytest.mark.parametrize(
    "options",
    [
        {"criteria": ("bending",)},
        {"criteria": ("invalid", "area", "bending")},
        {"energy": "paper"},
        {"search": "local"},
        {"price": None},
    ],
)
def test_a_price_without_effect_is_none_in_the_result(options: dict) -> None:
    strip = exact_strips.wrinkled(2).sampled(1e-2)
    found = triangulate(strip.p, strip.q, **{"price": 3.0, **options})
    assert found.price is None
    assert found.least_bending is None
    other = triangulate(strip.p, strip.q, **{"price": 1.0, **options})
    assert (other.steps == found.steps).all()


@pytest.mark.parametrize("price", [-1.0, 1.1e6, np.nan, np.inf])
def test_a_price_that_is_no_number_from_0_to_a_million_is_refused(price: float) -> None:
    strip = exact_strips.wrinkled(2).sampled(1e-2)
    with pytest.raises(
        InputError, match=r"price cannot be .*: give a number from 0 to 1e.06, or None"
    ):
        triangulate(strip.p, strip.q, price=price)

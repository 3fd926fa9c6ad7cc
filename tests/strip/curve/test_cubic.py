"""The cubic spline through points against scipy's, which leaves the equations to LAPACK."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.cubic import cubic_through


@pytest.mark.parametrize("count", [4, 5, 6, 7, 20, 300])
def test_it_is_the_spline_that_scipy_finds(count: int) -> None:
    for seed in range(20):
        random = np.random.default_rng(seed)
        at = np.cumsum(random.uniform(0.1, 3.0, count))
        points = random.normal(size=(count, 3))
        expected = make_interp_spline(at, points, k=3)
        found = cubic_through(at, points)
        assert np.array_equal(found.knots, expected.t)
        assert np.allclose(found.poles, expected.c, rtol=0.0, atol=1e-12 * abs(expected.c).max())


def test_it_runs_through_very_uneven_points() -> None:
    random = np.random.default_rng(3)
    at = np.cumsum(10.0 ** random.uniform(-5.0, 2.0, 60))
    points = random.normal(size=(60, 2))
    knots, poles = cubic_through(at, points)
    assert np.abs(BSpline(knots, poles, 3)(at) - points).max() < 1e-9


def test_a_cubic_comes_back_as_it_was() -> None:
    at = np.array([0.0, 0.3, 1.0, 2.5, 2.6, 4.0, 5.0])
    points = np.stack((at**3 - at, 2.0 - at**2), axis=1)
    knots, poles = cubic_through(at, points)
    dense = np.linspace(0.0, 5.0, 101)
    exact = np.stack((dense**3 - dense, 2.0 - dense**2), axis=1)
    assert np.allclose(BSpline(knots, poles, 3)(dense), exact, rtol=0.0, atol=1e-11)


def test_the_points_given_are_left_as_they_are() -> None:
    points = np.random.default_rng(0).normal(size=(6, 3))
    before = points.copy()
    cubic_through(np.arange(6.0), points)
    assert np.array_equal(points, before)


@pytest.mark.parametrize("at", [[0.0, 1.0, 1.0, 2.0], [0.0, 2.0, 1.0, 3.0], [0.0, 1.0, np.nan, 2]])
def test_points_that_coincide_are_refused(at: list[float]) -> None:
    with pytest.raises(InputError, match="Points 2 and 3 of the 4 of a curve coincide"):
        cubic_through(np.array(at), np.zeros((4, 3)))

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.chebyshev import Cells, FloatArray, fit_cells, point_in_cells


def wavy(t: FloatArray) -> FloatArray:
    return np.stack((10 * t, np.sin(40 * t), np.exp(-((t - 0.3) ** 2) / 1e-4)), axis=1)


def error_of(cells: Cells, t: FloatArray, true: FloatArray) -> float:
    found = np.array([point_in_cells(cells.edges, cells.coefficients, float(at)) for at in t])
    return float(np.max(np.abs(found - true)))


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-11])
def test_polynomials_come_as_close_as_asked(accuracy: float) -> None:
    cells = fit_cells(wavy, np.linspace(0, 1, 5), accuracy, share_of_extent=1.0)
    t = np.linspace(0, 1, 3001)
    assert error_of(cells, t, wavy(t)) <= accuracy
    assert error_of(cells, t, wavy(t) + 2 * accuracy) > accuracy


def test_cells_shrink_only_where_a_knot_spoils_the_polynomial() -> None:
    poles = np.random.default_rng(3).uniform(0, 10, (4, 3))
    spline = BSpline([0, 0, 0, 0.37, 1, 1, 1], poles, 2)
    cells = fit_cells(spline, np.array([0.0, 1.0]), 1e-9, share_of_extent=1.0)
    t = np.linspace(0, 1, 3001)
    assert error_of(cells, t, spline(t)) <= 1e-9
    assert np.all(np.diff(cells.edges) > 0)
    widest = np.max(np.diff(cells.edges))
    assert widest >= 0.125
    narrow = cells.edges[:-1][np.diff(cells.edges) < 1e-3]
    assert np.max(np.abs(narrow - 0.37)) < 0.01


def test_the_share_of_the_extent_holds_where_the_accuracy_is_coarse() -> None:
    cells = fit_cells(wavy, np.array([0.0, 1.0]), 100.0, share_of_extent=1e-4)
    t = np.linspace(0, 1, 3001)
    assert error_of(cells, t, wavy(t)) <= 1e-4 * 10


def test_first_edges_stay_edges() -> None:
    edges = np.array([0.0, 0.1, 0.11, 0.9, 1.0])
    cells = fit_cells(wavy, edges, 1e-8, share_of_extent=1.0)
    assert np.isin(edges, cells.edges).all()


def test_noise_is_refused_before_it_eats_the_memory() -> None:
    generator = np.random.default_rng(0)
    with pytest.raises(InputError, match="still rough after"):
        fit_cells(
            lambda t: generator.normal(size=(len(t), 3)),
            np.linspace(0, 1, 65),
            1e-6,
            share_of_extent=1.0,
        )

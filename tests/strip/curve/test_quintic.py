from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from wrinkle_cad.strip.curve.quintic import Quintic, fitted

Floats = np.ndarray
DENSE = np.linspace(0.0, 4.0, 4001)


def wave(t: Floats) -> tuple[Floats, Floats]:
    return (
        np.stack((np.sin(3.0 * t), t * np.cos(t)), axis=1),
        np.stack((3.0 * np.cos(3.0 * t), np.cos(t) - t * np.sin(t)), axis=1),
    )


def kinked(t: Floats) -> tuple[Floats, Floats]:
    """Its second derivative jumps at 1.7."""
    late = np.maximum(t - 1.7, 0.0)
    return (np.sin(t) + late**2)[:, None], (np.cos(t) + 2.0 * late)[:, None]


def found(function: object, knots: list[float], tolerance: float) -> Quintic:
    spline = fitted(function, knots, tolerance)  # type: ignore[arg-type]
    assert spline is not None
    return spline


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_a_spline_follows_a_function_as_closely_as_asked_and_not_much_closer(
    tolerance: float,
) -> None:
    spline = found(wave, [0.0, 4.0], tolerance)
    off = np.linalg.norm(spline.at(DENSE) - wave(DENSE)[0], axis=1).max()
    assert 0.01 * tolerance < off <= 1.05 * tolerance


def test_its_poles_are_those_of_a_b_spline_that_is_smooth_at_its_knots() -> None:
    spline = found(wave, [0.0, 1.3, 4.0], 1e-7)
    knots = np.repeat(spline.knots, spline.multiplicities)
    other = BSpline(knots, spline.poles, 5)
    np.testing.assert_allclose(other(DENSE), spline.at(DENSE), atol=1e-13)
    np.testing.assert_allclose(other(DENSE, 1), spline.slope_at(DENSE), atol=1e-11)
    beside = 1e-9
    inner = spline.knots[1:-1]
    before, after = spline.slope_at(inner - beside), spline.slope_at(inner + beside)
    np.testing.assert_allclose(before, after, atol=1e-6)


def test_a_knot_where_a_derivative_jumps_stays_and_others_go() -> None:
    spline = found(kinked, [0.0, 0.4, 0.8, 1.7, 2.2, 3.0, 4.0], 1e-4)
    assert 1.7 in spline.knots
    assert len(spline.knots) <= 5


def test_what_would_take_too_many_spans_has_no_spline() -> None:
    def corner(t: Floats) -> tuple[Floats, Floats]:
        return np.abs(t - 1.7)[:, None], np.sign(t - 1.7)[:, None]

    assert fitted(corner, [0.0, 4.0], 1e-12, most_spans=16) is None

from __future__ import annotations

import numpy as np
import pytest
from OCP.gp import gp_Pnt, gp_Vec

from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import curve_arrays, make_curve


def random_curve(seed: int, degree: int, *, is_rational: bool) -> PoleCurve:
    rng = np.random.default_rng(seed)
    inner = rng.integers(1, degree + 1, 4)
    count = int(degree + 1 + inner.sum())
    knots = np.concatenate(([-2.0], np.sort(rng.uniform(-1.5, 4.5, 4)), [5.0]))
    multiplicities = np.array([degree + 1, *inner, degree + 1])
    weights = rng.uniform(0.2, 5.0, count) if is_rational else None
    return PoleCurve(degree, knots, multiplicities, rng.normal(0.0, 100.0, (count, 3)), weights)


CURVES = [
    random_curve(17 * degree + rational, degree, is_rational=bool(rational))
    for degree in range(1, 10)
    for rational in (0, 1)
]


def kernel_values(curve: PoleCurve, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    own = make_curve(curve.poles, curve.knots, curve.multiplicities, curve.degree, curve.weights)
    points, velocities = [], []
    for u in parameters.tolist():
        point, velocity = gp_Pnt(), gp_Vec()
        own.D1(u, point, velocity)
        points.append((point.X(), point.Y(), point.Z()))
        velocities.append((velocity.X(), velocity.Y(), velocity.Z()))
    return np.array(points), np.array(velocities)


@pytest.mark.parametrize("curve", CURVES)
def test_points_and_velocities_are_those_of_the_kernel(curve: PoleCurve) -> None:
    between = np.linspace(-2.0, 5.0, 301)
    parameters = between[np.abs(between[:, None] - curve.knots[1:-1]).min(axis=1) > 1e-9]
    points, velocities = kernel_values(curve, parameters)
    size = np.abs(curve.poles).max()
    assert np.abs(curve.point_at(parameters) - points).max() <= 1e-12 * size
    fastest = np.linalg.norm(velocities, axis=1).max()
    assert np.abs(curve.velocity_at(parameters) - velocities).max() <= 1e-11 * fastest


@pytest.mark.parametrize("curve", CURVES)
def test_the_ends_are_the_end_poles(curve: PoleCurve) -> None:
    ends = curve.point_at(curve.knots[[0, -1]])
    assert np.allclose(ends, curve.poles[[0, -1]], rtol=1e-14, atol=0.0)


def test_a_corner_has_a_velocity_on_either_side() -> None:
    corner = PoleCurve(
        1, np.array([0.0, 1.0, 2.0]), np.array([2, 1, 2]), np.eye(3) * [1, 2, 3], None
    )
    at = np.array([1.0])
    assert corner.velocity_at(at, "left").tolist() == [[-1, 2, 0]]
    assert corner.velocity_at(at, "right").tolist() == [[0, -2, 3]]


@pytest.mark.parametrize("curve", CURVES[::3])
def test_reversed_and_stretched_curves_are_the_same_curve(curve: PoleCurve) -> None:
    share = np.linspace(0.0, 1.0, 97)
    own = curve.point_at(-2.0 + 7.0 * share)
    size = np.abs(curve.poles).max()
    backwards = curve.reversed().point_at(5.0 - 7.0 * share)
    assert np.abs(backwards - own).max() <= 1e-11 * size
    stretched = curve.stretched(10.0, 30.0)
    assert np.abs(stretched.point_at(10.0 + 20.0 * share) - own).max() <= 1e-11 * size
    assert stretched.knots[[0, -1]].tolist() == [10.0, 30.0]


@pytest.mark.parametrize("curve", CURVES[:4])
def test_numbers_survive_the_kernel(curve: PoleCurve) -> None:
    own = make_curve(curve.poles, curve.knots, curve.multiplicities, curve.degree, curve.weights)
    poles, weights, knots, multiplicities = curve_arrays(own)
    assert np.array_equal(poles, curve.poles)
    assert np.array_equal(knots, curve.knots)
    assert np.array_equal(multiplicities, curve.multiplicities)
    assert (weights is None) == (curve.weights is None)
    assert weights is None or np.allclose(weights, curve.weights, rtol=1e-15)

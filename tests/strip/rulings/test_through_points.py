from __future__ import annotations

import math

import numpy as np
import pytest

from tests.strip.rulings.rails import stack
from wrinkle_cad.strip.rulings.through_points import rail_through


@pytest.mark.parametrize("count", [20, 80, 400])
def test_points_on_a_circle_are_a_smooth_curve_close_to_it(count: int) -> None:
    turn = np.linspace(0.0, 2.0, count)
    rail = rail_through(stack(50.0 * np.cos(turn), 50.0 * np.sin(turn), 0.0))
    assert rail.breaks == ()
    assert rail.length == pytest.approx(100.0, rel=3.0 / count**2)
    at = np.linspace(0.0, rail.interval[1], 999)
    distance = np.linalg.norm(rail.point_at(at), axis=1) - 50.0
    assert np.abs(distance).max() <= 50.0 * (2.0 / count) ** 3


def test_the_points_are_on_the_rail_and_its_derivative_is_its_own() -> None:
    random = np.random.default_rng(3)
    points = stack(np.arange(30.0), random.normal(0.0, 0.2, 30), random.normal(0.0, 0.2, 30))
    rail = rail_through(points)
    at = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    np.testing.assert_allclose(rail.point_at(at), points, atol=1e-12)
    inside = np.linspace(0.1, at[-1] - 0.1, 777)
    slope = (rail.point_at(inside + 1e-6) - rail.point_at(inside - 1e-6)) / 2e-6
    np.testing.assert_allclose(rail.velocity_at(inside), slope, atol=1e-4)


@pytest.mark.parametrize("angle", [5.0, 20.0, 90.0])
def test_a_turn_of_its_own_stays_a_corner(angle: float) -> None:
    bend = math.radians(angle)
    straight, turned = np.linspace(0.0, 40.0, 9), np.linspace(0.0, 30.0, 7)[1:]
    points = np.vstack(
        (
            stack(straight, 0.0, 0.0),
            stack(40.0 + turned * math.cos(bend), 0.0, turned * math.sin(bend)),
        )
    )
    rail = rail_through(points)
    assert rail.breaks == (40.0,)
    assert rail.length == pytest.approx(70.0, rel=1e-9)


def test_two_points_are_a_straight_rail() -> None:
    rail = rail_through(np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]]))
    assert rail.length == 5.0
    np.testing.assert_allclose(rail.point_at(np.array([2.5])), [[1.5, 2.0, 0.0]])

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.strip.rulings.rails import circle, polyline, spiral, stack
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.rulings.between_nodes import point_and_tangent
from wrinkle_cad.strip.rulings.nodes import place_nodes
from wrinkle_cad.strip.rulings.rail_curve import RailCurve


def test_arc_lengths_are_those_of_the_closed_form() -> None:
    rail = spiral(40.0, 3.0, 7.0, (-1.0, 4.0))
    u = np.linspace(-1.0, 4.0, 1_001)
    np.testing.assert_allclose(rail.arc_at(u), math.hypot(40.0, 7.0) * (u + 1.0), rtol=1e-9)
    assert rail.length == pytest.approx(5.0 * math.hypot(40.0, 7.0), rel=1e-12)


def test_a_curve_run_at_changing_speed_has_the_same_arc_length() -> None:
    rail = RailCurve(
        lambda u: stack(40.0 * np.cos(u * u), 40.0 * np.sin(u * u), 0.0),
        lambda u: 80.0 * u[:, None] * stack(-np.sin(u * u), np.cos(u * u), 0.0),
        (0.0, 1.5),
    )
    u = np.linspace(0.0, 1.5, 77)
    np.testing.assert_allclose(rail.arc_at(u), 40.0 * u * u, atol=1e-7)
    np.testing.assert_allclose(rail.arc_at(rail.at_arc(40.0 * u * u)), 40.0 * u * u, atol=0.01)


def test_tangents_at_a_corner_are_those_of_the_piece_asked_for() -> None:
    rail = polyline([(0, 0, 0), (3, 0, 0), (3, 4, 0)])
    corner = np.array([3.0, 3.0])
    tangent, speed = rail.tangents(corner, np.array([0, 1]))
    np.testing.assert_array_equal(tangent, [[1, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(speed, 1.0)


def test_every_corner_is_a_node_of_both_its_pieces() -> None:
    nodes = place_nodes(polyline([(0, 0, 0), (3, 0, 0), (3, 4, 0)]), 0.5)
    np.testing.assert_array_equal(np.flatnonzero(np.diff(nodes.arc) == 0.0), [6])
    np.testing.assert_allclose(np.diff(nodes.arc[:7]), 0.5)
    np.testing.assert_allclose(np.diff(nodes.arc[7:]), 0.5)
    np.testing.assert_array_equal(nodes.tangent[6:8], [[1, 0, 0], [0, 1, 0]])


def test_between_nodes_the_curve_is_met_closely() -> None:
    rail = circle(10.0, 2.0)
    nodes = place_nodes(rail, 0.1)
    for at in (0.0, 0.123, 1.0, 1.999, 2.0):
        point, tangent = point_and_tangent(*nodes.pieces[0], at)
        here = np.array([at])
        np.testing.assert_allclose(point, rail.point_at(here)[0], atol=1e-9)
        np.testing.assert_allclose(tangent, rail.velocity_at(here)[0] / 10.0, atol=1e-6)


def test_a_point_has_no_length() -> None:
    apex = RailCurve(lambda u: stack(0 * u, 1.0, 2.0), lambda u: stack(0 * u, 0.0, 0.0), (0.0, 0.0))
    assert apex.is_point
    assert len(place_nodes(apex, 1.0).u) == 1


def test_a_derivative_that_is_zero_everywhere_is_refused() -> None:
    with pytest.raises(InputError, match="derivative is zero everywhere"):
        RailCurve(lambda u: stack(u, 0.0, 0.0), lambda u: stack(0 * u, 0.0, 0.0), (0.0, 1.0))


def test_a_parameter_that_falls_is_refused() -> None:
    with pytest.raises(InputError, match=r"runs from 2 to 1"):
        RailCurve(lambda u: stack(u, 0.0, 0.0), lambda u: stack(1.0 + 0 * u, 0.0, 0.0), (2.0, 1.0))

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from wrinkle_cad.cad.rail.directrix import make_directrix
from wrinkle_cad.cad.rail.rail_points import points_at_arcs
from wrinkle_cad.errors import InputError


def test_points_on_a_polyline_stand_at_their_arc_lengths() -> None:
    rail = make_directrix(np.array([[0.0, 0, 0], [3, 4, 0], [3, 4, 10]]))
    points = points_at_arcs(rail, [0.0, 2.5, 5.0, 12.0, 15.0])
    expected = [[0, 0, 0], [1.5, 2, 0], [3, 4, 0], [3, 4, 7], [3, 4, 10]]
    assert points == pytest.approx(np.array(expected, dtype=float), abs=1e-7)


def test_points_on_a_curve_are_as_far_along_as_an_independent_integral_says() -> None:
    import build123d as b3d

    edge = b3d.Edge.make_spline([(0, 0, 0), (10, 5, 2), (20, -3, 7), (30, 0, 0)])
    rail = make_directrix(edge)
    arcs = np.linspace(0.0, rail.length, 7)
    points = points_at_arcs(rail, arcs)

    def speed(u: float) -> float:
        h = 1e-5 * rail.length
        low, high = max(u - h, rail.interval[0]), min(u + h, rail.interval[1])
        ends = rail.point_at(np.array([low, high]))
        return float(np.linalg.norm(ends[1] - ends[0]) / (high - low))

    dense = np.linspace(*rail.interval, 20_001)
    for arc, point in zip(arcs[1:-1], points[1:-1], strict=True):
        nearest = dense[np.linalg.norm(rail.point_at(dense) - point, axis=1).argmin()]
        assert quad(speed, 0.0, nearest, limit=200)[0] == pytest.approx(arc, abs=3e-3)


def test_an_arc_beyond_the_rail_is_refused() -> None:
    rail = make_directrix(np.array([[0.0, 0, 0], [10, 0, 0]]))
    for arc in (-1.0, 10.1):
        with pytest.raises(InputError, match="Arc lengths"):
            points_at_arcs(rail, [arc])


def test_no_arcs_give_no_points() -> None:
    rail = make_directrix(np.array([[0.0, 0, 0], [10, 0, 0]]))
    assert points_at_arcs(rail, []).shape == (0, 3)

"""Outlines drawn on one face: through seams and poles, exact on the surface."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Cylinder, Edge, Sphere, Spline, Torus

from tests.cad.last import last_like_face, rail_on_face
from tests.seeds import seeds
from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.kernel.topology import free_edges, unwrap
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.cad.upper.profiles import wrinkle_profiles
from wrinkle_cad.cad.upper.stitch import Stitched, stitch
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

RADIUS = 50.0
EDGE_TOLERANCE = 1e-5


def pole_rail(x: float) -> Edge:
    """A curve on a sphere that passes its pole at x mm."""
    turns = np.linspace(-0.5, 0.5, 21)
    points = np.column_stack((np.full(21, x), RADIUS * np.sin(turns), RADIUS * np.cos(turns)))
    points *= RADIUS / np.linalg.norm(points, axis=1)[:, None]
    return Spline(*map(tuple, points))


def wrinkled(upper: object, p: object, q: object, margin: float, height: float) -> Stitched:
    opening = carve(upper, p, q, margin=margin, limit=25.0)
    curves = wrinkle_profiles(opening, waves=5, height=height) if height else (opening.p, opening.q)
    return stitch(opening, WrinkleStrip(*curves, name="wrinkle"))


def assert_whole(stitched: Stitched, upper: object) -> None:
    assert is_valid(stitched.shell_shape)
    assert len(free_edges(stitched.shell_shape)) == len(free_edges(unwrap(upper)))
    assert stitched.report.max_edge_tolerance_mm <= EDGE_TOLERANCE


@pytest.mark.parametrize(
    ("distance", "margin"),
    [(0.0, 0), (1e-4, 0), (1e-3, 0), (0.01, 0), (3, 3), (3, 2.999)],
)
def test_rails_and_sides_may_pass_a_spheres_pole_at_any_distance(
    distance: float, margin: float
) -> None:
    sphere = Sphere(RADIUS)
    made = wrinkled(sphere, pole_rail(distance), pole_rail(distance + 12.0), margin, margin / 2)
    assert_whole(made, sphere)


@pytest.mark.parametrize("seed", seeds(30, default=4))
def test_outlines_cross_the_seams_of_cylinder_and_torus(seed: int) -> None:
    random = np.random.default_rng(seed)
    is_torus = seed % 2 == 1
    upper = Torus(80.0, 30.0) if is_torus else Cylinder(40.0, 200.0)

    def at(turn: float, along: float) -> tuple[float, float, float]:
        if is_torus:
            out = 80.0 + 30.0 * math.cos(along / 30.0)
            return out * math.cos(turn), out * math.sin(turn), 30.0 * math.sin(along / 30.0)
        return 40.0 * math.cos(turn), 40.0 * math.sin(turn), along

    start, tilt = random.uniform(-0.8, -0.2), random.uniform(-15.0, 15.0)
    width, low = random.uniform(8.0, 20.0), random.uniform(-20.0, 5.0)
    rails = [
        Spline(*[at(start + 1.2 * t, low + side + tilt * t) for t in np.linspace(0.0, 1.0, 9)])
        for side in (0.0, width)
    ]
    assert_whole(wrinkled(upper, *rails, 2.0, 1.5), upper)


@pytest.mark.parametrize("seed", seeds(60, default=3))
def test_outlines_lie_anywhere_on_a_last_of_uneven_knots_with_poles(seed: int) -> None:
    face = last_like_face(seed)
    random = np.random.default_rng(seed)
    if seed % 2:
        u, du, v = random.uniform(-0.3, 0.9), random.uniform(0.1, 0.4), random.uniform(0.05, 0.85)
        dv = random.uniform(0.03, 0.08)
        rails = [rail_on_face(face, (u, v + side), (u + du, v + side)) for side in (0.0, dv)]
    else:
        u, du = random.uniform(0.0, 1.0), random.uniform(0.05, 0.15)
        v, dv = random.uniform(0.02, 0.5), random.uniform(0.2, 0.47)
        rails = [rail_on_face(face, (u + side, v), (u + side, v + dv)) for side in (0.0, du)]
    margin = random.uniform(0.5, 4.0)
    assert_whole(wrinkled(face, *rails, margin, min(2.0, margin)), face)

"""Closed rails: the strip goes all the way round, wherever the rails were drawn from."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Circle, Edge, Line, Plane, Pos, Rectangle, Rot, Text, Vector, Wire

from wrinkle_cad import InputError, WrinkleStrip
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges

SQUARE_TO_ROUND = 89_811.953498
"""mm2; four triangles and four quarter cones between a square of 200 and a circle r 50, h 150."""


def circle(radius: float, height: float, start_deg: float = 0.0) -> Edge:
    turned = Edge.make_circle(radius, start_angle=start_deg, end_angle=start_deg + 360.0)
    return Pos(0, 0, height) * turned


@pytest.mark.parametrize("start_deg", [0.0, 45.0, 90.0, 120.0, 179.0])
def test_a_tube_is_the_same_wherever_its_circles_begin(start_deg: float) -> None:
    strip = WrinkleStrip(circle(50, 0), circle(50, 60, start_deg))
    assert strip.area_mm2 == pytest.approx(2 * math.pi * 50 * 60, rel=3e-6)
    assert strip.shell().is_valid


def test_a_frustum_with_starts_opposite_is_a_cone() -> None:
    strip = WrinkleStrip(circle(50, 0), Pos(0, 0, 80) * Rot(0, 0, 180) * Edge.make_circle(30))
    assert strip.area_mm2 == pytest.approx(math.pi * 80 * math.hypot(20, 80), rel=1e-6)


@pytest.mark.parametrize("start_deg", [0.0, 33.0, 180.0, 271.0])
def test_a_square_to_round_duct_is_four_planes_and_four_cones(start_deg: float) -> None:
    square = Rectangle(200, 200).wire()
    strip = WrinkleStrip(square, circle(50, 150, start_deg))
    assert strip.area_mm2 == pytest.approx(SQUARE_TO_ROUND, rel=1e-7)
    assert len(faces_of(strip.topods_shell())) == 8
    swapped = WrinkleStrip(circle(50, 150, start_deg), square)
    assert swapped.area_mm2 == pytest.approx(SQUARE_TO_ROUND, rel=1e-7)


def test_a_wire_and_its_mirror_image_make_a_box() -> None:
    base = Rectangle(40, 20)
    strip = WrinkleStrip(base.wire(), Pos(0, 0, 10) * base.mirror(Plane.YZ).wire())
    assert strip.area_mm2 == pytest.approx(1200.0, rel=1e-12)
    # Two rings of four edges are free; the cut is sewn, for both its sides are one edge.
    assert len(free_edges(strip.topods_shell())) == 8


def test_a_flat_ring_is_the_face_between_its_wires() -> None:
    letter = Text("O", 60).faces()[0]
    strip = WrinkleStrip(letter.outer_wire(), letter.inner_wires()[0])
    assert strip.area_mm2 == pytest.approx(letter.area, rel=1e-9)
    assert strip.unrolling.area == pytest.approx(letter.area, rel=1e-6)


def test_a_closed_strip_is_laid_flat_from_its_shortest_ruling() -> None:
    lifted = Rot(0, 20, 0) * Edge.make_circle(50)
    strip = WrinkleStrip(circle(50, -60), lifted)
    first, last = strip.triangulation.bridges[[0, -1]]
    assert np.array_equal(strip.triangulation.p[0], strip.triangulation.p[-1])
    assert np.array_equal(strip.triangulation.q[0], strip.triangulation.q[-1])
    assert first.tolist() == [0, 0]
    i, j = strip.triangulation.bridges.T
    spans = np.linalg.norm(strip.triangulation.p[i] - strip.triangulation.q[j], axis=1)
    assert spans[0] <= spans.min() * 1.01
    assert strip.unrolling.p_length == pytest.approx(2 * math.pi * 50, rel=1e-6)
    assert last.tolist() == [len(strip.triangulation.p) - 1, len(strip.triangulation.q) - 1]


def test_one_closed_and_one_open_rail_are_refused() -> None:
    with pytest.raises(InputError, match=r"P is closed, but the ends of rail Q are 30 mm apart"):
        WrinkleStrip(circle(50, 0), Line((0, 0, 9), (30, 0, 9)))


@pytest.mark.parametrize("seed", range(6))
def test_a_wire_may_begin_at_any_of_its_points(seed: int) -> None:
    """A polygon started in the middle of a side has the same corners, and the same strip."""
    rng = np.random.default_rng(seed)
    corners = [(-30, -20), (40, -25), (35, 30), (-10, 45)]
    k, share = int(rng.integers(4)), float(rng.uniform(0.1, 0.9))
    a, b = (Vector(*corner) for corner in (corners[k], corners[(k + 1) % 4]))
    ring = [a + (b - a) * share, *(Vector(*corners[(k + 1 + i) % 4]) for i in range(4))]
    started = Wire.make_polygon(ring, close=True)
    plain = Wire.make_polygon([Vector(*corner) for corner in corners], close=True)
    top = Pos(5, 3, 40) * Circle(12).wire()
    assert WrinkleStrip(started, top).area_mm2 == pytest.approx(
        WrinkleStrip(plain, top).area_mm2, rel=1e-9
    )

"""Openings over the sharp edges of a box, with ends inside its faces or on its border."""

from __future__ import annotations

import pytest
from build123d import Box, Edge, Shell, Wire

from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.kernel.topology import free_edges, unwrap
from wrinkle_cad.cad.upper.carve import carve
from wrinkle_cad.cad.upper.profiles import wrinkle_profiles
from wrinkle_cad.cad.upper.stitch import stitch
from wrinkle_cad.errors import InputError
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip


def over_the_top(y: float) -> Wire:
    points = [(-50, y, 0), (-50, y, 20), (50, y, 20), (50, y, 0)]
    return Wire.make_polygon(points, close=False)


def from_the_border(y: float) -> Wire:
    return Wire.make_polygon([(-50, y, -20), (-50, y, 20), (20, y, 20)], close=False)


def line(y: float, z: float, x: float = 40.0) -> Edge:
    return Edge.make_line((-x, y, z), (x, y, z))


def assert_stitches(upper: object, p: object, q: object, margin: float) -> float:
    """Returns mm^2: what was cut out."""
    opening = carve(upper, p, q, margin=margin)
    curves = wrinkle_profiles(opening, waves=5, height=1.5) if margin else (opening.p, opening.q)
    stitched = stitch(opening, WrinkleStrip(*curves, name="wrinkle"))
    assert is_valid(stitched.shell_shape)
    report, border = stitched.report, free_edges(unwrap(upper))
    assert report.free_length_after_mm == pytest.approx(report.free_length_before_mm, abs=1e-6)
    assert (report.free_edges_after > 0) == bool(border)
    assert report.max_edge_tolerance_mm <= 1e-5
    return opening.areas[2]


@pytest.mark.parametrize("margin", [0.0, 1.0, 4.0])
def test_wires_over_two_sharp_edges_may_end_inside_faces(margin: float) -> None:
    area = assert_stitches(Box(100, 60, 40), over_the_top(-8), over_the_top(8), margin)
    assert area == pytest.approx(140 * 16, rel=1e-6) if margin == 0.0 else area > 140 * 16


@pytest.mark.parametrize("margin", [0.0, 2.0])
@pytest.mark.parametrize("height", [10.0, -9.0])
def test_rails_may_lie_on_two_faces_with_a_sharp_edge_between(height: float, margin: float) -> None:
    p, q = line(-30, height), line(-20, 20)
    area = assert_stitches(Box(100, 60, 40), p, q, margin)
    width = 20.0 - height + 10.0
    assert area == pytest.approx(80 * width, rel=1e-6) if margin == 0.0 else area > 80 * width


@pytest.mark.parametrize("y", [15.0, -29.0])
@pytest.mark.parametrize("is_swapped", [False, True])
def test_a_rail_may_run_along_a_sharp_edge(y: float, is_swapped: bool) -> None:
    rails = [line(-30, 20), line(y, 20)]
    area = assert_stitches(Box(100, 60, 40), *(rails[::-1] if is_swapped else rails), 0.0)
    assert area == pytest.approx(80 * (y + 30), rel=1e-6)


def test_both_rails_may_run_along_sharp_edges() -> None:
    assert assert_stitches(Box(100, 60, 40), line(-30, 20), line(30, 20), 0.0) == pytest.approx(
        80 * 60, rel=1e-6
    )


def test_a_margin_beyond_a_sharp_edge_is_refused_in_words() -> None:
    with pytest.raises(InputError, match=r"Rail P runs along an edge of the upper.*Take no margin"):
        carve(Box(100, 60, 40), line(-30, 20), line(-15, 20), margin=2.0)


@pytest.mark.parametrize("margin", [0.0, 2.0])
def test_wires_may_start_on_the_border_and_end_inside_a_face(margin: float) -> None:
    open_box = Shell([face for face in Box(100, 60, 40).faces() if face.center().Z > -19])
    area = assert_stitches(open_box, from_the_border(-8), from_the_border(8), margin)
    assert area == pytest.approx(110 * 16, rel=1e-6) if margin == 0.0 else area > 110 * 16

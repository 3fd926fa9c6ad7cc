from __future__ import annotations

import math

import build123d as b3d
import numpy as np
import pytest

from tests.cad.faces.test_smooth_shell import arc, auger_rail
from tests.cad.strips import lens_edges
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.kernel.topology import faces_of

pytestmark = pytest.mark.filterwarnings("ignore::wrinkle_cad.WrinkleWarning")


def codes(strip: WrinkleStrip) -> set[str]:
    return {finding.code for finding in strip.findings}


def test_the_pattern_of_an_auger_flight_is_an_annular_sector() -> None:
    strip = WrinkleStrip(auger_rail(10.0), auger_rail(30.0), surface="smooth")
    flat = strip.unrolling
    assert len(faces_of(strip.topods_shell())) == 1
    assert flat.area == pytest.approx(3211.938171, rel=1e-8)
    for points, length, radius in (
        (flat.p, flat.p_length, 15.14989),
        (flat.q, flat.q_length, 39.19343),
    ):
        matrix = np.column_stack((2.0 * points, np.ones(len(points))))
        x, y, rest = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
        assert math.sqrt(rest + x * x + y * y) == pytest.approx(radius, abs=2e-5)
        assert math.degrees(length / radius) == pytest.approx(281.6924, abs=1e-3)
    assert "not-smooth" not in codes(strip)


def test_the_pattern_is_that_of_the_smooth_faces_and_near_that_of_cones() -> None:
    rails = lens_edges()
    smooth, cones = (WrinkleStrip(*rails, surface=kind) for kind in ("smooth", "cones"))
    flat = smooth.unrolling
    assert flat.area == pytest.approx(smooth.area_mm2, rel=1e-7)
    assert flat.p_length == pytest.approx(smooth.p.length, rel=1e-9)
    assert flat.q_length == pytest.approx(smooth.q.length, rel=1e-9)
    assert len(flat.p) == len(smooth.triangulation.p)
    chords = np.linalg.norm(np.diff(flat.p, axis=0), axis=1)
    spans = np.linalg.norm(np.diff(smooth.triangulation.p, axis=0), axis=1)
    assert (chords >= spans * (1.0 - 1e-9)).all()
    assert cones.unrolling.area == pytest.approx(flat.area, rel=1e-3)


def test_rails_of_points_are_joined_by_cones_and_that_is_said() -> None:
    p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
    strip = WrinkleStrip(p, q, surface="smooth")
    assert "not-smooth" in codes(strip)
    assert len(faces_of(strip.topods_shell())) == len(faces_of(strip.topods_shell("cones")))
    assert strip.unrolling.area == pytest.approx(strip.area_mm2, rel=1e-6)


def test_closed_rails_are_joined_by_cones_and_that_is_said() -> None:
    strip = WrinkleStrip(
        b3d.Edge.make_circle(50), b3d.Pos(0, 0, 60) * b3d.Edge.make_circle(50), surface="smooth"
    )
    assert "not-smooth" in codes(strip)
    assert strip.area_mm2 == pytest.approx(2.0 * math.pi * 50.0 * 60.0, rel=1e-5)


def test_a_strip_without_a_smooth_piece_is_that_of_the_search() -> None:
    strip = WrinkleStrip(arc(50.0), b3d.Vertex(10, 5, 80), surface="smooth")
    assert codes(strip) & {"not-smooth", "rulings-cross"} == set()
    assert len(faces_of(strip.topods_shell())) == 1

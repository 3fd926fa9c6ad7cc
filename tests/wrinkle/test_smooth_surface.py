from __future__ import annotations

import math
from pathlib import Path

import build123d as b3d
import numpy as np
import pytest

from tests.cad.faces.test_smooth_shell import arc, auger_rail
from tests.cad.strips import faults_after_step, lens_edges
from wrinkle_cad import WrinkleStrip, carve, stitch, wrinkle_profiles
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


@pytest.mark.slow
def test_a_duct_between_two_circles_is_two_smooth_faces(tmp_path: Path) -> None:
    strip = WrinkleStrip(
        b3d.Edge.make_circle(50), b3d.Pos(0, 0, 60) * b3d.Edge.make_circle(50), surface="smooth"
    )
    shell = strip.topods_shell()
    assert len(faces_of(shell)) == 2
    assert faults_after_step(shell, tmp_path / "duct.step", tolerance=1e-5) == []
    assert strip.area_mm2 == pytest.approx(2.0 * math.pi * 50.0 * 60.0, rel=1e-8)
    assert strip.unrolling.area == pytest.approx(strip.area_mm2, rel=1e-8)
    assert "not-smooth" not in codes(strip)


@pytest.mark.slow
def test_a_closed_reducer_has_a_few_faces_whose_pattern_closes(tmp_path: Path) -> None:
    top = b3d.Pos(10, 5, 80) * b3d.Rot(7, 15, 0) * b3d.Edge.make_circle(30)
    strip = WrinkleStrip(b3d.Edge.make_circle(50), top, surface="smooth")
    shell, flat = strip.topods_shell(), strip.unrolling
    assert len(faces_of(shell)) <= 4
    assert faults_after_step(shell, tmp_path / "reducer.step", tolerance=1e-5) == []
    assert flat.area == pytest.approx(strip.area_mm2, rel=1e-6)
    seams = [np.linalg.norm(flat.p[at] - flat.q[at]) for at in (0, -1)]
    assert seams[0] == pytest.approx(seams[1], abs=1e-9)


def test_a_strip_without_a_smooth_piece_is_that_of_the_search() -> None:
    strip = WrinkleStrip(arc(50.0), b3d.Vertex(10, 5, 80), surface="smooth")
    assert codes(strip) & {"not-smooth", "rulings-cross"} == set()
    assert len(faces_of(strip.topods_shell())) == 1


def test_a_smooth_wrinkle_is_stitched_in_with_smooth_bands(tmp_path: Path) -> None:
    upper = b3d.Face.make_rect(100, 60)
    rails = b3d.Edge.make_line((-40, -8), (40, -8)), b3d.Edge.make_line((-40, 8), (40, 8))
    opening = carve(upper, *rails, margin=2)
    counts = {}
    for surface in ("cones", "smooth"):
        profiles = wrinkle_profiles(opening, waves=3, height=2)
        stitched = stitch(opening, WrinkleStrip(*profiles, name="wrinkle", surface=surface))
        assert stitched.report.is_valid
        assert stitched.report.max_edge_tolerance_mm <= 1e-5
        assert faults_after_step(stitched.shell_shape, tmp_path / "s.step", tolerance=1e-5) == []
        counts[surface] = stitched.report.face_count
    assert counts["smooth"] < 0.5 * counts["cones"]

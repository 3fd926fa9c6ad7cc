"""Strips one of whose rails is a point: cones to their apex."""

from __future__ import annotations

import json
import math
from pathlib import Path

import build123d as b3d
import ezdxf
import numpy as np
import pytest
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer

from tests.cad.makers import line
from wrinkle_cad import InputError, WrinkleStrip
from wrinkle_cad.cad.rail.directrix import make_directrix, reversed_directrix, sample_directrix

APEX = (0.0, 0.0, 60.0)
ARC = b3d.Edge.make_circle(50.0, start_angle=0.0, end_angle=143.0)
AREA = math.radians(143.0) / 2.0 * 50.0 * math.hypot(50.0, 60.0)
LENGTH = math.radians(143.0) * 50.0


def degenerate_edge() -> object:
    """The edge at the tip of a cone, which has a place and no curve."""
    explorer = TopExp_Explorer(b3d.Solid.make_cone(50.0, 0.0, 60.0).wrapped, TopAbs_EDGE)
    while explorer.More():
        edge = b3d.Edge(explorer.Current())
        if edge.is_degenerate if hasattr(edge, "is_degenerate") else not edge.length:
            return explorer.Current()
        explorer.Next()
    raise AssertionError("a cone has such an edge")


POINTS = {
    "one row": lambda: np.array([APEX]),
    "a list of one": lambda: [APEX],
    "a vertex": lambda: b3d.Vertex(*APEX),
    "an edge without length": lambda: line(APEX, (*APEX[:2], 60.0 + 1e-8)),
    "a degenerate edge": degenerate_edge,
}


@pytest.mark.parametrize("name", POINTS)
@pytest.mark.parametrize("is_swapped", [False, True])
def test_a_cone_to_its_apex_is_exact(name: str, is_swapped: bool) -> None:
    apex = POINTS[name]()
    strip = WrinkleStrip(*((apex, ARC) if is_swapped else (ARC, apex)))
    rails = ("q", "p") if is_swapped else ("p", "q")
    shell, report = strip.shell(), strip.report
    assert shell.is_valid
    assert len(shell.faces()) == 1
    assert strip.area_mm2 == pytest.approx(AREA, rel=1e-7)
    assert report.area_pattern_mm2 == pytest.approx(AREA, rel=1e-7)
    for seam, length in zip(rails, (LENGTH, 0.0), strict=True):
        assert report.seam_lengths_mm[seam].space == pytest.approx(length, rel=1e-9)
        assert report.seam_lengths_mm[seam].pattern == pytest.approx(length, rel=1e-9)
    samples = (report.samples_p, report.samples_q)
    assert samples[0 if is_swapped else 1] == 1
    assert samples[1 if is_swapped else 0] > 10
    assert report.state == "developable"
    assert strip.findings == ()


def test_the_flat_piece_is_the_cones_sector() -> None:
    strip = WrinkleStrip(ARC, b3d.Vertex(*APEX))
    slant = math.hypot(50.0, 60.0)
    (tip,) = strip.unrolling.q
    apart = np.linalg.norm(strip.unrolling.p_line - tip, axis=1)
    np.testing.assert_allclose(apart, slant, rtol=1e-9)
    first, last = (strip.unrolling.p[[0, -1]] - tip) / slant
    turn = math.acos(float(first @ last))
    assert turn == pytest.approx(LENGTH / slant, rel=1e-9)


@pytest.mark.parametrize("allowance", [0.0, 5.0])
def test_a_cone_has_a_pattern_and_files(allowance: float, tmp_path: Path) -> None:
    strip = WrinkleStrip(ARC, b3d.Vertex(*APEX))
    pattern = strip.pattern(seam_allowance=(allowance,) * 4)
    (piece,) = pattern.pieces
    assert not piece.findings
    assert pattern.sketch.area >= AREA - 1.0
    pattern.export_dxf(tmp_path / "cone.dxf")
    assert len(ezdxf.readfile(tmp_path / "cone.dxf").modelspace()) > 0
    strip.export_step(tmp_path / "cone.step")
    strip.export_stl(tmp_path / "cone.stl")
    assert b3d.import_step(tmp_path / "cone.step").area == pytest.approx(AREA, rel=1e-5)
    assert json.dumps(strip.report.as_json())


def test_facets_and_the_local_search_go_to_a_point_too() -> None:
    strip = WrinkleStrip(ARC, b3d.Vertex(*APEX), surface="facets", search="local")
    assert strip.shell().is_valid
    assert strip.area_mm2 == pytest.approx(strip.triangulation.area, rel=1e-12)


def test_a_wavy_rail_and_a_point_make_one_smooth_cone() -> None:
    wave = b3d.Spline(*[(x, 5 * math.sin(x / 20), 3 * math.cos(x / 9)) for x in range(0, 201, 10)])
    strip = WrinkleStrip(wave, b3d.Vertex(90, 60, 30))
    assert strip.shell().is_valid
    assert strip.report.state == "developable"
    assert strip.report.max_strain_percent == 0.0
    assert strip.unrolling.p_length == pytest.approx(wave.length, rel=1e-6)


def test_two_points_are_no_strip() -> None:
    with pytest.raises(InputError, match=r"^P and Q are a point each"):
        WrinkleStrip(b3d.Vertex(0, 0, 0), b3d.Vertex(*APEX))


def test_a_point_on_the_other_rail_is_refused_unless_at_its_end() -> None:
    with pytest.raises(InputError, match=r"P and Q touch at \(0.0, 50.0, 0.0\) mm"):
        WrinkleStrip(ARC, b3d.Vertex(0, 50, 0))
    fan = WrinkleStrip(b3d.Vertex(50, 0, 0), ARC)
    segment = 50.0**2 / 2.0 * (math.radians(143.0) - math.sin(math.radians(143.0)))
    assert fan.area_mm2 == pytest.approx(segment, rel=1e-9)


def test_a_point_stays_itself_when_turned_round() -> None:
    point = make_directrix(b3d.Vertex(*APEX), name="Q")
    assert point.is_point
    assert not make_directrix(ARC).is_point
    for rail in (point, reversed_directrix(point)):
        samples = sample_directrix(rail, 0.05)
        np.testing.assert_array_equal(samples.points, [APEX])
        np.testing.assert_array_equal(rail.point_at(np.array([-1.0, 0.0, 5.0])), [APEX] * 3)

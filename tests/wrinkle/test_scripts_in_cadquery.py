"""Small scripts as users of CadQuery write them, each against its closed form."""

from __future__ import annotations

import importlib.util
import math

import pytest

from wrinkle_cad import WrinkleStrip, carve

HAS_CADQUERY = importlib.util.find_spec("cadquery") is not None
pytestmark = pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery does not fit this kernel")


def test_lampshade() -> None:
    import cadquery as cq

    lower, upper = cq.Workplane().circle(120), cq.Workplane().workplane(offset=150).circle(70)
    shade = WrinkleStrip(lower, upper, tolerance=0.4)
    area = math.pi * 190 * math.hypot(150, 50)
    assert shade.report.area_3d_mm2 == pytest.approx(area, rel=2e-5)


def test_strap_drawn_without_wire() -> None:
    import cadquery as cq

    edge = cq.Workplane("XZ").lineTo(40, 0).lineTo(80, 30).lineTo(120, 30)
    strap = WrinkleStrip(edge, edge.wire().translate((0, 25, 0)))
    assert strap.report.area_3d_mm2 == pytest.approx(25 * (40 + 50 + 40), rel=1e-9)


def test_sheet_between_selected_edges() -> None:
    import cadquery as cq

    block = cq.Workplane().box(80, 40, 30)
    sheet = WrinkleStrip(block.edges(">Y and >Z"), block.edges("<Y and <Z"))
    assert sheet.report.area_3d_mm2 == pytest.approx(80 * math.hypot(40, 30), rel=1e-9)


def test_pipe_transition_between_faces_of_a_loft() -> None:
    import cadquery as cq

    solid = cq.Workplane().rect(60, 60).workplane(offset=40).rect(30, 30).loft()
    ends = solid.faces("<Z").wires(), solid.faces(">Z").wires()
    sheet = WrinkleStrip(*ends)
    assert sheet.report.area_3d_mm2 == pytest.approx(2 * 90 * math.hypot(40, 15), rel=1e-9)


def test_opening_in_a_workplane_face() -> None:
    import cadquery as cq

    upper = cq.Workplane().rect(100, 60).extrude(1).faces(">Z")
    rails = [cq.Workplane(origin=(0, 0, 1)).moveTo(-40, y).lineTo(40, y) for y in (-8, 8)]
    opening = carve(upper, *rails)
    assert opening.area_balance == pytest.approx(0.0, abs=1e-6)
    strip = WrinkleStrip(*rails)
    assert strip.report.area_3d_mm2 == pytest.approx(80 * 16, rel=1e-9)

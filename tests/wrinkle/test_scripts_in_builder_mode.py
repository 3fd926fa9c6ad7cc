"""Small scripts as users of build123d's builder mode write them, and what viewers expect."""

from __future__ import annotations

import math

import pytest
from build123d import (
    Align,
    Axis,
    BuildLine,
    BuildPart,
    BuildSketch,
    CenterArc,
    Color,
    Compound,
    Cylinder,
    GeomType,
    Line,
    Location,
    Locations,
    Mode,
    Plane,
    Polyline,
    Pos,
    RadiusArc,
    Rectangle,
    Side,
    Sketch,
    Spline,
    add,
    extrude,
    make_face,
    offset,
)

from wrinkle_cad import WrinkleStrip, carve, stitch, wrinkle_profiles

SMOOTH = 2e-5
"""Cones between exact rails follow a smooth surface within the tolerance, their area so closely."""


def test_bag_gusset() -> None:
    """A side of a bag: down, around two corners, up again, 80 mm wide."""
    with BuildLine(Plane.XZ) as side:
        Line((-100, 200), (-100, 30))
        CenterArc((-70, 30), 30, 180, 90)
        Line((-70, 0), (70, 0))
        CenterArc((70, 30), 30, 270, 90)
        Line((100, 30), (100, 200))
    gusset = WrinkleStrip(side, Pos(0, 80, 0) * side.line, tolerance=0.02, name="gusset")
    length = 2 * 170 + 30 * math.pi + 140
    assert gusset.report.area_3d_mm2 == pytest.approx(80 * length, rel=SMOOTH)
    assert gusset.report.seam_lengths_mm["p"].pattern == pytest.approx(length, rel=1e-5)


def test_upper_edge_of_a_shoe_box_lid() -> None:
    with BuildSketch() as lid:
        Rectangle(300, 180)
    rim = WrinkleStrip(lid, Pos(0, 0, 35) * lid.sketch)
    assert rim.report.area_3d_mm2 == pytest.approx(2 * 480 * 35, rel=1e-9)


def test_chute_between_two_edges_of_a_part() -> None:
    with BuildPart() as machine:
        with BuildSketch():
            with BuildLine():
                Polyline((0, 0), (120, 0), (120, 50), (0, 90), close=True)
            make_face()
        extrude(amount=200)
    slope = machine.faces().sort_by(Axis.Y)[-1]
    rails = slope.edges().filter_by(Axis.Z)
    chute = WrinkleStrip(*rails)
    assert chute.report.area_3d_mm2 == pytest.approx(slope.area, rel=1e-12)
    assert slope.area == pytest.approx(200 * math.hypot(120, 40))


def test_guard_around_a_drum_with_locations() -> None:
    with BuildPart() as drum, Locations((0, 0, 10)):
        Cylinder(70, 120, align=(Align.CENTER, Align.CENTER, Align.MIN))
    rims = drum.edges().filter_by(GeomType.CIRCLE).sort_by(Axis.Z)
    guard = WrinkleStrip(rims[0], rims[-1], tolerance=0.2)
    assert guard.report.area_3d_mm2 == pytest.approx(2 * math.pi * 70 * 120, rel=SMOOTH)


def test_fender_from_an_arc_and_its_copy() -> None:
    with BuildLine(Plane.YZ) as arc:
        RadiusArc((-150, 0), (150, 0), 200)
    with BuildLine() as other:
        add(Pos(60, 0, 0) * arc.line)
    fender = WrinkleStrip(arc, other)
    angle = 2 * math.asin(150 / 200)
    assert fender.report.area_3d_mm2 == pytest.approx(60 * 200 * angle, rel=SMOOTH)


def test_binding_beside_an_offset() -> None:
    """A strip of constant width in the plane: as long as the middle line between the two."""
    with BuildLine() as seam:
        CenterArc((0, 0), 90, 10, 120)
    with BuildLine() as edge:
        add(seam.line)
        offset(amount=8, side=Side.LEFT, closed=False, mode=Mode.REPLACE)
    binding = WrinkleStrip(seam, edge)
    inner = edge.edges()[0].length / math.radians(120)
    expected = math.radians(120) / 2 * abs(90**2 - inner**2)
    assert binding.report.area_3d_mm2 == pytest.approx(expected, rel=1e-6)


def test_wrinkle_in_an_upper_with_names_for_a_viewer() -> None:
    with BuildSketch() as vamp:
        Rectangle(100, 60)
    with BuildLine() as front:
        Line((-40, -8), (40, -8))
    with BuildLine() as back:
        Line((-40, 8), (40, 8))
    upper = vamp.faces()[0]
    upper.label, upper.color = "vamp", Color("tan")
    opening = carve(upper, front, back, margin=2)
    wrinkle = WrinkleStrip(*wrinkle_profiles(opening, waves=3, height=2), name="wrinkle")
    shell = stitch(opening, wrinkle).shell
    assert (shell.label, tuple(shell.color)) == ("vamp", tuple(Color("tan")))
    assert shell.area - wrinkle.report.area_3d_mm2 > 6000 - opening.removed.area


def test_what_ocp_vscode_and_three_cad_viewer_show() -> None:
    """A viewer asks an object for wrapped, label and color, and a tree of them for children."""
    strip = WrinkleStrip(
        Line((0, 0, 0), (90, 0, 0)), Spline((0, 30, 0), (40, 34, 9), (90, 30, 0)),
        name="lace", color=(0.8, 0.2, 0.1),
    )  # fmt: skip
    shell = strip.shell()
    assert shell.label == "lace"
    assert tuple(shell.color)[:3] == pytest.approx((0.8, 0.2, 0.1), abs=1e-6)
    assert not shell.wrapped.IsNull()
    flat = strip.pattern().sketch
    assert isinstance(flat, Sketch)
    shown = Compound(label="shoe", children=[shell, flat.moved(Location((0, 100, 0)))])
    assert shown.children[0].label == "lace"
    assert shown.children[0].parent is shown
    assert shown.bounding_box().size.X > 89

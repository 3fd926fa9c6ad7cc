"""Small scripts as users of build123d's algebra mode write them, each against its closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import (
    Axis,
    BasePartObject,
    CenterArc,
    Circle,
    Cone,
    Edge,
    GeomType,
    Helix,
    Line,
    Location,
    Plane,
    Polyline,
    Pos,
    Rectangle,
    RegularPolygon,
    Rot,
    Spline,
    Vertex,
    Wire,
)

from wrinkle_cad import WrinkleStrip

SMOOTH = 2e-5
"""Cones between exact rails follow a smooth surface within the tolerance, their area so closely."""


def area(strip: WrinkleStrip) -> float:
    """In space, which the flat pattern keeps."""
    report = strip.report
    assert report.area_pattern_mm2 == pytest.approx(report.area_3d_mm2, rel=1e-4)
    return report.area_3d_mm2


def test_lampshade() -> None:
    bottom, top, height = 50.0, 30.0, 80.0
    shade = WrinkleStrip(
        Edge.make_circle(bottom), Pos(0, 0, height) * Edge.make_circle(top), tolerance=0.2
    )
    slant = math.hypot(height, bottom - top)
    assert area(shade) == pytest.approx(math.pi * (bottom + top) * slant, rel=SMOOTH)


def test_lampshade_of_eight_panels() -> None:
    lower, upper = RegularPolygon(90, 8), Pos(0, 0, 70) * RegularPolygon(60, 8)
    shade = WrinkleStrip(lower.wire(), upper.wire(), tolerance=0.2)
    sides = [2 * r * math.sin(math.pi / 8) for r in (90, 60)]
    slant = math.hypot(70, 30 * math.cos(math.pi / 8))
    assert area(shade) == pytest.approx(8 * sum(sides) / 2 * slant, rel=1e-9)
    assert len(shade.report.creases) >= 7


def test_shirt_cuff() -> None:
    """A cone with an opening of 60 degrees."""
    wide = CenterArc((0, 0, 0), 40, 0, 300)
    cuff = WrinkleStrip(wide, CenterArc((0, 0, 55), 34, 0, 300), tolerance=0.02, name="cuff")
    assert area(cuff) == pytest.approx(math.radians(300) * 37 * math.hypot(55, 6), rel=SMOOTH)
    assert cuff.report.is_developable


def test_boat_plank_between_two_chines() -> None:
    """Chines on a cone: the upper one is the lower, 0.7 times as far from its apex."""
    apex, share = np.array([-900.0, 400.0, 1300.0]), 0.7
    x = np.linspace(0.0, 1200.0, 25)
    chine = np.stack((x, 150 * np.sin(np.pi * x / 1400), 40 * (x / 1200) ** 2), axis=1)
    plank = WrinkleStrip(chine, apex + share * (chine - apex), name="garboard")
    legs = chine - apex
    triangles = 0.5 * np.linalg.norm(np.cross(legs[:-1], legs[1:]), axis=1).sum()
    assert plank.report.area_3d_mm2 == pytest.approx((1 - share**2) * triangles, rel=2e-3)
    assert plank.report.max_strain_percent < 0.1


def test_tapered_duct() -> None:
    inlet, outlet = Rectangle(300, 200), Pos(0, 0, 250) * Rectangle(150, 100)
    duct = WrinkleStrip(inlet.wire(), outlet.wire(), tolerance=0.5, name="duct")
    panels = (300 + 150) * math.hypot(250, 50) + (200 + 100) * math.hypot(250, 75)
    assert area(duct) == pytest.approx(panels, rel=1e-9)


def test_book_cloth_over_a_round_spine() -> None:
    spine = Polyline((-150, 0), (-12, 0)) + CenterArc((0, 0), 12, 180, 180)
    spine += Line((12, 0), (150, 0))
    cloth = WrinkleStrip(spine, Pos(0, 0, 210) * spine, tolerance=0.02)
    assert area(cloth) == pytest.approx((2 * 138 + 12 * math.pi) * 210, rel=SMOOTH)


def test_helmet_strap() -> None:
    """A strap around a cylinder, 22 mm wide along its axis."""
    edge = Helix(pitch=120, height=60, radius=85)
    strap = WrinkleStrip(edge, Pos(0, 0, 22) * edge, tolerance=0.2, name="strap")
    assert area(strap) == pytest.approx(22 * math.pi * 85, rel=1e-4)
    assert strap.report.max_strain_percent < 0.05


def test_belt_with_a_thickness() -> None:
    belt = WrinkleStrip(Line((0, 0), (900, 0)), Line((0, 35), (900, 35)), thickness=3)
    assert area(belt) == pytest.approx(900 * 35, rel=1e-12)
    assert belt.pattern(seam_allowance=4).pieces[0].widths == (4.0, 4.0, 4.0, 4.0)


def test_corrugated_panel() -> None:
    folds = Polyline(*[(10 * i, 0, 6 * (i % 2)) for i in range(9)])
    panel = WrinkleStrip(folds, Pos(0, 25, 0) * folds)
    assert area(panel) == pytest.approx(25 * 8 * math.sqrt(136), rel=1e-12)
    assert panel.report.max_fold_deg == pytest.approx(2 * math.degrees(math.atan(0.6)), abs=1e-6)


def test_pyramid_roof_over_a_square() -> None:
    roof = WrinkleStrip(Rectangle(40, 40).wire(), Vertex(0, 0, 30))
    assert area(roof) == pytest.approx(4 * 0.5 * 40 * math.hypot(30, 20), rel=1e-9)


def test_collar_in_the_plane() -> None:
    turn = 130
    inner, outer = (Edge.make_circle(r, start_angle=0, end_angle=turn) for r in (120, 165))
    collar = WrinkleStrip(inner, Rot(0, 0, 0) * outer, tolerance=0.1)
    assert area(collar) == pytest.approx(turn / 360 * math.pi * (165**2 - 120**2), rel=1e-6)


def test_gore_of_a_stovepipe_elbow() -> None:
    """A cylinder between two slanting planes: the longest and the shortest line average out."""
    around = Edge.make_circle(60)
    ends = []
    for tilt in (-12, 12):
        plane = Plane(Location((0, 0, 4 * tilt), (tilt, 0, 0)))
        points = []
        for i in range(73):
            at = around @ (i / 72)
            slope = plane.z_dir
            z = plane.origin.Z - (at.X * slope.X + at.Y * slope.Y) / slope.Z
            points.append((at.X, at.Y, z))
        ends.append(Spline(*points[:-1], periodic=True))
    gore = WrinkleStrip(*ends, tolerance=0.2)
    assert area(gore) == pytest.approx(2 * math.pi * 60 * 96, rel=1e-4)


class Funnel(BasePartObject):
    """A part with parameters, as bd_warehouse has them."""

    def __init__(self, mouth: float, spout: float, height: float, rotation=(0, 0, 0)) -> None:
        super().__init__(Cone(spout, mouth, height), rotation)
        self.label = "funnel"

    @property
    def rims(self) -> list[Edge]:
        return list(self.edges().filter_by(GeomType.CIRCLE).sort_by(Axis.Z))


def test_funnel_of_a_class_with_parameters() -> None:
    funnel = Funnel(80, 15, 60)
    sheet = WrinkleStrip(*funnel.rims, name=funnel.label)
    assert area(sheet) == pytest.approx(math.pi * 95 * math.hypot(60, 65), rel=SMOOTH)
    side = funnel.faces().filter_by(GeomType.CONE)[0]
    assert area(sheet) == pytest.approx(side.area, rel=1e-6)


def test_hat_band_from_the_edges_of_a_sketch() -> None:
    head = Circle(95)
    band = WrinkleStrip(head, Pos(0, 0, 40) * head, tolerance=0.08)
    assert area(band) == pytest.approx(2 * math.pi * 95 * 40, rel=SMOOTH)


def test_awning_between_wires_in_pieces() -> None:
    front = Wire([Edge.make_line((0, 0, 0), (60, 0, 0)), Edge.make_line((60, 0, 0), (150, 0, 0))])
    awning = WrinkleStrip(front, Line((0, 90, 40), (150, 90, 40)))
    assert area(awning) == pytest.approx(150 * math.hypot(90, 40), rel=1e-9)

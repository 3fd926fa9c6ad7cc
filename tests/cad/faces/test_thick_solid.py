"""strip.thicken: a solid of constant thickness from a strip of any surface."""

from __future__ import annotations

import math

import pytest
from build123d import Edge, GeomType, Location, Polyline, Pos, Rectangle, Solid

from tests.cad.shoes import opening
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.errors import InputError, WrinkleWarning

THICKNESS = 1.2


def quarter(tolerance=0.002, **options):
    arc = Edge.make_circle(20, start_angle=0, end_angle=90)
    return WrinkleStrip(arc, arc.moved(Location((0, 0, 30))), tolerance=tolerance, **options)


def crease(degrees):
    x, z = 40 + 30 * math.cos(math.radians(degrees)), 30 * math.sin(math.radians(degrees))
    rail = Polyline((0, 0, 0), (40, 0, 0), (x, 0, z))
    return WrinkleStrip(rail, Pos(0, 20, 0) * rail)


@pytest.mark.parametrize("surface", ["cones", "smooth", "facets"])
def test_a_strip_of_any_surface_on_a_cylinder_becomes_a_part_of_a_tube(surface):
    strip = quarter(surface=surface)
    found = sorted(strip.thicken(side * THICKNESS).volume for side in (1.0, -1.0))
    exact = (7.5 * math.pi * (400 - 18.8**2), 7.5 * math.pi * (21.2**2 - 400))
    # Its ends stand upright on the last chords, which lean by half of 90 / 56 degrees.
    ends = 30 * THICKNESS**2 * math.tan(math.pi / 4 / 56)
    assert found == pytest.approx((exact[0] + ends, exact[1] - ends), rel=1e-4)


@pytest.mark.parametrize("degrees", [1.0, 10.0, 45.0, 90.0, 120.0])
def test_creases_are_mitred_so_that_both_planes_are_as_thick(degrees):
    strip = crease(degrees)
    # Seen from the side: two rectangles and the kite, or less it, that the mitre adds.
    mitre = 20 * THICKNESS**2 * math.tan(math.radians(degrees) / 2)
    found = sorted(strip.thicken(side * THICKNESS).volume for side in (1.0, -1.0))
    flat = THICKNESS * strip.area_mm2
    # Corners keep to the mean normal by a hundred-thousandth.
    assert found == pytest.approx((flat - mitre, flat + mitre), rel=3e-5)


@pytest.mark.slow
def test_a_closed_strip_becomes_a_tube():
    frustum = WrinkleStrip(Edge.make_circle(50), Pos(0, 0, 80) * Edge.make_circle(30), name="cuff")
    solid = frustum.thicken(1.0)
    assert isinstance(solid, Solid)
    assert solid.is_valid
    assert solid.label == "cuff"
    # An offset by 1 along the slope: frusta of radii larger by 1 / cos of the slope's angle.
    side, slope = math.hypot(80, 20), math.hypot(80, 20) / 80
    exact = math.pi * (80 + 20) / 2 * side * 2 * 0.8 + math.pi * side / slope
    assert solid.volume == pytest.approx(exact, rel=0.01)


def test_planes_and_cones_of_a_transition_are_as_thick_at_their_common_corners():
    with pytest.warns(WrinkleWarning, match="turned round"):
        duct = WrinkleStrip(Rectangle(200, 200).wire(), Pos(0, 0, 150) * Edge.make_circle(50))
    inside, outside = sorted(duct.thicken(side * THICKNESS).volume for side in (1.0, -1.0))
    # Cones add on the outside what they take away on the inside.
    assert inside + outside == pytest.approx(2.0 * THICKNESS * duct.area_mm2, rel=2e-3)


def test_a_wrinkle_becomes_a_solid_of_planes():
    strip = WrinkleStrip(*profile_curves(opening(), waves=6, height=3.0), name="w")
    solid = strip.thicken(0.6)
    assert solid.is_valid
    assert {face.geom_type for face in solid.faces()} == {GeomType.PLANE}
    assert solid.volume == pytest.approx(0.6 * strip.area_mm2, rel=0.02)


def test_what_is_too_thick_for_a_bend_is_refused_with_its_place():
    strip = quarter(tolerance=0.05)
    refused = []
    for side in (1.0, -1.0):
        try:
            strip.thicken(side * 25.0)
        except InputError as error:
            refused.append(str(error))
    # Outward there is room for any thickness, inward for the radius of 20.
    (message,) = refused
    assert "The strip cannot be 25 mm thick" in message
    assert "bends more sharply" in message


@pytest.mark.parametrize("thickness", [0.0, float("nan"), float("inf")])
def test_no_thickness_is_refused(thickness):
    with pytest.raises(InputError, match="Give one other than 0"):
        quarter(tolerance=0.05).thicken(thickness)

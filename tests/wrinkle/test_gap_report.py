"""The gaps in a strip's report, and their advice, followed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Edge, Line, Pos, Spline

from tests.strip.rulings.rails import Rails, bumps, helicoid, twisted
from wrinkle_cad.cad.faces.exact_surface import rail_curve
from wrinkle_cad.strip.rulings.cures import cure_of
from wrinkle_cad.strip.rulings.gaps import gaps_of
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip


def spline(rail: RailCurve, count: int = 41) -> Spline:
    points = rail.point_at(np.linspace(*rail.interval, count))
    return Spline(*[tuple(point) for point in points.tolist()])


def strip_of(rails: Rails) -> WrinkleStrip:
    return WrinkleStrip(*(spline(rail) for rail in rails))


@pytest.mark.parametrize("seed", [0, 24])
def test_a_strip_whose_rail_is_turned_as_advised_is_developable(seed: int) -> None:
    strip = strip_of(twisted(seed))
    assert strip.report.state == "stretched"
    rails = (rail_curve(strip.p), rail_curve(strip.q))
    (gap,) = (each for each in gaps_of(strip.ruled) if each.strain > 1e-3)
    (told,) = (each for each in strip.report.gaps if each.turn is not None)
    turned = cure_of(rails, strip.ruled, gap, is_closed=False, enough=1e-3).turned
    assert (turned.rail, math.degrees(turned.turn)) == (told.turn.rail, told.turn.turn_deg)
    at = 0 if turned.rail == "P" else 1
    again = list(rails)
    again[at] = turned.of(rails[at], is_closed=False)
    place = np.array([rails[at].at_arc(np.array([told.turn.at_mm]))[0]])
    moved = again[at].point_at(place) - rails[at].point_at(place)
    np.testing.assert_allclose(moved[0], told.turn.move_mm, atol=0.05)
    assert strip_of((again[0], again[1])).report.state == "developable"


@pytest.mark.parametrize(("rate", "way"), [(0.02, 1.0), (-0.02, -1.0)])
def test_the_advice_has_the_sign_of_the_twist(rate: float, way: float) -> None:
    """Mirrored rails twist the other way, and are turned the other way."""
    (gap,) = strip_of(helicoid(10.0, rate)).report.gaps
    (other,) = strip_of(helicoid(10.0, 0.02)).report.gaps
    assert gap.twist_deg == pytest.approx(way * other.twist_deg, rel=0.01)
    sign = {"P": 1.0, "Q": -1.0}[gap.turn.rail]
    assert math.copysign(1.0, gap.turn.turn_deg) == sign * math.copysign(1.0, gap.twist_deg)
    word = "clockwise" if gap.turn.turn_deg > 0.0 else "anticlockwise"
    assert f"° {word}, as seen from P to Q" in gap.advice


def test_gaps_stand_where_they_are_along_both_rails() -> None:
    report = strip_of(twisted(10)).report
    first, second = report.gaps
    assert (first.p_from_mm, first.q_from_mm) == (0.0, 0.0)
    assert first.p_to_mm < second.p_from_mm < second.p_to_mm
    assert second.p_to_mm == pytest.approx(report.seam_lengths_mm["p"].space, rel=1e-4)
    assert first.first_bridge == 0
    assert first.last_bridge < second.first_bridge
    assert report.max_strain_percent == first.max_strain_percent


def test_a_gap_that_hardly_strains_a_sheet_asks_for_nothing() -> None:
    (gap,) = strip_of(helicoid(10.0, 0.008)).report.gaps
    assert gap.max_strain_percent == pytest.approx(0.08, rel=0.01)
    assert gap.turn is None
    assert gap.advice.startswith("Nothing to change: it asks 0.0799% of a sheet")


def test_a_developable_strip_has_no_gaps() -> None:
    rails = Edge.make_circle(50, end_angle=120), Pos(0, 0, 60) * Edge.make_circle(30, end_angle=120)
    assert WrinkleStrip(*rails).report.gaps == ()
    assert all(gap.turn is None for gap in strip_of(bumps(1)).report.gaps)


def test_the_rails_of_a_band_are_not_the_users_to_turn() -> None:
    found = WrinkleStrip(Line((0, 0, 0), (100, 0, 0)), Line((0, 20, 0), (100, 20, 53)))
    band = TriangulatedStrip(
        found.p,
        found.q,
        found.p_samples,
        found.q_samples,
        found.triangulation,
        tolerance=0.05,
        name="band",
        role="band",
    )
    (gap,) = band.report.gaps
    assert gap.turn is None
    assert "a wall that the program made" in gap.advice


def test_the_report_of_a_trial_is_the_same_but_for_gaps_and_faces() -> None:
    strip = strip_of(twisted(0))
    whole, bare = strip.report.as_json(), strip.trial_report.as_json()
    assert bare["area_3d_mm2"] == pytest.approx(whole["area_3d_mm2"], rel=1e-6)
    assert {**whole, "gaps": [], "faces": 0, "area_3d_mm2": bare["area_3d_mm2"]} == bare

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tests.strip.rulings.rails import Rails, helicoid, ruled, spiral, stack
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.flat.unrolling import unroll
from wrinkle_cad.strip.rulings.cut_difference import (
    CutDifference,
    FlatRail,
    cut_difference,
    ruled_area,
)
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip
from wrinkle_cad.strip.triangulation import P_STEP, Q_STEP
from wrinkle_cad.strip.triangulation import measured as strip_along

STRAIGHT = np.linspace(0.0, 100.0, 801)


def piece_of(rails: Rails, u: np.ndarray, v: np.ndarray) -> tuple[tuple[FlatRail, FlatRail], float]:
    """The flat piece of triangles between equal numbers of points, with its area."""
    p, q = rails[0].point_at(u), rails[1].point_at(v)
    steps = np.tile(np.array([P_STEP, Q_STEP], dtype=np.int8), len(u) - 1)
    flat = unroll(
        strip_along(p, q, steps, planarity=1e-9, criteria=("bending",), search="global",
                    energy="hinge", price=None, least_bending=None)
    )  # fmt: skip
    return (FlatRail(arc_lengths(p), flat.p), FlatRail(arc_lengths(q), flat.q)), flat.area


def difference(rails: Rails, strip: RuledStrip, u: np.ndarray, v: np.ndarray) -> CutDifference:
    flat, area = piece_of(rails, u, v)
    return cut_difference(strip.sheet, flat, area, is_closed=False)


@pytest.mark.parametrize(("width", "rate"), [(10.0, 0.02), (20.0, 0.0414)])
def test_the_area_of_a_helicoid_is_that_of_the_closed_form(width: float, rate: float) -> None:
    exact = 2.0 * 100.0 * quad(lambda r: math.hypot(1.0, rate * r), 0.0, width / 2.0)[0]
    strip = rule_strip(*helicoid(width, rate), (STRAIGHT[::20], STRAIGHT[::20]))
    assert ruled_area(strip.sheet) == pytest.approx(exact, rel=1e-4)


def test_the_area_of_a_cylinder_is_that_of_the_closed_form() -> None:
    rails = spiral(40.0, 0.0, 3.0, (0.0, 2.0)), spiral(40.0, 30.0, -2.0, (0.0, 2.0))
    # Unrolled a trapezium of the width 80 between sides of 30 and 20.
    assert ruled_area(ruled(rails).sheet) == pytest.approx(80.0 * 25.0, rel=1e-4)


def test_a_piece_along_the_rulings_is_as_long_as_they_are() -> None:
    rails = helicoid(10.0, 0.02)
    strip = rule_strip(*rails, (STRAIGHT[::20], STRAIGHT[::20]))
    found = difference(rails, strip, STRAIGHT, STRAIGHT)
    assert abs(found.longer) <= 1e-3
    # The seams stretch, or the middle shrinks, by the strain: two thirds of it in area.
    assert found.larger == pytest.approx(2.0 / 3.0 * strip.strain.largest, rel=0.02)
    assert not found.is_beyond(0.01, 0.1)


def test_a_piece_between_other_points_is_longer_along_the_rulings() -> None:
    def rail(side: float) -> RailCurve:
        return RailCurve(
            lambda u: stack(40.0 * np.cos(u), 40.0 * np.sin(u), side),
            lambda u: stack(-40.0 * np.sin(u), 40.0 * np.cos(u), 0.0),
            (0.0, 2.0),
        )

    rails = rail(0.0), rail(20.0)
    u = np.linspace(0.0, 2.0, 801)
    strip = rule_strip(*rails, (u[::20], u[::20]))
    assert abs(difference(rails, strip, u, u).longer) <= 1e-3
    # Fans about the ends, and between them chords that lean and leave the cylinder.
    lean = np.clip(u + 0.5 * np.sin(np.pi * u / 2.0), 0.0, 2.0)
    found = difference(rails, strip, u, lean)
    assert found.is_beyond(0.01, 0.1)
    assert found.share > 0.02
    assert found.p_arc == pytest.approx(40.0, abs=12.0)


def test_a_ruling_across_the_cut_of_a_closed_strip_is_left_out() -> None:
    rails = helicoid(10.0, 0.02)
    sheet = rule_strip(*rails, (STRAIGHT[::20], STRAIGHT[::20])).sheet
    flat, area = piece_of(rails, STRAIGHT, STRAIGHT)
    whole = flat[0].arc[-1]
    half = tuple(FlatRail(rail.arc * 0.6, rail.point * 0.6) for rail in flat)
    found = cut_difference(sheet, (half[0], half[1]), area, is_closed=True)
    assert 0.0 <= found.p_arc <= 0.6 * whole


def test_what_is_beyond_a_bound_is_so_in_share_and_length_or_in_area() -> None:
    assert not CutDifference(0.05, 1.0, 0.0, 0.0).is_beyond(0.01, 0.1)
    assert not CutDifference(0.5, 100.0, 0.0, 0.0).is_beyond(0.01, 0.1)
    assert CutDifference(-1.5, 100.0, 0.0, 0.0).is_beyond(0.01, 0.1)
    assert CutDifference(0.0, 100.0, 0.0, -0.02).is_beyond(0.01, 0.1)

"""Gaps, and the turns of a rail that close them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.strip.rulings.rails import (
    Rails,
    bumps,
    circle,
    helicoid,
    polyline,
    reversed_rail,
    ruled,
    stack,
    twisted,
)
from wrinkle_cad.strip.rulings.closed import rule_closed_strip
from wrinkle_cad.strip.rulings.cures import cure_of
from wrinkle_cad.strip.rulings.gaps import gaps_of
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip
from wrinkle_cad.strip.rulings.turned_rail import TurnedRail, turned_in

ENOUGH = 1e-3


def skew(slope: float) -> Rails:
    """Two straight rails, one of which climbs."""
    return polyline([(0, 0, 0), (100, 0, 0)]), polyline([(0, 20, 0), (100, 20, 100 * slope)])


def turned_rails(rails: Rails, turned: TurnedRail) -> Rails:
    p, q = rails
    if turned.rail == "P":
        return turned.of(p, is_closed=False), q
    return p, turned.of(q, is_closed=False)


def after(rails: Rails, strip: RuledStrip) -> RuledStrip:
    return rule_strip(*rails, (strip.sheet.rulings.u, strip.sheet.rulings.v))


def test_a_developable_strip_has_no_gap() -> None:
    assert gaps_of(ruled((circle(50.0, 0.0), circle(30.0, 60.0)))) == ()


def test_a_helicoid_is_one_gap_with_the_strain_of_the_closed_form() -> None:
    strip = ruled(helicoid(10.0, 0.02))
    (gap,) = gaps_of(strip)
    assert (gap.first, gap.last) == (0, len(strip.sheet.rulings.u) - 1)
    assert gap.strain == pytest.approx(1.0 - 1.0 / math.hypot(1.0, 0.1), rel=0.01)
    assert abs(gap.twist) == pytest.approx(2.0 * math.atan(0.1), rel=1e-3)
    assert gap.length == pytest.approx(100.0, rel=0.01)


@pytest.mark.parametrize("slope", [0.3, -0.3])
def test_the_twist_of_a_gap_has_the_sign_of_the_turn_from_p_to_q(slope: float) -> None:
    """From P to Q is +y; Q climbs, which is left-handed about +y."""
    (gap,) = gaps_of(ruled(skew(slope)))
    assert gap.twist == pytest.approx(-math.copysign(math.atan(0.3), slope), rel=0.01)


def test_gaps_hold_all_the_strain_and_lie_in_order() -> None:
    strip = ruled(twisted(10))
    gaps = gaps_of(strip)
    assert len(gaps) == 2
    assert all(before.last < later.first for before, later in pairwise(gaps))
    outside = np.ones(len(strip.strain.share), dtype=bool)
    for gap in gaps:
        outside[gap.first : gap.last] = False
        assert gap.strain == strip.strain.share[gap.first : gap.last].max()
    assert strip.strain.share[outside].max(initial=0.0) <= 1e-6


@pytest.mark.parametrize("rail", ["P", "Q"])
@pytest.mark.parametrize("slope", [0.3, -0.53])
def test_a_rail_turned_by_the_whole_twist_lies_in_one_plane_with_the_other(
    rail: str, slope: float
) -> None:
    rails = skew(slope)
    strip = ruled(rails)
    (gap,) = gaps_of(strip)
    turned = turned_in(strip, gap, rail, "start", 1.0)
    assert turned is not None
    assert abs(turned.turn) == pytest.approx(math.atan(abs(slope)), rel=0.01)
    assert math.copysign(1.0, turned.turn) == math.copysign(1.0, gap.twist) * (
        1.0 if rail == "P" else -1.0
    )
    assert after(turned_rails(rails, turned), strip).strain.largest <= 1e-6


@pytest.mark.parametrize("rail", ["P", "Q"])
def test_turned_the_other_way_a_rail_strains_a_sheet_more(rail: str) -> None:
    rails = helicoid(10.0, 0.02)
    strip = ruled(rails)
    (gap,) = gaps_of(strip)
    turned = turned_in(strip, gap, rail, "start", 1.0)
    assert turned is not None
    wrong = TurnedRail(turned.rail, "start", 1.0, turned.parameters, -turned.slopes, -turned.turn)
    assert after(turned_rails(rails, wrong), strip).strain.largest > 1.5 * strip.strain.largest


@pytest.mark.parametrize("stays", ["start", "end", "both"])
def test_a_turned_rail_stays_where_it_is_told_to(stays: str) -> None:
    p, q = twisted(24)
    strip = ruled((p, q))
    turned = turned_in(strip, gaps_of(strip)[0], "P", stays, 1.0)
    assert turned is not None
    rail = turned.of(p, is_closed=False)
    first, last = (np.array([end]) for end in p.interval)
    moved = {
        "start": float(np.abs(rail.point_at(first) - p.point_at(first)).max()),
        "end": float(np.abs(rail.point_at(last) - p.point_at(last)).max()),
    }
    for end in moved:
        assert (moved[end] < 1e-9) == (stays in (end, "both"))


def test_a_turned_rails_derivative_is_its_own() -> None:
    p, q = twisted(19)
    strip = ruled((p, q))
    turned = turned_in(strip, gaps_of(strip)[0], "Q", "start", 1.0)
    assert turned is not None
    rail = turned.of(q, is_closed=False)
    u, step = np.linspace(0.31, 0.97, 41), 1e-6
    slope = (rail.point_at(u + step) - rail.point_at(u - step)) / (2.0 * step)
    np.testing.assert_allclose(rail.velocity_at(u), slope, atol=2e-3 * rail.length)


@pytest.mark.parametrize("seed", [0, 2, 7, 10, 24])
def test_a_cure_leaves_as_little_strain_as_it_says(seed: int) -> None:
    rails = twisted(seed)
    strip = ruled(rails)
    gap = max(gaps_of(strip), key=lambda each: each.strain)
    cure = cure_of(rails, strip, gap, is_closed=False, enough=ENOUGH)
    assert cure is not None
    assert cure.strain <= ENOUGH < gap.strain
    cured = ruled(turned_rails(rails, cure.turned))
    others = max((g.strain for g in gaps_of(strip) if g is not gap), default=0.0)
    assert cured.strain.largest <= max(1.05 * others, 1.1 * ENOUGH)


def test_a_cure_is_no_larger_than_it_must_be() -> None:
    """The strain goes with the square of the twist: a quarter of it needs half the turn."""
    rails = helicoid(10.0, 0.011)  # strains by 0.15%
    strip = ruled(rails)
    (gap,) = gaps_of(strip)
    assert cure_of(rails, strip, gap, is_closed=False, enough=ENOUGH).turned.amount == 0.25
    assert cure_of(rails, strip, gap, is_closed=False, enough=1e-4).turned.amount == 1.0


def test_the_cure_is_the_same_from_either_end() -> None:
    p, q = twisted(10)
    strain = []
    for rails in ((p, q), (reversed_rail(p), reversed_rail(q))):
        strip = ruled(rails)
        gap = max(gaps_of(strip), key=lambda each: each.strain)
        cure = cure_of(rails, strip, gap, is_closed=False, enough=ENOUGH)
        strain.append((cure.turned.distance, abs(cure.turned.turn)))
    np.testing.assert_allclose(strain[0], strain[1], rtol=0.05)


def test_a_closed_rail_still_ends_where_it_starts_after_a_turn_over_its_start() -> None:
    rail = circle(40.0, 0.0, (0.0, 2.0 * math.pi))
    places = np.linspace(6.0, 6.8, 81)  # the rail starts at 2 pi
    slopes = stack(0.0, 0.0, 5.0 * np.sin(2.0 * math.pi * (places - 6.0) / 0.8))
    turned = TurnedRail("P", "both", 1.0, places, slopes, 0.1).of(rail, is_closed=True)
    ends = turned.point_at(np.array(rail.interval))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
    assert ends[0, 2] > 0.5
    far = np.linspace(0.6, 5.9, 20)
    np.testing.assert_allclose(turned.point_at(far), rail.point_at(far), atol=1e-6)


def test_a_gap_of_a_closed_strip_is_cured_without_opening_it_or_not_at_all() -> None:
    def ring(radius: float, phase: float) -> RailCurve:
        return RailCurve(
            lambda u: stack(radius * np.cos(u), radius * np.sin(u), 3 * np.sin(4 * u + phase)),
            lambda u: stack(-radius * np.sin(u), radius * np.cos(u), 12 * np.cos(4 * u + phase)),
            (0.0, 2.0 * math.pi),
        )

    rails = (ring(40.0, 0.0), ring(55.0, 3.14))
    u = np.linspace(0.0, 2.0 * math.pi, 90)
    strip = rule_closed_strip(*rails, (u, u))
    gap = max(gaps_of(strip), key=lambda each: each.strain)
    assert gap.strain > ENOUGH
    cure = cure_of(rails, strip, gap, is_closed=True, enough=ENOUGH)
    assert cure is None or cure.turned.stays == "both"


def test_smooth_strips_without_strain_have_nothing_to_cure() -> None:
    for seed in range(5):
        assert all(gap.strain <= ENOUGH for gap in gaps_of(ruled(bumps(seed))))

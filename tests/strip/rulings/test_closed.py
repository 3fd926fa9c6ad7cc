"""Closed strips: what is found does not depend on where they are cut open."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.strip.rulings.rails import circle, polyline
from wrinkle_cad.strip.rulings.closed import rule_closed_strip
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip

TURN = 2.0 * math.pi
CREASE = math.radians(5.0)


def square(side: float, height: float) -> RailCurve:
    corners = [(1, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)]
    return polyline([(side * x, side * y, height) for x, y in corners])


def closed(p: RailCurve, q: RailCurve, start: float, ahead: float = 0.0) -> RuledStrip:
    """Ruled from bridges at equal shares of both rails, from a share of a turn on."""
    share = start + np.linspace(0.0, 1.0, 81)
    bridges = [
        rail.interval[0] + (share + shift) * (rail.interval[1] - rail.interval[0])
        for rail, shift in ((p, 0.0), (q, ahead))
    ]
    return rule_closed_strip(p, q, (bridges[0], bridges[1]))


@pytest.mark.parametrize("start", [0.0, 0.13, 0.7])
def test_a_closed_frustum_is_torsal_all_round(start: float) -> None:
    rails = (circle(50.0, 0.0, (0.0, TURN)), circle(30.0, 80.0, (0.0, TURN)))
    strip = closed(*rails, start)
    assert {piece.kind for piece in strip.pieces} == {"torsal"}
    assert not strip.creases
    assert strip.strain.largest == pytest.approx(0.0, abs=1e-9)
    slant = math.hypot(80.0, 20.0)
    assert strip.smallest_bend_radius(CREASE) == pytest.approx(30.0 * slant / 80.0, rel=0.01)


@pytest.mark.parametrize("start", [0.0, 0.125, 0.37])
def test_a_box_is_creased_at_its_four_edges(start: float) -> None:
    strip = closed(square(40.0, 0.0), square(40.0, 60.0), start)
    angles = [math.degrees(crease.angle) for crease in strip.creases]
    np.testing.assert_allclose(angles, 90.0, atol=0.1)
    places = sorted(round(crease.p_arc, 6) % 320.0 for crease in strip.creases)
    assert places == [0.0, 80.0, 160.0, 240.0]
    assert strip.developable_share == pytest.approx(1.0)


@pytest.mark.parametrize("start", [0.0, 0.2])
def test_a_square_becomes_round_without_an_end(start: float) -> None:
    round_one = circle(50.0, 150.0, (-math.pi / 4.0, TURN - math.pi / 4.0))
    strip = closed(square(100.0, 0.0), round_one, start)
    kinds = [piece.kind for piece in strip.pieces]
    cones = sum(kind == "cone" for kind in kinds)
    assert cones in (4, 5)  # one of them may be cut open where the turn begins
    assert set(kinds) == {"cone", "plane"}
    assert not strip.creases
    assert strip.strain.largest == 0.0

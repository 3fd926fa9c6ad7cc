"""Rulings that a designer holds: the surface has them, and keeps out of what is forbidden."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.seeds import seeds
from tests.strip.rulings.rails import bumps, circle, ruled
from wrinkle_cad.strip.rulings.closed import rule_closed_strip
from wrinkle_cad.strip.rulings.held import Held
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip

TURN = 2.0 * math.pi


def bridges_through(*places: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Bridges at even steps from place to place."""
    share = np.linspace(0.0, len(places) - 1.0, 20 * (len(places) - 1) + 1)
    u, v = (np.interp(share, range(len(places)), at) for at in zip(*places, strict=True))
    return u, v


def border_at(strip: RuledStrip, u: float, v: float) -> int:
    """The number of the ruling exactly between two parameters, where one piece ends."""
    rulings = strip.sheet.rulings
    (at,) = np.flatnonzero((rulings.u == u) & (rulings.v == v))
    assert at in [piece.first for piece in strip.pieces]
    return int(at)


def crease_of_an_oblique_ruling(radius: float, height: float, turn: float) -> float:
    """rad: between the planes of the ruling and of either circle's tangent at its end."""
    s, c, chord = math.sin(turn / 2), math.cos(turn / 2), 2 * radius * math.sin(turn / 2)
    square = height**2 + (chord * s) ** 2
    return math.acos((height**2 * (c * c - s * s) - (chord * s) ** 2) / square)


@pytest.mark.parametrize("turn", [0.1, 0.2, -0.3])
def test_an_oblique_ruling_held_on_a_cylinder_is_a_crease_of_known_angle(turn: float) -> None:
    rails = circle(50.0, 0.0), circle(50.0, 60.0)
    pin = (0.9, 0.9 + turn)
    bridges = bridges_through((0.0, 0.0), pin, (2.0, 2.0))
    strip = rule_strip(*rails, bridges, held=Held(pinned=(pin,)))
    at = border_at(strip, *pin)
    (crease,) = strip.creases
    assert crease.ruling == at
    assert crease.angle == pytest.approx(crease_of_an_oblique_ruling(50.0, 60.0, turn), rel=1e-3)
    assert strip.strain.largest < 1e-6


def test_a_ruling_that_the_surface_has_anyway_changes_nothing_but_its_pieces() -> None:
    rails = circle(50.0, 0.0), circle(30.0, 80.0)
    bridges = bridges_through((0.0, 0.0), (2.0, 2.0))
    free, held = (
        rule_strip(*rails, bridges, held=Held(pinned=pins)) for pins in ((), ((0.7, 0.7),))
    )
    border_at(held, 0.7, 0.7)
    assert [piece.kind for piece in held.pieces] == ["torsal", "torsal"]
    assert not held.creases
    assert held.smallest_bend_radius(0.1) == pytest.approx(free.smallest_bend_radius(0.1), rel=1e-6)


def test_rulings_are_held_on_every_turn_of_a_closed_strip() -> None:
    rails = circle(50.0, 0.0, (0.0, TURN)), circle(50.0, 60.0, (0.0, TURN))
    for pin in ((3.0, 3.2), (0.0, 0.2)):
        bridges = bridges_through(pin, (pin[0] + TURN, pin[1] + TURN))
        strip = rule_closed_strip(*rails, bridges, held=Held(pinned=(pin,)))
        (crease,) = strip.creases
        assert crease.angle == pytest.approx(crease_of_an_oblique_ruling(50.0, 60.0, 0.2), rel=1e-3)
        assert crease.p_arc % (50.0 * TURN) == pytest.approx(50.0 * pin[0], abs=1e-9)


def test_two_rulings_may_be_held_at_one_place() -> None:
    rails = circle(50.0, 0.0), circle(50.0, 60.0)
    pins = ((0.9, 0.8), (0.9, 1.1))
    bridges = bridges_through((0.0, 0.0), *pins, (2.0, 2.0))
    strip = rule_strip(*rails, bridges, held=Held(pinned=pins))
    first, last = (border_at(strip, *pin) for pin in pins)
    assert (strip.sheet.rulings.u[first : last + 1] == 0.9).all()


@pytest.mark.parametrize("seed", seeds(100, default=4))
def test_no_ruling_joins_stretches_that_are_forbidden(seed: int) -> None:
    rails = bumps(seed)
    free = ruled(rails).sheet.rulings
    at = len(free.u) // 3
    u, v = float(free.u[at]), float(free.v[at])
    stretch = (u - 0.05, u + 0.05, v - 0.04, v + 0.06)
    for corner in ((stretch[1], stretch[2]), (stretch[0], stretch[3])):
        bridges = bridges_through((0.0, 0.0), corner, (1.0, 1.0))
        strip = rule_strip(*rails, bridges, held=Held(forbidden=(stretch,)))
        rulings = strip.sheet.rulings
        inside = (rulings.u > stretch[0] + 1e-9) & (rulings.u < stretch[1] - 1e-9)
        inside &= (rulings.v > stretch[2] + 1e-9) & (rulings.v < stretch[3] - 1e-9)
        assert not inside.any()
        border_at(strip, *corner)

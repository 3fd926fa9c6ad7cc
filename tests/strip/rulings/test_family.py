from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.seeds import seeds
from tests.strip import exact_strips
from tests.strip.rulings.rails import Rails, analytic, bumps, circle, ruled, spiral, stack
from wrinkle_cad.strip.rulings.family import RulingFamily, family_of
from wrinkle_cad.strip.rulings.rail_curve import RailCurve

PLACES = np.linspace(0.0, 1.0, 997)


def families(rails: Rails, tolerance: float = 5e-4) -> list[tuple[str, RulingFamily]]:
    strip = ruled(rails, tolerance)
    return [(piece.kind, family_of(strip, piece, *rails)) for piece in strip.pieces]


def exact_rails(exact: exact_strips.ExactStrip) -> Rails:
    return analytic(exact.p_at, exact.interval), analytic(exact.q_at, exact.interval)


def moved(rails: Rails, seed: int) -> Rails:
    """Under a random rigid motion and a scale from 1e-3 to 1e3."""
    random = np.random.default_rng([21, seed])
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    scale, shift = 10.0 ** random.uniform(-3.0, 3.0), random.normal(0.0, 5.0, 3)

    def rail(own: RailCurve) -> RailCurve:
        return RailCurve(
            lambda u: scale * (own.point_at(u) @ turn + shift),
            lambda u: scale * (own.velocity_at(u) @ turn),
            own.interval,
        )

    return rail(rails[0]), rail(rails[1])


@pytest.mark.parametrize("seed", seeds(40, 4))
@pytest.mark.parametrize(
    "make",
    [
        exact_strips.cylinder,
        exact_strips.cone,
        exact_strips.convex_cylinder,
        exact_strips.convex_cone,
        exact_strips.convex_tangent_developable,
    ],
)
def test_every_ruling_of_an_exact_strip_is_one_of_the_surface_it_was_taken_from(
    make: exact_strips.Curve, seed: int
) -> None:
    exact = make(seed)
    ((kind, family),) = families(exact_rails(exact))
    assert kind == "torsal"
    u, v = family.parameters_at(PLACES)
    np.testing.assert_allclose(u, v, atol=1e-6)
    assert np.abs(family.twist_at(PLACES)).max() <= 1e-7


@pytest.mark.parametrize("seed", seeds(40, 4))
def test_rulings_do_not_depend_on_the_place_or_the_size_of_a_strip(seed: int) -> None:
    rails = exact_rails(exact_strips.convex_cone(seed))
    ((_, here),), ((_, there),) = families(rails), families(moved(rails, seed), tolerance=0.01)
    for own, other in zip(here.parameters_at(PLACES), there.parameters_at(PLACES), strict=True):
        np.testing.assert_allclose(own, other, atol=1e-6)


@pytest.mark.parametrize("seed", seeds(40, 6))
def test_no_rail_runs_back_and_neighbours_share_a_ruling(seed: int) -> None:
    found = families(bumps(seed), 0.05)
    for _, family in found:
        for at in family.parameters_at(PLACES):
            assert (np.diff(at) >= -4.0 * np.finfo(float).eps * np.abs(at).max()).all()
    for (_, before), (_, after) in pairwise(found):
        np.testing.assert_array_equal(before.ends[1], after.ends[0])


def test_velocities_are_the_derivatives_of_the_points() -> None:
    (_, _), (_, family), (_, _) = families(
        (spiral(40.0, 0.0, 3.0, (0.0, 2.0)), spiral(40.0, 30.0, -2.0, (0.3, 2.4)))
    )
    at, step = np.linspace(0.01, 0.99, 200), 1e-5
    differences = [
        (after - before) / (2.0 * step)
        for before, after in zip(
            family.points_at(at - step), family.points_at(at + step), strict=True
        )
    ]
    for velocity, difference in zip(family.velocities_at(at), differences, strict=True):
        np.testing.assert_allclose(velocity, difference, atol=1e-6)


def test_a_cone_keeps_its_apex() -> None:
    rails = (spiral(40.0, 0.0, 3.0, (0.0, 2.0)), spiral(40.0, 30.0, -2.0, (0.3, 2.4)))
    strip = ruled(rails)
    for piece in (strip.pieces[0], strip.pieces[-1]):
        points = family_of(strip, piece, *rails).points_at(PLACES)
        apex = points["PQ".index(str(piece.apex))]
        np.testing.assert_array_equal(apex, np.broadcast_to(apex[0], apex.shape))


def test_rulings_of_a_torsal_piece_do_not_cross_between_rails_beside_an_edge_of_regression() -> (
    None
):
    def tangent_of_helix(along: float) -> RailCurve:
        return analytic(
            lambda t: stack(
                np.cos(t) - along * np.sin(t), np.sin(t) + along * np.cos(t), t + along
            ),
            (0.0, 2.0),
        )

    for kind, family in families((tangent_of_helix(-0.8), tangent_of_helix(0.8))):
        p, q = family.points_at(PLACES)
        normals = [np.cross(speed, q - p) for speed in family.velocities_at(PLACES)]
        assert kind in ("cone", "torsal")
        assert ((normals[0] * normals[1]).sum(axis=1) >= 0.0).all()


def test_a_plane_between_arcs_has_rulings_from_end_to_end() -> None:
    ((kind, family),) = families((circle(50.0, 0.0), circle(80.0, 0.0)))
    assert kind == "plane"
    np.testing.assert_array_equal(family.ends, [[0.0, 0.0], [2.0, 2.0]])
    assert math.isclose(family.places[-1], 1.0)

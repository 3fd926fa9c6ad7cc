from __future__ import annotations

import numpy as np
import pytest

from tests.strip.rulings.rails import Rails, bumps, circle, ruled
from wrinkle_cad.strip.rulings.family import RulingFamily, family_of
from wrinkle_cad.strip.rulings.patch import RuledPatch, patch_of, places_of

PLACES = np.linspace(0.0, 1.0, 997)
NO_KNOTS = np.zeros(0)


def torsal(rails: Rails) -> list[RulingFamily]:
    strip = ruled(rails)
    pieces = [piece for piece in strip.pieces if piece.kind == "torsal"]
    return [family_of(strip, piece, *rails) for piece in pieces]


def patched(family: RulingFamily) -> RuledPatch:
    patch = patch_of(family, NO_KNOTS, NO_KNOTS)
    assert patch is not None
    return patch


@pytest.mark.parametrize("rails", [bumps(1), (circle(50.0, 0.0), circle(30.0, 80.0))])
def test_a_patch_lies_on_its_rails_and_has_the_rulings_of_its_piece(rails: Rails) -> None:
    for family in torsal(rails):
        patch = patched(family)
        p, q = family.points_at(PLACES)
        ends = patch.rails.at(PLACES)
        direction, other = q - p, ends[:, 3:] - ends[:, :3]
        cross = np.linalg.norm(np.cross(direction, other), axis=1)
        size = np.linalg.norm(direction, axis=1) * np.linalg.norm(other, axis=1)
        assert (cross / size).max() <= 2e-6
        for side, rail in enumerate((family.p, family.q)):
            at = np.linspace(*family.ends[:, side], 499)
            place = patch.ways[side].at(at)[:, 0]
            own = patch.rails.at(place)[:, 3 * side : 3 * side + 3]
            off = np.linalg.norm(own - rail.point_at(at), axis=1).max()
            assert off <= patch.error <= 1e-5


def test_the_place_of_a_ruling_is_found_from_either_of_its_ends() -> None:
    for family in torsal(bumps(2)):
        for side, parameters in enumerate(family.parameters_at(PLACES)):
            found = places_of(family, side, parameters)
            again = family.parameters_at(found)[side]
            span = family.ends[1, side] - family.ends[0, side]
            np.testing.assert_allclose(again, parameters, atol=1e-14 * span, rtol=1e-14)


def test_rulings_that_cross_between_the_rails_have_no_patch() -> None:
    """Behind the apex of a cone its rulings come out on the other side."""
    strip = ruled((circle(50.0, 0.0), circle(30.0, 80.0)))
    (piece,) = strip.pieces
    turned = circle(-30.0, 80.0)
    family = family_of(strip, piece, circle(50.0, 0.0), circle(30.0, 80.0))
    crossing = RulingFamily(
        family.p, turned, 0, 0, family.ends, family.places, family.ahead, family.slopes
    )
    assert np.abs(crossing.velocities_at(PLACES)[1]).max() > 0.0
    assert patch_of(crossing, NO_KNOTS, NO_KNOTS) is None

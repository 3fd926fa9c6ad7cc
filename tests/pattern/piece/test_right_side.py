"""Which side of a piece is up, and what turns over with it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings
from wrinkle_cad.wrinkle.facing import faces_away

SETTINGS = PieceSettings(
    seam_allowance=(3.0, 4.0, 5.0, 6.0), notches_p=NotchRule(count=2), rulings=True
)


def made(strip, **options):
    (piece,) = make_pieces(*strip, name="s", settings=SETTINGS, **options)
    return piece


def test_the_other_side_is_the_mirror_image_with_mountains_and_valleys_exchanged():
    front, back = made(strips.random_strip(4)), made(strips.random_strip(4), turned_over=True)
    assert back.is_mirrored
    assert shapely.Polygon(back.cut_line).exterior.is_ccw
    mirrored = shapely.Polygon(back.cut_line * (1.0, -1.0))
    assert mirrored.symmetric_difference(shapely.Polygon(front.cut_line)).area < 1e-6
    assert np.array_equal(back.ruling_fold, -front.ruling_fold)
    assert back.widths == front.widths


def test_the_user_can_turn_it_and_turning_twice_is_the_front():
    from dataclasses import replace

    back = replace(SETTINGS, right_side="back")
    (turned,) = make_pieces(*strips.random_strip(4), name="s", settings=back)
    (twice,) = make_pieces(*strips.random_strip(4), name="s", settings=back, turned_over=True)
    front = made(strips.random_strip(4))
    assert turned.is_mirrored
    assert not twice.is_mirrored
    assert np.array_equal(twice.cut_line, front.cut_line)
    assert np.array_equal(twice.ruling_fold, front.ruling_fold)


def test_every_piece_says_which_side_is_up():
    settings = PieceSettings(hand="left")
    for piece in make_pieces(*strips.random_strip(4), name="s", settings=settings):
        assert "RIGHT SIDE UP" in piece.texts


def test_swapped_rails_on_a_surface_give_the_same_piece_when_its_outside_decides():
    """A piece and the one of exchanged rails, each seen from the outside, are congruent."""
    unrolling, triangulation = strips.cylinder()
    one = made((unrolling, triangulation))
    other = made(strips.unrolled(triangulation.q, triangulation.p), turned_over=True)
    swapped = np.array(other.sew_line)
    assert (
        shapely.Polygon(swapped - swapped.min(axis=0))
        .symmetric_difference(shapely.Polygon(one.sew_line - one.sew_line.min(axis=0)))
        .area
        < 1e-6
    )
    assert set(np.sign(one.ruling_fold)) == set(np.sign(other.ruling_fold))


@pytest.mark.parametrize("inward", [False, True])
def test_a_strip_on_a_cylinder_faces_the_way_its_rails_say(inward):
    _, triangulation = strips.cylinder(inward=inward)
    points = triangulation.p
    axis_to_point = points * (1.0, 0.0, 1.0)
    outward = axis_to_point / np.linalg.norm(axis_to_point, axis=1)[:, None]
    assert faces_away(triangulation, points, outward) == inward

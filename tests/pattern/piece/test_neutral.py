from __future__ import annotations

import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.strips import make_pieces, one_piece
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.strip import triangulate, unroll

RADIUS, ANGLE, WIDTH, THICKNESS = 30.0, 2.0, 25.0, 2.0


def piece_of(made, thickness, side):
    settings = PieceSettings(thickness=thickness, surface_side=side, tolerance=1e-6)
    return one_piece(*made, name="tube", settings=settings)


def length_of(piece):
    return float(np.ptp(piece.sew_line[:, 0]))


@pytest.mark.parametrize("count", [5, 12, 60])
@pytest.mark.parametrize(("side", "share"), [("inside", 0.5), ("middle", 0.0), ("outside", -0.5)])
def test_a_cylinder_is_as_long_as_its_neutral_layer(count, side, share):
    made = strips.cylinder(RADIUS, ANGLE, WIDTH, count)
    chords = 2.0 * RADIUS * np.sin(0.5 * ANGLE / (count - 1)) * (count - 1)
    piece = piece_of(made, THICKNESS, side)
    # Chords for the surface itself, then the exact difference of the two arcs.
    assert length_of(piece) == pytest.approx(chords + share * THICKNESS * ANGLE, abs=1e-9)
    assert np.ptp(piece.sew_line[:, 1]) == pytest.approx(WIDTH, abs=1e-9)


def test_fine_samples_give_the_closed_form():
    made = strips.cylinder(RADIUS, ANGLE, WIDTH, 2000)
    piece = piece_of(made, THICKNESS, "inside")
    assert length_of(piece) == pytest.approx((RADIUS + 1.0) * ANGLE, rel=1e-6)


def test_inside_and_outside_change_places_when_the_strip_bends_the_other_way():
    bent_in = strips.cylinder(RADIUS, ANGLE, WIDTH, 60, inward=True)
    bent_out = strips.cylinder(RADIUS, ANGLE, WIDTH, 60)
    assert length_of(piece_of(bent_in, 2.0, "inside")) == pytest.approx(
        length_of(piece_of(bent_out, 2.0, "outside"))
    )


def test_rails_sampled_at_different_places_make_no_steps():
    one, two = np.linspace(0, ANGLE, 23), np.linspace(0, ANGLE, 31)
    p = np.column_stack((RADIUS * np.sin(one), 0 * one, RADIUS * np.cos(one)))
    q = np.column_stack((RADIUS * np.sin(two), 0 * two + WIDTH, RADIUS * np.cos(two)))
    triangulation = triangulate(p, q)
    piece = piece_of((unroll(triangulation), triangulation), THICKNESS, "inside")
    x = piece.sew_line[:, 0]
    run = x[np.flatnonzero(piece.sew.sides == 0)]
    assert np.all(np.diff(run) > 0.0)
    assert x.max() == pytest.approx((RADIUS + 1.0) * ANGLE, rel=2e-3)


def test_a_flat_strip_does_not_change_with_its_thickness():
    made = strips.rectangle()
    assert np.allclose(
        piece_of(made, 5.0, "inside").sew_line, piece_of(made, 0.0, "middle").sew_line
    )


def test_notches_stay_at_the_arc_lengths_of_the_surface():
    from wrinkle_cad.pattern.piece.options import NotchRule

    made = strips.cylinder(RADIUS, ANGLE, WIDTH, 60)
    thin, thick = (
        one_piece(
            *made,
            name="tube",
            settings=PieceSettings(
                thickness=t, surface_side="inside", notches_p=NotchRule(count=3)
            ),
        )
        for t in (0.0, 2.0)
    )
    assert [n.arc for n in thin.notches] == [n.arc for n in thick.notches]
    assert thick.notches[-1].seam[0] > thin.notches[-1].seam[0]


def k_piece(made, k_factor, *, side="middle", thickness=3.0, turned_over=False):
    settings = PieceSettings(
        thickness=thickness, surface_side=side, k_factor=k_factor, tolerance=1e-6
    )
    (piece,) = make_pieces(*made, name="tube", settings=settings, turned_over=turned_over)
    return piece


@pytest.mark.parametrize("inward", [False, True])
def test_three_mm_of_sheet_at_k_a_third_are_0_8_mm_shorter_over_90_degrees(inward):
    """(0.5 - K) t theta, whichever way it bends: the inner face is compressed."""
    made = strips.cylinder(RADIUS, 0.5 * np.pi, WIDTH, 200, inward=inward)
    shorter = length_of(k_piece(made, 0.5)) - length_of(k_piece(made, 0.33))
    assert shorter == pytest.approx(0.17 * 3.0 * 0.5 * np.pi, abs=1e-6)
    assert shorter == pytest.approx(0.80, abs=0.005)


@pytest.mark.parametrize("inward", [False, True])
@pytest.mark.parametrize(("side", "lowest"), [("inside", 0.0), ("middle", -0.5), ("outside", -1.0)])
@pytest.mark.parametrize("turned_over", [False, True])
def test_the_neutral_layer_counts_from_the_inner_face_of_the_bend(
    side, lowest, inward, turned_over
):
    """The material fills lowest...lowest + 1 thicknesses on the right side of the surface."""
    angle, k_factor, thickness = 1.5, 0.4, 2.0
    made = strips.cylinder(RADIUS, angle, WIDTH, 400, inward=inward)
    piece = k_piece(made, k_factor, side=side, thickness=thickness, turned_over=turned_over)
    # Seen from the axis the right side lies outside unless exactly one of the two turns it.
    is_outside = inward == turned_over
    inner = lowest if is_outside else -lowest - 1.0
    radius = RADIUS + thickness * (inner + k_factor)
    assert length_of(piece) == pytest.approx(radius * angle, rel=1e-5)

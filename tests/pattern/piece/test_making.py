from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces, one_piece
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.piece.options import SIDES, NotchRule, PieceSettings
from wrinkle_cad.pattern.piece.stacking import laid_out
from wrinkle_cad.settings import PIECE_GAP


def test_a_piece_stands_in_the_fixed_frame():
    for seed in range(0, 40, 3):
        for piece in make_pieces(*strips.random_strip(seed), name="strip"):
            assert np.allclose(piece.sew_line[0], 0.0)
            assert shapely.Polygon(piece.sew_line).exterior.is_ccw
            ends = piece.sew_line[piece.sew.corners]
            assert ends[:, 0].max() > abs(ends[:, 0].min())
            assert not piece.is_mirrored


def test_the_outline_runs_along_p_then_the_end_then_back_along_q():
    piece = one_piece(*strips.rectangle(120.0, 40.0), name="strip")
    assert piece.sew_line.tolist() == pytest.approx(
        np.array(((0, 0), (120, 0), (120, 40), (0, 40))), abs=1e-9
    )
    assert [SIDES[side] for side in piece.sew.sides] == ["P", "end", "Q", "start"]
    assert piece.p_span == (0.0, 120.0)
    assert piece.q_span == (0.0, 120.0)


def test_the_strip_is_turned_but_never_mirrored():
    unrolling, triangulation = strips.kinked()
    piece = one_piece(unrolling, triangulation, name="strip")
    # P dips 25 mm away from Q in its middle: below the line of its ends, with Q above.
    assert piece.sew_line[1, 1] == pytest.approx(-25.0)
    assert piece.sew_line[:, 1].max() == pytest.approx(30.0)


def test_rails_that_meet_leave_no_end_sides():
    piece = one_piece(*strips.lens(), name="lens")
    assert set(piece.sew.sides.tolist()) == {0, 1}
    assert int(piece.sew.corners.sum()) == 2


def test_no_segment_is_shorter_than_the_tolerance():
    x = np.concatenate((np.linspace(0.0, 1.0, 500), np.linspace(1.001, 100.0, 30)))
    p = np.column_stack((x, 0 * x, 0 * x))
    q = np.column_stack((x, 0 * x + 20.0, 0 * x))
    piece = one_piece(*strips.unrolled(p, q), name="strip")
    lengths = np.linalg.norm(np.roll(piece.sew_line, -1, axis=0) - piece.sew_line, axis=1)
    assert lengths.min() >= piece.tolerance
    assert shapely.Polygon(piece.sew_line).area == pytest.approx(2000.0)


def test_a_strip_below_the_tolerance_is_refused():
    with pytest.raises(InputError, match="Use a finer tolerance"):
        one_piece(*strips.rectangle(10.0, 0.01), name="thread")


def test_everything_in_a_piece_is_read_only():
    settings = PieceSettings(seam_allowance=(3.0,) * 4, notches_p=NotchRule(count=1))
    piece = one_piece(*strips.rectangle(), name="strip", settings=settings)
    arrays = [
        piece.cut_line, piece.sew_line, piece.grain_line, piece.rulings, piece.ruling_fold,
        piece.drill_holes, piece.cut.sides, piece.cut.corners, piece.notches[0].position,
    ]  # fmt: skip
    for array in arrays:
        assert not array.flags.writeable


def test_lasting_margin_comes_on_top_of_the_allowance_of_its_edge():
    settings = PieceSettings(seam_allowance=(5.0,) * 4, lasting_margin=(15.0, 0.0, 0.0, 0.0))
    piece = one_piece(*strips.rectangle(120.0, 40.0), name="strip", settings=settings)
    assert piece.widths == (20.0, 5.0, 5.0, 5.0)
    expected = shapely.box(-5.0, -20.0, 125.0, 45.0)
    assert shapely.Polygon(piece.cut_line).symmetric_difference(expected).area < 1e-6


def test_the_grain_runs_along_the_strip_inside_the_piece():
    piece = one_piece(*strips.cylinder(), name="tube")
    run = piece.grain_line[1] - piece.grain_line[0]
    assert run[1] == pytest.approx(0.0, abs=1e-9)
    assert run[0] == pytest.approx(0.7 * np.ptp(piece.sew_line[:, 0]), rel=1e-6)
    for seed in range(30):
        for piece in make_pieces(*strips.random_strip(seed), name="strip"):
            region = shapely.Polygon(piece.sew_line).buffer(1e-6)
            assert region.contains(shapely.LineString(piece.grain_line))


@pytest.mark.parametrize(
    ("direction", "flat"),
    [
        ((0.0, 1.0, 0.0), (0.0, 1.0)),
        ((0.0, -2.0, 0.0), (0.0, -1.0)),
        ((np.cos(1.0), 0.0, -np.sin(1.0)), (1.0, 0.0)),
        ((np.cos(1.0), 1.0, -np.sin(1.0)), (np.sqrt(0.5), np.sqrt(0.5))),
    ],
)
def test_a_direction_in_space_is_unrolled_at_the_middle_of_the_strip(direction, flat):
    # At the middle of this cylinder (1 rad of 2) the way along it is (cos 1, 0, -sin 1).
    settings = PieceSettings(grain=direction, stretch=direction)
    piece = one_piece(*strips.cylinder(count=61), name="tube", settings=settings)
    for line in (piece.grain_line, piece.stretch_line):
        run = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
        assert run == pytest.approx(flat, abs=0.02)


def test_a_direction_across_the_surface_is_refused():
    settings = PieceSettings(grain=(np.sin(1.0), 0.0, np.cos(1.0)))
    made = strips.cylinder(count=60)
    with pytest.raises(InputError, match="perpendicular to the strip"):
        one_piece(*made, name="tube", settings=settings)


def test_drill_holes_stand_where_their_shares_say():
    settings = PieceSettings(drill_holes=((0.25, 0.5), (0.5, 0.1)))
    piece = one_piece(*strips.rectangle(120.0, 40.0), name="strip", settings=settings)
    assert piece.drill_holes.tolist() == pytest.approx(np.array(((30, 20), (60, 4))))


def test_a_mirrored_pair_is_labelled_and_the_right_way_round():
    settings = PieceSettings(
        hand="left", seam_allowance=(4.0, 6.0, 5.0, 5.0), notches_p=NotchRule(count=3)
    )
    left, right = make_pieces(*strips.random_strip(1), name="vamp", settings=settings)
    assert (left.name, left.hand, left.is_mirrored) == ("vamp LEFT", "left", False)
    assert (right.name, right.hand, right.is_mirrored) == ("vamp RIGHT", "right", True)
    for one, other in ((left.cut, right.cut), (left.sew, right.sew)):
        assert shapely.Polygon(other.points).exterior.is_ccw
        turned = {(round(x, 9), round(-y, 9)): side for (x, y), side in edges(one)}
        assert turned == {(round(x, 9), round(y, 9)): side for (x, y), side in edges(other)}
    assert np.array_equal(left.ruling_fold, right.ruling_fold)
    assert [n.arc for n in left.notches] == [n.arc for n in right.notches]


def edges(outline):
    """The middles of an outline's segments with their sides."""
    middles = 0.5 * (outline.points + np.roll(outline.points, -1, axis=0))
    return zip(map(tuple, middles), outline.sides.tolist(), strict=True)


def test_the_texts_say_what_a_cutting_room_asks():
    settings = PieceSettings(size="38", quantity=2, material="Calf", tolerance=0.1)
    piece = one_piece(*strips.rectangle(), name="vamp", settings=settings)
    assert piece.texts == (
        "vamp", "SIZE 38", "QUANTITY 2", "RIGHT SIDE UP", "MATERIAL Calf",
        "UNITS MM", "CHORD TOLERANCE 0.1 MM",
    )  # fmt: skip


def test_rulings_can_be_thinned_out():
    made = strips.cylinder(count=200)
    every = one_piece(*made, name="tube", settings=PieceSettings(rulings=True)).rulings
    thinned = PieceSettings(rulings=True, ruling_spacing=5.0)
    some = one_piece(*made, name="tube", settings=thinned).rulings
    assert len(every) == 397
    assert 10 <= len(some) <= 13


def test_laid_out_pieces_keep_apart_and_start_at_the_origin():
    settings = PieceSettings(seam_allowance=(6.0,) * 4)
    pieces = [
        piece
        for seed in range(8)
        for piece in make_pieces(*strips.random_strip(seed), name=f"s{seed}", settings=settings)
    ]
    placed = laid_out(pieces)
    regions = [shapely.Polygon(piece.cut_line) for piece in placed]
    assert np.min([region.bounds[:2] for region in regions], axis=0) == pytest.approx((0.0, 0.0))
    for i, region in enumerate(regions):
        assert region.area == pytest.approx(shapely.Polygon(pieces[i].cut_line).area)
        for other in regions[:i]:
            assert region.distance(other) >= PIECE_GAP - 1e-9
    again = laid_out(placed)
    assert all(np.allclose(a.cut_line, b.cut_line) for a, b in zip(placed, again, strict=True))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"seam_allowance": (1.0, 2.0, 3.0)}, "4 numbers from 0 to 1000 mm, or one for all"),
        ({"seam_allowance": (1.0, -2.0, 3.0, 1.0)}, "4 numbers from 0 to 1000 mm, or one for all"),
        (
            {"lasting_margin": (1.0, float("nan"), 3.0, 1.0)},
            "4 numbers from 0 to 1000 mm, or one for all",
        ),
        ({"thickness": -1.0}, "from 0 to 1000 mm"),
        ({"thickness": float("inf")}, "from 0 to 1000 mm"),
        ({"tolerance": 0.0}, "from 1e-09 to 1000 mm"),
        ({"notch_depth": 0.0}, "above 0"),
        ({"mitre_limit": 0.5}, "from 1 to 100"),
        ({"quantity": 0}, "from 1 to 1000000"),
        ({"notch_kind": "w"}, "slit, v, t, castle, check or u"),
        ({"surface_side": "top"}, "inside, middle or outside"),
        ({"overlap": "ignore"}, "split or refuse"),
        ({"hand": "both"}, "left or right"),
        ({"grain": "up"}, "along, across or 3 numbers"),
        ({"grain": None}, "along, across or 3 numbers"),
        ({"grain": (0.0, 0.0, 0.0)}, "no direction"),
        ({"stretch": (1.0, float("nan"), 0.0)}, "3 numbers"),
        ({"drill_holes": ((0.5, 1.5),)}, "above 0 and below 1"),
        ({"drill_holes": ((0.5,),)}, "above 0 and below 1"),
    ],
)
def test_settings_that_mean_nothing_are_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        PieceSettings(**wrong)


def test_a_hole_outside_the_piece_is_refused():
    # Q goes up and down a steep peak: from its way down, the way to P leaves the material.
    p = np.array(((0, 0, 0), (100, 0, 0)), float)
    q = np.array(((0, 10, 0), (40, 80, 0), (45, 10, 0), (100, 10, 0)), float)
    made = strips.unrolled(p, q, ("length",))
    inside = PieceSettings(drill_holes=((0.2, 0.9),))
    assert len(one_piece(*made, name="peak", settings=inside).drill_holes) == 1
    with pytest.raises(InputError, match="outside the flat piece"):
        one_piece(*made, name="peak", settings=PieceSettings(drill_holes=((0.56, 0.9),)))

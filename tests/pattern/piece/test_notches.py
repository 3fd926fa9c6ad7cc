from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from tests.seeds import seeds
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.formats.drawing import draw
from wrinkle_cad.pattern.piece.notch_forms import notch_lines
from wrinkle_cad.pattern.piece.notches import corner_arcs, notch_arcs
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings

SLOW = pytest.mark.slow


def test_counted_notches_divide_the_rail_evenly():
    assert notch_arcs(100.0, NotchRule(count=4)).tolist() == [20.0, 40.0, 60.0, 80.0]
    assert notch_arcs(100.0, NotchRule()).tolist() == []


def test_spaced_notches_are_spread_so_that_all_distances_are_equal():
    arcs = notch_arcs(100.0, NotchRule(spacing=30.0))
    assert arcs == pytest.approx((100.0 / 3.0, 200.0 / 3.0))
    assert len(notch_arcs(100.0, NotchRule(spacing=300.0))) == 0


def test_given_positions_are_kept():
    assert notch_arcs(100.0, NotchRule(at=(70.0, 10.0))).tolist() == [10.0, 70.0]


@pytest.mark.parametrize("at", [1.0, 99.0, 52.0, 120.0])
def test_a_given_position_on_a_corner_or_off_the_rail_is_refused(at):
    with pytest.raises(InputError, match="from a corner or end"):
        notch_arcs(100.0, NotchRule(at=(at,)), corners=(50.0,))


def test_automatic_notches_move_away_from_corners():
    arcs = notch_arcs(100.0, NotchRule(count=3), corners=(50.0, 51.0, 76.0))
    assert arcs.tolist() == [25.0, 47.0, 73.0]
    assert len(notch_arcs(5.0, NotchRule(count=2))) == 0


def test_notches_never_crowd():
    corners = (40.0, 41.0, 42.0, 43.0, 44.0)
    arcs = notch_arcs(100.0, NotchRule(count=24), corners=corners)
    assert np.diff(arcs).min() >= 2.0
    assert 20 <= len(arcs) < 24
    assert np.abs(arcs[:, None] - corners).min() >= 3.0 - 1e-12
    assert len(notch_arcs(100.0, NotchRule(count=90))) == 86


def test_rules_that_contradict_themselves_are_refused():
    for wrong in (
        {"count": -1}, {"spacing": 0.0}, {"at": (-5.0,)}, {"count": 2, "spacing": 5.0},
    ):  # fmt: skip
        with pytest.raises(InputError, match="notches"):
            NotchRule(**wrong)


def test_the_same_rule_on_both_edges_gives_points_at_equal_arc_length():
    """The piece's notch and the point on the rail in space are equally far from the start."""
    settings = PieceSettings(
        seam_allowance=(6.0,) * 4, notches_p=NotchRule(count=5), notches_q=NotchRule(spacing=20.0)
    )
    unrolling, triangulation = strips.cylinder(count=121)
    (piece,) = make_pieces(unrolling, triangulation, name="tube", settings=settings)
    for side, rail, flat in (
        (0, triangulation.p, unrolling.p_line),
        (1, triangulation.q, unrolling.q_line),
    ):
        own = [notch for notch in piece.notches if notch.side == side]
        assert len(own) >= 2
        length = np.linalg.norm(np.diff(rail, axis=0), axis=1).sum()
        rule = settings.notches_p if side == 0 else settings.notches_q
        opening = notch_arcs(float(length), rule, corners=corner_arcs(flat, lengths_to(flat)))
        seam = seam_line(piece, side)
        measured = [seam.project(shapely.Point(notch.seam)) for notch in own]
        assert measured == pytest.approx(opening.tolist(), abs=1e-9)


def lengths_to(points):
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))


def seam_line(piece, side):
    closed = np.vstack((piece.sew_line, piece.sew_line[:1]))
    index = np.flatnonzero(piece.sew.sides == side)
    points = closed[index[0] : index[-1] + 2]
    return shapely.LineString(points if side == 0 else points[::-1])


@pytest.mark.parametrize("seed", seeds(25))
def test_notches_stand_on_the_cut_line_and_point_to_their_seam(seed):
    settings = PieceSettings(
        seam_allowance=(6.0, 3.0, 4.0, 4.0),
        notches_p=NotchRule(count=6),
        notches_q=NotchRule(count=4),
    )
    for piece in make_pieces(*strips.random_strip(seed), name="s", settings=settings):
        cut = shapely.Polygon(piece.cut_line)
        corners = shapely.MultiPoint(piece.sew_line[piece.sew.corners])
        for notch in piece.notches:
            foot, position = shapely.Point(notch.seam), shapely.Point(notch.position)
            assert cut.exterior.distance(position) < 1e-9
            assert foot.distance(corners) > 0.5
            assert np.linalg.norm(notch.direction) == pytest.approx(1.0)
            assert 0.0 < notch.depth <= 0.6 * piece.widths[notch.side] + 1e-12
            tip = shapely.Point(notch.position + notch.depth * notch.direction)
            assert cut.buffer(1e-9).contains(tip)
            if foot.distance(position) > 1e-6:
                towards = (notch.seam - notch.position) / foot.distance(position)
                assert towards @ notch.direction > 0.9


def test_no_notch_stands_on_a_kink_of_its_rail():
    settings = PieceSettings(notches_p=NotchRule(count=1))
    unrolling, triangulation = strips.kinked()
    (piece,) = make_pieces(unrolling, triangulation, name="kink", settings=settings)
    (notch,) = piece.notches
    kink = unrolling.p_arc[1]
    assert abs(notch.arc - kink) == pytest.approx(3.0)


def test_the_forms_of_notches_have_their_depth_and_width():

    for kind in ("slit", "v", "t", "castle", "check", "u"):
        settings = PieceSettings(
            seam_allowance=(10.0,) * 4, notches_p=NotchRule(count=1), notch_kind=kind
        )
        (piece,) = make_pieces(*strips.rectangle(), name="s", settings=settings)
        points = np.vstack(notch_lines(piece.notches[0]))
        assert np.ptp(points[:, 1]) == pytest.approx(3.0)
        assert np.ptp(points[:, 0]) == pytest.approx(
            {"slit": 0.0, "check": 1.0}.get(kind, 2.0), abs=1e-9
        )
        assert points[:, 1].min() == pytest.approx(-10.0)


def refusals(pieces):
    return [f for piece in pieces for f in piece.findings if f.code == "notch-left-out"]


def dart(mouth=4.0, depth=24.0):
    """A flat strap with a dart in P whose two allowances of 6 mm are wider than its mouth."""
    from tests.pattern.strips import unrolled

    left, right = 60.0 - 0.5 * mouth, 60.0 + 0.5 * mouth
    p = np.array(((0, 0, 0), (left, 0, 0), (60, depth, 0), (right, 0, 0), (120, 0, 0)))
    return unrolled(p, np.array(((0, 40, 0), (120, 40, 0))))


NINE = PieceSettings(seam_allowance=(6.0,) * 4, notches=9)


def test_notches_in_a_dart_that_its_allowance_closes_are_left_out_with_their_partners():
    (piece,) = make_pieces(*dart(), name="dart", settings=NINE)
    told = refusals([piece])
    on_p = [notch for notch in piece.notches if notch.side == 0]
    assert len(on_p) + len(told) == 9
    assert len(told) >= 2
    for notch in on_p:
        assert np.hypot(*(notch.position - notch.seam)) <= 2.0 * 6.0 + 1e-9
    assert "both edges" in told[0].message


@pytest.mark.parametrize(("mouth", "closed"), [(4.0, True), (9.0, True), (30.0, False)])
def test_a_dart_narrower_than_its_allowance_is_told(mouth, closed):
    (piece,) = make_pieces(*dart(mouth), name="dart", settings=NINE)
    assert ("dart-closed" in [finding.code for finding in piece.findings]) == closed
    (plain,) = make_pieces(*dart(mouth), name="dart")
    assert plain.findings == ()


def test_without_an_allowance_a_notch_is_a_mark_and_nothing_is_cut_into_the_product():
    settings = PieceSettings(notches=3, notch_kind="v", seam_allowance=(0.0, 5.0, 0.0, 0.0))
    (piece,) = make_pieces(*strips.rectangle(), name="s", settings=settings)
    assert [notch.is_cut for notch in piece.notches] == [False] * 3 + [True] * 3
    drawing = draw(piece)
    assert len([s for s in drawing.strokes if s.role == "mark"]) == 3
    for stroke in drawing.strokes:
        if stroke.role in ("notch", "cut"):
            inside = shapely.Polygon(piece.sew_line).buffer(-1e-6)
            assert not shapely.LineString(stroke.points).intersects(inside)


@pytest.mark.parametrize(
    "seed", [*range(20), *(pytest.param(s, marks=SLOW) for s in range(20, 200))]
)
def test_every_notch_is_within_the_mitre_or_told_and_no_slit_crosses(seed):
    random = np.random.default_rng(seed)
    widths = tuple(random.uniform(2.0, 10.0, 4).tolist())
    kind = ("slit", "v", "t", "castle", "check", "u")[seed % 6]
    settings = PieceSettings(seam_allowance=widths, notches=9, notch_kind=kind)
    pieces = make_pieces(*strips.random_strip(seed), name="s", settings=settings)
    for piece in pieces:
        corners = shapely.MultiPoint(piece.cut_line[piece.cut.corners])
        sew = shapely.Polygon(piece.sew_line)
        shapes = []
        for notch in piece.notches:
            away = np.hypot(*(notch.position - notch.seam))
            assert away <= settings.mitre_limit * piece.widths[notch.side] + 0.05
            assert notch.depth <= 0.6 * away + 1e-9
            shape = shapely.MultiLineString(notch_lines(notch))
            assert shape.distance(corners) >= 0.5 - 1e-9
            assert not shape.intersects(sew)
            assert all(shape.distance(other) >= 0.5 - 1e-9 for other in shapes)
            shapes.append(shape)
    for side in (0, 1):
        stand = sum(notch.side == side for piece in pieces for notch in piece.notches)
        told = sum(f" of {'PQ'[side]} of s" in finding.message for finding in refusals(pieces))
        wanted = wanted_notches(strips.random_strip(seed), settings, side)
        assert stand + told == wanted


def wanted_notches(strip, settings, side):
    from wrinkle_cad.pattern.piece.making import strip_parts
    from wrinkle_cad.pattern.piece.placing import seam_arcs

    parts = strip_parts(*strip, name="s", settings=settings)
    return len(seam_arcs(parts.strip, parts.parts, settings)[side])

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces, one_piece
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.piece.flat import flat_strip
from wrinkle_cad.pattern.piece.options import END_SIDE, START_SIDE, NotchRule, PieceSettings
from wrinkle_cad.pattern.piece.splitting import overlaps

SETTINGS = PieceSettings(
    seam_allowance=(4.0, 4.0, 6.0, 6.0), notches_p=NotchRule(count=7), notches_q=NotchRule(count=5)
)


@pytest.fixture(scope="module")
def ramp():
    return strips.ramp(turns=2.3)


def test_an_overlapping_pattern_is_refused_on_request(ramp):
    assert ramp[0].overlaps
    with pytest.raises(InputError, match="overlaps itself when flat"):
        make_pieces(*ramp, name="ramp", settings=PieceSettings(overlap="refuse"))
    with pytest.raises(InputError, match="overlaps itself when flat"):
        one_piece(*ramp, name="ramp")


def test_an_overlapping_pattern_is_split_into_simple_pieces_with_a_warning(ramp):
    pieces = make_pieces(*ramp, name="ramp", settings=SETTINGS)
    assert [piece.name for piece in pieces] == ["ramp-1", "ramp-2", "ramp-3"]
    for piece in pieces:
        assert shapely.Polygon(piece.sew_line).is_valid
        assert shapely.Polygon(piece.cut_line).is_valid
        assert "pattern-split" in [finding.code for finding in piece.findings]


def test_nothing_is_lost_or_doubled_by_splitting(ramp):
    unrolling, _ = ramp
    pieces = make_pieces(*ramp, name="ramp", settings=SETTINGS)
    area = sum(shapely.Polygon(piece.sew_line).area for piece in pieces)
    assert area == pytest.approx(unrolling.area, rel=1e-3)
    spans = [piece.p_span for piece in pieces]
    assert spans[0][0] == 0.0
    assert spans[-1][1] == pytest.approx(unrolling.p_length)
    for before, after in pairwise(spans):
        assert before[1] == after[0]


def test_no_fewer_pieces_would_do(ramp):
    """Every piece but the last would overlap with one more bridge."""
    strip = flat_strip(*ramp)
    pieces = make_pieces(*ramp, name="ramp", settings=SETTINGS)
    starts = [piece.p_span[0] for piece in pieces[1:]]
    first = 0
    for start in starts:
        cut = next(
            i
            for i, (row, _) in enumerate(strip.bridges)
            if i > first
            and strip.p_arc[row] == start
            and not overlaps(strip.run(first, i), 0.05)
            and overlaps(strip.run(first, i + 1), 0.05)
        )
        first = cut
    assert not overlaps(strip.run(first, len(strip.bridges) - 1), 0.05)


def test_cut_ends_match_in_length_allowance_and_notches(ramp):
    pieces = make_pieces(*ramp, name="ramp", settings=SETTINGS)
    for before, after in pairwise(pieces):
        assert before.widths[END_SIDE] == after.widths[START_SIDE] == 6.0
        ends = [notch for notch in before.notches if notch.side == END_SIDE]
        starts = [notch for notch in after.notches if notch.side == START_SIDE]
        # Two unless the allowance of a full turn runs into itself there.
        assert len(ends) == len(starts)
        told = [f for f in (*before.findings, *after.findings) if " of end of " in f.message]
        told += [f for f in (*before.findings, *after.findings) if " of start of " in f.message]
        assert len(ends) + len(told) >= 2
        assert [n.arc for n in ends] == pytest.approx([n.arc for n in starts])
        lengths = [
            np.linalg.norm(piece.sew_line[i + 1 - len(piece.sew_line)] - piece.sew_line[i])
            for piece, i in (
                (before, int(np.flatnonzero(before.sew.sides == END_SIDE)[0])),
                (after, int(np.flatnonzero(after.sew.sides == START_SIDE)[0])),
            )
        ]
        assert lengths[0] == pytest.approx(lengths[1])
    assert not [n for n in pieces[0].notches if n.side == START_SIDE]
    assert not [n for n in pieces[-1].notches if n.side == END_SIDE]


def test_the_notches_of_the_whole_rail_are_shared_out(ramp):
    pieces = make_pieces(*ramp, name="ramp", settings=SETTINGS)
    for side, count in ((0, 7), (1, 5)):
        arcs = [n.arc for piece in pieces for n in piece.notches if n.side == side]
        told = [
            f for piece in pieces for f in piece.findings if f" of {'PQ'[side]} of" in f.message
        ]
        assert len(arcs) + len(told) == count
        assert len(arcs) >= count - 2
        assert arcs == sorted(arcs)
    cuts = [piece.p_span[1] for piece in pieces[:-1]]
    all_arcs = np.array([n.arc for piece in pieces for n in piece.notches if n.side == 0])
    assert np.abs(all_arcs[:, None] - cuts).min() >= 3.0 - 1e-9


def test_cut_ends_without_end_allowance_take_that_of_the_seams(ramp):
    settings = PieceSettings(seam_allowance=(4.0, 3.0, 0.0, 0.0))
    pieces = make_pieces(*ramp, name="ramp", settings=settings)
    assert [piece.widths[END_SIDE] for piece in pieces] == [4.0, 4.0, 0.0]
    assert [piece.widths[START_SIDE] for piece in pieces] == [0.0, 4.0, 4.0]


def test_a_strip_that_lies_flat_stays_in_one_piece():
    (piece,) = make_pieces(*strips.ramp(turns=0.8), name="ramp", settings=SETTINGS)
    assert piece.name == "ramp"
    assert piece.findings == ()


def test_a_thick_material_is_split_as_well(ramp):
    settings = PieceSettings(thickness=2.0, surface_side="inside")
    for piece in make_pieces(*ramp, name="ramp", settings=settings):
        assert shapely.Polygon(piece.cut_line).is_valid


def test_a_ring_whose_ends_touch_is_whole_as_the_strip_says():
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    ring = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))
    unrolling, triangulation = strips.unrolled(35.0 * ring, 25.0 * ring)
    (piece,) = make_pieces(unrolling, triangulation, name="ring", settings=PieceSettings())
    assert not unrolling.overlaps
    assert shapely.Polygon(piece.sew_line).area == pytest.approx(unrolling.area, rel=1e-9)

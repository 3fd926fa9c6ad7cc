"""Bridges lie on pattern pieces where the strip's rulings lie."""

from __future__ import annotations

import numpy as np
import pytest

from tests.pattern.strips import make_pieces
from tests.report.strips import cylinder_rails, view_of, wavy_rails
from wrinkle_cad.pattern.piece.options import P_SIDE, Q_SIDE, PieceSettings
from wrinkle_cad.report.flat import bridge_ends, rail_line
from wrinkle_cad.report.views import StripView

ALLOWANCE = (6.0, 5.0, 4.0, 3.0)


@pytest.fixture(scope="module")
def view() -> StripView:
    return view_of(wavy_rails(60, 64))


def pieces_with(view: StripView, **settings: object) -> tuple[object, ...]:
    return make_pieces(
        view.unrolling,
        view.triangulation,
        name="a",
        settings=PieceSettings(rulings=True, **settings),
    )


@pytest.mark.parametrize("allowance", [(0.0, 0.0, 0.0, 0.0), ALLOWANCE])
def test_bridges_lie_on_the_rulings_of_the_piece(view: StripView, allowance: object) -> None:
    (piece,) = pieces_with(view, seam_allowance=allowance, tolerance=1e-4)
    first, ends = bridge_ends(piece, view.triangulation, view.unrolling)
    assert first == 0
    assert len(ends) == len(view.triangulation.bridges)
    assert len(piece.rulings) == len(ends) - 2
    assert np.allclose(ends[1:-1], piece.rulings, atol=0.01)


def test_bridges_follow_a_piece_that_is_moved_or_mirrored(view: StripView) -> None:
    for piece in pieces_with(view, seam_allowance=ALLOWANCE, hand="left", tolerance=1e-4):
        moved = piece.moved(np.array([30.0, -7.0]))
        _, ends = bridge_ends(moved, view.triangulation, view.unrolling)
        assert np.allclose(ends[1:-1], moved.rulings, atol=0.01)


def test_bridges_have_the_lengths_they_have_in_space(view: StripView) -> None:
    (piece,) = pieces_with(view, tolerance=1e-4)
    _, ends = bridge_ends(piece, view.triangulation, view.unrolling)
    i, j = view.triangulation.bridges.T
    space = np.linalg.norm(view.triangulation.p[i] - view.triangulation.q[j], axis=1)
    assert np.allclose(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), space, atol=0.01)


def test_rails_run_from_start_to_end(view: StripView) -> None:
    (piece,) = pieces_with(view)
    for side, sign in ((P_SIDE, -1.0), (Q_SIDE, 1.0)):
        line = rail_line(piece, side)
        assert line[-1, 0] - line[0, 0] > 100.0
        assert sign * (line[:, 1].mean() - piece.sew_line[:, 1].mean()) > 0.0


def test_a_split_pattern_shows_each_bridge_on_its_piece() -> None:
    """A ring sector of more than a full turn overlaps itself when flat."""
    turn = np.linspace(0.0, 2.4 * np.pi, 160)
    rise = 2.0 * turn
    rails = [np.column_stack((r * np.cos(turn), r * np.sin(turn), rise)) for r in (20.0, 30.0)]
    view = view_of((rails[0], rails[1]), settings=PieceSettings())
    assert view.unrolling.overlaps
    assert len(view.pieces) > 1
    seen = np.zeros(len(view.triangulation.bridges), dtype=int)
    for piece in view.pieces:
        first, ends = bridge_ends(piece, view.triangulation, view.unrolling)
        seen[first : first + len(ends)] += 1
    assert seen.min() == 1
    assert np.count_nonzero(seen > 1) == len(view.pieces) - 1


def test_a_piece_of_another_strip_takes_no_bridges(view: StripView) -> None:
    from dataclasses import replace

    (piece,) = pieces_with(view)
    elsewhere = replace(piece, p_span=(1e4, 2e4), q_span=(1e4, 2e4))
    first, ends = bridge_ends(elsewhere, view.triangulation, view.unrolling)
    assert (first, ends.shape) == (0, (0, 2, 2))


def test_a_strip_that_starts_in_a_point_has_its_bridges_there() -> None:
    s = np.linspace(-1.2, 1.2, 40)
    p = np.column_stack((40.0 * np.sin(s), 8.0 * (s**2 - 1.44), 40.0 * np.cos(s)))
    q = np.column_stack((40.0 * np.sin(s), 8.0 * (1.44 - s**2), 40.0 * np.cos(s)))
    view = view_of((p, q), settings=PieceSettings(tolerance=1e-4, rulings=True))
    (piece,) = view.pieces
    _, ends = bridge_ends(piece, view.triangulation, view.unrolling)
    assert np.allclose(ends[0, 0], ends[0, 1], atol=0.01)
    assert np.allclose(ends[-1, 0], ends[-1, 1], atol=0.01)
    assert len(ends) == len(view.triangulation.bridges)


def test_the_cylinder_strip_also_fits() -> None:
    view = view_of(cylinder_rails(), settings=PieceSettings(tolerance=1e-4, rulings=True))
    (piece,) = view.pieces
    _, ends = bridge_ends(piece, view.triangulation, view.unrolling)
    assert np.allclose(ends[1:-1], piece.rulings, atol=0.01)

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from tests.seeds import seeds
from wrinkle_cad.pattern.piece.allowance import cut_outline
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.pattern.piece.piece import make_outline

TOLERANCE = 0.05


def square(side=100.0):
    corners = np.array(((0, 0), (side, 0), (side, side), (0, side)), float)
    return make_outline(corners, [0, 3, 1, 2], [True] * 4)


def cut_of(outline, widths, mitre_limit=2.0):
    cut, holes = cut_outline(outline, widths, mitre_limit=mitre_limit, tolerance=TOLERANCE)
    assert not holes
    return cut


def side_lines(sew):
    closed = np.vstack((sew.points, sew.points[:1]))
    return {
        side: shapely.MultiLineString(
            [closed[i : i + 2] for i in np.flatnonzero(sew.sides == side)]
        )
        for side in np.unique(sew.sides)
    }


def check_cut(piece, mitre_limit):
    """The region cut is simple, holds the sew line and reaches every width, but not further."""
    cut = shapely.Polygon(piece.cut_line)
    sew = shapely.Polygon(piece.sew_line)
    assert cut.is_valid
    assert cut.exterior.is_simple
    assert cut.exterior.is_ccw
    assert cut.buffer(1e-9).contains(sew)
    lines = side_lines(piece.sew)
    boundary = shapely.segmentize(cut.exterior, 1.0)
    points = shapely.points(np.array(boundary.coords))
    misses = np.array(
        [shapely.distance(points, line) - piece.widths[side] for side, line in lines.items()]
    ).min(axis=0)
    corner_points = piece.sew_line[piece.sew.corners]
    # A clipped mitre is square: its ends stand a width beside the corner's axis.
    reach = float(np.hypot(mitre_limit, 1.0)) * max(piece.widths) + TOLERANCE
    from_corner = shapely.distance(points, shapely.MultiPoint(corner_points))
    away = from_corner > reach
    assert np.all(misses[away] <= TOLERANCE * 1.01), misses[away].max()
    assert np.all(misses <= reach)
    if len(set(piece.widths)) == 1:
        assert np.all(misses >= -TOLERANCE * 1.01), misses.min()
    # Straight out from the middle of every segment the whole width is there.
    after = np.roll(piece.sew_line, -1, axis=0)
    along = (after - piece.sew_line) / np.linalg.norm(after - piece.sew_line, axis=1)[:, None]
    width = np.array(piece.widths)[piece.sew.sides] - TOLERANCE
    out = np.column_stack((along[:, 1], -along[:, 0])) * width[:, None]
    middles = 0.5 * (after + piece.sew_line)
    rays = shapely.linestrings(np.stack((middles, middles + out), axis=1))
    assert np.all(shapely.covers(cut, rays))


@pytest.mark.parametrize("seed", seeds(200))
def test_every_random_strip_gets_a_simple_cut_line_at_its_widths(seed):
    random = np.random.default_rng(1000 + seed)
    unrolling, triangulation = strips.random_strip(seed)
    breadth = float(np.linalg.norm(unrolling.p[len(unrolling.p) // 2] - unrolling.q.mean(axis=0)))
    largest = max(1.0, random.choice((1.0, 5.0, 1.5 * breadth)))
    widths = tuple(random.uniform(1.0, largest, 4) if seed % 2 else np.full(4, largest))
    settings = PieceSettings(seam_allowance=widths, tolerance=TOLERANCE)
    for piece in make_pieces(unrolling, triangulation, name="random", settings=settings):
        check_cut(piece, settings.mitre_limit)
        lengths = np.linalg.norm(np.roll(piece.cut_line, -1, axis=0) - piece.cut_line, axis=1)
        assert lengths.min() > 1e-6


def test_the_check_of_the_widths_fails_for_a_wrong_width():
    unrolling, triangulation = strips.random_strip(1)
    settings = PieceSettings(seam_allowance=(5.0,) * 4)
    (piece,) = make_pieces(unrolling, triangulation, name="random", settings=settings)
    for wrong in (4.8, 5.2):
        with pytest.raises(AssertionError):
            check_cut(replace(piece, widths=(wrong,) * 4), 2.0)


def test_a_square_gets_mitred_corners():
    cut = cut_of(square(), (10.0,) * 4)
    assert shapely.Polygon(cut.points).equals(shapely.box(-10, -10, 110, 110))
    assert cut.corners.all()


def test_each_side_of_a_square_gets_its_own_width():
    cut = cut_of(square(), (1.0, 2.0, 3.0, 4.0))
    assert shapely.Polygon(cut.points).equals(shapely.box(-3, -1, 104, 102))
    assert sorted(cut.sides) == [0, 1, 2, 3]


def test_a_side_without_allowance_keeps_its_sew_line():
    cut = cut_of(square(), (5.0, 5.0, 0.0, 5.0))
    assert shapely.Polygon(cut.points).equals(shapely.box(0, -5, 105, 105))


def test_without_allowance_the_cut_line_is_the_sew_line():
    sew = square()
    assert cut_of(sew, (0.0,) * 4) is sew


def test_a_pointed_corner_is_clipped_at_the_mitre_limit():
    points = np.array(((0, 0), (100, -3), (100, 3)), float)
    sew = make_outline(points, [0, 3, 1], [True] * 3)
    for limit in (1.0, 2.0, 4.0):
        cut = cut_of(sew, (5.0, 5.0, 0.0, 5.0), limit)
        assert cut.points[:, 0].min() == pytest.approx(-5.0 * limit, abs=1e-9)


def test_an_infinitely_sharp_tip_keeps_its_allowance():
    x = np.linspace(0.0, 1.0, 50)
    lower = np.column_stack((100 * x, -5 * np.sin(np.pi * x) ** 3))
    upper = np.column_stack((100 * x, 5 * np.sin(np.pi * x) ** 3))[::-1][1:-1]
    points = np.vstack((lower, upper))
    sides = [0] * 49 + [1] * 49
    corners = np.zeros(98, bool)
    corners[[0, 49]] = True
    cut = cut_of(make_outline(points, sides, corners), (5.0, 5.0, 0.0, 0.0))
    assert shapely.Polygon(cut.points).exterior.distance(shapely.Point(0, 0)) > 4.99


def test_a_narrow_bay_is_trimmed_where_the_offset_crosses_itself():
    points = np.array(
        ((0, 0), (40, 0), (40, 60), (44, 60), (44, 0), (100, 0), (100, 100), (0, 100)), float
    )
    sew = make_outline(points, [0, 0, 0, 0, 0, 3, 1, 2], [True] * 8)
    cut = cut_of(sew, (5.0,) * 4)
    # The bay is 4 mm wide, the allowances together 10: it is filled.
    assert shapely.Polygon(cut.points).equals_exact(
        shapely.box(-5, -5, 105, 105).normalize(), 1e-6
    ) or (
        shapely.Polygon(cut.points).symmetric_difference(shapely.box(-5, -5, 105, 105)).area < 1e-6
    )


def test_an_allowance_that_closes_a_ring_leaves_a_cut_out():
    angle = np.linspace(0.3, 2.0 * np.pi - 0.3, 80)
    ring = np.column_stack((np.cos(angle), np.sin(angle)))
    points = np.vstack((50 * ring, 40 * ring[::-1]))
    sides = [0] * 79 + [3] + [1] * 79 + [2]
    corners = np.zeros(160, bool)
    corners[[0, 79, 80, 159]] = True
    sew = make_outline(points, sides, corners)
    cut, holes = cut_outline(sew, (0.0, 0.0, 16.0, 16.0), mitre_limit=2.0, tolerance=TOLERANCE)
    assert len(holes) == 1
    assert shapely.Polygon(holes[0]).is_valid
    assert shapely.Polygon(cut.points).contains(shapely.Polygon(holes[0]))


@pytest.mark.parametrize("shift", [-20.0, -35.0, 20.0])
@pytest.mark.parametrize("side", ["P", "Q"])
def test_beside_a_bare_edge_the_allowance_ends_on_the_line_of_that_edge(shift, side):
    """A strap of 100 x 40 mm whose start slants; allowance on one seam only."""
    p = np.array(((0.0, 0.0, 0.0), (100.0, 0.0, 0.0)))
    q = np.array(((shift, 40.0, 0.0), (100.0, 40.0, 0.0)))
    widths = (6.0, 0.0, 0.0, 0.0) if side == "P" else (0.0, 6.0, 0.0, 0.0)
    settings = PieceSettings(seam_allowance=widths)
    (piece,) = make_pieces(*strips.unrolled(p, q), name="s", settings=settings)
    start = piece.sew_line[piece.sew.corners]
    first, last = start[0], start[-1]
    slope = (last - first) / 40.0
    corner = first - 6.0 * slope if side == "P" else last + 6.0 * slope
    nearest = np.hypot(*(piece.cut_line - corner).T).min()
    assert nearest < 1e-6
    # A parallelogram of the seam's length stands on the seam, less or more the slant.
    area = shapely.Polygon(piece.cut_line).area - shapely.Polygon(piece.sew_line).area
    seam = 100.0 if side == "P" else 100.0 - shift
    away = abs(corner[0] - (first if side == "P" else last)[0])
    grows = (shift > 0.0) == (side == "P")
    assert area == pytest.approx(6.0 * (seam + (0.5 if grows else -0.5) * away), abs=1e-6)

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.pattern import strips
from tests.pattern.strips import make_pieces
from wrinkle_cad.pattern.formats.contours import closed_spline, with_arcs
from wrinkle_cad.pattern.piece.options import PieceSettings

TOLERANCE = 0.05


def along_arcs(rows, count=40):
    """Points along bulged vertices, by the definition: bulge = tan(angle / 4), left is positive."""
    points = []
    for (x, y, bulge), (u, v, _) in zip(rows, np.roll(rows, -1, axis=0), strict=True):
        start, stop = complex(x, y), complex(u, v)
        if bulge == 0.0:
            points.append(start)
            continue
        angle = 4.0 * np.arctan(bulge)
        centre = 0.5 * (start + stop) + 0.5j * (stop - start) / np.tan(0.5 * angle)
        turn = np.exp(1j * angle * np.arange(count) / count)
        points.extend(centre + (start - centre) * turn)
    return np.column_stack((np.real(points), np.imag(points)))


def gap(made, points):
    rings = [shapely.LinearRing(line) for line in (made, points)]
    return shapely.hausdorff_distance(*(shapely.segmentize(ring, 0.5) for ring in rings))


def circle(radius=30.0, count=100):
    angle = 2.0 * np.pi * np.arange(count) / count
    return radius * np.column_stack((np.cos(angle), np.sin(angle)))


def test_a_circle_becomes_a_few_exact_arcs():
    rows = with_arcs(circle(), tolerance=TOLERANCE)
    assert len(rows) <= 4
    radii = np.linalg.norm(along_arcs(rows), axis=1)
    assert radii == pytest.approx(np.full(len(radii), 30.0), abs=1e-9)
    assert np.all(rows[:, 2] > 0.0)


def test_a_square_stays_a_square():
    corners = np.array(((0, 0), (10, 0), (10, 10), (0, 10)), float)
    rows = with_arcs(corners, tolerance=TOLERANCE)
    assert sorted(map(tuple, rows[:, :2])) == sorted(map(tuple, corners))
    assert not rows[:, 2].any()


def test_a_notch_turned_inward_has_negative_bulges():
    outer = circle()[:51]
    inner = 20.0 * circle()[:51][::-1] / 30.0
    rows = with_arcs(np.vstack((outer, inner)), tolerance=TOLERANCE)
    assert (rows[:, 2] > 0.0).any()
    assert (rows[:, 2] < 0.0).any()


@pytest.mark.parametrize("seed", range(0, 18, 3))
def test_curves_stay_within_the_tolerance_of_the_contour(seed):
    settings = PieceSettings(seam_allowance=(5.0,) * 4)
    for piece in make_pieces(*strips.random_strip(seed), name="s", settings=settings):
        for points in (piece.cut_line, piece.sew_line):
            arcs = along_arcs(with_arcs(points, tolerance=TOLERANCE))
            assert gap(arcs, points) <= TOLERANCE * 1.02
            spline = closed_spline(points, tolerance=TOLERANCE)
            line = np.array([(point.x, point.y) for point in spline.approximate(4000)])
            assert np.allclose(line[0], line[-1])
            ring = shapely.LinearRing(points)
            assert shapely.distance(shapely.points(line), ring).max() <= TOLERANCE * 1.001
            # The other way round only as finely as the spline is sampled here.
            step = np.linalg.norm(np.diff(line, axis=0), axis=1).max()
            assert gap(line[:-1], points) <= TOLERANCE + 0.5 * step
            assert shapely.Polygon(line[:-1]).is_valid


def test_a_spline_keeps_the_corners():
    corners = np.array(((0, 0), (10, 0), (10, 10), (0, 10)), float)
    spline = closed_spline(corners, tolerance=TOLERANCE)
    line = np.array([(point.x, point.y) for point in spline.approximate(4000)])
    assert shapely.Polygon(line).symmetric_difference(shapely.box(0, 0, 10, 10)).area < 0.01

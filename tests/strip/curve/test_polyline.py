from __future__ import annotations

import numpy as np
import pytest

from wrinkle_cad.strip.curve.nearest import gap_from_segment, nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import (
    arc_lengths,
    points_at,
    polyline_length,
    row_lengths,
    segment_gaps,
    segment_lengths,
)


def test_arc_lengths_of_a_staircase_count_its_steps() -> None:
    stairs = [[0, 0, 0], [3, 0, 0], [3, 4, 0], [3, 4, 12]]
    assert segment_lengths(stairs).tolist() == [3, 4, 12]
    assert arc_lengths(stairs).tolist() == [0, 3, 7, 19]
    assert polyline_length(stairs) == 19
    assert polyline_length([[1.0, 2.0]]) == 0.0


def test_inscribed_polygons_approach_the_circle_from_below() -> None:
    angle = np.linspace(0, 2 * np.pi, 1001)
    around = polyline_length(np.stack((np.cos(angle), np.sin(angle)), axis=1))
    assert around == pytest.approx(2000 * np.sin(np.pi / 1000), rel=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_points_at_places_are_the_interpolated_coordinates(seed: int) -> None:
    generator = np.random.default_rng(seed)
    line = generator.normal(size=(int(generator.integers(1, 30)), 1 + seed % 3))
    arcs = arc_lengths(line)
    at = np.append(generator.uniform(-1, arcs[-1] + 1, 50), arcs)
    expected = np.column_stack([np.interp(at, arcs, column) for column in line.T])
    assert np.allclose(points_at(line, arcs, at), expected, rtol=0, atol=1e-12)


def test_where_vertices_coincide_the_last_one_is_found() -> None:
    line = np.array([[0.0, 0], [1, 0], [1, 5], [2, 5]])
    assert points_at(line, [0, 1, 1, 2], [1.0]).tolist() == [[1, 5]]


@pytest.mark.parametrize("seed", range(20))
def test_nearest_points_are_no_further_than_any_point_of_the_line(seed: int) -> None:
    generator = np.random.default_rng(seed)
    line = generator.normal(size=(int(generator.integers(2, 12)), 3))
    if seed % 4 == 0:
        line[1] = line[0]
    points = generator.normal(size=(15, 3))
    found = nearest_on_polyline(points, line)
    chord = line[found.segment + 1] - line[found.segment]
    feet = line[found.segment] + found.share[:, None] * chord
    assert np.allclose(row_lengths(feet - points), found.distance, rtol=0, atol=1e-12)
    share = np.linspace(0, 1, 501)[:, None, None]
    dense = (line[:-1] + share * np.diff(line, axis=0)).reshape(-1, 3)
    least = row_lengths(points[:, None] - dense).min(axis=1)
    assert (found.distance <= least + 1e-12).all()
    assert np.allclose(found.distance, least, rtol=0, atol=1e-2)
    gaps = segment_gaps(points[:, None], line[:-1], line[1:])
    assert np.allclose(gaps.min(axis=1), found.distance, rtol=0, atol=1e-12)


def test_beyond_its_ends_a_segment_is_as_far_as_its_end() -> None:
    assert segment_gaps([[-3.0, 4], [9, 3], [2, 1]], [0.0, 0], [5.0, 0]).tolist() == [5, 5, 1]
    assert segment_gaps([3.0, 4], [0.0, 0], [0.0, 0]) == 5
    assert gap_from_segment(0.0, 0.0, 3.0, 4.0) == 5
    assert gap_from_segment(5.0, 0.0, 9.0, 3.0) == 5
    assert gap_from_segment(5.0, 0.0, 2.0, -1.0) == 1

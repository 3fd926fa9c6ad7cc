from __future__ import annotations

import numpy as np
import pytest

from tests.seeds import seeds
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline


def every_distance(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """(k, l-1): how far each point is from each segment."""
    start, way = line[:-1], np.diff(line, axis=0)
    square = (way * way).sum(axis=1)
    offset = points[:, None] - start
    share = (offset * way).sum(axis=2) / np.where(square > 0.0, square, 1.0)
    return np.linalg.norm(offset - np.clip(share, 0.0, 1.0)[..., None] * way, axis=2)


@pytest.mark.parametrize("seed", seeds(200))
def test_no_segment_is_nearer(seed: int) -> None:
    random = np.random.default_rng([41, seed])
    line = np.cumsum(random.normal(size=(int(random.integers(2, 300)), 3)), axis=0)
    if seed % 2:
        line = np.round(line)
    chosen = line[random.integers(0, len(line), 60)]
    points = chosen + random.normal(size=(60, 3)) * 10.0 ** random.uniform(-3, 2)
    found = nearest_on_polyline(points, line)
    distances = every_distance(points, line)
    np.testing.assert_allclose(found.distance, distances.min(axis=1), rtol=1e-9, atol=1e-12)
    own = distances[np.arange(60), found.segment]
    np.testing.assert_allclose(own, found.distance, rtol=1e-9, atol=1e-12)


def test_of_equally_near_places_the_first_by_coordinates_is_found_whichever_way_it_runs() -> None:
    turns = np.linspace(0.0, 2 * np.pi, 401)
    circle = np.stack((np.cos(turns), np.sin(turns), 0 * turns), axis=1)
    for line in (circle, circle[::-1]):
        found = nearest_on_polyline([[0.0, 0.0, 1.0]], line)
        start, end = line[found.segment[0]], line[found.segment[0] + 1]
        place = start + found.share[0] * (end - start)
        np.testing.assert_allclose(place, [-1.0, 0.0, 0.0], atol=0.02)

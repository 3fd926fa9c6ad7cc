from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely import Polygon, union_all

from tests.seeds import seeds
from wrinkle_cad.strip.flat.overlap import is_overlapping
from wrinkle_cad.strip.flat.unrolling import unroll
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

FloatArray = NDArray[np.float64]


def covered_twice(corners: FloatArray) -> float:
    """mm2 that triangles (k, 3, 2) cover more than once, by their union."""
    triangles = [Polygon(corner) for corner in corners]
    return float(sum(triangle.area for triangle in triangles) - union_all(triangles).area)


def curling(seed: int) -> Triangulation:
    """A strip that wanders at random, more or less tightly, sometimes from point to point."""
    generator = np.random.default_rng(seed)
    count = int(generator.integers(3, 50))
    heading = np.cumsum(generator.normal(generator.uniform(0, 0.3), 0.25, count))
    along = np.stack((np.cos(heading), np.sin(heading)), axis=1)
    middle = 3 * np.cumsum(along, axis=0)
    aside = generator.uniform(0.5, 6) * np.stack((-along[:, 1], along[:, 0]), axis=1)
    rise = np.cumsum(generator.normal(0, 0.3, (2, count)), axis=1)
    p, q = np.column_stack((middle - aside, rise[0])), np.column_stack((middle + aside, rise[1]))
    if seed % 3 == 0:
        q[0] = p[0]
    if seed % 4 == 0:
        q[-1] = p[-1]
    return triangulate(p, q, criteria=("length",))


@pytest.mark.parametrize("seed", seeds(200))
def test_overlaps_of_random_strips_are_those_of_their_triangles(seed: int) -> None:
    triangulation = curling(seed)
    flat = unroll(triangulation)
    corners = np.concatenate((flat.p, flat.q))[triangulation.triangles]
    assert flat.overlaps == (covered_twice(corners) > 1e-8 * triangulation.area)


def test_both_answers_are_frequent_among_random_strips() -> None:
    count = sum(unroll(curling(seed)).overlaps for seed in range(20))
    assert 3 <= count <= 17


def test_a_rectangle_does_not_overlap_and_a_bow_tie_does() -> None:
    low, high = np.array([[0.0, 0], [4, 0]]), np.array([[0.0, 1], [4, 1]])
    assert not is_overlapping(low, high)
    crossing = np.array([[0.0, 0], [4, 0], [4, 3], [2, 3], [2, -3]])
    assert is_overlapping(crossing, np.array([[0.0, 1], [1, 1]]))


def test_edges_that_touch_do_not_overlap() -> None:
    """A C whose ends touch: a corner on an edge, an edge along an edge, a corner on a corner."""
    outer = [[0.0, 0], [10, 0], [10, 10], [0, 10]]
    for outer_end, inner in (
        ([0, 3], [[2.0, 3], [2, 2], [8, 2], [8, 8], [2, 8], [2, 3]]),
        ([0, 2], [[0.0, 2], [8, 2], [8, 8], [2, 8], [2, 2]]),
    ):
        assert not is_overlapping(np.array([*outer, outer_end]), np.array(inner))


def test_a_ring_that_lies_on_itself_edge_upon_edge_overlaps() -> None:
    """One and a quarter turns: no two edges cross, those of the second turn lie on the first."""
    unit = np.array([(np.cos(k % 72 * np.pi / 36), np.sin(k % 72 * np.pi / 36)) for k in range(91)])
    assert is_overlapping(35 * unit, 25 * unit)
    assert not is_overlapping(35 * unit[:73], 25 * unit[:73])


def test_touching_is_judged_by_the_size_of_the_strip() -> None:
    angle = np.linspace(0, 2 * np.pi, 200)
    unit = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    for size in (1e-3, 1.0, 2e4):
        assert not is_overlapping(35 * size * unit, 25 * size * unit)
        turned = np.stack((np.cos(1.1 * angle), np.sin(1.1 * angle)), axis=1)
        assert is_overlapping(35 * size * turned, 25 * size * turned)


def test_a_long_outline_is_judged_in_reasonable_time() -> None:
    t = np.linspace(0, 400, 20_000)
    low = np.stack((t, np.sin(t)), axis=1)
    high = np.stack((t, np.sin(t) + 5), axis=1)
    assert not is_overlapping(low, high)
    quarter = np.array([[0.0, 1], [-1, 0]])
    assert not is_overlapping(low @ quarter, high @ quarter)
    high[t > 399, 1] -= 6
    assert is_overlapping(low, high)
    assert is_overlapping(low @ quarter, high @ quarter)

"""Strips as a new user draws them, sampled here, against areas and folds known in closed form."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicSpline

from tests.strip.exact_strips import stack
from wrinkle_cad.strip import Triangulation, sample_curve, triangulate

Floats = npt.NDArray[np.float64]


def saddle(count: int) -> tuple[Floats, Floats]:
    """Two rails on z = xy/40 that bulge outwards at their ends."""
    s = np.linspace(0.0, 1.0, count)
    x, y = 100 * s - 50, 10 + 3 * (2 * s - 1) ** 2
    return stack(x, -y, -x * y / 40), stack(x, y, x * y / 40)


def largest_fold(found: Triangulation) -> float:
    return math.degrees(np.abs(found.fold).max())


def polygon_area(p: Floats, q: Floats) -> float:
    """Of the plane region between two rails in the plane z = 0."""
    x, y = np.concatenate((p, q[::-1]))[:, :2].T
    return abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))) / 2


def assert_flat(p: Floats, q: Floats) -> None:
    found = triangulate(p, q)
    assert found.area == pytest.approx(polygon_area(p, q), rel=1e-12)
    assert found.bending == 0.0
    assert largest_fold(found) < 1e-6
    assert (found.fold_back_count, found.counted_invalid_count) == (0, 0)


ZIGZAG = np.array([(10 * k, 0, 6 * (k % 2)) for k in range(9)], dtype=float)
JOGGLE = np.array(
    [(0, 0, 0), (10, 0, 0), (14, 0, 8), (24, 0, 8), (28, 0, 0), (38, 0, 0), (42, 0, 8), (52, 0, 8)],
    dtype=float,
)


@pytest.mark.parametrize("price", [None, 1.0, 50.0])
@pytest.mark.parametrize(
    ("rail", "length", "fold"),
    [
        (ZIGZAG, 8 * math.sqrt(136), 2 * math.degrees(math.atan(0.6))),
        (JOGGLE, 4 * 10 + 3 * math.sqrt(80), math.degrees(math.atan(2))),
    ],
)
def test_an_extruded_polyline_is_a_prism(
    rail: Floats, length: float, fold: float, price: float | None
) -> None:
    for offset in ([0, 25, 0], [3, 25, 0], [-7, 25, 0]):
        found = triangulate(rail, rail + np.array(offset), price=price)
        assert largest_fold(found) == pytest.approx(fold, abs=1e-6) if offset[0] == 0 else True
        assert found.counted_invalid_count == 0
        assert found.invalid_count > 0
        assert found.area == pytest.approx(prism_area(rail, np.array(offset)), rel=1e-12)
    assert prism_area(rail, np.array([0, 25, 0])) == pytest.approx(25 * length)


def prism_area(rail: Floats, offset: Floats) -> float:
    return float(np.linalg.norm(np.cross(np.diff(rail, axis=0), offset), axis=1).sum())


def test_random_zigzags_extruded_are_prisms() -> None:
    for seed in range(40):
        random = np.random.default_rng([31, seed])
        steps = random.uniform(-1.0, 1.0, (int(random.integers(2, 20)), 3)) * [8, 0, 12]
        steps[:, 0] = np.abs(steps[:, 0]) + 1.0
        rail = np.concatenate(([[0, 0, 0]], np.cumsum(steps, axis=0)))
        offset = np.array([random.uniform(-9, 9), 25.0, 0.0])
        found = triangulate(rail, rail + offset)
        assert found.area == pytest.approx(prism_area(rail, offset), rel=1e-12)
        assert (found.counted_invalid_count, found.fold_back_count) == (0, 0)


def test_a_flat_strap_with_a_tab_stays_flat_if_its_straight_side_is_sampled_too() -> None:
    p = np.array([(0, 0, 0), (40, 0, 0), (50, -15, 0), (60, 0, 0), (120, 0, 0)], dtype=float)
    assert_flat(p, stack(np.linspace(0.0, 120.0, 7), 30.0, 0.0))


def test_a_strap_that_can_only_fold_back_says_where() -> None:
    p = np.array([(0, 0, 0), (40, 0, 0), (50, -15, 0), (60, 0, 0), (120, 0, 0)], dtype=float)
    found = triangulate(p, [(0, 30, 0), (120, 30, 0)])
    assert found.area == pytest.approx(4050.0)
    assert found.fold_back_count == 2
    assert np.abs(found.fold[found.folded_back[1:-1]]) == pytest.approx(np.pi)


@pytest.mark.parametrize("angle", [30.0, 90.0, 170.0])
@pytest.mark.parametrize("width", [2.0, 20.0, 80.0])
@pytest.mark.parametrize("radius", [20.0, 200.0, 1000.0])
def test_flat_ring_sectors_stay_flat(radius: float, width: float, angle: float) -> None:
    def ring(r: float) -> Floats:
        arc = lambda t: stack(r * np.cos(t), r * np.sin(t), 0.0)  # noqa: E731
        return sample_curve(arc, (0.0, math.radians(angle)), 0.05).points

    assert_flat(ring(radius), ring(radius + width))


def test_bridges_of_a_ring_sector_are_the_shortest_there_are() -> None:
    t = np.linspace(0.0, 2.0, 40)
    inner, outer = (r * stack(np.cos(t), np.sin(t), 0.0) for r in (20.0, 40.0))
    i, j = triangulate(inner, outer).bridges.T
    assert (np.abs(i - j) <= 1).all()


@pytest.mark.parametrize(("height", "bound"), [(5.0, 2.2), (20.0, 24.0), (40.0, 57.0)])
def test_a_line_against_a_wave_bends_little(height: float, bound: float) -> None:
    knots = np.arange(0.0, 201.0, 10.0)
    wave = CubicSpline(knots, height * np.sin(knots / 25))
    x = np.linspace(0.0, 200.0, 81)
    p, q = stack(x[::4], 0.0, 0.0), stack(x, 40.0, wave(x))
    assert triangulate(p, q, planarity=5e-5).bending <= bound
    # Without a price one valid bridge more costs four to seven times the bending.
    assert triangulate(p, q, planarity=5e-5, price=None).bending > 4 * bound

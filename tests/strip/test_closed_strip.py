from __future__ import annotations

import numpy as np
import pytest

from tests.strip import brute_force
from tests.strip.test_closed_search import every_way_around, ring, triangles_of
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.closed_strip import closed_line
from wrinkle_cad.strip.convexity import validity_matrix
from wrinkle_cad.strip.validity_price import thinned_rail


def circle(count: int, radius: float, z: float, turn: float = 0.0) -> np.ndarray:
    t = np.linspace(0.0, 2 * np.pi, count, endpoint=False) + turn
    return np.stack((radius * np.cos(t), radius * np.sin(t), z + 0 * t), axis=1)


def wavy(count: int, radius: float, z: float, waves: int) -> np.ndarray:
    rail = circle(count, radius, z)
    rail[:, 2] += 0.08 * radius * np.sin(np.linspace(0, 2 * np.pi * waves, count, endpoint=False))
    return rail


@pytest.mark.parametrize("price", [None, 1.0, 50.0])
def test_a_closed_strip_measures_what_its_triangles_do(price: float | None) -> None:
    measured = 0
    for seed in range(30):
        p, q = ring(seed)
        if min(len(p), len(q)) < 3 or seed % 5 == 2:
            continue
        found = triangulate(p, q, closed=True, planarity=brute_force.PLANARITY, price=price)
        way = tuple(map(tuple, found.bridges.tolist()))
        one = every_way_around(p, q, "hinge")[triangles_of(way, len(p), len(q))]
        assert found.is_closed
        assert found.interior_count == found.fold.size == len(p) + len(q)
        assert found.fold_back_count == one["fold-backs"]
        assert found.degenerate_count == one["degenerate"]
        assert found.counted_invalid_count == one["invalid"]
        for part in ("bending", "area", "length"):
            assert brute_force.is_close(getattr(found, part), one[part]), part
        measured += 1
    assert measured > 8


def test_the_last_bridge_is_the_first_one_again_and_triangles_count_around() -> None:
    found = triangulate(circle(7, 5.0, 0.0), circle(9, 4.0, 3.0, 1.0), closed=True)
    assert (found.bridges[-1] - found.bridges[0]).tolist() == [7, 9]
    assert found.triangles.shape == (16, 3)
    assert np.bincount(found.triangles.ravel()).size == 16
    assert found.valid.shape == found.twist.shape == found.counted.shape == (17,)
    assert found.valid[0] == found.valid[-1]


@pytest.mark.parametrize("price", [None, 50.0])
def test_where_closed_rails_begin_does_not_matter(price: float | None) -> None:
    p, q = wavy(60, 50.0, 0.0, 5), wavy(70, 40.0, 60.0, 3)
    found = triangulate(p, q, closed=True, price=price)
    for first, second in ((1, 0), (17, 55), (59, 31)):
        other = triangulate(
            np.roll(p, first, axis=0), np.roll(q, second, axis=0), closed=True, price=price
        )
        assert other.counted_invalid_count == found.counted_invalid_count
        assert other.bending == pytest.approx(found.bending, rel=1e-9)
        assert other.area == pytest.approx(found.area, rel=1e-9)
        assert other.planarity == pytest.approx(found.planarity, rel=1e-12)


@pytest.mark.parametrize("turn", [0.0, 0.7, np.pi / 2, 3.1])
def test_a_frustum_is_a_frustum_whatever_its_starts(turn: float) -> None:
    p, q = circle(60, 50.0, 0.0), np.roll(circle(60, 30.0, 80.0), int(turn * 9), axis=0)
    found = triangulate(p, q, closed=True)
    side = 2 * 50 * np.sin(np.pi / 60), 2 * 30 * np.sin(np.pi / 60)
    slope = np.hypot(80.0, 20 * np.cos(np.pi / 60))
    assert found.area == pytest.approx(60 * slope * (side[0] + side[1]) / 2, rel=1e-12)
    assert found.counted_invalid_count == 0
    assert np.degrees(np.abs(found.fold)).max() < 6.1


@pytest.mark.parametrize("turn", [0, 14, 60])
def test_of_diagonals_that_cost_the_same_those_are_taken_that_step_on_p_first(turn: int) -> None:
    t = np.linspace(0.0, 2 * np.pi, 113, endpoint=False)
    t = np.roll(t + 1e-4 * np.sin(3 * t), turn)
    p, q = (np.stack((50 * np.cos(t), 50 * np.sin(t), z + 0 * t), axis=1) for z in (0.0, 60.0))
    found = triangulate(p, q, closed=True)
    assert found.steps.tolist() == [0, 1] * 113


def test_at_least_as_many_bridges_are_valid_as_in_any_strip_cut_open() -> None:
    p, q = wavy(24, 50.0, 0.0, 5), wavy(30, 40.0, 60.0, 3)
    found = triangulate(p, q, closed=True, price=None, planarity=1e-6)
    for i in range(0, 24, 5):
        for j in range(30):
            rails = (np.roll(rail, -k, axis=0) for rail, k in ((p, i), (q, j)))
            opened = triangulate(
                *(np.concatenate((rail, rail[:1])) for rail in rails), price=None, planarity=1e-6
            )
            assert found.counted_invalid_count <= opened.counted_invalid_count + 1


@pytest.mark.parametrize(
    ("m", "n", "seed"),
    [
        (18, 24, 3),
        *(pytest.param(60, 80, seed, marks=pytest.mark.slow) for seed in (3, 4, 5)),
        pytest.param(180, 240, 3, marks=pytest.mark.slow),
    ],
)
def test_no_noisy_strip_cut_open_has_more_bridges_that_are_valid_where_it_is_closed(
    m: int, n: int, seed: int
) -> None:
    """Cut open, the first and the last sample have one neighbour; their fans are judged by half."""
    random = np.random.default_rng(seed)
    p, q = wavy(m, 50.0, 0.0, 5), wavy(n, 40.0, 60.0, 3)
    p, q = p + random.normal(0.0, 0.5, p.shape), q + random.normal(0.0, 0.5, q.shape)
    found = triangulate(p, q, closed=True, price=None)
    padded = [np.vstack((rail[-1:], rail, rail[:1])) for rail in (p, q)]
    valid = validity_matrix(*padded, planarity=found.planarity)[1:-1, 1:-1]
    assert valid[tuple((found.bridges % (m, n)).T)].tolist() == found.valid.tolist()
    # Every closed strip has a bridge from sample 0 of P, so these are all seams.
    for j in range(n):
        turned = np.roll(q, -j, axis=0)
        opened = triangulate(*(np.vstack((rail, rail[:1])) for rail in (p, turned)), price=None)
        judged = valid[tuple(((opened.bridges[:-1] + np.array((0, j))) % (m, n)).T)]
        assert found.valid[:-1].sum() >= judged.sum()


def test_the_price_of_long_closed_strips_is_measured_on_thinned_ones() -> None:
    p, q = wavy(400, 50.0, 0.0, 5), wavy(300, 40.0, 60.0, 3)
    found = triangulate(p, q, closed=True)
    thin = (thinned_rail(closed_line(rail))[:-1] for rail in (p, q))
    least = triangulate(*thin, closed=True, criteria=("bending",), planarity=found.planarity)
    assert found.least_bending == pytest.approx(least.bending, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p: p[:2], "Closed rail P has 2 samples: at least 3 are needed"),
        (lambda p: np.concatenate((p, p[:1])), "Closed rail P ends with its first sample again"),
    ],
)
def test_rails_that_cannot_be_closed_are_refused(change, message: str) -> None:
    with pytest.raises(InputError, match=message):
        triangulate(change(circle(8, 5.0, 0.0)), circle(8, 5.0, 3.0), closed=True)


@pytest.mark.parametrize("criteria", [("invalid", "bending"), ("bending",)])
def test_the_local_search_goes_around_from_the_shortest_bridge(criteria) -> None:
    p, q = wavy(60, 50.0, 0.0, 5), wavy(70, 40.0, 60.0, 3)
    found = triangulate(p, q, closed=True, search="local", criteria=criteria)
    assert (found.bridges[-1] - found.bridges[0]).tolist() == [60, 70]
    i, j = found.bridges[0]
    shortest = np.linalg.norm(p[:, None] - q[None], axis=2).min()
    assert np.linalg.norm(p[i] - q[j]) == pytest.approx(shortest, rel=1e-12)
    best = triangulate(p, q, closed=True, criteria=criteria, price=None)
    if criteria[0] == "invalid":
        assert best.counted_invalid_count <= found.counted_invalid_count
    else:
        assert best.bending <= found.bending * (1 + 1e-9)


@pytest.mark.parametrize("turn", [0, 7, 31])
def test_a_frustum_found_locally_is_the_frustum_wherever_it_begins(turn: int) -> None:
    p, q = circle(60, 50.0, 0.0), np.roll(circle(60, 30.0, 80.0), turn, axis=0)
    found = triangulate(p, q, closed=True, search="local")
    assert found.area == pytest.approx(triangulate(p, q, closed=True).area, rel=1e-9)
    assert found.counted_invalid_count == 0

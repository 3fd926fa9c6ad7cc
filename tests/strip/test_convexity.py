from __future__ import annotations

import numpy as np
import pytest

from tests.strip import brute_force, exact_strips
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate, validity_matrix

RANDOM_STRIPS = [exact_strips.random_points(seed, 7, 9) for seed in range(60)]


def on_hull(p: np.ndarray, q: np.ndarray, i: int, j: int) -> bool:
    """Whether some plane through the bridge has all six points on one side, tried densely.

    Planes turn in steps of a hundredth of a degree; a slack of that size is allowed for.
    """
    e = q[j] - p[i]
    e = e / np.linalg.norm(e)
    u = np.linalg.svd(e[None])[2][1]
    v = np.cross(e, u)
    around = [p[k] - p[i] for k in (i - 1, i + 1) if 0 <= k < len(p)]
    around += [q[k] - q[j] for k in (j - 1, j + 1) if 0 <= k < len(q)]
    seen = np.array([[w @ u, w @ v] for w in around])
    seen /= np.maximum(np.hypot(*seen.T), 1e-300)[:, None]
    turn = np.arange(0.0, 2 * np.pi, np.pi / 18_000)
    lowest = (seen @ np.stack((np.cos(turn), np.sin(turn)))).min(axis=0)
    return bool(lowest.max() >= -2e-4)


def test_a_bridge_is_valid_if_it_lies_on_the_hull_of_the_six_points() -> None:
    differs = total = 0
    for p, q in RANDOM_STRIPS[:12]:
        valid = validity_matrix(p, q, planarity=1e-12)
        for i, j in np.ndindex(valid.shape):
            if np.linalg.norm(q[j] - p[i]) > 0:
                differs += valid[i, j] != on_hull(p, q, i, j)
                total += 1
    assert total > 700
    assert differs <= 2


def test_validity_agrees_with_the_gap_between_neighbours() -> None:
    seen = set()
    for p, q in RANDOM_STRIPS:
        valid = validity_matrix(p, q, planarity=1e-12)
        for i, j in np.ndindex(valid.shape):
            expected = brute_force.is_valid(p.tolist(), q.tolist(), i, j)
            assert valid[i, j] == expected
            seen.add(expected)
    assert seen == {True, False}


@pytest.mark.parametrize("family", exact_strips.CONVEX)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_convex_developables_have_no_invalid_bridge(family, tolerance: float) -> None:
    for seed in range(6):
        strip = family(seed).sampled(tolerance)
        assert triangulate(strip.p, strip.q).invalid_count == 0


@pytest.mark.slow
@pytest.mark.parametrize("family", exact_strips.CONVEX)
def test_finely_sampled_convex_developables_have_no_invalid_bridge(family) -> None:
    for seed in range(30):
        strip = family(seed).sampled(1e-5)
        assert triangulate(strip.p, strip.q).invalid_count == 0


def test_a_strict_sign_test_is_destroyed_by_round_off() -> None:
    destroyed = 0
    for seed in range(3):
        strip = exact_strips.convex_cylinder(seed).sampled(1e-5)
        strict = validity_matrix(strip.p, strip.q, planarity=0.0)
        destroyed += int(np.count_nonzero(validity_matrix(strip.p, strip.q) & ~strict))
    assert destroyed > 0


def test_planarity_near_the_chord_tolerance_hides_defects() -> None:
    strip = exact_strips.wrinkled(1).sampled(1e-3)
    found = triangulate(strip.p, strip.q).invalid_count
    assert found > 10
    assert triangulate(strip.p, strip.q, planarity=1e-4).invalid_count == found
    assert triangulate(strip.p, strip.q, planarity=8e-3).counted_invalid_count == 0


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("offset", [0.0, 2e4])
def test_scale_and_a_far_origin_change_no_bridge(scale: float, offset: float) -> None:
    strip = exact_strips.wrinkled(2).sampled(1e-3)
    here = validity_matrix(strip.p, strip.q, planarity=1e-6)
    shift = np.array([offset, -offset, offset / 3])
    there = validity_matrix(
        scale * strip.p + scale * shift, scale * strip.q + scale * shift, planarity=scale * 1e-6
    )
    assert (here != there).sum() <= 1e-4 * here.size


def test_a_neighbour_on_the_line_of_the_bridge_says_nothing() -> None:
    p = np.array([[0.0, -1, 0], [0, 0, 0], [1, 0, -1], [2, 0, 0]])
    q = np.array([[-1.0, 1, 1], [0, 1, 0], [1, 1, 1]])
    # p[0] lies on the line of bridge (1, 1); the other three fit in no half-plane.
    p_free = p.copy()
    p_free[0] = [-1, 0, -1]
    assert not validity_matrix(p_free, q, planarity=1e-9)[1, 1]
    assert validity_matrix(p, q, planarity=1e-9)[1, 1] == brute_force.is_valid(
        p.tolist(), q.tolist(), 1, 1
    )


def test_bridges_of_zero_length_are_valid() -> None:
    p, q = exact_strips.random_points(9, 6, 6)
    assert (p[0] == q[0]).all()
    valid = validity_matrix(p, q)
    assert valid[0, 0]
    assert valid[-1, -1]


def test_the_matrix_agrees_with_the_path_and_is_read_only() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-2)
    found = triangulate(strip.p, strip.q)
    valid = validity_matrix(strip.p, strip.q)
    assert (valid[tuple(found.bridges.T)] == found.valid).all()
    with pytest.raises(ValueError, match="read-only"):
        valid[0, 0] = False


@pytest.mark.parametrize("planarity", [-1.0, np.nan, np.inf])
def test_a_planarity_that_is_no_distance_is_refused(planarity: float) -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-2)
    with pytest.raises(InputError, match=r"planarity cannot be .* mm: give a finite distance"):
        validity_matrix(strip.p, strip.q, planarity=planarity)

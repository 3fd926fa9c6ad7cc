from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from wrinkle_cad.strip.crossings import SelfCrossings, self_crossings
from wrinkle_cad.strip.triangulation import Triangulation, measured, triangulate


def loop(count: int) -> np.ndarray:
    """A curve in the plane y = 0 that passes through itself at (0, 0, 10)."""
    t = np.linspace(-1.0, 1.0, count)
    return np.column_stack((60.0 * t**3 - 40.0 * t, 0.0 * t, 30.0 * (1.0 - t * t)))


def strip_on(curve: np.ndarray, width: float = 15.0) -> Triangulation:
    return triangulate(curve, curve + np.array((0.0, width, 0.0)), criteria=("bending", "length"))


def crossings_of(p: np.ndarray, q: np.ndarray) -> SelfCrossings:
    return self_crossings(triangulate(p, q, criteria=("bending", "length")))


@pytest.mark.parametrize("count", [30, 61, 200])
def test_a_loop_that_passes_through_itself_is_found_where_it_does(count: int) -> None:
    found = self_crossings(strip_on(loop(count)))
    assert found.count >= 2
    np.testing.assert_allclose(found.points[:, 0], 0.0, atol=0.2)
    np.testing.assert_allclose(found.points[:, 2], 10.0, atol=0.2)
    assert ((found.points[:, 1] > 0.0) & (found.points[:, 1] < 15.0)).all()
    assert (np.diff(found.triangles) > 0).all()
    assert set(found.partners.tolist()) <= set(found.triangles.tolist())


def arc(turns: float, count: int, pitch: float = 0.0) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi * turns, count)
    along = pitch * np.linspace(0.0, turns, count)
    return np.column_stack((20.0 * np.cos(angle), along, 20.0 * np.sin(angle)))


ZIGZAG = np.array([(10.0 * i, 0.0, 6.0 * (i % 2)) for i in range(9)])


@pytest.mark.parametrize(
    "curve",
    [
        arc(0.7, 40),
        arc(1.0, 60),
        arc(1.0, 7),
        arc(3.0, 90, pitch=40.0),
        ZIGZAG,
        np.array([(0.0, 0.0, 0.0), (100.0, 0.0, 0.0)]),
    ],
    ids=["open arc", "tube cut open", "coarse tube", "helix", "zigzag", "plane"],
)
def test_a_strip_that_at_most_touches_itself_has_no_crossings(curve: np.ndarray) -> None:
    assert self_crossings(strip_on(curve)).count == 0


def test_a_tube_wound_twice_lies_in_itself() -> None:
    assert self_crossings(strip_on(arc(1.5, 90))).count > 0


def test_a_flat_spiral_of_more_than_a_turn_covers_itself() -> None:
    angle = np.linspace(0.0, 2.5 * np.pi, 60)
    ray = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * angle))
    found = crossings_of(30.0 * ray, 40.0 * ray)
    assert found.count > 0
    assert np.hypot(found.points[:, 0], found.points[:, 1]).max() < 40.0
    quarter = ray[:40]
    assert crossings_of(30.0 * quarter, 40.0 * quarter).count == 0


def test_rails_that_meet_at_their_ends_are_no_crossing() -> None:
    x = np.linspace(0.0, 100.0, 30)
    bulge = np.sin(np.pi * x / 100.0)
    p = np.column_stack((x, -15.0 * bulge, 5.0 * bulge**2))
    q = np.column_stack((x, 15.0 * bulge, -5.0 * bulge))
    assert crossings_of(p, q).count == 0


def pierces(a: np.ndarray, b: np.ndarray, triangle: np.ndarray) -> float:
    """How clearly the segment a b goes through a triangle, mm; negative if it does not."""
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    normal /= np.linalg.norm(normal)
    before, after = (a - triangle[0]) @ normal, (b - triangle[0]) @ normal
    if before == after:
        return -1.0
    at = a + before / (before - after) * (b - a)
    inner = [
        np.cross(normal, triangle[(k + 1) % 3] - triangle[k])
        @ (at - triangle[k])
        / np.linalg.norm(triangle[(k + 1) % 3] - triangle[k])
        for k in range(3)
    ]
    apart = -np.sign(before * after) * min(abs(before), abs(after))
    return float(min(apart, *inner))


def brute_force(strip: Triangulation) -> dict[tuple[int, int], float]:
    """By how much each two triangles that share no bridge pierce each other."""
    points = np.vstack((strip.p, strip.q))
    found = {}
    for i, j in combinations(range(len(strip.triangles)), 2):
        first, second = strip.triangles[i], strip.triangles[j]
        if len(set(first.tolist()) & set(second.tolist())) > 1:
            continue
        clear = [
            pierces(points[one[k]], points[one[(k + 1) % 3]], points[other])
            for one, other in ((first, second), (second, first))
            for k in range(3)
        ]
        found[i, j] = max(clear)
    return found


@pytest.mark.parametrize("seed", range(20))
def test_random_tangled_strips_agree_with_brute_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.normal(0.0, 4.0, (int(rng.integers(8, 16)), 3)), axis=0)
    strip = triangulate(
        walk, walk[:-2] + rng.normal(0.0, 3.0, 3) + rng.normal(0.0, 1.0, (len(walk) - 2, 3))
    )
    clear = brute_force(strip)
    found = set(self_crossings(strip).triangles.tolist())
    least = 8e-3 * float(np.ptp(np.vstack((strip.p, strip.q)), axis=0).max())
    certain = {k for pair, by in clear.items() if by > least for k in pair}
    possible = {k for pair, by in clear.items() if by > 0.0 for k in pair}
    assert certain <= found <= possible


def test_the_brute_force_tells_crossings_from_none() -> None:
    assert max(brute_force(strip_on(loop(30))).values()) > 0.5
    assert max(brute_force(strip_on(arc(0.7, 20))).values()) < 1e-9


@pytest.mark.parametrize("seed", range(5))
def test_crossings_move_with_the_strip(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    size, shift = 10.0 ** rng.uniform(-3.0, 3.0), rng.normal(0.0, 50.0, 3)
    strip = strip_on(loop(61))
    one = self_crossings(strip)
    p, q = (size * (rail @ turn.T + shift) for rail in (strip.p, strip.q))
    # The same steps: equal bridges tie, and round-off would choose among them.
    other = self_crossings(
        measured(
            p,
            q,
            strip.steps,
            planarity=size * strip.planarity,
            criteria=("bending",),
            search="global",
            energy="hinge",
        )
    )
    assert other.triangles.tolist() == one.triangles.tolist()
    np.testing.assert_allclose(
        other.points, size * (one.points @ turn.T + shift), rtol=1e-9, atol=1e-7 * size
    )


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 6, 7, 8])
def test_the_place_does_not_depend_on_which_way_the_rails_run(seed: int) -> None:
    rng = np.random.default_rng([5, seed])
    walk = np.cumsum(rng.normal(0.0, 4.0, (14, 3)), axis=0)
    p, q = walk, walk[:-2] + rng.normal(0.0, 3.0, 3) + rng.normal(0.0, 1.0, (12, 3))
    there = self_crossings(triangulate(p, q))
    assert there.count
    for rails in ((p[::-1], q[::-1]), (q, p), (q[::-1], p[::-1])):
        back = self_crossings(triangulate(*rails))
        assert back.count == there.count
        np.testing.assert_allclose(back.place, there.place, atol=1e-9)


def test_of_two_crossings_the_longer_one_is_the_place() -> None:
    # Two loops in a row, the second one twice as large and twice as wide.
    first, second = loop(61), 2.0 * loop(61)
    curve = np.vstack((first, second - second[0] + first[-1] + np.array((1.0, 0.0, 0.0))))
    width = np.concatenate((np.full(61, 10.0), np.full(61, 20.0)))
    for way in (1, -1):
        p, q = curve[::way], (curve + width[:, None] * np.array((0.0, 1.0, 0.0)))[::way]
        found = crossings_of(p, q)
        assert found.place[0] == pytest.approx(second[30, 0] - second[0, 0] + first[-1, 0] + 1.0)


def test_results_are_read_only() -> None:
    found = self_crossings(strip_on(loop(30)))
    for array in (found.triangles, found.partners, found.points, found.lengths):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0

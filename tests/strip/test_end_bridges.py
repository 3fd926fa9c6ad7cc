from __future__ import annotations

import numpy as np
import pytest

from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.end_bridges import end_crossings

HOOK = np.array([(0.0, 0.0, 0.0), (10.0, 30.0, 0.0), (20.0, 0.0, 0.0), (100.0, 0.0, 0.0)])
STRAIGHT = np.array([(20.0, 12.0, 0.0), (100.0, 12.0, 0.0)])
PLACE = (50.0 / 3.0, 10.0, 0.0)
"""Where the line from (0, 0) to (20, 12) meets that from (10, 30) to (20, 0)."""


def posed(points: np.ndarray, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    moved: np.ndarray = 10.0 ** rng.uniform(-2.0, 2.0) * (points @ turn + rng.normal(0.0, 50.0, 3))
    return moved


@pytest.mark.parametrize("seed", range(5))
def test_an_end_bridge_that_runs_into_a_rail_is_found_in_any_pose(seed: int) -> None:
    p, q, place = (posed(np.array(points), seed) for points in (HOOK, STRAIGHT, [PLACE]))
    (one,) = end_crossings(triangulate(p, q))
    assert (one.end, one.rail) == ("first", "P")
    np.testing.assert_allclose(one.point, place[0], atol=1e-9 * np.abs(p).max())


def test_ends_and_rails_change_their_names_with_the_way_they_are_drawn() -> None:
    for rails, names in (
        ((STRAIGHT, HOOK), ("first", "Q")),
        ((HOOK[::-1], STRAIGHT[::-1]), ("last", "P")),
        ((STRAIGHT[::-1], HOOK[::-1]), ("last", "Q")),
    ):
        (one,) = end_crossings(triangulate(*rails))
        assert (one.end, one.rail) == names
        assert one.point == pytest.approx(PLACE)


def test_of_several_meetings_the_one_nearest_along_the_rail_is_given() -> None:
    p = np.array([(0.0, 0), (4, 30), (8, 0), (12, 30), (16, 0), (100, 0)])
    p = np.column_stack((p, np.zeros(6)))
    (one,) = end_crossings(triangulate(p, STRAIGHT))
    # y = 0.6 x meets the leg from (4, 30) to (8, 0).
    assert one.point == pytest.approx((60.0 / 8.1, 36.0 / 8.1, 0.0))


def test_rails_that_meet_or_only_lean_have_no_crossing_end_bridge() -> None:
    x = np.linspace(0.0, 100.0, 21)
    bulge = 10.0 * np.sin(np.pi * x / 100.0)
    lens = (np.column_stack((x, -bulge, 0 * x)), np.column_stack((x, bulge, 0 * x)))
    leaning = (HOOK[2:], STRAIGHT + np.array((30.0, 0.0, 0.0)))
    over = (HOOK, STRAIGHT + np.array((0.0, 0.0, 1.0)))
    point = (HOOK, np.array([(-5.0, 40.0, 0.0)]))
    for p, q in (lens, leaning, over, point):
        assert end_crossings(triangulate(p, q)) == ()

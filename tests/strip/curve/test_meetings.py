from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from wrinkle_cad.strip.curve.meetings import Meeting, meetings_of
from wrinkle_cad.strip.curve.sampling import Samples, sample_curve

Curve = Callable[[np.ndarray], np.ndarray]
DISTANCE = 1e-5


def segment(start: tuple[float, ...], end: tuple[float, ...]) -> Curve:
    ends = np.array([start, end], dtype=float)
    return lambda t: ends[0] + t[:, None] * (ends[1] - ends[0])


def circle(
    radius: float, centre: tuple[float, float, float], first: float = 0.0, last: float = 360.0
) -> Curve:
    def at(t: np.ndarray) -> np.ndarray:
        angle = np.radians(first + t * (last - first))
        ray = np.column_stack((np.cos(angle), np.sin(angle), 0.0 * t))
        return np.asarray(centre) + radius * ray

    return at


def meet(p_at: Curve, q_at: Curve, tolerance: float = 0.05) -> tuple[Meeting, ...]:
    p, q = (sample_curve(curve, (0.0, 1.0), tolerance) for curve in (p_at, q_at))
    return meetings_of(p_at, q_at, p, q, DISTANCE)


def test_lines_cross_in_one_place() -> None:
    (found,) = meet(segment((0, 0, 0), (100, 20, 0)), segment((0, 20, 0), (100, 0, 0)))
    assert found.point == pytest.approx((50.0, 10.0, 0.0), abs=2e-5)
    assert found.end_point == pytest.approx(found.point, abs=2e-5)
    assert found.p_start <= 0.5 <= found.p_end
    assert found.q_start <= 0.5 <= found.q_end


@pytest.mark.parametrize("gap", [2e-5, 1e-3, 10.0])
def test_lines_that_pass_do_not_meet(gap: float) -> None:
    assert meet(segment((0, 0, gap), (100, 20, gap)), segment((0, 20, 0), (100, 0, 0))) == ()


@pytest.mark.parametrize("tolerance", [1.0, 0.05, 1e-3])
def test_circles_cross_in_two_places_whatever_their_chords(tolerance: float) -> None:
    found = meet(circle(50.0, (0, 0, 0)), circle(50.0, (60, 0, 0), 90.0, 330.0), tolerance)
    places = [meeting.point for meeting in found]
    assert len(places) == 2
    assert places[0] == pytest.approx((30.0, 40.0, 0.0), abs=1e-4)
    assert places[1] == pytest.approx((30.0, -40.0, 0.0), abs=1e-4)


@pytest.mark.parametrize(("gap", "count"), [(0.0, 1), (5e-6, 1), (2e-5, 0), (1e-3, 0)])
def test_a_line_touches_a_circle_only_where_it_does(gap: float, count: int) -> None:
    # Chords lie up to 0.05 mm inside the circle: they do not decide.
    line = segment((-100, 50 + gap, 0), (90, 50 + gap, 0))
    found = meet(circle(50.0, (0, 0, 0)), line)
    assert len(found) == count
    for meeting in found:
        assert meeting.point == pytest.approx((0.0, 50.0, 0.0), abs=0.1)


def test_chords_that_cross_are_not_curves_that_cross() -> None:
    # The inner circle's radius is less by a fifth of what its chords cut off.
    assert meet(circle(50.0, (0, 0, 0)), circle(50.01, (0, 0, 0), 3.0, 340.0)) == ()


def test_a_common_stretch_is_one_meeting_from_its_start_to_its_end() -> None:
    p, q = circle(50.0, (0, 0, 0), 0.0, 120.0), circle(50.0, (0, 0, 0), 60.0, 180.0)
    (found,) = meet(p, q)
    assert found.p_start == pytest.approx(0.5, abs=5e-3)
    assert found.p_end == 1.0
    assert found.q_start == 0.0
    assert found.point == pytest.approx((25.0, 50.0 * math.sin(math.pi / 3), 0.0), abs=0.2)
    assert found.end_point == pytest.approx((-25.0, 50.0 * math.sin(math.pi / 3), 0.0), abs=0.2)


def test_ends_that_meet_are_two_meetings() -> None:
    found = meet(
        lambda t: np.column_stack((100 * t, 10 * np.sin(np.pi * t), 0 * t)),
        lambda t: np.column_stack((100 * t, -10 * np.sin(np.pi * t), 0 * t)),
    )
    assert [meeting.p_start for meeting in found[:1]] == [0.0]
    assert [meeting.p_end for meeting in found[1:]] == [1.0]


def test_a_point_on_a_curve_meets_it() -> None:
    arc = circle(50.0, (0, 0, 0), 0.0, 180.0)
    samples = sample_curve(arc, (0.0, 1.0), 0.05)
    for place, count in (((0.0, 50.0, 0.0), 1), ((0.0, 49.99, 0.0), 0)):
        point = Samples(np.zeros(1), np.array([place]))
        found = meetings_of(
            lambda t, at=place: np.tile(at, (len(t), 1)), arc, point, samples, DISTANCE
        )
        assert len(found) == count
        swapped = meetings_of(
            arc, lambda t, at=place: np.tile(at, (len(t), 1)), samples, point, DISTANCE
        )
        assert len(swapped) == count


def wave(rng: np.random.Generator, lift: float) -> Curve:
    size, rate, phase = rng.uniform(2, 10, 3), rng.uniform(2, 14, 3), rng.uniform(0, 6, 3)

    def at(t: np.ndarray) -> np.ndarray:
        y = (size * np.sin(np.multiply.outer(t, rate) + phase)).sum(axis=1)
        return np.column_stack((100.0 * t, y, lift * t))

    return at


def crossings_by_scan(p: Curve, q: Curve) -> np.ndarray:
    """Where two graphs over x = 100 t cross, by a dense scan and bisection."""
    t = np.linspace(0.0, 1.0, 100_001)
    gap = p(t)[:, 1] - q(t)[:, 1]
    (before,) = np.nonzero(gap[:-1] * gap[1:] < 0.0)
    low, high = t[before], t[before + 1]
    for _ in range(50):
        middle = (low + high) / 2.0
        same = (p(middle)[:, 1] - q(middle)[:, 1]) * (p(low)[:, 1] - q(low)[:, 1]) > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return p(low)


@pytest.mark.parametrize("seed", range(20))
def test_random_waves_cross_where_a_scan_finds_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p, q = wave(rng, 30.0), wave(rng, 30.0)
    places = crossings_by_scan(p, q)
    found = meet(p, q)
    assert len(found) == len(places)
    for meeting, place in zip(found, places, strict=True):
        assert meeting.point == pytest.approx(place, abs=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_the_places_do_not_depend_on_the_direction_or_the_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p, q = wave(rng, 30.0), wave(rng, 30.0)
    places = sorted(meeting.point for meeting in meet(p, q))
    assert places
    for other in (meet(q, p), meet(lambda t: p(1.0 - t), lambda t: q(1.0 - t))):
        np.testing.assert_allclose(sorted(m.point for m in other), places, atol=1e-4)


def test_curves_that_run_close_take_no_longer() -> None:
    def near(by: float) -> Curve:
        return lambda t: np.column_stack((100 * t, 5 * np.sin(9 * t) + by, 3 * np.cos(7 * t)))

    assert meet(near(0.0), near(1e-3), 1e-3) == ()
    assert len(meet(near(0.0), near(1e-6), 1e-3)) == 1

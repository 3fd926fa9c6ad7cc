from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.sampling import Samples, sample_curve

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], FloatArray]


def clamped_knots(degree: int, poles: int, inner: FloatArray | None = None) -> FloatArray:
    inner = np.linspace(0, 1, poles - degree + 1)[1:-1] if inner is None else inner
    return np.concatenate((np.zeros(degree + 1), inner, np.ones(degree + 1)))


def b_spline(degree: int, seed: int, *, size: float = 100.0, poles: int = 14) -> Curve:
    generator = np.random.default_rng(seed)
    inner = np.sort(generator.uniform(0, 1, poles - degree - 1))
    return BSpline(
        clamped_knots(degree, poles, inner), generator.uniform(0, size, (poles, 3)), degree
    )


def rational_spline(degree: int, seed: int) -> Curve:
    generator = np.random.default_rng(seed)
    weights = generator.uniform(0.1, 10, (9, 1))
    poles = generator.uniform(0, 50, (9, 3))
    spline = BSpline(clamped_knots(degree, 9), np.hstack((poles * weights, weights)), degree)

    def point_at(t: FloatArray) -> FloatArray:
        homogeneous = spline(t)
        return homogeneous[:, :3] / homogeneous[:, 3:]

    return point_at


def circle(t: FloatArray) -> FloatArray:
    return np.stack((10 * np.cos(t), 10 * np.sin(t), np.zeros_like(t)), axis=1)


def line(t: FloatArray) -> FloatArray:
    return t[:, None] * np.array([3.0, -4.0, 12.0]) + 1.0


def spike(t: FloatArray) -> FloatArray:
    return np.stack((100 * t, 3 * np.exp(-(((t - 0.4123) / 2e-3) ** 2)), t * 0), axis=1)


def cusp(t: FloatArray) -> FloatArray:
    return np.stack((10 * t**2, 10 * t**3, t), axis=1)


def ripple(t: FloatArray) -> FloatArray:
    """Waves flatter than a coarse tolerance: a chord to a crest fails, one to the end succeeds."""
    return np.stack((100 * t, np.sin(60 * t), 0 * t), axis=1)


def square_root_speed(t: FloatArray) -> FloatArray:
    return circle(2 * np.sqrt(t))


def power_speed(t: FloatArray) -> FloatArray:
    return circle(3 * t**7)


def chord_gaps(
    point_at: Curve, parameters: FloatArray, points: FloatArray, count: int
) -> FloatArray:
    """Largest distance of the curve from each chord, by ``count`` points per chord."""
    gaps = []
    for i in range(len(parameters) - 1):
        curve = point_at(np.linspace(parameters[i], parameters[i + 1], count))
        chord = points[i + 1] - points[i]
        share = np.clip((curve - points[i]) @ chord / (chord @ chord), 0, 1)
        gaps.append(np.max(np.linalg.norm(curve - points[i] - share[:, None] * chord, axis=1)))
    return np.array(gaps)


@njit
def farthest(x: FloatArray, i: int, tolerance: float, stop_at_first_failure: bool) -> int:
    """Dense point with the longest chord from dense point i, by trying all of them."""
    best = i + 1
    for j in range(i + 1, len(x)):
        u = x[j] - x[i]
        square = np.dot(u, u)
        ok = True
        for k in range(i + 1, j):
            v = x[k] - x[i]
            share = 0.0 if square == 0 else min(1.0, max(0.0, np.dot(v, u) / square))
            w = v - share * u
            if np.dot(w, w) > tolerance * tolerance:
                ok = False
                break
        if ok:
            best = j
        elif stop_at_first_failure:
            break
    return best


def greedy_count(point_at: Curve, start: float, end: float, tolerance: float, first: bool) -> int:
    """Chords of the brute-force greedy on curve points spread by arc length."""
    dense = point_at(np.linspace(start, end, 200_001))
    arc = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(dense, axis=0), axis=1))))
    even = np.searchsorted(arc, np.linspace(0, arc[-1], 2500)[1:-1])
    x = dense[np.concatenate(([0], even, [len(dense) - 1]))]
    i = count = 0
    while i < len(x) - 1:
        i = farthest(x, i, tolerance, first)
        count += 1
    return count


def segment_lengths(samples: Samples) -> FloatArray:
    return np.linalg.norm(np.diff(samples.points, axis=0), axis=1)


CURVES: dict[str, tuple[Curve, tuple[float, float]]] = {
    **{f"degree {k}": (b_spline(k, k), (0.0, 1.0)) for k in range(2, 10)},
    **{f"rational {k}": (rational_spline(k, k), (0.0, 1.0)) for k in (2, 3, 5, 8)},
    "circle": (circle, (0.3, 5.0)),
    "closed circle": (circle, (0.0, 2 * np.pi)),
    "spike": (spike, (0.0, 1.0)),
    "cusp": (cusp, (-1.0, 1.3)),
    "ripple": (ripple, (0.0, 1.0)),
    "square root speed": (square_root_speed, (0.0, 4.0)),
    "power speed": (power_speed, (0.0, 1.0)),
}


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("tolerance", [1.5, 0.2, 0.01])
def test_no_curve_point_is_farther_from_its_chord_than_the_tolerance(
    name: str, tolerance: float
) -> None:
    point_at, interval = CURVES[name]
    samples = sample_curve(point_at, interval, tolerance)
    count = max(60, 20_000 // len(samples.points))
    gaps = chord_gaps(point_at, samples.parameters, samples.points, count)
    assert gaps.max() <= tolerance
    assert np.array_equal(samples.points, point_at(samples.parameters))
    assert samples.parameters[0] == interval[0]
    assert samples.parameters[-1] == interval[1]
    assert np.all(np.diff(samples.parameters) > 0)


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("first", [True, False], ids=["first failure", "last success"])
def test_chords_are_hardly_more_than_the_greedy_needs(name: str, first: bool) -> None:
    point_at, interval = CURVES[name]
    for tolerance in (1.4, 0.2):
        greedy = greedy_count(point_at, *interval, tolerance, first)
        count = len(sample_curve(point_at, interval, tolerance).points) - 1
        assert count <= max(greedy + 1, 1.10 * greedy)


def test_the_measure_of_chord_gaps_sees_a_vertex_left_out() -> None:
    samples = sample_curve(circle, (0.0, 6.0), 0.01)
    thinned = np.delete(np.arange(len(samples.points)), 5)
    gaps = chord_gaps(circle, samples.parameters[thinned], samples.points[thinned], 200)
    assert gaps.max() > 0.03


def test_the_brute_force_greedy_knows_the_circle() -> None:
    tolerance = 0.01
    exact = 4.7 / (2 * np.arccos(1 - tolerance / 10))
    assert greedy_count(circle, 0.3, 5.0, tolerance, False) in (np.ceil(exact), np.ceil(exact) + 1)


@pytest.mark.parametrize("seed", range(12))
def test_random_splines_hold_the_tolerance_with_few_chords(seed: int) -> None:
    generator = np.random.default_rng(seed)
    point_at = b_spline(int(generator.integers(2, 10)), 1000 + seed, poles=24)
    tolerance = 10 ** generator.uniform(-1, 0.5)
    samples = sample_curve(point_at, (0.0, 1.0), tolerance)
    assert chord_gaps(point_at, samples.parameters, samples.points, 400).max() <= tolerance
    greedy = greedy_count(point_at, 0.0, 1.0, tolerance, False)
    assert len(samples.points) - 1 <= max(greedy + 1, 1.10 * greedy)


def test_chords_of_a_smooth_curve_are_evened_out() -> None:
    samples = sample_curve(circle, (0.0, 5.0), 0.01)
    lengths = segment_lengths(samples)
    assert lengths.max() / lengths.min() < 1.05


def test_a_straight_line_has_two_vertices_at_any_tolerance() -> None:
    for tolerance in (1e-6, 0.05, 50.0):
        assert len(sample_curve(line, (0.0, 1.0), tolerance).points) == 2
        assert len(sample_curve(lambda t: line(t**5), (0.0, 1.0), tolerance).points) == 2


def test_a_line_that_turns_back_keeps_its_far_end() -> None:
    samples = sample_curve(lambda t: line(np.sin(t)), (0.0, 3.0), 1e-3)
    assert (
        chord_gaps(lambda t: line(np.sin(t)), samples.parameters, samples.points, 999).max() <= 1e-3
    )


def test_waves_flatter_than_the_tolerance_need_one_chord() -> None:
    assert len(sample_curve(ripple, (0.0, np.pi / 3), 1.2).points) == 2


@pytest.mark.parametrize("size", [1e-3, 1.0, 20_000.0])
def test_scaling_curve_and_tolerance_changes_no_parameter(size: float) -> None:
    samples = sample_curve(b_spline(3, 7, size=1.0), (0.0, 1.0), 1e-3)
    scaled = sample_curve(b_spline(3, 7, size=size), (0.0, 1.0), 1e-3 * size)
    assert len(scaled.points) == len(samples.points)
    assert scaled.parameters == pytest.approx(samples.parameters, abs=1e-6)


def test_breaks_are_always_vertices() -> None:
    knots = clamped_knots(1, 40)
    point_at = b_spline(1, 3, poles=40)
    breaks = np.unique(point_at.t)
    samples = sample_curve(point_at, (0.0, 1.0), 0.01, breaks=breaks)
    assert np.array_equal(samples.parameters, breaks)
    assert len(knots) == len(point_at.t)
    loose = sample_curve(line, (0.0, 1.0), 1.0, breaks=[0.7, 0.2, 0.2])
    assert loose.parameters.tolist() == [0.0, 0.2, 0.7, 1.0]


def test_each_piece_between_breaks_has_few_chords_of_its_own() -> None:
    breaks = [1.0, 2.0, 2.1]
    samples = sample_curve(circle, (0.0, 6.0), 0.05, breaks=breaks)
    edges = [0.0, *breaks, 6.0]
    for i in range(len(edges) - 1):
        inside = (samples.parameters >= edges[i]) & (samples.parameters <= edges[i + 1])
        greedy = greedy_count(circle, edges[i], edges[i + 1], 0.05, False)
        assert np.sum(inside) - 1 <= max(greedy + 1, 1.10 * greedy)


def test_an_undeclared_corner_still_holds_the_tolerance() -> None:
    def corner(t: FloatArray) -> FloatArray:
        return np.stack((10 * t, 10 * np.abs(t - 0.37), 0 * t), axis=1)

    samples = sample_curve(corner, (0.0, 1.0), 1e-3)
    assert chord_gaps(corner, samples.parameters, samples.points, 5001).max() <= 1e-3
    assert len(samples.points) <= 4


def test_breaks_closer_than_a_millionth_of_the_length_merge() -> None:
    breaks = [1e-8, 0.5, 0.5 + 3e-7, 0.5 + 6e-7, 0.75, 1 - 1e-7]
    samples = sample_curve(line, (0.0, 1.0), 0.05, breaks=breaks)
    assert samples.parameters.tolist() == [0.0, 0.5, 0.75, 1.0]


def zigzag(t: FloatArray) -> FloatArray:
    """20 m with a step of 0.01 mm in the middle, which lies across the rest."""
    x = np.interp(t, [0, 1, 2, 3], [0, 1e4, 1e4, 2e4])
    y = np.interp(t, [0, 1, 2, 3], [0, 0, 0.01, 0.01])
    return np.stack((x, y, 0 * x), axis=1)


def test_merged_breaks_still_hold_the_tolerance_or_are_refused() -> None:
    samples = sample_curve(zigzag, (0.0, 3.0), 0.02, breaks=[1, 2])
    assert len(samples.points) == 3
    assert chord_gaps(zigzag, samples.parameters, samples.points, 30_001).max() <= 0.02
    with pytest.raises(InputError, match=r"takes chords shorter than 0\.02.* mm.*tiny edge"):
        sample_curve(zigzag, (0.0, 3.0), 1e-4, breaks=[1, 2])


@pytest.mark.parametrize("tolerance", [1e-4, 0.1, 5.0, 100.0])
def test_no_segment_is_shorter_than_a_millionth_of_the_length(tolerance: float) -> None:
    for name, (point_at, interval) in CURVES.items():
        dense = point_at(np.linspace(*interval, 20_001))
        length = np.sum(np.linalg.norm(np.diff(dense, axis=0), axis=1))
        lengths = segment_lengths(sample_curve(point_at, interval, tolerance))
        assert lengths.min() >= 1e-6 * length, name


def test_a_closed_curve_ends_where_it_began() -> None:
    samples = sample_curve(circle, (0.0, 2 * np.pi), 0.01)
    assert samples.points[-1] == pytest.approx(samples.points[0], abs=1e-12)
    assert len(samples.points) > 60
    coarse = sample_curve(circle, (0.0, 2 * np.pi), 100.0)
    assert len(coarse.points) == 3
    assert segment_lengths(coarse).min() > 10


def largest_shift_when_run_the_other_way(
    point_at: Curve,
    interval: tuple[float, float],
    tolerance: float,
    breaks: Sequence[float] = (),
    max_chord: float | None = None,
) -> float:
    """mm, between the vertices of a curve and those of the same curve run the other way."""
    total = sum(interval)
    samples = sample_curve(point_at, interval, tolerance, breaks=breaks, max_chord=max_chord)
    turned = sample_curve(
        lambda t: point_at(total - t),
        interval,
        tolerance,
        breaks=[total - at for at in breaks],
        max_chord=max_chord,
    )
    assert len(turned.points) == len(samples.points)
    return float(np.abs(turned.points[::-1] - samples.points).max())


def symmetric_waves(t: FloatArray) -> FloatArray:
    """Flatter than a coarse tolerance in the middle, and the same seen from either end."""
    return np.stack((100 * t, 2 * np.sin(40 * t) * t, 0 * t), axis=1)


@pytest.mark.parametrize("tolerance", [1.5, 0.2, 0.01])
def test_a_curve_run_the_other_way_has_the_same_vertices(tolerance: float) -> None:
    curves = {**CURVES, "symmetric waves": (symmetric_waves, (-1.0, 1.0))}
    for name, (point_at, interval) in curves.items():
        shift = largest_shift_when_run_the_other_way(point_at, interval, tolerance)
        assert shift < 1e-9, name


def shift_of_random_spline(seed: int) -> float:
    generator = np.random.default_rng(seed)
    degree, poles = int(generator.integers(2, 9)), int(generator.integers(10, 30))
    return largest_shift_when_run_the_other_way(
        b_spline(degree, 5000 + seed, poles=poles),
        (0.0, 1.0),
        10 ** generator.uniform(-2, 0),
        generator.uniform(0, 1, seed % 4).tolist(),
        3.0 if seed % 5 == 0 else None,
    )


@pytest.mark.parametrize("seed", range(20))
def test_random_splines_run_the_other_way_have_the_same_vertices(seed: int) -> None:
    assert shift_of_random_spline(seed) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 320))
def test_many_random_splines_run_the_other_way_have_the_same_vertices(seed: int) -> None:
    assert shift_of_random_spline(seed) < 1e-9


def test_breaks_merge_into_the_same_one_from_either_end() -> None:
    breaks = [0.0, 0.3, 0.3 + 4e-7, 0.3 + 8e-7, 0.3 + 1.2e-6, 0.8, 0.8 + 5e-7]
    assert largest_shift_when_run_the_other_way(line, (0.0, 1.0), 0.05, breaks) < 1e-12


@pytest.mark.parametrize("max_chord", [0.05, 0.5, 2.5, 100.0])
def test_no_chord_is_longer_than_asked(max_chord: float) -> None:
    for point_at in (circle, line):
        samples = sample_curve(point_at, (0.0, 1.0), 0.01, max_chord=max_chord)
        lengths = segment_lengths(samples)
        assert lengths.max() <= max_chord
        free = len(sample_curve(point_at, (0.0, 1.0), 0.01).points) - 1
        total = 10.0 if point_at is circle else 13.0
        assert len(lengths) <= max(free, np.ceil(total / max_chord)) + 1


def test_the_curve_is_asked_for_many_points_in_few_calls() -> None:
    calls: list[int] = []

    def counted(t: FloatArray) -> FloatArray:
        calls.append(len(t))
        return spike(t)

    sample_curve(counted, (0.0, 1.0), 1e-3)
    assert len(calls) < 30


def test_results_are_read_only_and_repeatable() -> None:
    point_at = b_spline(4, 11)
    samples = sample_curve(point_at, (0.0, 1.0), 0.02)
    again = sample_curve(point_at, (0.0, 1.0), 0.02)
    assert samples.parameters.tobytes() == again.parameters.tobytes()
    with pytest.raises(ValueError, match="read-only"):
        samples.points[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        samples.parameters[0] = 1.0


def test_a_needle_between_the_first_points_is_found_by_its_foot() -> None:
    def needle(t: FloatArray) -> FloatArray:
        return np.stack((100 * t, 1 / (1 + ((t - 0.4123) / 1e-5) ** 2), 0 * t), axis=1)

    samples = sample_curve(needle, (0.0, 1.0), 1e-2)
    assert samples.points[:, 1].max() > 0.98
    assert chord_gaps(needle, samples.parameters, samples.points, 20_000).max() <= 1e-2


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf])
def test_a_tolerance_that_is_no_positive_length_is_refused(tolerance: float) -> None:
    with pytest.raises(
        InputError, match=r"^tolerance cannot be .* mm: give a finite length above 0 mm"
    ):
        sample_curve(circle, (0.0, 1.0), tolerance)
    with pytest.raises(InputError, match=r"^max_chord cannot be "):
        sample_curve(circle, (0.0, 1.0), 0.1, max_chord=tolerance)


@pytest.mark.parametrize(
    ("interval", "message"),
    [
        ((0.0, 0.0), "must be above"),
        ((1.0, 0.0), "must be above"),
        ((0.0, np.nan), "must be finite"),
        ((-np.inf, 0.0), "must be finite"),
    ],
)
def test_an_interval_without_extent_is_refused(interval: tuple[float, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        sample_curve(circle, interval, 0.1)


@pytest.mark.parametrize("breaks", [[2.0], [-0.1], [np.nan], [[0.5]]])
def test_breaks_that_are_not_on_the_curve_are_refused(breaks: list[float]) -> None:
    with pytest.raises(InputError, match=r"^(The break|breaks cannot be) "):
        sample_curve(circle, (0.0, 1.0), 0.1, breaks=breaks)


def test_curves_that_are_no_curves_are_refused() -> None:
    with pytest.raises(InputError, match="NaN or infinite point at parameter"):
        sample_curve(lambda t: circle(np.where(t > 0.5, np.nan, t)), (0.0, 1.0), 0.1)
    with pytest.raises(InputError, match=r"array of shape \(1088, 2\)"):
        sample_curve(lambda t: circle(t)[:, :2], (0.0, 1.0), 0.1)
    with pytest.raises(InputError, match="All points of the curve coincide"):
        sample_curve(lambda t: circle(0 * t), (0.0, 1.0), 0.1)
    with pytest.raises(InputError, match=r"jumps by .* mm at parameter 0\.3"):
        sample_curve(lambda t: circle(t + (t > 0.3)), (0.0, 1.0), 0.1)


def test_tolerances_below_what_can_be_done_are_refused() -> None:
    with pytest.raises(InputError, match=r"mm is round-off\. Raise it"):
        sample_curve(lambda t: circle(t) + 1e6, (0.0, 1.0), 1e-6)
    with pytest.raises(InputError, match=r"asks? for too many vertices"):
        sample_curve(line, (0.0, 1.0), 1.0, max_chord=1e-7)

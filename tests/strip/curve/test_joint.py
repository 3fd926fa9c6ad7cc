from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.seeds import seeds
from tests.strip.curve.test_sampling import b_spline, chord_gaps
from wrinkle_cad.strip.curve.joint import sample_against
from wrinkle_cad.strip.curve.polyline import arc_lengths, points_at, segment_lengths
from wrinkle_cad.strip.curve.sampling import Samples, sample_curve
from wrinkle_cad.strip.triangulation import triangulate

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], FloatArray]
TOLERANCE = 0.05


def polyline(*points: tuple[float, ...]) -> tuple[Curve, tuple[float, float], list[float]]:
    """A curve through points, by its length, with its corners."""
    line = np.array([(*point, 0.0)[:3] for point in points], dtype=np.float64)
    arcs = arc_lengths(line)
    return lambda t: points_at(line, arcs, t), (0.0, float(arcs[-1])), arcs[1:-1].tolist()


def alone(
    rail: tuple[Curve, tuple[float, float], list[float]], tolerance: float = TOLERANCE
) -> Samples:
    return sample_curve(rail[0], rail[1], tolerance, breaks=rail[2])


def jointly(
    p: tuple[Curve, tuple[float, float], list[float]],
    q: tuple[Curve, tuple[float, float], list[float]],
    tolerance: float = TOLERANCE,
) -> tuple[Samples, Samples]:
    p_alone, q_alone = alone(p, tolerance), alone(q, tolerance)
    return (
        sample_against(p[0], p_alone, q_alone.points, tolerance),
        sample_against(q[0], q_alone, p_alone.points, tolerance),
    )


def random_rails(seed: int) -> list[tuple[Curve, tuple[float, float], list[float]]]:
    """Two wavy rails side by side, sometimes a straight one."""
    generator = np.random.default_rng(seed)
    width, wave = generator.uniform(5, 60), generator.uniform(2, 25)
    shapes = generator.uniform(-1, 1, (2, 12, 3)) * wave
    rails = []
    for side in range(2):
        poles = shapes[side] + np.stack((np.linspace(0, 200, 12), np.zeros(12), np.zeros(12)), 1)
        poles[:, 1] += side * (width + 2 * wave)
        if side and seed % 3 == 0:
            rails.append(polyline(tuple(poles[0]), tuple(poles[-1])))
            continue
        spline = b_spline(3, seed, poles=12)
        spline = type(spline)(spline.t, poles, 3)  # type: ignore[call-arg]
        rails.append((spline, (0.0, 1.0), []))
    return rails


def turned(
    rail: tuple[Curve, tuple[float, float], list[float]],
) -> tuple[Curve, tuple[float, float], list[float]]:
    point_at, interval, breaks = rail
    total = sum(interval)
    return lambda t: point_at(total - t), interval, [total - at for at in breaks[::-1]]


def test_a_corner_puts_the_place_nearest_to_it_on_the_other_rail() -> None:
    tab = polyline((0, 0), (40, 0), (50, -15), (60, 0), (120, 0))
    line = polyline((0, 30), (120, 30))
    p, q = jointly(tab, line)
    assert {40.0, 50.0, 60.0} <= set(q.points[:, 0].round(9).tolist())
    assert set(p.points[:, 0].round(9).tolist()) >= {0.0, 40.0, 50.0, 60.0, 120.0}


def test_parallel_lines_and_rails_sampled_alike_get_nothing_new() -> None:
    p, q = jointly(polyline((0, 0), (200, 0)), polyline((0, 30), (200, 30)))
    assert len(p.points) == len(q.points) == 2
    for width in (0.02, 0.5, 5.0, 60.0):
        rails = [
            (lambda t, y=y: np.stack((t, 0 * t + y, 4 * np.sin(t / 15)), 1), (0.0, 200.0), [])
            for y in (0.0, width)
        ]
        p, q = jointly(*rails)
        assert len(p.points) == len(alone(rails[0]).points)
        assert len(q.points) == len(alone(rails[1]).points)


def test_a_line_opposite_a_wave_has_a_vertex_for_each_45_degrees_of_turning() -> None:
    for height, width in ((5.0, 20.0), (20.0, 40.0), (40.0, 40.0)):
        wave = (
            lambda t, h=height, w=width: np.stack((t, 0 * t + w, h * np.sin(t / 25)), 1),
            (0.0, 200.0),
            [],
        )
        wavy, line = jointly(wave, polyline((0, 0), (200, 0)))
        turning = 200 / (25 * np.pi) * 2 * np.arctan(height / 25)
        assert len(line.points) - 1 >= np.floor(turning / (np.pi / 4))
        coarsest = 1.5 * segment_lengths(wavy.points).max()
        assert segment_lengths(line.points).max() <= max(np.hypot(width, height), coarsest)


@pytest.mark.parametrize("seed", range(20))
def test_vertices_are_on_the_curve_and_hold_the_tolerance(seed: int) -> None:
    rails = random_rails(seed)
    for rail, samples in zip(rails, jointly(*rails), strict=True):
        assert np.array_equal(samples.points, rail[0](samples.parameters))
        assert np.isin(alone(rail).parameters, samples.parameters).all()
        assert np.all(np.diff(samples.parameters) > 0)
        assert chord_gaps(rail[0], samples.parameters, samples.points, 60).max() <= TOLERANCE


@pytest.mark.parametrize("seed", range(20))
def test_rails_run_the_other_way_have_the_same_vertices(seed: int) -> None:
    rails = random_rails(seed)
    for there, back in zip(jointly(*rails), jointly(*map(turned, rails)), strict=True):
        assert len(there.points) == len(back.points)
        assert np.abs(there.points - back.points[::-1]).max() < 1e-9


@pytest.mark.parametrize("seed", range(20))
def test_the_order_of_the_rails_does_not_matter(seed: int) -> None:
    p, q = random_rails(seed)
    there, back = jointly(p, q), jointly(q, p)
    assert there[0].parameters.tobytes() == back[1].parameters.tobytes()
    assert there[1].parameters.tobytes() == back[0].parameters.tobytes()


def test_a_symmetric_tab_is_treated_alike_on_both_its_sides() -> None:
    tab = polyline((-60, 0), (-9, 0), (-5, -20), (5, -20), (9, 0), (60, 0))
    peak = polyline((-60, 30), (-7, 30), (0, 12), (7, 30), (60, 30))
    for samples in jointly(tab, peak):
        x = samples.points[:, 0]
        assert x == pytest.approx(-x[::-1], abs=1e-9)


@pytest.mark.parametrize("seed", seeds(30))
def test_smooth_rails_of_similar_shape_get_at_most_half_as_many_again(seed: int) -> None:
    generator = np.random.default_rng(seed)
    point_at = b_spline(3, seed, poles=10)
    shift = generator.uniform(5, 60, 3)
    rails = [(point_at, (0.0, 1.0), []), (lambda t: 1.02 * point_at(t) + shift, (0.0, 1.0), [])]
    before = sum(len(alone(rail).points) for rail in rails)
    assert sum(len(samples.points) for samples in jointly(*rails)) <= 1.5 * before


def test_a_curve_that_waves_about_its_chord_is_split_until_it_holds_the_tolerance() -> None:
    def ripple(t: FloatArray) -> FloatArray:
        return np.stack((100 * t, 0.9 * np.sin(60 * t), 0 * t), axis=1)

    rail: tuple[Curve, tuple[float, float], list[float]] = (ripple, (0.0, np.pi / 3), [])
    assert len(alone(rail, 1.0).points) == 2
    tab = polyline((0, 20), (41, 20), (44, 40), (47, 20), (104.7, 20))
    samples, _ = jointly(rail, tab, 1.0)
    assert chord_gaps(ripple, samples.parameters, samples.points, 999).max() <= 1.0


def test_uneven_parameters_do_not_move_the_vertices() -> None:
    tab = polyline((0, 30), (40, 30), (50, 45), (60, 30), (120, 30))
    even = polyline((0, 0), (120, 0))
    uneven: tuple[Curve, tuple[float, float], list[float]] = (
        lambda t: np.stack((120 * t**3, 0 * t, 0 * t), axis=1),
        (0.0, 1.0),
        [],
    )
    expected = jointly(even, tab)[0].points
    assert jointly(uneven, tab)[0].points == pytest.approx(expected, abs=2e-3)


def test_a_rail_that_is_a_point_or_coincides_with_the_other_adds_nothing() -> None:
    rail = polyline((0, 0), (40, 0), (40, 30))
    samples = alone(rail)
    for other in (np.array([[20.0, 50, 0]]), samples.points.copy()):
        assert sample_against(rail[0], samples, other, TOLERANCE) is samples


def wavy_rail(seed: int) -> tuple[Curve, float]:
    """A wave of 2 to 8 periods beside the x axis, 200 mm long, and how far away it is."""
    generator = np.random.default_rng(seed)
    waves, width = generator.integers(2, 9), float(generator.choice([10.0, 20.0, 40.0, 80.0]))
    height, sideways = generator.choice([2.0, 6.0, 15.0]), generator.uniform(0, 0.5)
    k, phase = 2 * np.pi * waves / 200, generator.uniform(0, np.pi)
    sideways *= min(height, 0.8 * width)

    def point_at(t: FloatArray) -> FloatArray:
        return np.stack(
            (t, width + sideways * np.cos(k * t + phase), height * np.sin(k * t)), axis=1
        )

    return point_at, width


def four_times(samples: Samples, point_at: Curve) -> FloatArray:
    """(4 k - 3, 3): the samples, and three more curve points between neighbours."""
    count = len(samples.parameters)
    places = np.arange(4 * count - 3) / 4
    return point_at(np.interp(places, np.arange(count), samples.parameters))


def bendings(seed: int) -> tuple[float, float, float]:
    """Of a wavy rail against a straight one: sampled jointly, four times as densely, alone."""
    rails: list[tuple[Curve, tuple[float, float], list[float]]] = [
        (wavy_rail(seed)[0], (0.0, 200.0), []),
        polyline((0, 0), (200, 0)),
    ]
    planarity = 1e-3 * TOLERANCE
    p, q = jointly(*rails)
    dense = [four_times(samples, rail[0]) for samples, rail in zip((p, q), rails, strict=True)]
    single = [alone(rail).points for rail in rails]
    return (
        triangulate(p.points, q.points, planarity=planarity).bending,
        triangulate(dense[0], dense[1], planarity=planarity).bending,
        triangulate(single[0], single[1], planarity=planarity, price=None).bending,
    )


def check_waves(seeds: range) -> None:
    found = np.array([bendings(seed) for seed in seeds])
    assert np.mean(found[:, 0] <= 1.15 * found[:, 1]) >= 0.9
    # Where the best surface gathers its rulings at two points anyway, the line's other samples cut
    # the plane triangle between them into lower ones, which count as a little stiffer.
    assert np.all(found[:, 0] <= 1.02 * found[:, 2])
    assert np.mean(found[:, 0] <= found[:, 2]) >= 0.75


def test_a_wave_against_a_line_bends_as_with_four_times_the_samples() -> None:
    check_waves(range(20))


@pytest.mark.slow
def test_many_waves_against_a_line_bend_as_with_four_times_the_samples() -> None:
    check_waves(range(20, 320))

"""Plain inputs, from curves to strip: straps with tabs, waves, and rails drawn the other way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Edge, Line, Polyline, Spline
from numpy.typing import NDArray
from shapely.geometry import Polygon

from tests.seeds import seeds
from tests.strip.test_partners import leaning_strap, least_folds, upright_strap
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.rail.directrix import make_directrix, sample_directrix
from wrinkle_cad.strip import triangulate

FloatArray = NDArray[np.float64]


def line_between(start: FloatArray, end: FloatArray) -> Edge:
    return Edge.make_line(tuple(start.tolist()), tuple(end.tolist()))


def polyline(points: FloatArray) -> Edge:
    if len(points) == 2:
        return line_between(points[0], points[1])
    return Polyline(*map(tuple, points.tolist()))


def spline(points: FloatArray) -> Edge:
    return Edge.make_spline([tuple(point) for point in points.tolist()])


def largest_fold_deg(strip: WrinkleStrip) -> float:
    return math.degrees(np.abs(strip.triangulation.fold).max(initial=0.0))


def test_a_flat_strap_with_a_tab_lies_flat() -> None:
    tab = Polyline((0, 0, 0), (40, 0, 0), (50, -15, 0), (60, 0, 0), (120, 0, 0))
    strip = WrinkleStrip(tab, Line((0, 30, 0), (120, 30, 0)))
    assert strip.area_mm2 == pytest.approx(3750.0, rel=1e-9)
    assert strip.shell().is_valid
    assert largest_fold_deg(strip) < 1e-6


def test_a_flat_strap_with_a_smooth_bump_lies_flat() -> None:
    bump = Spline((0, 0, 0), (40, 0, 0), (60, -12, 0), (80, 0, 0), (120, 0, 0))
    strip = WrinkleStrip(bump, Line((0, 30, 0), (120, 30, 0)))
    assert strip.area_mm2 == pytest.approx(3380.289, abs=1e-3)
    assert largest_fold_deg(strip) < 1e-6


def test_the_flat_region_between_two_splines_has_its_area() -> None:
    x = np.arange(0.0, 201.0, 10.0)
    strip = WrinkleStrip(
        spline(np.stack((x, 5 * np.sin(x / 20), 0 * x), 1)),
        spline(np.stack((x, 30 + 4 * np.cos(x / 15), 0 * x), 1)),
    )
    assert strip.area_mm2 == pytest.approx(5857.9725, rel=2e-6)
    assert largest_fold_deg(strip) < 1e-6


@pytest.mark.parametrize(("height", "most"), [(5.0, 2.2), (20.0, 24.0), (40.0, 57.0)])
def test_a_line_against_a_wave_bends_little(height: float, most: float) -> None:
    x = np.arange(0.0, 201.0, 10.0)
    wave = spline(np.stack((x, 0 * x + 40, height * np.sin(x / 25)), 1))
    strip = WrinkleStrip(Line((0, 0, 0), (200, 0, 0)), wave)
    assert strip.triangulation.bending <= most
    assert len(strip.p_samples.points) < 16


def bending_of_wave(seed: int) -> tuple[float, float]:
    """Of a wave of 2 to 8 turns, 10 to 80 away from a line.

    First that of the strip, then that between the rails as each is sampled for itself, with as many
    convex bridges as can be.
    """
    generator = np.random.default_rng(seed)
    turns, width = generator.uniform(2, 8), generator.uniform(10, 80)
    height, phase = generator.uniform(0.02, 0.5) * width, generator.uniform(0, 6)
    x = np.linspace(0.0, 200.0, 20 * math.ceil(turns))
    turned = 2 * math.pi * turns * x / 200 + phase
    wave = spline(np.stack((x, 0 * x + width, height * np.sin(turned)), 1))
    line = Line((0, 0, 0), (200, 0, 0))
    alone = [sample_directrix(make_directrix(rail), 0.05).points for rail in (line, wave)]
    greedy = triangulate(alone[0], alone[1], planarity=5e-5, price=None)
    return WrinkleStrip(line, wave).triangulation.bending, greedy.bending


@pytest.mark.parametrize("seed", range(20))
def test_a_line_against_a_wave_never_bends_more_than_by_the_fewest_invalid_bridges(
    seed: int,
) -> None:
    bending, greedy = bending_of_wave(seed)
    assert bending <= (1 + 1e-9) * greedy


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 320))
def test_many_lines_against_waves_never_bend_more_than_by_the_fewest_invalid_bridges(
    seed: int,
) -> None:
    bending, greedy = bending_of_wave(seed)
    assert bending <= (1 + 1e-9) * greedy


WAVES = [
    (turns, width, share)
    for turns in (2, 3, 5, 6, 8)
    for width in (10.0, 20.0, 40.0, 80.0)
    for share in (0.1, 0.3, 0.5)
]


def bending_of_its_own(turns: int, width: float, height: float) -> float:
    """How much a line against a wave bends, against the same with four times the samples."""
    x = np.linspace(0.0, 200.0, 20 * turns)
    wave = spline(np.stack((x, 0 * x + width, height * np.sin(2 * np.pi * turns * x / 200)), 1))
    strip = WrinkleStrip(Line((0, 0, 0), (200, 0, 0)), wave)
    finer = []
    for rail, own in ((strip.p, strip.p_samples), (strip.q, strip.q_samples)):
        u = own.parameters
        at, step = u[:-1, None], np.diff(u)[:, None]
        finer.append(rail.point_at(np.append((at + step * np.arange(4) / 4).ravel(), u[-1])))
    fine = triangulate(finer[0], finer[1], planarity=5e-5)
    return strip.triangulation.bending / fine.bending


@pytest.mark.slow
def test_a_line_against_a_wave_bends_as_with_four_times_the_samples() -> None:
    above = [
        case for case in WAVES if bending_of_its_own(case[0], case[1], case[2] * case[1]) > 1.15
    ]
    assert len(above) <= 0.1 * len(WAVES), above


def saddle(half: float = 10.0, bow: float = 3.0) -> tuple[Edge, Edge]:
    """Rails on z = xy / 40."""
    x = np.linspace(-50.0, 50.0, 51)
    y = half + bow * (x / 50) ** 2
    p, q = (spline(np.stack((x, side * y, side * x * y / 40), 1)) for side in (-1, 1))
    return p, q


@pytest.mark.parametrize("tolerance", [0.1, 0.05, 0.02, 0.005, 0.002])
def test_a_saddle_is_not_folded_back_for_a_few_bridges(tolerance: float) -> None:
    assert largest_fold_deg(WrinkleStrip(*saddle(), tolerance=tolerance)) < 55.0
    assert largest_fold_deg(WrinkleStrip(*saddle(), tolerance=tolerance, price=1.0)) < 40.0


@pytest.mark.parametrize(("half", "bow"), [(4.0, 1.0), (5.0, 1.0), (6.0, 0.0)])
@pytest.mark.parametrize("tolerance", [0.1, 0.01])
def test_a_narrow_saddle_has_the_samples_not_to_be_folded(
    half: float, bow: float, tolerance: float
) -> None:
    rails = saddle(half, bow)
    assert largest_fold_deg(WrinkleStrip(*rails, tolerance=tolerance)) < 55.0
    assert largest_fold_deg(WrinkleStrip(*rails, tolerance=tolerance, price=1.0)) < 40.0


def test_skew_lines_are_not_folded_along_one_diagonal() -> None:
    strip = WrinkleStrip(Line((0, 0, 0), (100, 0, 0)), Line((0, 20, 0), (100, 20, 53)))
    assert largest_fold_deg(strip) < 55.0
    assert strip.report.state == "stretched"


def check_strap(rails: tuple[FloatArray, FloatArray]) -> None:
    strip = WrinkleStrip(polyline(rails[0]), polyline(rails[1]))
    area = Polygon(np.vstack((rails[0], rails[1][::-1]))[:, :2]).area
    assert strip.area_mm2 == pytest.approx(area, rel=1e-9)
    assert largest_fold_deg(strip) < 1e-6


@pytest.mark.parametrize("seed", range(20))
def test_straps_with_tabs_of_any_shape_lie_flat(seed: int) -> None:
    check_strap(upright_strap(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 150))
def test_many_straps_with_tabs_of_any_shape_lie_flat(seed: int) -> None:
    check_strap(upright_strap(seed))


@pytest.mark.parametrize("seed", [21, 71, 108])
def test_straps_with_leaning_tabs_lie_flat(seed: int) -> None:
    check_strap(leaning_strap(seed))


def bump(generator: np.random.Generator, side: int, width: float) -> Edge:
    """One rail of a flat strap with a smooth bump or dent."""
    start = generator.uniform(15, 50)
    end = start + generator.uniform(20, 50)
    height = generator.uniform(3, 18) * (1.0 if generator.random() < 0.75 else -0.4)
    y = np.array([0.0, 0.0, (2 * side - 1) * height, 0.0, 0.0]) + side * width
    return spline(np.stack(([0.0, start, (start + end) / 2, end, 120.0], y, np.zeros(5)), 1))


def outline_of(edge: Edge, spacing: float) -> FloatArray:
    return sample_directrix(make_directrix(edge), 1e-4, spacing).points


def strap_with_bumps(seed: int) -> tuple[Edge, Edge]:
    """Rails between which a flat strap exists, with a bump on one side or on both."""
    generator = np.random.default_rng(seed)
    while True:
        width = generator.uniform(15, 45)
        p, q = bump(generator, 0, width), bump(generator, 1, width)
        if seed % 3:
            q = Line((0, width, 0), (120, width, 0))
        dense = [outline_of(edge, 0.7) for edge in (p, q)]
        is_simple = Polygon(np.vstack((dense[0], dense[1][::-1]))[:, :2]).is_valid
        if is_simple and least_folds(dense[0], dense[1]) == 0:
            return p, q


def check_bump(seed: int) -> None:
    edges = strap_with_bumps(seed)
    strip = WrinkleStrip(*edges)
    outline = [outline_of(edge, 1.0)[:, :2] for edge in edges]
    area = Polygon(np.vstack((outline[0], outline[1][::-1]))).area
    assert strip.area_mm2 == pytest.approx(area, rel=2e-5)
    assert largest_fold_deg(strip) < 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_straps_with_smooth_bumps_lie_flat(seed: int) -> None:
    check_bump(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8, 60))
def test_many_straps_with_smooth_bumps_lie_flat(seed: int) -> None:
    check_bump(seed)


def random_strip(seed: int) -> tuple[FloatArray, FloatArray]:
    """Poles of two cubic rails side by side."""
    generator = np.random.default_rng(seed)
    count, width, wave = 10, generator.uniform(8, 50), generator.uniform(1, 15)
    poles = generator.uniform(-wave, wave, (2, count, 3))
    poles[:, :, 0] += np.linspace(0, generator.uniform(80, 250), count)
    poles[1, :, 1] += width + wave
    return poles[0], poles[1]


def check_both_rails_reversed(seed: int) -> None:
    points = random_strip(seed)
    there = WrinkleStrip(*map(spline, points))
    back = WrinkleStrip(*(spline(rail[::-1]) for rail in points))
    for ours, theirs in ((there.p_samples, back.p_samples), (there.q_samples, back.q_samples)):
        assert len(ours.points) == len(theirs.points)
        assert np.abs(ours.points - theirs.points[::-1]).max() < 1e-9
    assert back.triangulation.invalid_count == there.triangulation.invalid_count
    assert back.triangulation.bending == pytest.approx(there.triangulation.bending, rel=1e-9)
    assert back.report.is_developable == there.report.is_developable


@pytest.mark.parametrize("seed", seeds(20, default=10))
def test_both_rails_drawn_the_other_way_give_the_same_strip(seed: int) -> None:
    check_both_rails_reversed(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 200))
def test_many_rails_drawn_the_other_way_give_the_same_strip(seed: int) -> None:
    check_both_rails_reversed(seed)


@pytest.mark.parametrize("seed", range(10))
def test_p_and_q_swapped_have_the_same_samples_and_energy(seed: int) -> None:
    p, q = map(spline, random_strip(seed))
    there, back = WrinkleStrip(p, q), WrinkleStrip(q, p)
    assert np.array_equal(there.p_samples.points, back.q_samples.points)
    assert np.array_equal(there.q_samples.points, back.p_samples.points)
    assert back.triangulation.bending == pytest.approx(there.triangulation.bending, rel=1e-9)


@pytest.mark.parametrize("apart", [1e-13, 1e-11, 1e-10, 1e-9, 1e-8, 9e-8])
def test_rails_that_meet_to_within_the_kernel_s_tolerance_meet(apart: float) -> None:
    x = np.linspace(0.0, 100.0, 11)
    out, up = 8 * np.sin(np.pi * x / 100), 3 * np.sin(x / 9)
    p = spline(np.stack((x, -out, up), 1))
    met, near = (
        WrinkleStrip(p, spline(np.stack((x, out + gap, up + out / 4), 1))) for gap in (0.0, apart)
    )
    assert near.triangulation.degenerate_count == met.triangulation.degenerate_count == 2
    assert near.triangulation.bending <= 1.1 * met.triangulation.bending
    assert largest_fold_deg(near) == pytest.approx(largest_fold_deg(met), abs=1e-3)
    assert near.shell().is_valid

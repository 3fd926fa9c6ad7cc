"""Flat straps with tabs: what a corner sees of the other rail must hold a sample."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely.geometry import Polygon

from wrinkle_cad.strip.curve.joint import sample_against
from wrinkle_cad.strip.curve.polyline import arc_lengths, points_at
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.partners import without_fold_backs
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

FloatArray = NDArray[np.float64]
Outlines = tuple[FloatArray, FloatArray]
LENGTH, TOLERANCE = 120.0, 0.05


def search(p: FloatArray, q: FloatArray) -> Triangulation:
    return triangulate(p, q, planarity=1e-3 * TOLERANCE)


def along(line: FloatArray) -> Callable[[FloatArray], FloatArray]:
    return partial(points_at, line, arc_lengths(line))


def upright_tab(generator: np.random.Generator, outward: bool) -> FloatArray:
    """(k, 2): a tab, or a notch, that goes on along the strap; its sides may be upright."""
    start = generator.uniform(0.1, 0.6) * LENGTH
    end = start + generator.uniform(0.08, 0.35) * LENGTH
    count = int(generator.integers(1, 6))
    x = np.sort(generator.uniform(start, end, count))
    if count > 1 and generator.random() < 0.3:
        x[0], x[-1] = start, end
    y = generator.uniform(3, 25, count) * (1.0 if outward else -0.5)
    return np.stack((np.r_[start, x, end], np.r_[0.0, y, 0.0]), axis=1)


def leaning_tab(generator: np.random.Generator, width: float) -> FloatArray:
    """(k, 2): a tab that may lean over its foot, so that its corners see little from inside."""
    start, foot = generator.uniform(0.05, 0.6) * LENGTH, generator.uniform(0.04, 0.35) * LENGTH
    count = int(generator.integers(1, 7))
    x = start + np.sort(generator.uniform(-0.3 * foot, 1.3 * foot, count))
    y = generator.uniform(1, 30, count)
    return np.stack((np.r_[start, x, start + foot], np.r_[0.0, y, 0.0]), axis=1)


def strap(tabs: tuple[FloatArray | None, FloatArray | None], width: float) -> Outlines:
    """Both rails of a strap along x with tabs that point away from it."""
    rails = []
    for side, tab in enumerate(tabs):
        inner = np.zeros((0, 2)) if tab is None else tab * (1.0, 2.0 * side - 1.0)
        line = np.vstack(([0.0, 0.0], inner, [LENGTH, 0.0])) + np.array([0.0, side * width])
        rails.append(np.column_stack((line, np.zeros(len(line)))))
    return rails[0], rails[1]


def upright_strap(seed: int) -> Outlines:
    generator = np.random.default_rng(seed)
    which = int(generator.integers(3))
    tabs = [
        upright_tab(generator, bool(generator.random() < 0.8)) if which in (side, 2) else None
        for side in range(2)
    ]
    return strap((tabs[0], tabs[1]), 30.0)


def leaning_strap(seed: int) -> Outlines:
    generator = np.random.default_rng(seed)
    width, which = generator.uniform(8, 45), int(generator.integers(3))
    tabs = [leaning_tab(generator, width) if which in (side, 2) else None for side in range(2)]
    return strap((tabs[0], tabs[1]), width)


def outline(rails: Outlines) -> Polygon:
    return Polygon(np.vstack((rails[0], rails[1][::-1]))[:, :2])


def least_folds(p: FloatArray, q: FloatArray) -> int:
    """Fewest triangles of any triangulation that lie the wrong way round, by a plain program."""

    def doubled(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
        return np.asarray(
            (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1])
            - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
        )

    p_wrong = doubled(p[:-1, None], p[1:, None], q[None]) < -1e-9
    q_wrong = doubled(p[:, None], q[None, 1:], q[None, :-1]) < -1e-9
    count = np.concatenate(([0], np.cumsum(q_wrong[0])))
    for i in range(1, len(p)):
        best = count + p_wrong[i - 1]
        for j in range(1, len(q)):
            best[j] = min(best[j], best[j - 1] + q_wrong[i, j - 1])
        count = best
    return int(count[-1])


def can_lie_flat(rails: Outlines) -> bool:
    if not outline(rails).is_valid:
        return False
    dense = [
        points_at(line, arcs, np.union1d(arcs, np.arange(0.0, arcs[-1], 0.75)))
        for line, arcs in ((line, arc_lengths(line)) for line in rails)
    ]
    return least_folds(dense[0], dense[1]) == 0


def strip_between(rails: Outlines) -> Triangulation:
    alone = [Samples(arc_lengths(line), line.copy()) for line in rails]
    p_at, q_at = along(rails[0]), along(rails[1])
    sampled = (
        sample_against(p_at, alone[0], rails[1], TOLERANCE),
        sample_against(q_at, alone[1], rails[0], TOLERANCE),
    )
    found = search(sampled[0].points, sampled[1].points)
    mended, samples = without_fold_backs(found, sampled, (p_at, q_at), TOLERANCE, search)
    assert np.array_equal(mended.p, samples[0].points)
    assert np.array_equal(mended.q, samples[1].points)
    return mended


def check_lies_flat(rails: Outlines) -> None:
    found = strip_between(rails)
    assert found.fold_back_count == 0
    assert np.abs(found.fold).max() < 1e-6
    assert found.area == pytest.approx(outline(rails).area, rel=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_straps_with_tabs_of_any_shape_lie_flat(seed: int) -> None:
    check_lies_flat(upright_strap(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 320))
def test_many_straps_with_tabs_of_any_shape_lie_flat(seed: int) -> None:
    check_lies_flat(upright_strap(seed))


LEANING = [1, 15, 21, 27, 38, 41, 42, 45, 71, 73, 101, 103, 108]


@pytest.mark.parametrize("seed", LEANING)
def test_leaning_tabs_whose_corners_see_little_lie_flat(seed: int) -> None:
    rails = leaning_strap(seed)
    assert can_lie_flat(rails)
    check_lies_flat(rails)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(300))
def test_every_leaning_tab_that_can_lie_flat_does(seed: int) -> None:
    rails = leaning_strap(seed)
    if can_lie_flat(rails):
        check_lies_flat(rails)


def test_without_partners_some_of_these_straps_fold() -> None:
    folded = 0
    for seed in LEANING:
        p, q = leaning_strap(seed)
        alone = [Samples(arc_lengths(line), line.copy()) for line in (p, q)]
        sampled = (
            sample_against(along(p), alone[0], q, TOLERANCE),
            sample_against(along(q), alone[1], p, TOLERANCE),
        )
        folded += search(sampled[0].points, sampled[1].points).fold_back_count > 0
    assert folded > 5


def test_a_mushroom_folds_whatever_the_samples_and_keeps_those_it_has() -> None:
    head = np.array(
        [[58.0, 0], [58, 10], [40, 10], [40, 20], [80, 20], [80, 10], [62, 10], [62, 0]]
    )
    rails = strap((head, None), 20.0)
    assert not can_lie_flat(rails)
    found = strip_between(rails)
    assert found.fold_back_count > 0
    samples = (Samples(arc_lengths(found.p), found.p), Samples(arc_lengths(found.q), found.q))
    again, same = without_fold_backs(
        found, samples, (along(found.p), along(found.q)), TOLERANCE, search
    )
    assert again.fold_back_count <= found.fold_back_count
    assert again is found or again.fold_back_count < found.fold_back_count
    assert same is samples or again is not found


def test_a_rail_given_as_points_keeps_its_samples() -> None:
    rails = leaning_strap(LEANING[0])
    samples = (Samples(arc_lengths(rails[0]), rails[0]), Samples(arc_lengths(rails[1]), rails[1]))
    found = search(*rails)
    assert found.fold_back_count > 0
    same, kept = without_fold_backs(found, samples, (None, None), TOLERANCE, search)
    assert same is found
    assert kept is samples
    _, (p, _) = without_fold_backs(found, samples, (None, along(rails[1])), TOLERANCE, search)
    assert p is samples[0]


def test_a_fan_from_a_point_that_turns_back_is_left_as_it_is() -> None:
    apex, rail = np.zeros((1, 3)), np.array([[-40.0, 30, 0], [20, 30, 0], [-5, 40, 0], [40, 45, 0]])
    samples = (Samples(np.zeros(1), apex), Samples(arc_lengths(rail), rail))
    found = search(apex, rail)
    assert found.fold_back_count > 0
    same, kept = without_fold_backs(found, samples, (None, along(rail)), TOLERANCE, search)
    assert same is found
    assert kept is samples

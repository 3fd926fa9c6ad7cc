from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.strip import exact_strips
from tests.strip.exact_strips import stack
from wrinkle_cad.strip import Triangulation, sample_curve, triangulate
from wrinkle_cad.strip.inflection import plane_misfit
from wrinkle_cad.strip.rails import coarser_sagitta
from wrinkle_cad.strip.triangulation import measured


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("family", exact_strips.WAVY)
def test_invalid_bridges_of_developables_stand_at_inflections_and_are_reported(
    family, tolerance: float
) -> None:
    invalid_count = 0
    for seed in range(8):
        check_inflections(family(seed).sampled(tolerance))
        invalid_count += triangulate_invalid(family(seed).sampled(tolerance)).size
    assert invalid_count > 5


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("family", exact_strips.WAVY)
def test_so_they_do_on_many_developables(family, tolerance: float) -> None:
    for seed in range(100):
        check_inflections(family(seed).sampled(tolerance))


def triangulate_invalid(strip: exact_strips.SampledStrip) -> np.ndarray:
    return np.flatnonzero(~triangulate(strip.p, strip.q).valid[1:-1])


def check_inflections(strip: exact_strips.SampledStrip) -> None:
    found = triangulate(strip.p, strip.q)
    invalid = ~found.valid
    invalid[[0, -1]] = False
    assert (strip.samples_to_inflection(found.bridges[invalid]) <= 2.0).all(), strip.name
    assert (found.inflection == invalid).all(), strip.name


def test_the_distance_to_an_inflection_can_be_too_large() -> None:
    strip = exact_strips.cylinder(0).sampled(1e-4)
    found = triangulate(strip.p, strip.q)
    shifted = exact_strips.SampledStrip(strip.name, strip.p, strip.q, strip.inflections + 5.0)
    with pytest.raises(AssertionError):
        check_inflections(shifted)
    assert found.inflection.any()


@pytest.mark.parametrize("samples", [(60, 60), (500, 450)])
@pytest.mark.parametrize("family", exact_strips.WAVY)
def test_samples_at_equal_parameters_show_the_same(family, samples: tuple[int, int]) -> None:
    for seed in range(8):
        strip = family(seed)
        t, u = (np.linspace(*strip.interval, count) for count in samples)
        found = triangulate(strip.p_at(t), strip.q_at(u))
        assert found.inflection_count == found.invalid_count


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_no_inflection_is_seen_far_from_a_change_of_bending(tolerance: float) -> None:
    inflections = defects = 0
    for seed in range(6):
        strip = exact_strips.wrinkled(seed).sampled(tolerance)
        found = triangulate(strip.p, strip.q)
        bridges, fold = found.bridges[1:-1], found.fold
        changes = np.flatnonzero(fold[:-1] * fold[1:] < 0.0)
        at = np.vstack((bridges[changes], bridges[changes + 1]))
        apart = np.abs(found.bridges[found.inflection][:, None] - at[None]).min(axis=2).min(axis=1)
        assert (apart <= 2).all()
        inflections += found.inflection_count
        defects += found.invalid_count - found.inflection_count
    assert inflections > 0
    assert defects > 10


def twisted_paraboloid(slope: float, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Parabolas in parallel planes, one tilted against the other: bent one way everywhere."""
    t = np.linspace(0.0, 10.0, int(10.0 / np.sqrt(80 * tolerance)))
    p = stack(t, 0 * t, 0.05 * t * t)
    return p, p + stack(0 * t, 1.0 + 0 * t, slope * t)


@pytest.mark.parametrize("slope", [0.02, 0.1])
def test_twist_without_a_change_of_bending_is_no_inflection(slope: float) -> None:
    found = triangulate(*twisted_paraboloid(slope, 1e-4), criteria=("length",))
    assert found.invalid_count > 30
    assert found.inflection_count == 0


def distance_from_a_common_plane(p: np.ndarray, q: np.ndarray, i: int, j: int) -> float:
    """mm; least largest distance of a bridge's neighbours from a plane through it, by trial."""
    ruling = (q[j] - p[i]) / np.linalg.norm(q[j] - p[i])
    first = np.cross(ruling, np.eye(3)[np.argmin(np.abs(ruling))])
    first /= np.linalg.norm(first)
    turn = np.linspace(0.0, np.pi, 4001)[:, None]
    normals = np.cos(turn) * first + np.sin(turn) * np.cross(ruling, first)
    ends = (p[max(i - 1, 0)], p[min(i + 1, len(p) - 1)], q[max(j - 1, 0)])
    offsets = np.array([*ends, q[min(j + 1, len(q) - 1)]]) - p[i]
    return float(np.abs(normals @ offsets.T).max(axis=1).min())


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_at_an_inflection_the_sheet_is_flat_to_within_two_sagittas(tolerance: float) -> None:
    """Beyond that it is twisted, and an invalid bridge is a defect whatever bends beside it."""
    for seed in range(6):
        strip = exact_strips.wrinkled(seed).sampled(tolerance)
        found = triangulate(strip.p, strip.q)
        bent = found.inflection & found.counted
        assert bent.any()
        limit = 2.0 * coarser_sagitta(strip.p, strip.q)
        for i, j in found.bridges[bent]:
            assert distance_from_a_common_plane(strip.p, strip.q, i, j) < 1.001 * limit


def test_an_invalid_bridge_at_which_nothing_bends_is_no_defect() -> None:
    rail = np.array([(10 * k, 0, 6 * (k % 2)) for k in range(9)], dtype=float)
    found = triangulate(rail, rail + np.array([0, 25, 0]))
    assert found.invalid_count == found.inflection_count > 0
    assert found.counted_invalid_count == 0


def zigzag(p: np.ndarray, q: np.ndarray) -> Triangulation:
    """P-steps and Q-steps in turn; rulings at equal parameters."""
    steps = np.tile(np.array([0, 1], dtype=np.int8), len(p) - 1)
    return measured(
        p, q, steps, planarity=1e-12, criteria=("length",), search="global", energy="hinge"
    )


@pytest.mark.parametrize("count", [20, 80, 320])
def test_the_twist_of_a_hyperbolic_paraboloid_is_its_closed_form(count: int) -> None:
    t = np.linspace(0.0, 4.0, count)
    slope = 0.3
    p, q = stack(t, 0 * t, 0 * t), stack(t, 1.0 + 0 * t, slope * t)
    found = zigzag(p, q)
    ruling = stack(0 * t, 1.0 + 0 * t, slope * t)
    normals = [np.cross(tangent, ruling) for tangent in ([1.0, 0, 0], [1.0, 0, slope])]
    first, second = (normal / np.linalg.norm(normal, axis=1)[:, None] for normal in normals)
    exact = np.arccos((first * second).sum(axis=1))
    i, j = found.bridges.T
    inner = (i == j) & (i > 1) & (i < count - 2) & ~found.valid
    assert inner.sum() == count - 4
    spacing = t[1]
    assert np.abs(found.twist[inner] - exact[i[inner]]).max() < 0.2 * spacing
    assert np.degrees(found.twist.max()) > 15.0


def test_fans_are_not_mistaken_for_twist() -> None:
    p, q = exact_strips.twisted_plane_and_cone()
    assert triangulate(p, q).twist.max() == 0.0
    assert np.degrees(triangulate(p, q, criteria=("length",)).twist.max()) > 25.0


@pytest.mark.parametrize("family", exact_strips.WAVY + exact_strips.CONVEX)
def test_the_twist_of_a_developable_vanishes_as_the_sampling_is_refined(family) -> None:
    def largest(tolerance: float) -> float:
        strips = [family(seed).sampled(tolerance) for seed in range(4)]
        return max(float(triangulate(strip.p, strip.q).twist.max()) for strip in strips)

    assert np.degrees(largest(1e-2)) < 3.0
    assert np.degrees(largest(1e-4)) < 0.3


def test_the_plane_that_fits_best_is_found() -> None:
    random = np.random.default_rng(11)
    view = random.normal(size=(9, 40))
    offsets = view[1:].reshape(4, 2, -1)
    turn = np.linspace(0.0, np.pi, 40_001)
    side = np.abs(
        offsets[:, 0, :, None] * np.cos(turn) + offsets[:, 1, :, None] * np.sin(turn)
    ).max(axis=0)
    assert plane_misfit(view) == pytest.approx(side.min(axis=1), abs=2e-4)


def test_neighbours_on_the_line_of_the_bridge_fit_every_plane() -> None:
    assert plane_misfit(np.zeros((9, 3))).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("tolerances", [(1e-2, 1e-5), (1e-5, 1e-2)])
@pytest.mark.parametrize(
    "make", [exact_strips.cylinder, exact_strips.cone, exact_strips.tangent_developable]
)
def test_a_rail_sampled_thirty_times_finer_has_invalid_bridges_at_inflections_only(
    make: Callable[[int], exact_strips.ExactStrip], tolerances: tuple[float, float]
) -> None:
    strip = make(2)
    p, q = (
        sample_curve(curve, strip.interval, tolerance).points
        for curve, tolerance in zip((strip.p_at, strip.q_at), tolerances, strict=True)
    )
    found = triangulate(p, q)
    # Opposite the coarse chord that holds an inflection all samples of the fine rail are invalid.
    shares = max(len(p) / len(q), len(q) / len(p))
    assert 20.0 < shares < 40.0
    assert found.inflection_count == found.invalid_count
    assert found.invalid_count <= 1.2 * shares * len(strip.inflections)

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from wrinkle_cad.strip.curve.sampling import Samples, sample_curve
from wrinkle_cad.strip.flat.planes import planar_runs, plane_normal, spans_of
from wrinkle_cad.strip.flat.unrolling import exact_rails, unroll_cones
from wrinkle_cad.strip.triangulation import Triangulation, measured, triangulate

GAP = 1e-8

Curve = Callable[[np.ndarray], np.ndarray]


def rail(x: Curve, y: Curve, z: Curve) -> Curve:
    return lambda t: np.column_stack((x(t), y(t), z(t)))


def constant(value: float) -> Curve:
    return lambda t: np.full(len(t), value)


def runs_of(
    triangulation: Triangulation, curves: tuple[Curve, Curve], samples: tuple[Samples, Samples]
) -> np.ndarray:
    parameters = samples[0].parameters, samples[1].parameters
    return planar_runs(triangulation, exact_rails(curves, samples), parameters, GAP)


def strip_between(
    p_at: Curve, q_at: Curve, *, breaks: tuple[float, ...] = (), tolerance: float = 1e-2
) -> tuple[Triangulation, tuple[Curve, Curve], tuple[Samples, Samples]]:
    samples = (
        sample_curve(p_at, (0.0, 1.0), tolerance, breaks=breaks),
        sample_curve(q_at, (0.0, 1.0), tolerance, breaks=breaks),
    )
    triangulation = triangulate(
        samples[0].points, samples[1].points, criteria=("invalid", "bending", "length")
    )
    return triangulation, (p_at, q_at), samples


def wave(y: float, size: float, rate: float) -> Curve:
    return rail(lambda t: 100.0 * t, lambda t: y + size * np.sin(rate * t), constant(0.0))


def turned(curve: Curve, rotation: np.ndarray) -> Curve:
    return lambda t: curve(t) @ rotation.T


def random_rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


@pytest.mark.parametrize("seed", range(8))
def test_a_flat_strip_is_one_run_in_any_pose(seed: int) -> None:
    rotation = random_rotation(seed)
    given = strip_between(
        turned(wave(0.0, 6.0, 11.0), rotation), turned(wave(25.0, 8.0, 9.0), rotation)
    )
    assert set(runs_of(*given).tolist()) == {0}
    normal = plane_normal(given[0], 0, len(given[0].steps))
    np.testing.assert_allclose(normal, rotation[:, 2] * np.linalg.det(rotation), atol=1e-12)


def test_the_legs_of_a_fold_are_runs_of_their_own() -> None:
    def fold(y: float) -> Curve:
        return rail(lambda t: 40.0 * t, constant(y), lambda t: 10.0 * np.abs(t - 0.5))

    given = strip_between(fold(0.0), fold(10.0), breaks=(0.5,))
    assert runs_of(*given).tolist() == [0, 0, 1, 1]
    assert spans_of(runs_of(*given)) == [(0, 2), (2, 4)]


def test_a_cylinder_has_no_runs() -> None:
    def arc(y: float) -> Curve:
        return rail(lambda t: 20.0 * np.cos(t), constant(y), lambda t: 20.0 * np.sin(t))

    assert set(runs_of(*strip_between(arc(0.0), arc(30.0))).tolist()) == {-1}


def test_a_strip_that_is_nearly_flat_has_no_runs() -> None:
    def bent(y: float) -> Curve:
        return rail(lambda t: 100.0 * t, lambda t: y + np.sin(5.0 * t), lambda t: 1e-2 * t * t)

    assert set(runs_of(*strip_between(bent(0.0), bent(20.0))).tolist()) == {-1}


def test_a_flat_spiral_that_covers_itself_is_cut() -> None:
    def spiral(radius: float) -> Curve:
        return rail(
            lambda t: radius * np.cos(8.0 * t), lambda t: radius * np.sin(8.0 * t), constant(0.0)
        )

    runs = runs_of(*strip_between(spiral(30.0), spiral(40.0)))
    assert runs.min() == 0
    assert runs.max() >= 1


def folded_back() -> tuple[Triangulation, tuple[Curve, Curve], tuple[Samples, Samples]]:
    """Two flat triangles, the second one lying on the first."""
    p = np.array([(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (4.0, 1.0, 0.0)])
    q = np.array([(0.0, 10.0, 0.0), (10.0, 11.0, 0.0)])
    steps = np.array([0, 0, 1], dtype=np.int8)
    made = measured(
        p, q, steps, planarity=1e-6, criteria=("area",), search="global", energy="hinge"
    )

    def polyline(points: np.ndarray) -> tuple[Curve, Samples]:
        at = np.arange(len(points), dtype=float)
        curve = lambda t: np.column_stack([np.interp(t, at, axis) for axis in points.T])  # noqa: E731
        return curve, Samples(at, points.copy())

    (p_at, p_samples), (q_at, q_samples) = polyline(p), polyline(q)
    return made, (p_at, q_at), (p_samples, q_samples)


def test_triangles_that_lie_on_each_other_are_not_one_run() -> None:
    runs = runs_of(*folded_back())
    assert runs[0] != runs[1]


def test_a_bank_may_turn_back_where_the_strip_is_flat() -> None:
    p_at = rail(lambda t: 100.0 * t, lambda t: 0.4 * np.sin(30.0 * t), constant(0.0))
    q_at = rail(lambda t: 100.0 * t, constant(8.0), constant(0.0))
    # The bridges lean so much that, seen from their ends, the wave turns back between samples.
    samples = (
        Samples(np.linspace(0.0, 1.0, 3), p_at(np.linspace(0.0, 1.0, 3))),
        Samples(np.linspace(0.0, 1.0, 2), q_at(np.linspace(0.0, 1.0, 2))),
    )
    triangulation = triangulate(samples[0].points, samples[1].points, criteria=("area",))
    flat = unroll_cones(triangulation, *samples, p_at, q_at, tolerance=1e-3)
    t = np.linspace(0.0, 1.0, 200_001)
    area = 800.0 - float(np.trapezoid(p_at(t)[:, 1], p_at(t)[:, 0]))
    assert flat.area == pytest.approx(area, rel=1e-9)
    assert flat.turned_back_count == 0
    line = flat.p_line
    apart = np.linalg.norm(line - line[0], axis=1)
    own = np.linalg.norm(p_at(t) - p_at(t)[0], axis=1)
    arc = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(p_at(t), axis=0), axis=1))))
    np.testing.assert_allclose(apart, np.interp(flat.p_arc, arc, own), atol=1e-6)

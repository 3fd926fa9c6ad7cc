from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.strip import exact_strips
from tests.strip.exact_strips import stack
from wrinkle_cad.strip import Triangulation, covered_lengths, find_invalid_runs, triangulate


def lengths_of(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def hyperbolic_paraboloid(slope: float) -> Triangulation:
    t = np.linspace(0.0, 4.0, 60)
    p, q = stack(t, 0 * t, 0 * t), stack(t, 1.0 + 0 * t, slope * t)
    return triangulate(p, q, criteria=("length",))


def test_invalid_runs_are_the_runs_of_invalid_interior_bridges() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    runs = find_invalid_runs(found)
    numbers = [k for run in runs for k in range(run.first, run.last + 1)]
    assert numbers == (np.flatnonzero(~found.valid[1:-1]) + 1).tolist()
    assert all(a.last + 1 < b.first for a, b in pairwise(runs))
    for run in runs:
        assert run.start == tuple(found.bridges[run.first])
        assert run.end == tuple(found.bridges[run.last])


def test_lengths_of_all_runs_are_those_of_all_invalid_bridges() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    runs = find_invalid_runs(found)
    invalid = ~found.valid
    invalid[[0, -1]] = False
    p_length, q_length = covered_lengths(found, invalid)
    assert sum(run.p_length for run in runs) == pytest.approx(p_length)
    assert sum(run.q_length for run in runs) == pytest.approx(q_length)


def test_all_bridges_together_cover_both_rails() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    everything = covered_lengths(found, np.ones(len(found.bridges), dtype=bool))
    assert everything == pytest.approx((lengths_of(strip.p), lengths_of(strip.q)))
    assert covered_lengths(found, np.zeros(len(found.bridges), dtype=bool)) == (0.0, 0.0)


def test_a_developable_strip_has_no_invalid_run() -> None:
    strip = exact_strips.convex_cone(1).sampled(1e-3)
    assert find_invalid_runs(triangulate(strip.p, strip.q)) == ()


@pytest.mark.parametrize("family", exact_strips.WAVY)
def test_invalid_runs_of_developables_are_inflections(family) -> None:
    strip = family(1).sampled(1e-3)
    kinds = {run.kind for run in find_invalid_runs(triangulate(strip.p, strip.q))}
    assert kinds == {"inflection"}


@pytest.mark.parametrize("slope", [0.3, -0.3])
def test_a_hyperbolic_paraboloid_is_twisted_with_the_sign_of_its_slope(slope: float) -> None:
    runs = find_invalid_runs(hyperbolic_paraboloid(slope))
    assert {run.kind for run in runs} == {"twist"}
    # Seen along the first rulings, from P to Q, the tangent of Q is turned by atan(slope).
    assert max(abs(run.angle_defect) for run in runs) == pytest.approx(np.arctan(0.3), rel=0.02)
    assert {np.sign(run.angle_defect) for run in runs} == {-np.sign(slope)}


def test_a_fan_whose_apex_leaves_the_plane_is_called_so() -> None:
    kinds = set()
    for seed in range(4):
        strip = exact_strips.wrinkled(seed).sampled(1e-3)
        for run in find_invalid_runs(triangulate(strip.p, strip.q)):
            kinds.add(run.kind)
            if run.kind == "fan end":
                assert run.twist <= 0.5 * abs(run.angle_defect)
    assert "fan end" in kinds

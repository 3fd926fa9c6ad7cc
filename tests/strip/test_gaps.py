from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.strip import exact_strips
from tests.strip.exact_strips import stack
from wrinkle_cad.strip import Triangulation, covered_lengths, find_gaps, triangulate


def lengths_of(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def hyperbolic_paraboloid(slope: float) -> Triangulation:
    t = np.linspace(0.0, 4.0, 60)
    p, q = stack(t, 0 * t, 0 * t), stack(t, 1.0 + 0 * t, slope * t)
    return triangulate(p, q, criteria=("length",))


def test_gaps_are_the_runs_of_invalid_interior_bridges() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    gaps = find_gaps(found)
    numbers = [k for gap in gaps for k in range(gap.first, gap.last + 1)]
    assert numbers == (np.flatnonzero(~found.valid[1:-1]) + 1).tolist()
    assert all(a.last + 1 < b.first for a, b in pairwise(gaps))
    for gap in gaps:
        assert gap.start == tuple(found.bridges[gap.first])
        assert gap.end == tuple(found.bridges[gap.last])


def test_lengths_of_all_gaps_are_those_of_all_invalid_bridges() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    gaps = find_gaps(found)
    invalid = ~found.valid
    invalid[[0, -1]] = False
    p_length, q_length = covered_lengths(found, invalid)
    assert sum(gap.p_length for gap in gaps) == pytest.approx(p_length)
    assert sum(gap.q_length for gap in gaps) == pytest.approx(q_length)


def test_all_bridges_together_cover_both_rails() -> None:
    strip = exact_strips.wrinkled(3).sampled(1e-3)
    found = triangulate(strip.p, strip.q)
    everything = covered_lengths(found, np.ones(len(found.bridges), dtype=bool))
    assert everything == pytest.approx((lengths_of(strip.p), lengths_of(strip.q)))
    assert covered_lengths(found, np.zeros(len(found.bridges), dtype=bool)) == (0.0, 0.0)


def test_a_developable_strip_has_no_gap() -> None:
    strip = exact_strips.convex_cone(1).sampled(1e-3)
    assert find_gaps(triangulate(strip.p, strip.q)) == ()


@pytest.mark.parametrize("family", exact_strips.WAVY)
def test_gaps_of_developables_are_inflections(family) -> None:
    strip = family(1).sampled(1e-3)
    kinds = {gap.kind for gap in find_gaps(triangulate(strip.p, strip.q))}
    assert kinds == {"inflection"}


@pytest.mark.parametrize("slope", [0.3, -0.3])
def test_a_hyperbolic_paraboloid_is_twisted_with_the_sign_of_its_slope(slope: float) -> None:
    gaps = find_gaps(hyperbolic_paraboloid(slope))
    assert {gap.kind for gap in gaps} == {"twist"}
    # Seen along the first rulings, from P to Q, the tangent of Q is turned by atan(slope).
    assert max(abs(gap.angle_defect) for gap in gaps) == pytest.approx(np.arctan(0.3), rel=0.02)
    assert {np.sign(gap.angle_defect) for gap in gaps} == {-np.sign(slope)}


def test_a_fan_whose_apex_leaves_the_plane_is_called_so() -> None:
    kinds = set()
    for seed in range(4):
        strip = exact_strips.wrinkled(seed).sampled(1e-3)
        for gap in find_gaps(triangulate(strip.p, strip.q)):
            kinds.add(gap.kind)
            if gap.kind == "fan end":
                assert gap.twist <= 0.5 * abs(gap.angle_defect)
    assert "fan end" in kinds

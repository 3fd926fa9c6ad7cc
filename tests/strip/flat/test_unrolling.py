from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.interpolate import BSpline

from tests.seeds import seeds
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.sampling import Samples, sample_curve
from wrinkle_cad.strip.flat.unrolling import Unrolling, unroll, unroll_cones
from wrinkle_cad.strip.triangulation import P_STEP, Triangulation, measured, triangulate

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], FloatArray]


class Strip(NamedTuple):
    p_at: Curve
    q_at: Curve
    interval: tuple[float, float]
    flat_p: Curve | None = None
    flat_q: Curve | None = None


def on_cylinder(height: Callable[[FloatArray], FloatArray]) -> tuple[Curve, Curve]:
    """A curve on a cylinder of radius 20 and the same curve in the plane."""
    return (
        lambda t: np.stack((20 * np.cos(t), 20 * np.sin(t), height(t)), axis=1),
        lambda t: np.stack((20 * t, height(t)), axis=1),
    )


def on_cone(distance: Callable[[FloatArray], FloatArray]) -> tuple[Curve, Curve]:
    """A curve on a cone of half angle 0.5 at the origin and the same curve in the plane."""
    sine, cosine = np.sin(0.5), np.cos(0.5)

    def in_space(t: FloatArray) -> FloatArray:
        unit = np.stack((sine * np.cos(t), sine * np.sin(t), cosine + 0 * t), axis=1)
        return distance(t)[:, None] * unit

    def in_plane(t: FloatArray) -> FloatArray:
        return distance(t)[:, None] * np.stack((np.cos(sine * t), np.sin(sine * t)), axis=1)

    return in_space, in_plane


def strip_of(p: tuple[Curve, Curve], q: tuple[Curve, Curve], end: float) -> Strip:
    return Strip(p[0], q[0], (0.0, end), p[1], q[1])


CYLINDER = strip_of(
    on_cylinder(lambda t: 2 * np.sin(3 * t)), on_cylinder(lambda t: 15 + np.cos(2 * t)), 2.5
)
CONE = strip_of(
    on_cone(lambda t: 60 + 3 * np.sin(2 * t)), on_cone(lambda t: 40 + 2 * np.cos(3 * t)), 3.0
)
LENS = strip_of(
    on_cylinder(lambda t: -4 * np.sin(t) ** 2), on_cylinder(lambda t: 5 * np.sin(t)), np.pi
)
SPACE = Strip(
    BSpline([0, 0, 0, 0, 0.3, 0.6, 1, 1, 1, 1], np.random.default_rng(2).uniform(0, 30, (6, 3)), 3),
    BSpline(
        [0, 0, 0, 0.5, 1, 1, 1],
        np.random.default_rng(5).uniform([0, 0, 40], [30, 30, 70], (4, 3)),
        2,
    ),
    (0.0, 1.0),
)
STRIPS = {"cylinder": CYLINDER, "cone": CONE, "lens": LENS, "space": SPACE}


class Sampled(NamedTuple):
    triangulation: Triangulation
    p_samples: Samples
    q_samples: Samples


def sampled(strip: Strip, tolerance: float) -> Sampled:
    p_samples = sample_curve(strip.p_at, strip.interval, tolerance)
    q_samples = sample_curve(strip.q_at, strip.interval, tolerance)
    return Sampled(triangulate(p_samples.points, q_samples.points), p_samples, q_samples)


def evenly(strip: Strip, count: int) -> Sampled:
    parameters = np.linspace(*strip.interval, count)
    p_samples = Samples(parameters.copy(), strip.p_at(parameters))
    q_samples = Samples(parameters.copy(), strip.q_at(parameters))
    return Sampled(triangulate(p_samples.points, q_samples.points), p_samples, q_samples)


def with_cones(strip: Strip, sampling: Sampled, tolerance: float = 0.01) -> Unrolling:
    return unroll_cones(*sampling, strip.p_at, strip.q_at, tolerance=tolerance)


def lengths(points: FloatArray) -> FloatArray:
    return np.linalg.norm(np.diff(points, axis=0), axis=1)


def misfit(found: FloatArray, true: FloatArray) -> float:
    """Largest distance after the best rigid motion (Kabsch, no reflection)."""
    a, b = found - found.mean(axis=0), true - true.mean(axis=0)
    angle = np.arctan2(
        np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1])
    )
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return float(np.max(np.linalg.norm(a @ turn - b, axis=1)))


def closed_form_misfit(strip: Strip, sampling: Sampled, flat: Unrolling) -> float:
    assert strip.flat_p is not None
    assert strip.flat_q is not None
    true = (
        strip.flat_p(sampling.p_samples.parameters),
        strip.flat_q(sampling.q_samples.parameters),
    )
    return misfit(np.concatenate((flat.p, flat.q)), np.concatenate(true))


def flat_of(triangulation: Triangulation, flat: Unrolling) -> FloatArray:
    """(m + n - 2, 3, 2): the triangles' corners in the plane."""
    return np.concatenate((flat.p, flat.q))[triangulation.triangles]


def sides(corners: FloatArray) -> FloatArray:
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


@pytest.mark.parametrize("name", STRIPS)
@pytest.mark.parametrize("tolerance", [0.5, 0.01, 1e-4])
def test_every_edge_of_a_facet_is_as_long_as_in_space(name: str, tolerance: float) -> None:
    triangulation = sampled(STRIPS[name], tolerance).triangulation
    flat = unroll(triangulation)
    corners = np.concatenate((triangulation.p, triangulation.q))[triangulation.triangles]
    in_space, in_plane = sides(corners), sides(flat_of(triangulation, flat))
    is_edge = in_space > 1e-9
    assert np.max(np.abs(in_plane - in_space)[is_edge] / in_space[is_edge]) < 1e-12
    assert np.max(np.abs(in_plane - in_space)[~is_edge], initial=0.0) < 1e-12
    assert flat.area == pytest.approx(triangulation.area, rel=1e-12)


def test_the_comparison_of_edges_sees_a_moved_point() -> None:
    triangulation = sampled(CYLINDER, 0.01).triangulation
    flat = unroll(triangulation)
    corners = flat_of(triangulation, flat).copy()
    corners[5, 0, 0] += 1e-9
    assert np.max(np.abs(sides(corners) / sides(flat_of(triangulation, flat)) - 1)) > 1e-12


@pytest.mark.parametrize("name", STRIPS)
def test_triangles_are_counter_clockwise_and_start_at_the_origin(name: str) -> None:
    strip = STRIPS[name]
    sampling = sampled(strip, 0.05)
    for flat in (unroll(sampling.triangulation), with_cones(strip, sampling)):
        a, b, c = np.moveaxis(flat_of(sampling.triangulation, flat), 1, 0)
        doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        assert doubled.min() > -1e-9
        assert np.array_equal(flat.p[0], [0, 0])
        assert flat.q[0, 0] == 0
        assert not flat.overlaps


@pytest.mark.parametrize("name", STRIPS)
@pytest.mark.parametrize("tolerance", [0.5, 0.02, 1e-3])
def test_cones_keep_the_lengths_of_curves_and_bridges(name: str, tolerance: float) -> None:
    strip = STRIPS[name]
    sampling = sampled(strip, tolerance)
    flat = with_cones(strip, sampling, tolerance)
    for curve, found in ((strip.p_at, flat.p_length), (strip.q_at, flat.q_length)):
        dense = curve(np.linspace(*strip.interval, 2_000_001))
        assert found == pytest.approx(np.sum(lengths(dense)), rel=1e-9)
    i, j = sampling.triangulation.bridges.T
    in_space = np.linalg.norm(sampling.triangulation.p[i] - sampling.triangulation.q[j], axis=1)
    assert np.linalg.norm(flat.p[i] - flat.q[j], axis=1) == pytest.approx(in_space, abs=1e-11)


def cone_faces_area(strip: Strip, sampling: Sampled) -> float:
    """Area of the cones as surfaces, from thin triangles between rulings."""
    area = 0.0
    for step, (i, j) in zip(
        sampling.triangulation.steps, sampling.triangulation.bridges[:-1], strict=True
    ):
        samples, k = (sampling.p_samples, i) if step == P_STEP else (sampling.q_samples, j)
        curve = strip.p_at if step == P_STEP else strip.q_at
        apex = sampling.triangulation.q[j] if step == P_STEP else sampling.triangulation.p[i]
        points = curve(np.linspace(samples.parameters[k], samples.parameters[k + 1], 2001)) - apex
        area += 0.5 * np.sum(np.linalg.norm(np.cross(points[:-1], points[1:]), axis=1))
    return area


@pytest.mark.parametrize("name", STRIPS)
def test_cones_keep_the_area_of_the_faces(name: str) -> None:
    strip = STRIPS[name]
    sampling = sampled(strip, 0.2)
    flat = with_cones(strip, sampling)
    assert flat.area == pytest.approx(cone_faces_area(strip, sampling), rel=1e-6)


@pytest.mark.parametrize("name", STRIPS)
def test_the_flat_lines_enclose_the_area(name: str) -> None:
    strip = STRIPS[name]
    flat = with_cones(strip, sampled(strip, 0.2), 1e-5)
    x, y = np.concatenate((flat.p_line, flat.q_line[::-1])).T
    shoelace = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert shoelace == pytest.approx(flat.area, rel=1e-5)


@pytest.mark.parametrize("strip", [CYLINDER, CONE, LENS], ids=["cylinder", "cone", "lens"])
@pytest.mark.parametrize("tolerance", [0.1, 0.01, 1e-3])
def test_cones_match_the_closed_form_within_the_tolerance(strip: Strip, tolerance: float) -> None:
    sampling = sampled(strip, tolerance)
    flat = with_cones(strip, sampling, tolerance)
    assert closed_form_misfit(strip, sampling, flat) <= tolerance


@pytest.mark.parametrize("strip", [CYLINDER, CONE, LENS], ids=["cylinder", "cone", "lens"])
def test_facets_converge_to_the_closed_form_with_the_square_of_the_spacing(strip: Strip) -> None:
    errors = []
    for count in (41, 81, 161):
        sampling = evenly(strip, count)
        errors.append(closed_form_misfit(strip, sampling, unroll(sampling.triangulation)))
    assert errors[0] / errors[1] >= 3.5
    assert errors[1] / errors[2] >= 3.5


def test_a_cone_about_its_own_apex_is_exact() -> None:
    p_at, flat_p = on_cone(lambda t: 60 + 3 * np.sin(2 * t))

    def q_at(t: FloatArray) -> FloatArray:
        return np.outer(1 - t, [0.0, 0.0, -30.0])

    p_ends, q_ends = np.linspace(0, 2, 5), np.array([0.0, 1.0])
    p_samples, q_samples = Samples(p_ends, p_at(p_ends)), Samples(q_ends, q_at(q_ends))
    triangulation = measured(
        p_samples.points,
        q_samples.points,
        np.array([1, 0, 0, 0, 0], dtype=np.int8),
        planarity=1e-6,
        criteria=("length",),
        search="global",
        energy="hinge",
    )
    flat = unroll_cones(triangulation, p_samples, q_samples, p_at, q_at, tolerance=1e-4)
    assert misfit(flat.p, flat_p(p_ends)) < 1e-10
    offset = flat.p_line - flat.q[1]
    start = np.arctan2(offset[0, 1], offset[0, 0])
    t = np.unwrap(np.arctan2(offset[:, 1], offset[:, 0]) - start) / np.sin(0.5)
    assert np.hypot(*offset.T) == pytest.approx(60 + 3 * np.sin(2 * t), abs=1e-9)
    assert len(t) > 50


def test_the_polar_angle_is_the_integral_by_arc_length() -> None:
    strip, sampling = SPACE, evenly(SPACE, 4)
    triangulation = sampling.triangulation
    flat = with_cones(strip, sampling)
    k = int(np.flatnonzero(triangulation.steps == P_STEP)[0])
    i, j = triangulation.bridges[k]
    apex = triangulation.q[j]
    slope = strip.p_at.derivative()  # type: ignore[attr-defined]

    def rate(t: float) -> float:
        offset, velocity = strip.p_at(np.array([t]))[0] - apex, slope(t)
        radius = np.linalg.norm(offset)
        radial = offset @ velocity / radius
        return float(np.sqrt(velocity @ velocity - radial**2) / radius)

    low, high = sampling.p_samples.parameters[i : i + 2]
    angle = quad(rate, low, high, epsabs=1e-12, epsrel=1e-12, points=[0.6], limit=200)[0]
    u, v = flat.p[i] - flat.q[j], flat.p[i + 1] - flat.q[j]
    assert np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v) == pytest.approx(angle, abs=1e-10)


@pytest.mark.parametrize("tolerance", [0.3, 0.01, 1e-4])
def test_lines_pass_through_the_samples_and_follow_the_flat_curves(tolerance: float) -> None:
    strip = CYLINDER
    sampling = evenly(strip, 12)
    flat, fine = with_cones(strip, sampling, tolerance), with_cones(strip, sampling, 1e-7)
    assert np.array_equal(flat.p_line[flat.p_index], flat.p)
    assert np.array_equal(flat.q_line[flat.q_index], flat.q)
    for line, dense in ((flat.p_line, fine.p_line), (flat.q_line, fine.q_line)):
        start, chord = line[:-1], np.diff(line, axis=0)
        offset = dense[:, None] - start
        share = np.clip(np.sum(offset * chord, axis=2) / np.sum(chord**2, axis=1), 0, 1)
        gaps = np.linalg.norm(offset - share[..., None] * chord, axis=2).min(axis=1)
        assert gaps.max() <= tolerance
    assert len(fine.p_line) > 10 * len(flat.p_line)


def test_arc_lengths_are_those_of_the_curve_in_space() -> None:
    strip = SPACE
    sampling = evenly(strip, 9)
    flat = with_cones(strip, sampling, 1e-3)
    dense = strip.p_at(np.linspace(0, 1, 1_600_001))
    arc = np.concatenate(([0.0], np.cumsum(lengths(dense))))[::200_000]
    assert flat.p_arc[flat.p_index] == pytest.approx(arc, abs=1e-8)
    assert flat.p_arc[-1] == flat.p_length
    steps = lengths(flat.p_line)
    assert np.all(steps <= np.diff(flat.p_arc) + 1e-9)
    assert np.sum(steps) == pytest.approx(flat.p_length, rel=1e-3)
    facets = unroll(sampling.triangulation)
    assert facets.p_length == pytest.approx(np.sum(lengths(sampling.triangulation.p)), rel=1e-14)


def rotation(seed: int) -> FloatArray:
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_rigid_motion_and_scale_do_nothing_else_to_the_plane(size: float) -> None:
    turn = size * rotation(1)
    moved = SPACE._replace(
        p_at=lambda t: SPACE.p_at(t) @ turn.T + 7 * size,
        q_at=lambda t: SPACE.q_at(t) @ turn.T + 7 * size,
    )
    plain, other = evenly(SPACE, 30), evenly(moved, 30)
    assert np.array_equal(plain.triangulation.steps, other.triangulation.steps)
    for first, second in (
        (unroll(plain.triangulation), unroll(other.triangulation)),
        (with_cones(SPACE, plain, 0.01), with_cones(moved, other, 0.01 * size)),
    ):
        assert second.p == pytest.approx(first.p * size, abs=1e-9 * size)
        assert second.q == pytest.approx(first.q * size, abs=1e-9 * size)
        assert second.area == pytest.approx(first.area * size**2, rel=1e-9)


def swapped(sampling: Sampled) -> Sampled:
    """The very same triangles, with P and Q in each other's place."""
    old = sampling.triangulation
    new = measured(
        old.q.copy(),
        old.p.copy(),
        (1 - old.steps).astype(np.int8),
        planarity=old.planarity,
        criteria=old.criteria,
        search=old.search,
        energy=old.energy,
    )
    return Sampled(new, sampling.q_samples, sampling.p_samples)


def turned_round(sampling: Sampled, end: float) -> Sampled:
    """The very same triangles, read from the other end."""
    old = sampling.triangulation
    new = measured(
        old.p[::-1].copy(),
        old.q[::-1].copy(),
        old.steps[::-1].copy(),
        planarity=old.planarity,
        criteria=old.criteria,
        search=old.search,
        energy=old.energy,
    )
    p, q = (
        Samples(end - samples.parameters[::-1], samples.points[::-1].copy())
        for samples in (sampling.p_samples, sampling.q_samples)
    )
    return Sampled(new, p, q)


@pytest.mark.parametrize("name", STRIPS)
def test_swapping_the_rails_mirrors_the_strip(name: str) -> None:
    strip = STRIPS[name]
    sampling = sampled(strip, 0.05)
    other = swapped(sampling)
    mirrored = strip._replace(p_at=strip.q_at, q_at=strip.p_at)
    for first, second in (
        (unroll(sampling.triangulation), unroll(other.triangulation)),
        (with_cones(strip, sampling), with_cones(mirrored, other)),
    ):
        whole = np.concatenate((first.p, first.q)) * [-1, 1]
        assert misfit(np.concatenate((second.q, second.p)), whole) < 1e-9
        assert second.area == pytest.approx(first.area, rel=1e-12)
        assert second.overlaps == first.overlaps


@pytest.mark.parametrize("name", STRIPS)
def test_reading_the_strip_from_its_other_end_mirrors_it(name: str) -> None:
    strip = STRIPS[name]
    sampling = sampled(strip, 0.05)
    end = strip.interval[1]
    other = turned_round(sampling, end)
    back = strip._replace(p_at=lambda t: strip.p_at(end - t), q_at=lambda t: strip.q_at(end - t))
    for first, second in (
        (unroll(sampling.triangulation), unroll(other.triangulation)),
        (with_cones(strip, sampling), with_cones(back, other)),
    ):
        whole = np.concatenate((first.p, first.q)) * [-1, 1]
        found = np.concatenate((second.p[::-1], second.q[::-1]))
        assert misfit(found, whole) < 1e-8
        assert second.p_length == pytest.approx(first.p_length, rel=1e-9)


def test_rails_that_meet_at_both_ends_have_bridges_of_no_length() -> None:
    sampling = sampled(LENS, 0.01)
    flat = with_cones(LENS, sampling)
    assert np.linalg.norm(flat.p[0] - flat.q[0]) < 1e-12
    assert np.linalg.norm(flat.p[-1] - flat.q[-1]) < 1e-12
    assert flat.p[-1, 0] ** 2 + flat.p[-1, 1] ** 2 == pytest.approx((20 * np.pi) ** 2, rel=1e-3)
    assert np.all(np.isfinite(flat.p_line))


def test_rails_that_touch_on_the_way_and_points_that_repeat_keep_every_length() -> None:
    t = np.linspace(0, 3, 31)
    wave = 3 * np.abs(np.sin(t * np.pi / 1.5))
    p = np.stack((10 * t, -wave, 0 * t), axis=1)
    q = np.stack((10 * t, wave, t), axis=1)
    q[[0, 15, 30]] = p[[0, 15, 30]]
    for rail in (p, np.insert(p, 7, p[7], axis=0)):
        triangulation = triangulate(rail, q)
        flat = unroll(triangulation)
        corners = np.concatenate((triangulation.p, triangulation.q))[triangulation.triangles]
        assert sides(flat_of(triangulation, flat)) == pytest.approx(sides(corners), abs=1e-13)
        assert not flat.overlaps


@pytest.mark.parametrize("seed", seeds(40))
def test_random_strips_keep_every_length(seed: int) -> None:
    generator = np.random.default_rng(seed)
    m, n = generator.integers(2, 9, 2)
    p, q = generator.normal(size=(m, 3)), generator.normal(size=(n, 3))
    if seed % 3 == 0:
        q[0] = p[0]
    if seed % 5 == 0:
        q[-1] = p[-1]
    triangulation = triangulate(p, q)
    corners = np.concatenate((p, q))[triangulation.triangles]
    found = sides(flat_of(triangulation, unroll(triangulation)))
    assert found == pytest.approx(sides(corners), rel=1e-12, abs=1e-14)


def test_a_planar_strip_stays_as_it_is() -> None:
    p_at: Curve = lambda t: np.stack((10 * t, np.sin(2 * t), 0 * t), axis=1)  # noqa: E731
    q_at: Curve = lambda t: np.stack((10 * t, 6 + np.cos(3 * t), 0 * t), axis=1)  # noqa: E731
    strip = Strip(p_at, q_at, (0.0, 3.0), lambda t: p_at(t)[:, :2], lambda t: q_at(t)[:, :2])
    p_samples = sample_curve(p_at, strip.interval, 1e-3)
    q_samples = sample_curve(q_at, strip.interval, 1e-3)
    triangulation = triangulate(p_samples.points, q_samples.points, criteria=("length",))
    sampling = Sampled(triangulation, p_samples, q_samples)
    flat = with_cones(strip, sampling)
    assert flat.turned_back_count == 0
    assert closed_form_misfit(strip, sampling, flat) < 1e-9
    assert closed_form_misfit(strip, sampling, unroll(triangulation)) < 1e-11


def test_a_cone_whose_segment_turns_back_is_counted_and_keeps_its_lengths() -> None:
    p_at: Curve = lambda t: np.stack((t, 3 * np.sin(t), 0 * t), axis=1)  # noqa: E731
    q_at: Curve = lambda t: np.stack((-1 - t, 0.3 + 0 * t, 0 * t), axis=1)  # noqa: E731
    ends = np.array([0.0, 3.0])
    p_samples, q_samples = Samples(ends, p_at(ends)), Samples(ends.copy(), q_at(ends))
    triangulation = triangulate(p_samples.points, q_samples.points, criteria=("length",))
    assert triangulation.steps.tolist() == [0, 1]
    flat = unroll_cones(triangulation, p_samples, q_samples, p_at, q_at, tolerance=0.01)
    assert flat.turned_back_count == 1
    dense = p_at(np.linspace(0, 3, 1_000_001))
    assert flat.p_length == pytest.approx(np.sum(lengths(dense)), rel=1e-9)
    fan = np.linalg.norm(np.cross(dense[:-1] - q_samples.points[0], dense[1:] - dense[:-1]), axis=1)
    triangle = triangulation.area - 0.5 * np.linalg.norm(
        np.cross(
            p_samples.points[0] - q_samples.points[0], p_samples.points[1] - p_samples.points[0]
        )
    )
    assert flat.area == pytest.approx(0.5 * np.sum(fan) + triangle, rel=1e-8)


def test_a_curve_with_knots_inside_a_segment_is_followed() -> None:
    knots = [0, 0, 0, 0.21, 0.22, 0.23, 0.61, 1, 1, 1]
    poles = np.random.default_rng(8).uniform(0, 30, (7, 3))
    strip = SPACE._replace(p_at=BSpline(knots, poles, 2))
    sampling = evenly(strip, 5)
    flat = with_cones(strip, sampling)
    slope = strip.p_at.derivative()  # type: ignore[attr-defined]
    length = quad(
        lambda t: float(np.linalg.norm(slope(t))), 0, 1, points=knots[3:7], epsrel=1e-12, limit=400
    )[0]
    assert flat.p_length == pytest.approx(length, rel=1e-9)
    assert flat.area == pytest.approx(cone_faces_area(strip, sampling), rel=1e-6)
    assert len(flat.p_line) < 400


def annulus(turns: float, *, pitch: float = 0.0, count: int = 121) -> Unrolling:
    """A flat ring-shaped strip; with a pitch it is a spiral that clears itself after a turn."""
    angle = np.linspace(0, 2 * np.pi * turns, count)
    radius = 30 + pitch * angle / (2 * np.pi)
    unit = np.stack((np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    strip = triangulate(
        (radius + 5)[:, None] * unit, (radius - 5)[:, None] * unit, criteria=("length",)
    )
    return unroll(strip)


@pytest.mark.parametrize(
    ("turns", "pitch", "overlaps"),
    [
        (0.5, 0.0, False),
        (0.999, 0.0, False),
        (1.0, 0.0, False),
        (1.001, 0.0, True),
        (1.2, 0.0, True),
        (2.5, 0.0, True),
        (1.5, 12.0, False),
        (3.5, 10.5, False),
        (3.5, 9.5, True),
        (1.5, 6.0, True),
        (1.02, 9.0, True),
    ],
)
def test_a_strip_overlaps_where_it_lies_over_itself_and_not_where_it_touches(
    turns: float, pitch: float, overlaps: bool
) -> None:
    assert annulus(turns, pitch=pitch).overlaps is overlaps
    assert annulus(turns, pitch=pitch, count=1000).overlaps is overlaps


def test_an_overlap_with_equal_corners_is_seen() -> None:
    assert annulus(1.25, count=51).overlaps
    assert annulus(2.0, count=81).overlaps


@pytest.mark.parametrize(("turn", "overlaps"), [(7.0, False), (8.0, True)])
def test_a_fan_overlaps_when_its_flat_angle_is_more_than_a_full_turn(
    turn: float, overlaps: bool
) -> None:
    angle = np.linspace(0, turn, 60)
    p = np.stack((10 * np.cos(angle), 10 * np.sin(angle), np.linspace(0.2, 12.0, 60)), axis=1)
    flat = unroll(triangulate(p, np.array([[0.0, 0, 0], [0.0, 0, 1e-3]]), criteria=("length",)))
    rays = flat.p - flat.q[0]
    heading = np.unwrap(np.arctan2(rays[:, 1], rays[:, 0]))
    assert (abs(heading[-1] - heading[0]) > 2 * np.pi) == overlaps
    assert flat.overlaps == overlaps


def test_results_are_read_only_and_repeatable() -> None:
    sampling = sampled(SPACE, 0.01)
    flat, again = with_cones(SPACE, sampling), with_cones(SPACE, sampling)
    for name in ("p", "q", "p_line", "q_line", "p_arc", "q_arc", "p_index", "q_index"):
        array = getattr(flat, name)
        assert array.tobytes() == getattr(again, name).tobytes()
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_a_rail_of_one_sample_unrolls_into_a_point() -> None:
    ring = lambda t: np.stack((np.cos(t), np.sin(t), 0 * t), axis=1)  # noqa: E731
    arc = sample_curve(ring, (0.0, 2.0), 1e-3)
    apex = Samples(np.zeros(1), np.array([[0.0, 0.0, 1.0]]))
    for p, q in ((arc, apex), (apex, arc)):
        found = triangulate(p.points, q.points)
        flat = unroll_cones(found, p, q, ring, ring, tolerance=1e-3)
        assert flat.area == pytest.approx(np.sqrt(2.0), rel=1e-12)
        assert sorted((flat.p_length, flat.q_length)) == pytest.approx([0.0, 2.0])
        assert not flat.overlaps


def test_wrong_input_is_refused() -> None:
    sampling = sampled(CYLINDER, 0.1)
    for tolerance in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match=r"^tolerance cannot be .* mm: give a finite"):
            with_cones(CYLINDER, sampling, tolerance)
    other = sampled(CYLINDER, 0.01)
    with pytest.raises(InputError, match=r"^P has \d+ samples for \d+ points"):
        with_cones(CYLINDER, sampling._replace(p_samples=other.p_samples))
    moved = Samples(sampling.q_samples.parameters, sampling.q_samples.points + 0.1)
    with pytest.raises(InputError, match=r"^The samples of Q lie up to 0\.1 mm"):
        with_cones(CYLINDER, sampling._replace(q_samples=moved))
    broken = CYLINDER._replace(
        p_at=lambda t: CYLINDER.p_at(t) * np.where(t > 1, np.nan, 1)[:, None]
    )
    with pytest.raises(InputError, match="NaN or infinite point"):
        with_cones(broken, sampling)

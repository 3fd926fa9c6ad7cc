from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest

from tests.seeds import seeds
from tests.strip import exact_strips
from tests.strip.rulings.rails import Rails, analytic, bumps, circle, ruled, stack
from wrinkle_cad.strip.flat.ruled import FlatPiece, lay_flat
from wrinkle_cad.strip.rulings.family import RulingFamily, family_of
from wrinkle_cad.strip.rulings.rail_curve import RailCurve

Floats = npt.NDArray[np.float64]


def flat_pieces(rails: Rails, tolerance: float = 0.05) -> list[tuple[RulingFamily, FlatPiece]]:
    """The pieces of a strip laid flat one after the other, each where the one before it ends."""
    strip = ruled(rails, tolerance)
    found: list[tuple[RulingFamily, FlatPiece]] = []
    start = np.zeros((2, 2))
    for piece in strip.pieces:
        family = family_of(strip, piece, *rails)
        if not found:
            p, q = family.points_at(np.zeros(1))
            start[1, 1] = np.linalg.norm(q - p)
        flat = lay_flat(family, start)
        found.append((family, flat))
        start = np.stack((flat.p[-1], flat.q[-1]))
    return found


def auger_rail(radius: float) -> RailCurve:
    """Where the tangents of a helix of radius 8 and pitch 40 reach a radius."""
    inner, rise = 8.0, 40.0 / (2.0 * math.pi)
    along = math.sqrt(radius**2 - inner**2) / inner
    return RailCurve(
        lambda w: stack(
            inner * (np.cos(w) - along * np.sin(w)),
            inner * (np.sin(w) + along * np.cos(w)),
            rise * (w + along),
        ),
        lambda w: stack(
            inner * (-np.sin(w) - along * np.cos(w)),
            inner * (np.cos(w) - along * np.sin(w)),
            rise,
        ),
        (0.0, 2.0 * math.pi),
    )


def centre_and_radius(points: Floats) -> tuple[Floats, float]:
    matrix = np.column_stack((2.0 * points, np.ones(len(points))))
    x, y, rest = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    return np.array([x, y]), math.sqrt(rest + x * x + y * y)


def test_a_convolute_auger_flight_is_an_annular_sector() -> None:
    ((family, flat),) = flat_pieces((auger_rail(10.0), auger_rail(30.0)))
    assert flat.area == pytest.approx(3211.938171, rel=1e-9)
    (centre, inner), (other, outer) = (centre_and_radius(points) for points in (flat.p, flat.q))
    np.testing.assert_allclose(centre, other, atol=1e-9)
    assert (inner, outer) == pytest.approx((15.14989, 39.19343), abs=1e-5)
    for points, radius in ((flat.p, inner), (flat.q, outer)):
        np.testing.assert_allclose(np.linalg.norm(points - centre, axis=1), radius, rtol=1e-12)
    assert math.degrees(flat.p_length / inner) == pytest.approx(281.6924, abs=1e-4)
    assert flat.p_length == pytest.approx(family.p.length, rel=1e-11)
    assert flat.q_length == pytest.approx(family.q.length, rel=1e-11)


def test_a_frustum_is_an_annular_sector() -> None:
    ((_, flat),) = flat_pieces((circle(50.0, 0.0), circle(30.0, 80.0)))
    slant = math.hypot(20.0, 80.0)
    assert flat.area == pytest.approx(2.0 / 2.0 * (50.0 + 30.0) * slant, rel=1e-12)
    radii = [centre_and_radius(points)[1] for points in (flat.p, flat.q)]
    assert radii == pytest.approx([50.0 * slant / 20.0, 30.0 * slant / 20.0], rel=1e-9)


@pytest.mark.parametrize("seed", seeds(40, 4))
@pytest.mark.parametrize(
    "make",
    [
        exact_strips.cylinder,
        exact_strips.cone,
        exact_strips.tangent_developable,
        exact_strips.convex_tangent_developable,
    ],
)
def test_lengths_rulings_and_areas_stay_as_in_space(make: exact_strips.Curve, seed: int) -> None:
    exact = make(seed)
    rails = analytic(exact.p_at, exact.interval), analytic(exact.q_at, exact.interval)
    found = flat_pieces(rails, 5e-4)
    for side, rail in enumerate(rails):
        whole = sum((flat.p_length, flat.q_length)[side] for _, flat in found)
        assert whole == pytest.approx(rail.length, rel=1e-9)
    for family, flat in found:
        p, q = family.points_at(flat.places)
        reach = np.linalg.norm(q - p, axis=1)
        np.testing.assert_allclose(np.linalg.norm(flat.q - flat.p, axis=1), reach, rtol=1e-12)
        fine = np.linspace(0.0, 1.0, 4001)
        start, end = family.points_at(fine)
        # A quadrilateral of two chords and two rulings, as the mean of both ways to halve it.
        one = np.cross(start[1:] - start[:-1], end[1:] - start[:-1])
        two = np.cross(end[1:] - start[:-1], end[:-1] - start[:-1])
        other = np.cross(start[1:] - start[:-1], end[:-1] - start[:-1])
        rest = np.cross(end[:-1] - end[1:], start[1:] - end[1:])
        halves = [np.linalg.norm(each, axis=1).sum() for each in (one, two, other, rest)]
        assert flat.area == pytest.approx(sum(halves) / 4.0, rel=1e-6)


def third_corner(first: Floats, second: Floats, from_first: float, from_second: float) -> Floats:
    """The point on the right of the way from one point to another, at distances from both."""
    way = second - first
    side = math.hypot(*way)
    along = (side**2 + from_first**2 - from_second**2) / (2.0 * side)
    across = math.sqrt(max(0.0, from_first**2 - along**2))
    point: Floats = first + (along * way + across * np.array([way[1], -way[0]])) / side
    return point


def triangle_by_triangle(start: Floats, end: Floats, first: Floats) -> tuple[Floats, Floats]:
    """Two rails laid flat by the law of cosines alone, from the first ruling's place in the plane.

    Of the two diagonals of each quadrilateral one is taken and then the other, in turn.
    """

    def apart(a: Floats, b: Floats) -> float:
        return math.dist(a, b)

    p, q = [first[0]], [first[1]]
    for k in range(len(start) - 1):
        a, b, c, d = start[k], start[k + 1], end[k], end[k + 1]
        if k % 2 == 0:
            p.append(third_corner(p[k], q[k], apart(a, b), apart(c, b)))
            q.append(third_corner(p[k + 1], q[k], apart(b, d), apart(c, d)))
        else:
            q.append(third_corner(p[k], q[k], apart(a, d), apart(c, d)))
            p.append(third_corner(p[k], q[k + 1], apart(a, b), apart(d, b)))
    return np.array(p), np.array(q)


@pytest.mark.parametrize("seed", seeds(20, 2))
@pytest.mark.parametrize(
    "make",
    [exact_strips.cylinder, exact_strips.cone, exact_strips.convex_tangent_developable],
)
def test_it_lies_where_many_thin_triangles_come_to_lie(make: exact_strips.Curve, seed: int) -> None:
    exact = make(seed)
    rails = analytic(exact.p_at, exact.interval), analytic(exact.q_at, exact.interval)
    ((family, flat),) = flat_pieces(rails, 5e-4)
    size = rails[0].length + rails[1].length
    errors = []
    for finer in (16, 64):
        share = np.arange(finer) / finer
        between = flat.places[:-1, None] + np.diff(flat.places)[:, None] * share
        at = np.append(between.ravel(), 1.0)
        first = np.stack((flat.p[0], flat.q[0]))
        p, q = triangle_by_triangle(*family.points_at(at), first)
        errors.append(max(np.abs(p[::finer] - flat.p).max(), np.abs(q[::finer] - flat.q).max()))
    # Four times as many triangles are sixteen times as close to it: it is what they converge to.
    assert errors[1] <= errors[0] / 12.0
    assert errors[1] <= 1e-6 * size


@pytest.mark.parametrize("seed", seeds(20, 3))
def test_seams_of_any_strip_are_as_long_flat_as_in_space_gaps_included(seed: int) -> None:
    rails = bumps(seed)
    found = flat_pieces(rails)
    lengths = [sum(flat.p_length for _, flat in found), sum(flat.q_length for _, flat in found)]
    assert lengths == pytest.approx([rail.length for rail in rails], rel=1e-6)
    for (_, before), (_, after) in pairwise(found):
        np.testing.assert_array_equal(before.p[-1], after.p[0])
        np.testing.assert_allclose(before.q[-1], after.q[0], atol=1e-9)

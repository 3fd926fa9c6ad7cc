from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from tests.seeds import seeds
from tests.strip import exact_strips
from tests.strip.rulings.rails import (
    Rails,
    analytic,
    bumps,
    circle,
    helicoid,
    percent_of_twist,
    polyline,
    reversed_rail,
    ruled,
    spiral,
    stack,
    twisted,
)
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip

Floats = npt.NDArray[np.float64]
CREASE = math.radians(5.0)

HELICOIDS = [(10.0, 0.01, 0.125), (10.0, 0.02, 0.496), (20.0, 0.0414, 7.605)]


def check_helicoid(strip: RuledStrip, width: float, rate: float, percent: float) -> None:
    exact = 100.0 * (1.0 - 1.0 / math.hypot(1.0, width * rate / 2.0))
    assert exact == pytest.approx(percent, abs=6e-4)
    assert 100.0 * strip.strain.largest == pytest.approx(exact, rel=0.01)
    assert 100.0 * strip.strain.percentile(0.95) == pytest.approx(exact, rel=0.01)
    assert strip.developable_share == 0.0
    assert strip.largest_twist == pytest.approx(2.0 * math.atan(width * rate / 2.0), rel=1e-3)
    assert not strip.creases


@pytest.mark.parametrize(("width", "rate", "percent"), HELICOIDS)
def test_a_helicoid_strains_a_sheet_by_the_closed_form(
    width: float, rate: float, percent: float
) -> None:
    straight = np.linspace(0.0, 100.0, 40)
    strip = rule_strip(*helicoid(width, rate), (straight, straight))
    check_helicoid(strip, width, rate, percent)


@pytest.mark.parametrize(("width", "rate", "percent"), HELICOIDS[:2])
@pytest.mark.parametrize("tolerance", [0.1, 0.002])
def test_a_triangulated_helicoid_strains_as_much(
    width: float, rate: float, percent: float, tolerance: float
) -> None:
    check_helicoid(ruled(helicoid(width, rate), tolerance), width, rate, percent)


def test_rails_of_a_steep_helicoid_also_span_half_a_cylinder_which_bends_less() -> None:
    strip = ruled(helicoid(20.0, 0.0414))
    assert [piece.kind for piece in strip.pieces] == ["cone", "torsal", "cone"]
    assert strip.strain.largest == pytest.approx(0.0, abs=1e-6)
    middle = slice(strip.pieces[1].first, strip.pieces[1].last)
    np.testing.assert_allclose(strip.radius[middle], 10.0, rtol=0.01)


def test_a_saddle_twists_by_the_angle_of_its_straight_rails() -> None:
    ends = [(-50.0, y, -50.0 * y / 40.0) for y in (-10.0, 10.0)]
    rails = tuple(polyline([(x, y, z), (-x, y, -z)]) for x, y, z in ends)
    strip = ruled((rails[0], rails[1]))
    twist = 2.0 * math.atan(10.0 / 40.0)
    assert strip.largest_twist == pytest.approx(twist, rel=1e-3)
    speed = 1.0  # both rails cross the middle ruling at right angles
    assert 100.0 * strip.strain.largest == pytest.approx(speed * percent_of_twist(twist), rel=0.01)


def test_skew_lines_stretch_a_sheet() -> None:
    strip = ruled((polyline([(0, 0, 0), (100, 0, 0)]), polyline([(0, 20, 0), (100, 20, 53)])))
    assert strip.strain.largest > 0.02
    assert strip.developable_share == 0.0


@pytest.mark.parametrize(("small", "radius"), [(3.0, 3.81084), (1.0, 1.29110)])
def test_a_frustum_is_bent_most_at_its_small_end(small: float, radius: float) -> None:
    slant = math.hypot(60.0, 50.0 - small)
    assert small * slant / 60.0 == pytest.approx(radius, rel=1e-4)
    strip = ruled((circle(50.0, 0.0), circle(small, 60.0)))
    assert [piece.kind for piece in strip.pieces] == ["torsal"]
    assert strip.smallest_bend_radius(CREASE) == pytest.approx(radius, rel=0.01)
    assert strip.strain.largest == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("tolerance", [0.1, 0.002])
def test_oblique_ends_of_a_cylinder_strain_nothing(tolerance: float) -> None:
    rails = (
        spiral(40.0, 0.0, 3.0, (0.0, 2.0)),
        spiral(40.0, 30.0, -2.0, (0.3, 2.4)),
    )
    strip = ruled(rails, tolerance)
    assert [piece.kind for piece in strip.pieces] == ["cone", "torsal", "cone"]
    assert strip.strain.largest == pytest.approx(0.0, abs=1e-9)
    assert strip.developable_share == pytest.approx(1.0, abs=1e-9)
    assert strip.smallest_bend_radius(CREASE) == pytest.approx(40.0, rel=0.01)
    middle = next(piece for piece in strip.pieces if piece.kind == "torsal")
    u, v = (
        getattr(strip.sheet.rulings, name)[middle.first : middle.last + 1] for name in ("u", "v")
    )
    np.testing.assert_allclose(u, v, atol=1e-6)


@pytest.mark.parametrize("seed", range(7))
@pytest.mark.parametrize(
    "family", [exact_strips.cylinder, exact_strips.cone, exact_strips.tangent_developable]
)
def test_exact_developables_are_torsal_all_along(family: exact_strips.Curve, seed: int) -> None:
    exact = family(seed)
    strip = ruled(
        (analytic(exact.p_at, exact.interval), analytic(exact.q_at, exact.interval)), 5e-4
    )
    assert strip.developable_share >= 0.995
    assert strip.strain.largest <= 1e-6
    assert not strip.creases
    if family is not exact_strips.tangent_developable:  # its rails span other developables, too
        rulings = strip.sheet.rulings
        on_exact = np.abs(rulings.u - rulings.v) <= 1e-4
        assert np.count_nonzero(on_exact) >= 0.99 * len(on_exact)


def test_a_folded_pair_of_rails_is_two_planes_and_a_crease() -> None:
    rails = tuple(polyline([(0, 0, z), (40, 0, z), (70, 30, z)]) for z in (0, 20))
    strip = ruled((rails[0], rails[1]))
    assert [piece.kind for piece in strip.pieces] == ["plane", "plane"]
    (crease,) = strip.creases
    assert math.degrees(crease.angle) == pytest.approx(45.0, abs=0.1)
    assert (crease.p_arc, crease.q_arc, crease.cause) == (40.0, 40.0, "corner")
    assert strip.smallest_bend_radius(CREASE) == 0.0
    assert strip.developable_share == 1.0


def test_a_zigzag_prism_is_creased_at_every_corner() -> None:
    corners = [(10.0 * i, 6.0 * (i % 2)) for i in range(9)]
    rails = tuple(polyline([(x, y, z) for x, z in corners]) for y in (0.0, 25.0))
    strip = ruled((rails[0], rails[1]))
    angles = [math.degrees(crease.angle) for crease in strip.creases]
    np.testing.assert_allclose(angles, 2.0 * math.degrees(math.atan(0.6)), atol=0.1)
    assert len(angles) == 7


def extruded(seed: int) -> tuple[Rails, Floats, Floats]:
    """A zigzag of any angles and its copy beside it; where its corners are, and their angles."""
    random = np.random.default_rng([21, seed])
    count = int(random.integers(3, 12))
    x = np.cumsum(random.uniform(4.0, 15.0, count))
    z = random.uniform(2.0, 9.0) * random.uniform(0.5, 1.5, count) * (np.arange(count) % 2)
    corners, by = stack(x, 0.0, z), np.array([random.uniform(-3.0, 3.0), 30.0, 0.0])
    legs = np.diff(corners, axis=0)
    normals = np.cross(legs, by)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    angle = np.degrees(np.arccos((normals[1:] * normals[:-1]).sum(axis=1)))
    at = np.cumsum(np.linalg.norm(legs, axis=1))[:-1]
    p, q = (polyline([tuple(point) for point in points]) for points in (corners, corners + by))
    return (p, q), at, angle


# Number 16 was a row of planes between corners that are not opposite each other.
@pytest.mark.parametrize("seed", [*seeds(200, default=6), 16])
def test_a_prism_is_creased_along_its_edges_and_nowhere_else(seed: int) -> None:
    rails, at, angle = extruded(seed)
    corners = np.concatenate(([0.0], at, [rails[0].length]))
    strip = rule_strip(*rails, (corners, corners))
    creases = strip.creases
    np.testing.assert_allclose([crease.p_arc for crease in creases], at, atol=1e-9)
    np.testing.assert_allclose([crease.q_arc for crease in creases], at, atol=1e-9)
    found = [math.degrees(crease.angle) for crease in creases]
    np.testing.assert_allclose(found, angle, atol=1e-6)
    assert strip.strain.largest == pytest.approx(0.0, abs=1e-12)


def test_a_leg_along_a_ruling_of_a_cylinder_folds_nothing() -> None:
    """A tab with an upright side: from that side to a point beside it there is no sheet."""
    radius, up = 40.0, 6.0

    def rolled(corners: list[tuple[float, float]]) -> RailCurve:
        at = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
        corner = np.array(corners)

        def point_at(u: Floats) -> Floats:
            x, y = (np.interp(u, at, corner[:, axis]) for axis in (0, 1))
            return stack(radius * np.cos(x / radius), y, radius * np.sin(x / radius))

        def velocity_at(u: Floats) -> Floats:
            leg = np.clip(np.searchsorted(at, u, side="right") - 1, 0, len(at) - 2)
            x = np.interp(u, at, corner[:, 0]) / radius
            dx, dy = (np.diff(corner, axis=0) / np.diff(at)[:, None])[leg].T
            return stack(-dx * np.sin(x), dy, dx * np.cos(x))

        return RailCurve(point_at, velocity_at, (0.0, float(at[-1])), tuple(at[1:-1].tolist()))

    for lean in (0.0, 1e-6, 3e-3, -3e-3):
        tab = [(0.0, 30.0), (24.0, 30.0), (24.0 + lean, 30.0 - up), (50.0, 23.0), (50.0, 30.0)]
        strip = ruled((rolled([(0.0, 0.0), (120.0, 0.0)]), rolled([*tab, (120.0, 30.0)])))
        assert not strip.creases
        assert strip.radius.min() == pytest.approx(radius, rel=0.02)
        assert strip.strain.largest < 1e-6


@pytest.mark.parametrize("away", [0.1, 1.0])
def test_close_to_the_edge_of_regression_the_radius_is_right(away: float) -> None:
    """On the tangents of a helix of radius a and pitch 2 pi b it is a / b times the way from it."""
    a, b, far = 20.0, 8.0, 15.0

    def along(way: float) -> RailCurve:
        s = way / math.hypot(a, b)
        return analytic(
            lambda u: stack(
                a * (np.cos(u) - s * np.sin(u)), a * (np.sin(u) + s * np.cos(u)), b * (u + s)
            ),
            (0.0, 2.0),
        )

    strip = ruled((along(away), along(away + far)))
    assert strip.developable_share == pytest.approx(1.0)
    assert strip.radius.min() == pytest.approx(away * a / b, rel=0.01)


def test_a_flat_strap_with_a_tab_is_one_plane() -> None:
    strip = ruled(
        (
            polyline([(0, 0, 0), (40, 0, 0), (50, -15, 0), (60, 0, 0), (120, 0, 0)]),
            polyline([(0, 30, 0), (120, 30, 0)]),
        )
    )
    assert [piece.kind for piece in strip.pieces] == ["plane"]
    assert strip.smallest_bend_radius(CREASE) == math.inf
    assert not strip.creases


def test_a_straight_rail_and_a_wave_make_planes_and_cones_without_a_crease() -> None:
    wave = RailCurve(
        lambda x: stack(x, 40.0, 20.0 * np.sin(x / 25.0)),
        lambda x: stack(1.0, 0.0, 0.8 * np.cos(x / 25.0)),
        (0.0, 200.0),
    )
    strip = ruled((polyline([(0, 0, 0), (200, 0, 0)]), wave))
    assert {piece.kind for piece in strip.pieces} == {"plane", "cone"}
    assert not strip.creases
    crests = 25.0 * np.pi * (np.arange(3) + 0.5)
    planes = [piece for piece in strip.pieces if piece.kind == "plane"]
    at_crests = [strip.sheet.rulings.v[piece.first] for piece in planes]
    np.testing.assert_allclose(at_crests, crests[: len(planes)], atol=1e-6)


def test_a_square_becomes_round_by_four_planes_and_four_cones_about_its_corners() -> None:
    side = 100.0
    corners = [(1, 0), (1, 1), (-1, 1), (-1, -1), (1, -1), (1, 0)]
    square = polyline([(side * x, side * y, 0.0) for x, y in corners])
    strip = ruled((square, circle(50.0, 150.0, (0.0, 2.0 * math.pi))))
    kinds = [piece.kind for piece in strip.pieces]
    assert kinds == ["plane", *["cone", "plane"] * 4]
    cones = [piece for piece in strip.pieces if piece.kind == "cone"]
    assert [strip.sheet.p_arc[cone.first] for cone in cones] == [100.0, 300.0, 500.0, 700.0]
    quarters = [strip.sheet.rulings.v[cone.first] for cone in cones]
    np.testing.assert_allclose(quarters, math.pi / 2 * np.arange(4), atol=0.02)
    assert not strip.creases


def test_rails_that_meet_at_their_ends_have_a_surface() -> None:
    def rail(side: float) -> RailCurve:
        return analytic(
            lambda u: stack(u, side * 10.0 * np.sin(np.pi * u / 100), 3.0 * np.sin(np.pi * u / 50)),
            (0.0, 100.0),
        )

    strip = ruled((rail(-1.0), rail(1.0)))
    assert strip.developable_share == pytest.approx(1.0, abs=0.005)
    assert not strip.creases


def test_a_rail_that_is_a_point_makes_one_cone() -> None:
    apex = RailCurve(
        lambda u: stack(0 * u, 0.0, 60.0), lambda u: stack(0 * u, 0.0, 0.0), (0.0, 0.0)
    )
    base = circle(50.0, 0.0)
    u = np.linspace(0.0, 2.0, 40)
    strip = rule_strip(apex, base, (np.zeros(40), u))
    assert [(piece.kind, piece.apex) for piece in strip.pieces] == [("cone", "P")]
    assert strip.strain.largest == 0.0
    slant = math.hypot(50.0, 60.0)
    assert strip.radius.min() == pytest.approx(50.0 * slant / 60.0, rel=0.01)


def figures(strip: RuledStrip) -> tuple[float, float, float]:
    return strip.developable_share, 100.0 * strip.strain.largest, math.degrees(strip.largest_crease)


def check_one_verdict(strips: list[RuledStrip]) -> float:
    """Spread of the share in points; asserts that strain and crease agree."""
    share, strain, crease = np.array([figures(strip) for strip in strips]).T
    assert np.ptp(strain) <= max(0.02, 0.1 * strain.max())
    assert crease.max() < 5.0  # the rails are smooth
    return 100.0 * float(np.ptp(share))


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("family", [bumps, twisted])
def test_the_verdict_does_not_depend_on_the_sampling(
    family: Callable[[int], Rails], seed: int
) -> None:
    rails = family(seed)
    assert check_one_verdict([ruled(rails, tolerance) for tolerance in (0.1, 0.01)]) <= 2.5


@pytest.mark.slow
@pytest.mark.parametrize("family", [bumps, twisted])
def test_sixty_strips_have_one_verdict_at_four_tolerances(family: Callable[[int], Rails]) -> None:
    spreads = [
        check_one_verdict(
            [ruled(family(seed), tolerance) for tolerance in (0.1, 0.05, 0.01, 0.002)]
        )
        for seed in range(60)
    ]
    assert np.median(spreads) <= 1.0


@pytest.mark.parametrize("seed", range(4))
def test_the_verdict_does_not_depend_on_the_rails_direction_or_order(seed: int) -> None:
    p, q = bumps(seed)
    turned: list[Rails] = [(p, q), (q, p), (reversed_rail(p), reversed_rail(q))]
    assert check_one_verdict([ruled(rails) for rails in turned]) <= 0.5


@pytest.mark.parametrize("angle", [8.0, 20.0, 60.0])
@pytest.mark.parametrize("tolerance", [0.1, 0.002])
@pytest.mark.parametrize("is_turned", [False, True])
def test_a_corner_across_the_strip_is_always_a_crease(
    angle: float, tolerance: float, is_turned: bool
) -> None:
    def rail(y: float, swing: float) -> RailCurve:
        bend = math.radians(angle)
        far = (40.0 + 30.0 * math.cos(bend), y, 30.0 * math.sin(bend) + swing)
        return polyline([(0.0, y, 0.0), (40.0, y, 0.0), far])

    rails = (rail(0.0, 0.0), rail(15.0, 0.5))
    if is_turned:
        rails = (reversed_rail(rails[0]), reversed_rail(rails[1]))
    strip = ruled(rails, tolerance)
    assert strip.largest_crease >= CREASE
    assert max(strip.creases, key=lambda crease: crease.angle).cause == "corner"


def test_moving_and_scaling_the_rails_changes_nothing_else() -> None:
    p, q = bumps(3)
    turn = np.array([[0.0, -0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, 0.6]])

    def moved(rail: RailCurve) -> RailCurve:
        return RailCurve(
            lambda u: 3.0 * rail.point_at(u) @ turn.T + [100.0, -20.0, 7.0],
            lambda u: 3.0 * rail.velocity_at(u) @ turn.T,
            rail.interval,
        )

    u = np.linspace(0.0, 1.0, 60)
    here, there = rule_strip(p, q, (u, u)), rule_strip(moved(p), moved(q), (u, u))
    np.testing.assert_allclose(figures(here), figures(there), rtol=0.01, atol=0.002)
    assert there.radius.min() == pytest.approx(3.0 * here.radius.min(), rel=0.01)


def test_a_strip_is_judged_in_a_moment() -> None:
    p, q = bumps(1)
    u = np.linspace(0.0, 1.0, 60)
    rule_strip(p, q, (u, u))  # compiles
    begin = time.process_time()
    rule_strip(p, q, (u, u))
    assert time.process_time() - begin < 1.0


@pytest.mark.parametrize("height", [0.5, 3.0])
def test_a_band_that_begins_and_ends_in_a_point_is_not_strained_there(height: float) -> None:
    def rail(side: float) -> RailCurve:
        return analytic(
            lambda u: stack(
                u,
                side * np.sin(np.pi * u / 100) ** 2,
                height * side * np.sin(np.pi * u / 20) * np.sin(np.pi * u / 100) ** 2,
            ),
            (0.0, 100.0),
        )

    strip = ruled((rail(-2.0), rail(2.0)))
    strained = strip.strain.length[strip.strain.share > 1e-3]
    assert strained.size == 0 or strained.sum() > 0.5

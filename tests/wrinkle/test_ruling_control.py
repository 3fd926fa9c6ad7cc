"""Rulings under the designer's control, by place on CAD curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from build123d import Edge, Helix, Line, Polyline, Pos, Rectangle, Rot, Spline

from wrinkle_cad import InputError, WrinkleStrip
from wrinkle_cad.strip.constraints import lean_cosines


def wave(y: float, phase: float) -> Spline:
    return Spline(*[(x, y, 4 * math.sin(x / 9 + phase)) for x in range(0, 121, 4)])


P, Q = wave(0, 0.0), wave(18, 0.4)


def has_ruling(strip: WrinkleStrip, p_point, q_point) -> bool:
    t = strip.triangulation
    i, j = t.bridges.T
    off = np.linalg.norm(t.p[i] - p_point, axis=1) + np.linalg.norm(t.q[j] - q_point, axis=1)
    return bool(off.min() < 1e-6)


def test_a_pinned_ruling_is_there_by_lengths_and_by_points() -> None:
    free = WrinkleStrip(P, Q)
    ends = [rail @ (at / rail.length) for rail, at in ((P, 30.0), (Q, 36.0))]
    points = [tuple(end) for end in ends]
    assert not has_ruling(free, *points)
    by_length = WrinkleStrip(P, Q, pinned=[(30.0, 36.0)])
    by_points = WrinkleStrip(P, Q, pinned=[(*points[0], *points[1])])
    for strip in (by_length, by_points):
        assert has_ruling(strip, *points)
        assert strip.shell().is_valid
    assert by_points.area_mm2 == pytest.approx(by_length.area_mm2, rel=1e-9)


def test_the_verdict_is_about_a_surface_that_keeps_what_is_asked() -> None:
    """A ruling across a cylinder: a crease between the planes of its ends' tangents."""
    tube = Edge.make_circle(50), Pos(0, 0, 60) * Edge.make_circle(50)
    free, held = WrinkleStrip(*tube), WrinkleStrip(*tube, pinned=[(30.0, 40.0)])
    assert free.report.state == "developable"
    assert held.report.state == "creased"
    assert math.degrees(held.ruled.largest_crease) == pytest.approx(11.62, abs=0.01)
    assert not held.cut.differs
    stretch = (60.0, 75.0, 55.0, 70.0)
    around = WrinkleStrip(P, Q, forbidden=[stretch])
    for strip, enters in ((WrinkleStrip(P, Q), True), (around, False)):
        arcs = strip.ruled.sheet.p_arc, strip.ruled.sheet.q_arc
        inside = (arcs[0] > 60.01) & (arcs[0] < 74.99) & (arcs[1] > 55.01) & (arcs[1] < 69.99)
        assert bool(inside.any()) == enters


def test_no_ruling_joins_forbidden_stretches() -> None:
    strip = WrinkleStrip(P, Q, forbidden=[(20.0, 50.0, 20.0, 50.0)])
    t = strip.triangulation
    low, high = ([(rail @ (at / rail.length)).X for at in (20.0, 50.0)] for rail in (P, Q))
    i, j = t.bridges.T
    inside = (t.p[i, 0] > low[0] + 1e-6) & (t.p[i, 0] < low[1] - 1e-6)
    inside &= (t.q[j, 0] > high[0] + 1e-6) & (t.q[j, 0] < high[1] - 1e-6)
    assert not inside.any()


def test_a_stretch_between_two_samples_is_forbidden_all_the_same() -> None:
    p, q = Line((0, 0, 0), (60, 0, 0)), Line((0, 20, 0), (60, 20, 9))
    strip = WrinkleStrip(p, q, forbidden=[(20.0, 40.0, 10.0, 50.0)])
    t = strip.triangulation
    i, j = t.bridges.T
    inside = (t.p[i, 0] > 20.001) & (t.p[i, 0] < 39.999)
    assert inside.any()
    assert not (inside & (t.q[j, 0] > 10.001) & (t.q[j, 0] < 49.0)).any()


def test_limits_of_lean_length_and_fold_are_kept() -> None:
    lean = WrinkleStrip(P, Q, max_lean_deg=30.0).triangulation
    i, j = lean.bridges.T
    assert lean_cosines(lean.p, lean.q)[i, j].min() >= math.cos(math.radians(30.0)) - 1e-12
    short = WrinkleStrip(P, Q, max_ruling=20.5).triangulation
    i, j = short.bridges.T
    assert np.linalg.norm(short.p[i] - short.q[j], axis=1).max() <= 20.5
    s = np.linspace(0.0, 1.0, 41)
    ends = [(100 * s - 50, sign * (10 + 3 * (2 * s - 1) ** 2)) for sign in (-1, 1)]
    saddle = [Spline(*zip(x, y, x * y / 40, strict=True)) for x, y in ends]
    sharp = WrinkleStrip(*saddle, price=None).report
    flat = WrinkleStrip(*saddle, price=None, fold_bound_deg=50.0).report
    assert flat.max_fold_deg <= 50.0 < 100.0 < sharp.max_fold_deg
    assert flat.counted_invalid_bridges >= sharp.counted_invalid_bridges


@pytest.mark.parametrize("lean_deg", [30.0, 45.0, 60.0])
def test_a_limit_of_lean_takes_long_fans_away_and_says_what_that_costs(lean_deg: float) -> None:
    """A rail that winds around the other: a plane and a cone, or a sheet that must give."""
    t = np.linspace(0.0, 4.0, 60)
    f = 1.2 * (t / 4.0) ** 2
    p = Line((0, 0, 0), (40, 0, 0))
    q = Spline(*zip(10 * t, 10 * np.sin(f), 10 * np.cos(f), strict=True))
    free = WrinkleStrip(p, q, tolerance=0.005)
    assert free.report.state == "developable"
    assert free.report.max_twist_deg < 0.01
    kept = WrinkleStrip(p, q, tolerance=0.005, max_lean_deg=lean_deg)
    i, j = kept.triangulation.bridges.T
    cosines = lean_cosines(kept.triangulation.p, kept.triangulation.q)[i, j]
    assert cosines.min() >= math.cos(math.radians(lean_deg)) - 1e-12
    assert kept.report.state == "stretched"
    # Along the steepest ruling the rails' tangents differ by the angle of the winding.
    assert kept.report.max_twist_deg == pytest.approx(math.degrees(math.atan(0.6)), abs=0.05)
    assert 3.0 < kept.report.max_strain_percent < 3.7


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_ruling": 17.0}, "keeps max_ruling of 17 mm: the longest ruling of the best one"),
        ({"pinned": [(20.0, 30.0), (40.0, 10.0)]}, "Pinned rulings 1 and 2 cross"),
        ({"pinned": [(500.0, 30.0)]}, r"pinned names a place at 500 mm of rail P, which is 12\d"),
        ({"pinned": [(1.0, 2.0, 3.0)]}, "A pinned ruling has 3 numbers: give two, .*, or six"),
        ({"pinned": [(0, 5, 0, 0, 18, 0)]}, r"ends at \(0, 5, 0\), which is .* mm off rail P"),
        ({"forbidden": [(20.0, 10.0, 3.0, 5.0)]}, "cannot go from 20 to 10 mm: its end must lie"),
        ({"give_up": 5.0}, "give_up of 5 mm has no effect where the ends are fixed"),
        ({"ends": "free"}, "Free ends may leave some rail, and give_up says None"),
        ({"ends": "free", "give_up": 70.0}, "would leave nothing of rail P"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(options: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        WrinkleStrip(P, Q, **options)


def test_free_ends_leave_the_rail_that_spoils_the_strip() -> None:
    """A cylinder between square cuts, with a tail on one rail that only folds could take up."""
    arc = [(30 * math.sin(t), 30 * math.cos(t)) for t in np.linspace(0.0, 2.0, 40)]
    p = Spline(*[(x, 0, z) for x, z in arc])
    q = Polyline(*[(x, 25, z) for x, z in arc], (arc[-1][0] + 6.0, 25, arc[-1][1] - 1.0))
    fixed = WrinkleStrip(p, q)
    free = WrinkleStrip(p, q, ends="free", give_up=8.0)
    assert free.triangulation.unused == pytest.approx((0, 0, 0, math.hypot(6, 1)), abs=1e-9)
    assert free.report.unused_q_mm == free.triangulation.unused[2:]
    assert free.report.max_fold_deg < 5.0 < fixed.report.max_fold_deg
    assert free.area_mm2 == pytest.approx(30 * 2.0 * 25, rel=1e-3)
    assert free.q.length == pytest.approx(q.length - math.hypot(6, 1), rel=1e-9)
    assert [finding.code for finding in free.findings] == ["rail-unused"]
    assert free.shell().is_valid
    assert free.unrolling.q_length == pytest.approx(free.q.length, rel=1e-9)


def test_a_developable_strip_keeps_all_its_rail_though_its_ends_are_free() -> None:
    p = Spline(*[(30 * math.sin(t), 0, 30 * math.cos(t)) for t in np.linspace(0.0, 2.0, 40)])
    strip = WrinkleStrip(p, Pos(0, 25, 0) * p, ends="free", give_up=8.0)
    assert strip.triangulation.unused == (0.0, 0.0, 0.0, 0.0)


def test_closed_rails_have_no_ends_to_give_up() -> None:
    with pytest.raises(InputError, match="Closed rails have no ends to give up"):
        WrinkleStrip(
            Edge.make_circle(50), Pos(0, 0, 60) * Edge.make_circle(40), ends="free", give_up=3.0
        )


@pytest.mark.parametrize("search", ["global", "local"])
@pytest.mark.parametrize("start_deg", [0.0, 100.0])
def test_a_closed_strip_keeps_what_is_asked_of_its_rulings(start_deg: float, search: str) -> None:
    p = Edge.make_circle(50, start_angle=start_deg, end_angle=start_deg + 360.0)
    q = Pos(0, 0, 60) * Rot(0, 15, 0) * Edge.make_circle(40)
    start = math.radians(start_deg)
    at = [(50.0 * ((math.radians(angle) - start) % (2 * math.pi))) for angle in (20.0, 60.0, 80.0)]
    strip = WrinkleStrip(
        p, q, pinned=[(at[0], 40 * 0.5)], forbidden=[(at[1], at[2], 20, 60)], search=search
    )
    t = strip.triangulation
    assert has_ruling(
        strip,
        50 * np.array([math.cos(0.349065850399), math.sin(0.349065850399), 0]),
        tuple(q @ (20 / q.length)),
    )
    turn = np.degrees(np.arctan2(t.p[:, 1], t.p[:, 0])) % 360.0
    i, j = t.bridges.T
    inside = (turn[i] > 60.001) & (turn[i] < 79.999)
    assert inside.any()
    arcs = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(t.q, axis=0), axis=1))))
    first = 20 - float(arcs[np.linalg.norm(t.q - tuple(q @ (20 / q.length)), axis=1).argmin()])
    along_q = (arcs + first) % arcs[-1]
    assert not (inside & (along_q[j] > 20.1) & (along_q[j] < 59.9)).any()
    assert strip.shell().is_valid


def test_a_closed_strip_is_cut_at_the_users_ruling() -> None:
    p, q = Edge.make_circle(50), Pos(0, 0, 60) * Edge.make_circle(40)
    strip = WrinkleStrip(p, q, cut=(100.0, 80.0))
    assert np.allclose(strip.triangulation.p[0], tuple(p @ (100.0 / p.length)), atol=1e-6)
    assert np.allclose(strip.triangulation.q[0], tuple(q @ (80.0 / q.length)), atol=1e-6)
    assert strip.unrolling.p_length == pytest.approx(p.length, rel=1e-9)


def test_the_best_cut_takes_the_smallest_sheet() -> None:
    square, circle = Rectangle(200, 100).wire(), Pos(30, 0, 120) * Edge.make_circle(40)
    strips = [WrinkleStrip(square, circle, cut=cut) for cut in ("shortest", "best")]
    sheets = [
        shapely.MultiPoint(
            np.concatenate((s.unrolling.p, s.unrolling.q))
        ).minimum_rotated_rectangle.area
        for s in strips
    ]
    assert sheets[1] <= sheets[0]
    assert strips[1].area_mm2 == pytest.approx(strips[0].area_mm2, rel=1e-9)
    assert not strips[1].unrolling.overlaps


def test_a_limited_lean_keeps_to_the_helicoid_between_two_helices() -> None:
    strip = WrinkleStrip(Helix(40, 40, 10), Helix(40, 40, 30), max_lean_deg=30.0)
    pitch = 40.0 / (2.0 * math.pi)
    radius = np.linspace(10.0, 30.0, 1001)
    helicoid = 2.0 * math.pi * float(np.trapezoid(np.hypot(radius, pitch), radius))
    assert strip.report.state == "stretched"
    assert strip.area_mm2 == pytest.approx(helicoid, rel=0.02)


def test_bridges_that_lean_along_a_curved_rail_have_their_surface_judged() -> None:
    """They end further along the outer helix than those of a straight rail that lean no more."""
    strip = WrinkleStrip(Helix(40, 40, 10), Helix(40, 40, 30), max_lean_deg=45.0)
    assert strip.report.state == "stretched"

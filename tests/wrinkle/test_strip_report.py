"""What a strip's report says of its exact surface."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Edge, Line, Polyline, Pos, Rectangle, Spline

from tests.strip.rulings.rails import twisted
from wrinkle_cad.batch.folder.delivery import figures_of
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.verdict import judge
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

FOLD = [(0, 0, 0), (40, 0, 0), (70, 30, 0)]


def creased(**options: float) -> WrinkleStrip:
    return WrinkleStrip(Polyline(*FOLD), Pos(0, 0, 20) * Polyline(*FOLD), **options)


@pytest.mark.parametrize("tolerance", [0.1, 0.002])
def test_a_folded_pair_of_rails_is_creased_at_the_corner(tolerance: float) -> None:
    report = creased(tolerance=tolerance).report
    assert report.state == "creased"
    (crease,) = report.creases
    assert crease.angle_deg == pytest.approx(45.0, abs=0.1)
    assert (crease.p_mm, crease.q_mm) == pytest.approx((40.0, 40.0))
    assert crease.cause == "corner"
    assert report.smallest_bend_radius_mm == report.inner_bend_radius_mm == 0.0


def test_rails_given_as_points_are_judged_as_their_curve() -> None:
    rails = [np.array(FOLD, dtype=np.float64) + np.array([0.0, 0.0, z]) for z in (0.0, 20.0)]
    assert WrinkleStrip(*rails).report.creases == creased().report.creases
    turn = np.linspace(0.0, 2.0, 60)
    arcs = [
        np.column_stack((r * np.cos(turn), r * np.sin(turn), 0 * turn + z))
        for r, z in ((50, 0), (3, 60))
    ]
    report = WrinkleStrip(*arcs).report
    assert report.state == "developable"
    assert report.smallest_bend_radius_mm == pytest.approx(3.81, rel=0.01)


def test_skew_lines_are_stretched() -> None:
    strip = WrinkleStrip(Line((0, 0, 0), (100, 0, 0)), Line((0, 20, 0), (100, 20, 53)))
    assert strip.report.state == "stretched"
    assert strip.report.max_strain_percent > 2.0
    assert strip.report.stretched_mm == pytest.approx(100.0, rel=0.1)
    assert strip.report.developable_share == 0.0


@pytest.mark.parametrize(("width", "rate", "percent"), [(10, 0.01, 0.125), (10, 0.02, 0.496)])
def test_a_helicoid_reads_the_strain_of_the_closed_form(
    width: float, rate: float, percent: float
) -> None:
    x = np.linspace(0.0, 100.0, 41)
    rails = [
        Spline(
            *zip(
                x.tolist(),
                (side * width / 2 * np.cos(rate * x)).tolist(),
                (side * width / 2 * np.sin(rate * x)).tolist(),
                strict=True,
            )
        )
        for side in (1, -1)
    ]
    report = WrinkleStrip(*rails).report
    assert report.state == "stretched"
    assert report.max_strain_percent == pytest.approx(percent, rel=0.01)


@pytest.mark.parametrize(("small", "radius"), [(3.0, 3.81), (1.0, 1.29)])
def test_thickness_brings_the_inner_face_closer(small: float, radius: float) -> None:
    rails = (
        Edge.make_circle(50, start_angle=0, end_angle=120),
        Pos(0, 0, 60) * Edge.make_circle(small, start_angle=0, end_angle=120),
    )
    report = WrinkleStrip(*rails, thickness=1.2, k_factor=0.4).report
    assert report.smallest_bend_radius_mm == pytest.approx(radius, rel=0.01)
    assert report.inner_bend_radius_mm == pytest.approx(report.smallest_bend_radius_mm - 0.4 * 1.2)


@pytest.mark.parametrize(("side", "inner"), [("inside", 40.0), ("middle", 39.2), ("outside", 38.0)])
@pytest.mark.parametrize("is_swapped", [False, True])
def test_the_inner_face_is_on_the_side_where_the_material_lies(
    side: str, inner: float, is_swapped: bool
) -> None:
    arc = Edge.make_circle(40, start_angle=0, end_angle=100)
    p, q = arc, Pos(0, 0, 20) * arc
    # p' x (q - p) points away from the axis, where the material of a surface on the inside lies.
    if is_swapped:
        p, q, side = q, p, {"inside": "outside", "outside": "inside"}.get(side, side)
    report = WrinkleStrip(p, q, thickness=2.0, k_factor=0.4, surface_side=side).trial_report
    assert report.inner_bend_radius_mm == pytest.approx(inner, rel=0.002)


def test_a_flat_strip_is_bent_nowhere() -> None:
    report = WrinkleStrip(Line((0, 0, 0), (80, 0, 0)), Line((0, 20, 0), (80, 30, 0))).report
    assert report.state == "developable"
    assert report.smallest_bend_radius_mm == math.inf
    assert report.developable_share == 1.0
    assert report.creases == ()


def test_the_json_holds_every_figure_as_a_plain_value() -> None:
    entry = creased().report.as_json()
    assert entry["creases"] == [
        {"angle_deg": pytest.approx(45.0), "p_mm": 40.0, "q_mm": 40.0, "cause": "corner"}
    ]
    figures = {"developable_share", "max_strain_percent", "p95_strain_percent", "max_twist_deg"}
    assert all(isinstance(entry[name], float) for name in figures)
    assert entry["closed"] is False
    assert entry["state"] == "creased"


def test_a_box_open_at_both_ends_is_creased_at_its_four_edges() -> None:
    frame = Rectangle(40, 20)
    report = WrinkleStrip(frame.wire(), (Pos(0, 0, 10) * frame).wire()).report
    assert report.closed
    assert [crease.angle_deg for crease in report.creases] == pytest.approx([90.0] * 4, abs=0.1)


def test_a_closed_frustum_is_judged_without_a_seam() -> None:
    rails = (Edge.make_circle(50), Pos(0, 0, 80) * Edge.make_circle(30))
    report = WrinkleStrip(*rails).report
    assert (report.state, report.developable_share) == ("developable", 1.0)
    assert report.smallest_bend_radius_mm == pytest.approx(30 * math.hypot(80, 20) / 80, rel=0.01)


@pytest.mark.parametrize("seed", range(3))
def test_bridges_are_counted_one_way_everywhere(seed: int) -> None:
    rails = [
        Spline(*[tuple(at) for at in rail.point_at(np.linspace(*rail.interval, 41)).tolist()])
        for rail in twisted(seed)
    ]
    strip = WrinkleStrip(*rails, name="vamp")
    report = strip.trial_report
    runs = [run.last - run.first + 1 for run in report.invalid_runs]
    assert sum(runs) == report.invalid_bridges
    assert report.inflection_bridges <= report.invalid_bridges
    assert report.counted_invalid_bridges <= report.invalid_bridges
    counts = f"{report.invalid_bridges} of {report.interior_bridges} bridges not locally convex"
    assert counts in repr(strip)
    entry = {**report.as_json(), "trials": []}
    figures = figures_of({"strips": [entry]})
    for name in ("interior_bridges", "invalid_bridges", "inflection_bridges"):
        assert figures[name] == entry[name] == getattr(report, name)
    # Lengths under them leave inflection rulings out, here and where a limit asks for them.
    lengths = report.invalid_length_p_mm + report.invalid_length_q_mm
    whole = sum(seam.space for seam in report.seam_lengths_mm.values())
    assert judge([entry], Limits()).strips[0].invalid_percent == pytest.approx(
        100.0 * lengths / whole
    )

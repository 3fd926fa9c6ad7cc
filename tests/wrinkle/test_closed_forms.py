"""Strain, share, radius and crease of strips whose surface is known, as their report has them."""

from __future__ import annotations

import math
from itertools import product

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip
from wrinkle_cad.wrinkle.strip_report import StripReport

pytestmark = pytest.mark.filterwarnings("ignore::wrinkle_cad.WrinkleWarning")

Rails = tuple[object, object]
TOLERANCES = [0.1, pytest.param(0.01, marks=pytest.mark.slow)]


def spline(points: np.ndarray) -> b3d.Edge:
    return b3d.Spline(*[tuple(point) for point in points.tolist()])


def rail(*coordinates: np.ndarray | float) -> b3d.Edge:
    return spline(np.stack(np.broadcast_arrays(*coordinates), axis=1).astype(float))


def report_of(rails: Rails, **options: object) -> StripReport:
    return WrinkleStrip(*rails, **options).trial_report


def percent(twist: float) -> float:
    """Strain where both rails run equally fast across a ruling along which the plane turns."""
    return 100.0 * (1.0 - math.cos(twist / 2.0))


def helicoid(width: float, rate: float) -> Rails:
    x = np.linspace(0.0, 100.0, 81)
    return tuple(  # type: ignore[return-value]
        rail(x, side * width / 2 * np.cos(rate * x), side * width / 2 * np.sin(rate * x))
        for side in (1, -1)
    )


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(("width", "rate"), [(10.0, 0.01), (20.0, 0.01)])
def test_a_helicoid(width: float, rate: float, tolerance: float) -> None:
    report = report_of(helicoid(width, rate), tolerance=tolerance)
    twist = 2.0 * math.atan(width * rate / 2.0)
    assert report.max_strain_percent == pytest.approx(percent(twist), rel=0.01)
    assert report.max_twist_deg == pytest.approx(math.degrees(twist), rel=0.01)
    assert report.developable_share <= 0.005


def test_a_steep_helicoid_where_its_rulings_may_not_lean() -> None:
    # Free to lean, they find half a cylinder between the same rails, which a sheet takes as it is.
    report = report_of(helicoid(20.0, 0.0414), max_lean_deg=20.0)
    assert report.max_strain_percent == pytest.approx(7.605, rel=0.01)
    assert report_of(helicoid(20.0, 0.0414)).max_strain_percent <= 0.001


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("rise", [53.0, pytest.param(10.0, marks=pytest.mark.slow)])
def test_a_hypar_between_skew_lines(rise: float, tolerance: float) -> None:
    rails = b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((0, 20, 0), (100, 20, rise))
    report = report_of(rails, tolerance=tolerance)
    # Where the ruling stands upright on both lines it twists by their angle.
    twist = math.atan(rise / 100.0)
    assert report.max_strain_percent == pytest.approx(percent(twist), rel=0.01)
    assert report.max_twist_deg == pytest.approx(math.degrees(twist), rel=0.01)
    assert report.developable_share <= 0.005


def test_a_saddle_between_straight_rails() -> None:
    ends = [(-50.0, y, -50.0 * y / 40.0) for y in (-10.0, 10.0)]
    rails = tuple(b3d.Line((x, y, z), (-x, y, -z)) for x, y, z in ends)
    report = report_of((rails[0], rails[1]))
    twist = 2.0 * math.atan(10.0 / 40.0)
    assert report.max_twist_deg == pytest.approx(math.degrees(twist), rel=0.01)
    assert report.max_strain_percent == pytest.approx(percent(twist), rel=0.01)


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("small", [3.0, pytest.param(20.0, marks=pytest.mark.slow)])
def test_a_frustum_sector(small: float, tolerance: float) -> None:
    def arc(radius: float, z: float) -> b3d.Edge:
        return b3d.Pos(0, 0, z) * b3d.Edge.make_circle(radius, start_angle=0, end_angle=110)

    report = report_of((arc(50.0, 0.0), arc(small, 60.0)), tolerance=tolerance)
    # The normal's radius on a cone: that of the circle over the sine of the half angle at the axis.
    exact = small * math.hypot(60.0, 50.0 - small) / 60.0
    assert report.smallest_bend_radius_mm == pytest.approx(exact, rel=0.01)
    assert report.max_strain_percent <= 1e-3
    assert report.developable_share >= 0.995


def test_a_cylinder_between_oblique_ends() -> None:
    def spiral(z: float, rise: float, first: float, last: float) -> b3d.Edge:
        u = np.linspace(first, last, 81)
        return rail(40.0 * np.cos(u), 40.0 * np.sin(u), z + rise * u)

    report = report_of((spiral(0.0, 3.0, 0.0, 2.0), spiral(30.0, -2.0, 0.3, 2.4)))
    assert report.smallest_bend_radius_mm == pytest.approx(40.0, rel=0.01)
    assert report.max_strain_percent <= 1e-3
    assert report.developable_share >= 0.995


@pytest.mark.parametrize("shift", [4.0, pytest.param(10.0, marks=pytest.mark.slow)])
def test_a_tangent_developable_of_a_helix(shift: float) -> None:
    # Between the curves at two distances along the tangents of a helix: radius a, pitch 2 pi b.
    a, b = 20.0, 8.0
    speed = math.hypot(a, b)
    u = np.linspace(0.0, 2.0, 81)

    def at(distance: float) -> b3d.Edge:
        s = distance / speed
        return rail(
            a * np.cos(u) - s * a * np.sin(u), a * np.sin(u) + s * a * np.cos(u), b * u + s * b
        )

    report = report_of((at(shift), at(shift + 15.0)))
    # Its rulings at a distance d from the edge are bent to the radius d kappa / tau = d a / b.
    assert report.smallest_bend_radius_mm == pytest.approx(shift * a / b, rel=0.01)
    assert report.max_strain_percent <= 1e-3
    assert report.developable_share >= 0.995


@pytest.mark.parametrize(
    ("tolerance", "angle", "is_turned"),
    [
        pytest.param(*case, marks=() if at % 6 == 0 else pytest.mark.slow)
        for at, case in enumerate(
            product((0.1, 0.05, 0.01, 0.002), (5.2, 45.0, 90.0), (False, True))
        )
    ],
)
def test_a_corner_across_the_strip(angle: float, tolerance: float, is_turned: bool) -> None:
    bend = math.radians(angle)
    points = [(0.0, 0.0, 0.0), (40.0, 0.0, 0.0)]
    points.append((40.0 + 30.0 * math.cos(bend), 0.0, 30.0 * math.sin(bend)))
    fold = b3d.Polyline(*(points[::-1] if is_turned else points))
    report = report_of((fold, b3d.Pos(0, 20, 0) * fold), tolerance=tolerance)
    (crease,) = report.creases
    assert crease.angle_deg == pytest.approx(angle, abs=0.1)
    assert crease.p_mm == pytest.approx(30.0 if is_turned else 40.0, abs=0.01)
    assert report.state == "creased"
    assert report.smallest_bend_radius_mm == 0.0

"""Plain rails whose strip is known beforehand."""

from __future__ import annotations

import math
import warnings
from itertools import pairwise

import build123d as b3d
import numpy as np
import pytest
import shapely

from wrinkle_cad import WrinkleStrip, WrinkleWarning
from wrinkle_cad.cad.rail.directrix import make_directrix

ALONG = (0.0, 25.0, 0.0)


def fold_of(strip: WrinkleStrip) -> float:
    return math.degrees(float(np.abs(strip.triangulation.fold).max(initial=0.0)))


def is_sound(strip: WrinkleStrip) -> bool:
    """Whether nothing is unsure about a strip; that it has creases where its rails have is sure."""
    unsure = {finding.code for finding in strip.findings} - {"creased", "stretched"}
    return strip.shell().is_valid and not unsure and not strip.unrolling.turned_back_count


def test_a_flat_strap_with_a_tab_is_flat() -> None:
    tab = b3d.Polyline((0, 0, 0), (40, 0, 0), (50, -15, 0), (60, 0, 0), (120, 0, 0))
    strip = WrinkleStrip(tab, b3d.Line((0, 30, 0), (120, 30, 0)))
    assert strip.area_mm2 == pytest.approx(3750.0, rel=1e-12)
    assert strip.report.area_pattern_mm2 == pytest.approx(3750.0, rel=1e-9)
    assert fold_of(strip) == pytest.approx(0.0, abs=1e-9)
    assert len(strip.shell().faces()) == 1
    assert is_sound(strip)


def test_a_flat_strap_with_a_smooth_bump_is_flat() -> None:
    bump = b3d.Spline((0, 0, 0), (40, 0, 0), (60, -12, 0), (80, 0, 0), (120, 0, 0))
    dense = make_directrix(bump)
    line = dense.point_at(np.linspace(*dense.interval, 20_001))[:, :2]
    area = shapely.Polygon([*line, (120, 30), (0, 30)]).area
    assert area == pytest.approx(3380.289, abs=1e-3)
    strip = WrinkleStrip(bump, b3d.Line((0, 30, 0), (120, 30, 0)))
    assert strip.area_mm2 == pytest.approx(area, rel=1e-7)
    assert fold_of(strip) == pytest.approx(0.0, abs=1e-9)
    assert is_sound(strip)


def straps(seed: int) -> tuple[b3d.Wire, b3d.Wire, float]:
    """A flat strap with a tab of any polyline shape on one side, and its area."""
    rng = np.random.default_rng(seed)
    length, width = rng.uniform(60.0, 200.0), rng.uniform(15.0, 50.0)
    first, last = np.sort(rng.uniform(0.1, 0.9, 2)) * length
    last = max(last, first + 0.05 * length)
    inner = np.sort(rng.uniform(first, last, int(rng.integers(1, 5))))
    out = rng.uniform(-0.5, 0.5, len(inner)) * width
    corners = [(0.0, 0.0), (first, 0.0), *zip(inner, out, strict=True), (last, 0.0), (length, 0.0)]
    rails = [
        b3d.Polyline(*[(float(x), float(y), 0.0) for x, y in corners]),
        b3d.Line((0.0, width, 0.0), (length, width, 0.0)),
    ]
    return (
        rails[seed % 2],
        rails[1 - seed % 2],
        shapely.Polygon([*corners, (length, width), (0, width)]).area,
    )


@pytest.mark.parametrize("seed", range(20))
def test_a_flat_strap_with_any_tab_is_exact(seed: int) -> None:
    p, q, area = straps(seed)
    strip = WrinkleStrip(p, q)
    assert strip.area_mm2 == pytest.approx(area, rel=1e-9)
    assert is_sound(strip)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 150))
def test_many_flat_straps_with_any_tab_are_exact(seed: int) -> None:
    test_a_flat_strap_with_any_tab_is_exact(seed)


def prism(points: list[tuple[float, float, float]], by: tuple[float, float, float]) -> WrinkleStrip:
    rail = b3d.Wire(b3d.Polyline(*points).edges())
    return WrinkleStrip(rail, b3d.Pos(*by) * rail)


def prism_area(points: list[tuple[float, float, float]], by: tuple[float, float, float]) -> float:
    return sum(float(np.linalg.norm(np.cross(np.subtract(b, a), by))) for a, b in pairwise(points))


def test_a_zigzag_extruded_is_the_prism() -> None:
    points = [(10.0 * i, 0.0, 6.0 * (i % 2)) for i in range(9)]
    strip = prism(points, ALONG)
    assert strip.area_mm2 == pytest.approx(25.0 * 8.0 * math.sqrt(136.0), rel=1e-12)
    assert fold_of(strip) == pytest.approx(2.0 * math.degrees(math.atan(0.6)), rel=1e-9)
    assert len(strip.shell().faces()) == 8
    assert is_sound(strip)


def test_a_joggle_extruded_is_the_prism() -> None:
    flat = [(0, 0), (10, 0), (14, 8), (24, 8), (28, 0), (38, 0), (42, 8), (52, 8)]
    points = [(float(x), 0.0, float(z)) for x, z in flat]
    strip = prism(points, ALONG)
    assert strip.area_mm2 == pytest.approx(prism_area(points, ALONG), rel=1e-12)
    assert is_sound(strip)


def random_prism(seed: int) -> tuple[list[tuple[float, float, float]], tuple[float, float, float]]:
    """A zigzag or a joggle with legs of any length and angle, and how it is extruded."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 12))
    x = np.cumsum(rng.uniform(4.0, 15.0, count))
    z = rng.uniform(2.0, 9.0) * (np.arange(count) % 2 if seed % 2 else np.arange(count) // 2 % 2)
    z = z * rng.uniform(0.5, 1.5, count)
    points = [(float(a), 0.0, float(b)) for a, b in zip(x, z, strict=True)]
    return points, (float(rng.uniform(-3.0, 3.0)), float(rng.uniform(10.0, 40.0)), 0.0)


@pytest.mark.parametrize("seed", range(20))
def test_random_prisms_are_exact(seed: int) -> None:
    points, by = random_prism(seed)
    strip = prism(points, by)
    assert strip.area_mm2 == pytest.approx(prism_area(points, by), rel=1e-9)
    assert len(strip.shell().faces()) <= len(points) - 1
    assert is_sound(strip)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 100))
def test_many_random_prisms_are_exact(seed: int) -> None:
    test_random_prisms_are_exact(seed)


@pytest.mark.parametrize("tolerance", [0.1, 0.02, 0.002])
def test_a_saddle_is_not_folded_for_its_last_valid_bridges(tolerance: float) -> None:
    x = np.linspace(-50.0, 50.0, 51)
    y = 10.0 + 3.0 * (x / 50.0) ** 2
    p, q = (
        b3d.Spline(*map(tuple, np.column_stack((x, s * y, s * x * y / 40.0)).tolist()))
        for s in (-1.0, 1.0)
    )
    assert fold_of(WrinkleStrip(p, q, tolerance=tolerance)) < 55.0


def test_a_helical_ribbon_is_the_helicoid() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WrinkleWarning)
        strip = WrinkleStrip(b3d.Helix(10, 40, 30), b3d.Helix(10, 40, 20))
    c = 10.0 / (2.0 * math.pi)
    r = np.linspace(20.0, 30.0, 10_001)
    helicoid = 8.0 * math.pi * float(np.trapezoid(np.hypot(r, c), r))
    assert strip.area_mm2 == pytest.approx(helicoid, rel=1e-3)
    assert fold_of(strip) < 5.0
    assert strip.triangulation.invalid_count > 0.9 * strip.triangulation.interior_count

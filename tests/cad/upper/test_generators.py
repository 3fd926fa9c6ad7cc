"""Rails straight along the generators of a cylinder: the strip that is cut out is developable."""

from __future__ import annotations

import math

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip, carve, settings, stitch, wrinkle_profiles
from wrinkle_cad.strip.flat.unrolling import unroll_cones

RADIUS, HEIGHT = 60.0, 200.0


def rail(angle: float) -> b3d.Edge:
    x, y = RADIUS * math.cos(angle), RADIUS * math.sin(angle)
    return b3d.Edge.make_line((x, y, 40.0), (x, y, 160.0))


@pytest.mark.parametrize(
    ("width", "waves", "height"),
    [(10.0, 4, 2.0), (20.0, 4, 2.0), (40.0, 4, 2.0), (10.0, 6, 3.0), (10.0, 2, 3.0)],
)
def test_a_wrinkle_along_generators_is_stitched_and_its_bands_do_not_fold_over(
    width: float, waves: int, height: float
) -> None:
    side = max(b3d.Solid.make_cylinder(RADIUS, HEIGHT).faces(), key=lambda face: face.area)
    half = width / 2.0 / RADIUS
    # The cylinder's own seam is at angle 0, on the far side.
    opening = carve(side, rail(math.pi - half), rail(math.pi + half), margin=4.0)
    p, q = wrinkle_profiles(opening, waves=waves, height=height)
    strip = WrinkleStrip(p, q)
    made = stitch(opening, strip)
    assert made.report.is_valid
    assert made.report.free_length_after_mm == pytest.approx(
        made.report.free_length_before_mm, rel=1e-6
    )
    assert made.report.max_edge_tolerance_mm <= 1e-4
    assert len(made.report.bands) == 2
    for band in made.report.bands:
        assert band.triangulation.fold_back_count == 0
        assert np.degrees(np.abs(band.triangulation.fold).max()) < 90.0
        flat = unroll_cones(
            band.triangulation,
            band.p_samples,
            band.q_samples,
            band.p.point_at,
            band.q.point_at,
            tolerance=settings.FLAT_LINE_PER_TOLERANCE * settings.TOLERANCE,
        )
        assert flat.turned_back_count == 0
    assert strip.unrolling.turned_back_count == 0


@pytest.mark.parametrize("margin", [0.0, 4.0])
@pytest.mark.parametrize("width", [10.0, 20.0, 40.0])
def test_straight_rails_without_waves_are_stitched_with_any_margin(
    width: float, margin: float
) -> None:
    # Their samples are their ends, where the bands have no width.
    side = max(b3d.Solid.make_cylinder(RADIUS, HEIGHT).faces(), key=lambda face: face.area)
    half = width / 2.0 / RADIUS
    opening = carve(side, rail(math.pi - half), rail(math.pi + half), margin=margin)
    strip = WrinkleStrip(opening.rail_p, opening.rail_q)
    made = stitch(opening, strip)
    assert strip.area_mm2 == pytest.approx(120.0 * 2.0 * RADIUS * math.sin(half), rel=1e-9)
    assert made.report.is_valid
    assert made.report.free_length_after_mm == pytest.approx(made.report.free_length_before_mm)
    assert [band.name[-1] for band in made.report.bands] == (["P", "Q"] if margin else [])
    for band in made.report.bands:
        assert band.width == pytest.approx(margin, rel=0.05)
        assert np.degrees(np.abs(band.triangulation.fold).max()) < 20.0

"""What build123d says that a rail is made of, in a script."""

from __future__ import annotations

import build123d as b3d
import pytest

from wrinkle_cad import WrinkleStrip
from wrinkle_cad.report.material import find_material


def arcs(radius: float) -> tuple[b3d.Edge, b3d.Edge]:
    def arc(z: float) -> b3d.Edge:
        return b3d.Pos(0, 0, z) * b3d.Edge.make_circle(radius, start_angle=0, end_angle=100)

    return arc(0.0), arc(20.0)


@pytest.mark.parametrize("rail", [0, 1])
def test_the_material_of_a_rail_is_that_of_the_strip(rail: int) -> None:
    rails = arcs(40.0)
    rails[rail].material = "leather_generic"
    strip = WrinkleStrip(*rails, name="vamp")
    assert strip.material == find_material("Leather_GENERIC")
    assert strip.report.smallest_bend_radius_mm == pytest.approx(40.0, rel=0.01)
    assert strip.report.inner_bend_radius_mm == pytest.approx(
        strip.report.smallest_bend_radius_mm - 0.5 * 2.0
    )
    said = strip.verdict()
    assert said.passed is True
    assert said.headline == "PASS for Leather_GENERIC: gives 2%, needs 0%."
    assert strip.pattern().pieces[0].sew_line[:, 0].max() > 40.0


def test_what_a_script_asks_for_goes_before_the_material() -> None:
    p, q = arcs(40.0)
    p.material = "Leather_GENERIC"
    strip = WrinkleStrip(p, q, thickness=0.0)
    assert strip.report.inner_bend_radius_mm == strip.report.smallest_bend_radius_mm
    assert strip.verdict(max_strain_percent=0.5).limits[0] == "strain at most 0.5%"


def test_a_material_that_is_not_packaged_has_the_thickness_that_build123d_knows() -> None:
    p, q = arcs(40.0)
    p.material = "felt"
    strip = WrinkleStrip([p], q)
    assert strip.material is not None
    assert strip.material.name.lower().startswith("felt")
    assert strip.material.thickness_mm > 0.0


def test_rails_without_a_material_are_judged_by_the_limits_alone() -> None:
    strip = WrinkleStrip(*arcs(40.0))
    assert strip.material is None
    assert strip.verdict().passed is None
    assert strip.verdict(min_radius_mm=50.0).passed is False


def test_the_material_that_a_strip_is_judged_by_has_its_thickness() -> None:
    strip = WrinkleStrip(*arcs(4.5), tolerance=0.01)
    report = strip.report  # of a sheet without thickness
    assert report.inner_bend_radius_mm == pytest.approx(4.5, rel=0.01)
    assert strip.verdict(min_radius_mm=4.0).passed is True
    assert strip.verdict(material="Leather_GENERIC", min_radius_mm=4.0).passed is False
    assert strip.report is report

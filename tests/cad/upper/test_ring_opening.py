"""Openings like rings: closed rails on an upper, and a closed strip stitched in."""

from __future__ import annotations

import math

import pytest
from build123d import Edge, Face, GeomType, Pos, Rot, Solid, Spline

from tests.cad.stitch_checks import shell_faults
from wrinkle_cad import InputError, WrinkleStrip, carve, stitch, wrinkle_profiles


def tube() -> Face:
    (face,) = Solid.make_cylinder(40, 120).faces().filter_by(GeomType.CYLINDER)
    return face


def loop(radius: float, height: float, start_deg: float = 0.0) -> Edge:
    return Pos(0, 0, height) * Rot(0, 0, start_deg) * Edge.make_circle(radius)


RINGS = {
    "around a tube, from its seam": (tube(), loop(40, 40), loop(40, 70)),
    "around a tube, from elsewhere": (tube(), loop(40, 40, 130), loop(40, 70, 77)),
    "in the middle of a plane": (Face.make_rect(200, 200), loop(60, 0, 20), loop(40, 0, 140)),
}


@pytest.mark.parametrize("name", RINGS)
def test_a_ring_cut_out_and_sewn_in_again_is_the_upper(name: str) -> None:
    upper, p, q = RINGS[name]
    opening = carve(upper, p, q)
    assert opening.body_count == 2
    assert sum(opening.areas[1:]) == pytest.approx(upper.area, rel=1e-5)
    strip = WrinkleStrip(opening.p, opening.q)
    stitched = stitch(opening, strip)
    assert stitched.report.is_valid
    assert stitched.report.bands == ()
    assert stitched.report.area_mm2 == pytest.approx(upper.area, rel=1e-5)
    assert shell_faults(stitched.shell_shape, stitched.report.face_count, upper.wrapped) == []


@pytest.mark.parametrize("name", RINGS)
def test_a_gathered_ring_has_bands_that_begin_where_it_begins(name: str) -> None:
    upper, p, q = RINGS[name]
    opening = carve(upper, p, q, margin=3.0)
    strip = WrinkleStrip(*wrinkle_profiles(opening, waves=8, height=2.0), name="ring")
    stitched = stitch(opening, strip)
    report = stitched.report
    assert report.is_valid
    assert report.free_length_after_mm == pytest.approx(report.free_length_before_mm, abs=1e-6)
    assert [band.name for band in report.bands] == ["ring band P", "ring band Q"]
    assert report.bands[0].q_samples is strip.p_samples
    assert report.bands[1].p_samples is strip.q_samples
    assert shell_faults(stitched.shell_shape, report.face_count, upper.wrapped) == []


def test_the_margin_of_a_ring_is_the_same_all_around() -> None:
    opening = carve(tube(), loop(40, 40), loop(40, 70), margin=3.0)
    assert opening.areas[2] == pytest.approx(2 * math.pi * 40 * 36, rel=1e-6)


def test_rails_that_do_not_make_a_ring_are_refused_in_a_sentence() -> None:
    with pytest.raises(InputError, match=r"P is closed, but the ends of rail Q are .* mm apart"):
        carve(tube(), loop(40, 40), Spline((0, 40, 70), (40, 0, 70), (0, -40, 70)))
    opening = carve(tube(), loop(40, 40), loop(40, 70), margin=3.0)
    with pytest.raises(InputError, match=r"10\.5 on P, which is closed: a whole number of waves"):
        wrinkle_profiles(opening, waves=10.5, height=2.0)
    small = WrinkleStrip(loop(10, 0), loop(10, 10))
    with pytest.raises(InputError, match="Profile P is closed and at least"):
        stitch(opening, small)

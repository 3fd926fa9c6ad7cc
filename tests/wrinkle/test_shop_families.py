"""Twelve ducts as shops make them, against closed forms, from any start of both rails."""

from __future__ import annotations

import time

import numpy as np
import pytest

from tests.wrinkle.shop_families import Family, families
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.kernel.measures import face_areas
from wrinkle_cad.cad.kernel.topology import faces_of
from wrinkle_cad.cad.rail.closed_starts import started_at
from wrinkle_cad.cad.rail.directrix import make_directrix

FAMILIES = families()
NAMES = [family.name for family in FAMILIES]
SOME_SMOOTH = [
    family if family.name in ("cone", "hopper") else pytest.param(family, marks=pytest.mark.slow)
    for family in FAMILIES
]
PLANES_AND_CONES = {"square to round": 8, "rectangle to round": 8, "hopper": 4}


@pytest.mark.parametrize("family", FAMILIES, ids=NAMES)
def test_a_duct_has_the_area_and_the_seams_of_its_closed_form(family: Family) -> None:
    strip = WrinkleStrip(family.p, family.q, tolerance=0.02)
    exact = 1e-9 if family.is_polyhedral else 1e-5
    assert strip.area_mm2 == pytest.approx(family.area, rel=exact)
    flat = strip.unrolling
    assert flat.area == pytest.approx(family.area, rel=exact)
    assert flat.p_length == pytest.approx(family.p_length, rel=1e-6)
    assert flat.q_length == pytest.approx(family.q_length, rel=1e-6)
    assert strip.triangulation.counted_invalid_count == 0
    if family.name in PLANES_AND_CONES:
        assert len(faces_of(strip.topods_shell())) == PLANES_AND_CONES[family.name]


def figures_of(family: Family, starts: tuple[float, float]) -> tuple[float, float, tuple[int, ...]]:
    """Area, energy and counts, both rails started at shares of their parameters."""
    rails = [
        started_at(rail, share * rail.interval[1])
        for rail, share in zip(map(make_directrix, (family.p, family.q)), starts, strict=True)
    ]
    strip = WrinkleStrip(*rails, tolerance=0.02)
    found = strip.triangulation
    counts = (found.invalid_count, found.counted_invalid_count, len(found.p), len(found.q))
    return strip.area_mm2, found.bending, (len(faces_of(strip.topods_shell())), *counts)


def assert_same_from_starts(family: Family, count: int) -> None:
    random = np.random.default_rng(5)
    area, bending, counts = figures_of(family, (0.0, 0.0))
    for _ in range(count):
        other = figures_of(family, tuple(random.uniform(0.0, 1.0, 2).tolist()))
        assert other[0] == pytest.approx(area, rel=1e-9)
        assert other[1] == pytest.approx(bending, rel=1e-4)
        assert other[2] == counts


@pytest.mark.parametrize("family", FAMILIES[::5], ids=NAMES[::5])
def test_a_duct_does_not_remember_where_its_rails_began(family: Family) -> None:
    assert_same_from_starts(family, 1)


@pytest.mark.parametrize("family", SOME_SMOOTH, ids=NAMES)
def test_a_duct_of_smooth_faces_has_its_area_to_the_eighth_digit(family: Family) -> None:
    strip = WrinkleStrip(family.p, family.q, tolerance=0.02, surface="smooth")
    faces = faces_of(strip.topods_shell())
    # The kernel's own integral is off by up to 1e-4 here.
    area = sum(face_areas(faces, relative_error=1e-12))
    assert area == pytest.approx(family.area, rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES, ids=NAMES)
def test_a_duct_is_the_same_from_twenty_starts(family: Family) -> None:
    assert_same_from_starts(family, 20)


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES, ids=NAMES)
def test_a_duct_takes_under_a_second_of_processor_time(family: Family) -> None:
    WrinkleStrip(family.p, family.q, tolerance=0.02).topods_shell()
    before = time.process_time()
    WrinkleStrip(family.p, family.q, tolerance=0.02).topods_shell()
    assert time.process_time() - before < 1.0

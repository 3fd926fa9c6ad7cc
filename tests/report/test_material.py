"""Limits from a material file, and how sharply a strip is bent."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests.report.strips import cylinder_rails, planar_rails
from wrinkle_cad.errors import InputError
from wrinkle_cad.report.material import Limits, read_material
from wrinkle_cad.strip.bend_radius import smallest_bend_radius
from wrinkle_cad.strip.triangulation import triangulate

LEATHER = """
name = "calf leather"
thickness_mm = 1.2
smallest_bend_radius_mm = 2.0
largest_twist_deg = 4.0
"""


def material_file(folder: Path, text: str) -> Path:
    path = folder / "leather.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_material_gives_its_limits(tmp_path: Path) -> None:
    limits = read_material(material_file(tmp_path, LEATHER), Limits(max_fold_deg=9.0))
    assert limits == Limits(
        max_fold_deg=9.0,
        max_twist_deg=4.0,
        smallest_bend_radius_mm=2.0,
        thickness_mm=1.2,
        material="calf leather",
    )
    assert limits.stated == (
        "fold at most 9°",
        "twist at most 4°",
        "bend radius at least 2 mm (calf leather)",
    )


def test_a_twist_limit_of_its_own_wins_over_the_material(tmp_path: Path) -> None:
    path = material_file(tmp_path, LEATHER)
    assert read_material(path, Limits(max_twist_deg=1.0)).max_twist_deg == 1.0
    assert read_material(path, Limits(max_twist_deg=0.0)).max_twist_deg == 0.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", "cannot be read as TOML"),
        ('name = "a"\nweight = 1', "unknown key 'weight' - known: name, thickness_mm"),
        ("thickness_mm = 1.0", "no name"),
        ('name = " "', "no name"),
        ("name = 3", "no name"),
        ('name = "a"\nthickness_mm = -1', "thickness_mm is -1 - a finite number from 0"),
        ('name = "a"\nthickness_mm = inf', "thickness_mm is inf"),
        ('name = "a"\nlargest_twist_deg = true', "largest_twist_deg is True"),
        ('name = "a"\nsmallest_bend_radius_mm = "2"', "smallest_bend_radius_mm is '2'"),
    ],
)
def test_a_material_file_that_cannot_be_used_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(InputError) as refused:
        read_material(material_file(tmp_path, text))
    assert str(refused.value).startswith("material leather.toml - ")
    assert message in str(refused.value)


def test_a_missing_material_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"material none\.toml - cannot be read"):
        read_material(tmp_path / "none.toml")


@pytest.mark.parametrize(("m", "n"), [(60, 75), (75, 60), (200, 90), (121, 121)])
@pytest.mark.parametrize("thickness", [0.0, 1.0, 5.0])
def test_the_bend_radius_of_a_cylinder_is_its_radius(m: int, n: int, thickness: float) -> None:
    strip = triangulate(*cylinder_rails(m, n))
    radius = smallest_bend_radius(strip, thickness=thickness)
    assert radius == pytest.approx(40.0, rel=0.5)
    assert radius > 20.0


def test_the_bend_radius_gets_exact_when_rulings_are_parallel() -> None:
    turn = np.linspace(0.0, 2.0, 400)
    rails = [
        np.column_stack((25.0 * np.cos(turn), 25.0 * np.sin(turn), z + 0.0 * turn)) for z in (0, 9)
    ]
    strip = triangulate(*rails)
    assert smallest_bend_radius(strip) == pytest.approx(25.0, rel=0.01)


def test_a_flat_strip_has_no_bend_radius() -> None:
    radius = smallest_bend_radius(triangulate(*planar_rails()))
    assert radius > 1e6
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert smallest_bend_radius(triangulate(flat, flat + np.array([0.0, 1.0, 0.0]))) == math.inf


def test_a_crease_is_as_sharp_as_the_material_is_thick() -> None:
    """Two flat halves that meet at a right angle: pi/2 of turn within one thickness."""
    x = np.linspace(-10.0, 10.0, 201)
    rails = [np.column_stack((x, y + 0.0 * x, np.abs(x))) for y in (0.0, 8.0)]
    strip = triangulate(*rails)
    for thickness in (1.0, 2.0):
        radius = smallest_bend_radius(strip, thickness=thickness)
        assert radius == pytest.approx(thickness / (math.pi / 2.0), rel=1e-6)

"""Materials from files and from the package, and the limits that they set."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import build123d as b3d
import pytest

from wrinkle_cad import WrinkleStrip, settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.report.judging import missed_limits
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.material import find_material, packaged_materials, read_material
from wrinkle_cad.report.verdict import judge

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
    limits = Limits(max_fold_deg=9.0).of(find_material(str(material_file(tmp_path, LEATHER))))
    assert (limits.material, limits.thickness_mm, limits.k_factor) == ("calf leather", 1.2, None)
    assert limits.stated == (
        "bend radius at least 2 mm",
        "twist at most 4°",
        "fold at most 9°",
        "no crease of 5° or more",
    )


def test_a_twist_limit_of_its_own_wins_over_the_material(tmp_path: Path) -> None:
    path = material_file(tmp_path, LEATHER)
    leather = read_material(path)
    assert Limits(max_twist_deg=1.0).of(leather).max_twist_deg == 1.0
    assert Limits(max_twist_deg=0.0).of(leather).max_twist_deg == 0.0
    assert Limits(min_radius_mm=0.5).of(leather).min_radius_mm == 0.5


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", "cannot be read as TOML"),
        ('name = "a"\nweight = 1', "unknown key 'weight'. Known are name, thickness_mm"),
        ("thickness_mm = 1.0", "no name"),
        ('name = " "', "no name"),
        ("name = 3", "no name"),
        ('name = "a"\nthickness_mm = -1', "thickness_mm = -1. Give a number from 0 to 1e+06"),
        ('name = "a"\nthickness_mm = inf', "thickness_mm = inf"),
        ('name = "a"\nlargest_twist_deg = true', "largest_twist_deg = True"),
        ('name = "a"\nsmallest_bend_radius_mm = "2"', "smallest_bend_radius_mm = '2'"),
    ],
)
def test_a_material_file_that_cannot_be_used_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(InputError) as refused:
        read_material(material_file(tmp_path, text))
    assert str(refused.value).startswith("The material leather.toml ")
    assert message in str(refused.value)


def test_a_missing_material_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"The material none\.toml cannot be read \(No such"):
        read_material(tmp_path / "none.toml")


def test_packaged_materials_say_where_their_figures_come_from() -> None:
    materials = packaged_materials()
    assert len(materials) >= 12
    assert len({material.name for material in materials}) == len(materials)
    assert all(material.source for material in materials)


def test_a_material_is_found_by_its_name_in_any_case() -> None:
    assert find_material("LEATHER_generic").largest_strain_percent == 2.0
    with pytest.raises(InputError, match=r"no material 'chalk'. Known are .*Leather_GENERIC"):
        find_material("chalk")


FEET = 304.8
PLYWOOD = {
    "1-4": (2, 5),
    "5-16": (2, 6),
    "3-8": (3, 8),
    "1-2": (6, 12),
    "5-8": (8, 16),
    "3-4": (12, 20),
}


@pytest.mark.parametrize("inches", PLYWOOD)
@pytest.mark.parametrize("factor", [0.999, 1.001])
@pytest.mark.parametrize("is_across", [False, True])
def test_plywood_bends_to_the_radii_of_its_table(
    inches: str, factor: float, is_across: bool
) -> None:
    limits = Limits().of(find_material(f"Plywood_{inches}in"))
    radius = factor * FEET * PLYWOOD[inches][0 if is_across else 1]
    given = {
        "name": "board",
        "state": "developable",
        "creases": [],
        "gaps": [],
        "max_strain_percent": 0.0,
        "max_twist_deg": 0.0,
        "max_fold_deg": 0.0,
        "inner_bend_radius_mm": radius,
        "bend_radius_along_grain_mm": None if is_across else radius,
        "bend_radius_across_grain_mm": radius if is_across else None,
    }
    assert (not missed_limits(given, limits, 0.0)) == (factor > 1.0)


@pytest.mark.parametrize(
    "inches", ["1-4", *(pytest.param(each, marks=pytest.mark.slow) for each in list(PLYWOOD)[1:])]
)
def test_a_strip_of_plywood_passes_at_the_radius_of_the_table_for_its_grain(inches: str) -> None:
    board = find_material(f"Plywood_{inches}in")
    limits = Limits().of(board)
    across, along = (FEET * feet for feet in PLYWOOD[inches])

    def passes(inner: float, grain: Literal["along", "across"]) -> bool | None:
        radius = inner + settings.K_FACTOR * limits.thickness_mm
        arc = b3d.Edge.make_circle(radius, start_angle=0, end_angle=20)
        strip = WrinkleStrip(
            arc, b3d.Pos(0, 0, 300) * arc, thickness=limits.thickness_mm, grain=grain
        )
        return judge([strip.trial_report.as_json() | {"trials": []}], limits).passed

    # The strip bends along itself: its rulings lie along a grain that runs across it.
    for grain, least in (("across", across), ("along", along)):
        assert passes(1.002 * least, grain) is True
        assert passes(0.998 * least, grain) is False
    between = (across + along) / 2.0
    assert (passes(between, "across"), passes(between, "along")) == (True, False)

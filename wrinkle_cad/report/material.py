"""Materials: what a sheet gives, from files of our own or the user's.

name = "calf leather, 1.2 mm"
thickness_mm = 1.2
k_factor = 0.5
smallest_bend_radius_mm = 2.0
smallest_bend_radius_across_grain_mm = 2.0
largest_strain_percent = 2.0
largest_twist_deg = 4.0
source = "the tannery's sheet"
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.toml import read_toml

_TEXTS: Final = ("name", "source")
_FOLDER: Final = "materials"
_LISTED: Final = 40
_LARGEST: Final = 1e6


@dataclass(frozen=True, kw_only=True)
class Material:
    """What is known of a sheet; None where nothing is."""

    name: str
    """As it is called; the packaged ones as ``bd_materials`` names them where it has them."""
    thickness_mm: float | None = None
    """Of the sheet."""
    k_factor: float | None = None
    """Where the neutral layer lies in a bend, in shares of the thickness from the inner face."""
    smallest_bend_radius_mm: float | None = None
    """At the inner face, for bends along the grain, and across it if nothing else is said."""
    smallest_bend_radius_across_grain_mm: float | None = None
    """The same for bends across the grain: with the rulings along it."""
    largest_strain_percent: float | None = None
    """What it gives."""
    largest_twist_deg: float | None = None
    """How far it may turn along a ruling."""
    source: str = ""
    """Where the figures come from."""


def find_material(name_or_file: str) -> Material:
    """Returns a packaged material by its name, or that of a TOML file.

    Args:
        name_or_file: a name, in any case; or the path of a file that ends in ``.toml``.

    Raises:
        InputError: no such material, or a file that cannot be used.

    >>> find_material("leather_generic").largest_strain_percent
    2.0
    """
    if name_or_file.lower().endswith(".toml"):
        return read_material(Path(name_or_file))
    found = _packaged(name_or_file)
    if found is not None:
        return found
    known = ", ".join(material.name for material in packaged_materials()[:_LISTED])
    raise InputError(
        f"There is no material {name_or_file!r}. Known are {known}; or give a file that ends in"
        " .toml."
    )


def material_named(name: str, thickness_mm: float | None) -> Material:
    """Returns a packaged material by its name, or one of which no more than its thickness is known.

    Args:
        name: in any case.
        thickness_mm: of the sheet, where it is not a packaged one.

    >>> material_named("Plywood_1-4in", None).smallest_bend_radius_mm
    1524
    >>> material_named("Slate", 6.0).smallest_bend_radius_mm is None
    True
    """
    return _packaged(name) or Material(name=name, thickness_mm=thickness_mm)


def _packaged(name: str) -> Material | None:
    same = (each for each in packaged_materials() if each.name.casefold() == name.casefold())
    return next(same, None)


@cache
def packaged_materials() -> tuple[Material, ...]:
    """Returns the materials that come with the package, by name."""
    found = [_material_of(tomllib.loads(text), name) for name, text in _packaged_texts()]
    return tuple(sorted(found, key=lambda material: material.name.casefold()))


def read_material(path: Path) -> Material:
    """Reads a material's TOML file; all keys but the name may be missing.

    Raises:
        InputError: not TOML, an unknown or a missing key, or a value out of its range.
    """
    try:
        table = read_toml(path)
    except InputError as error:
        raise InputError(f"The material {error}") from error
    return _material_of(table, path.name)


def _packaged_texts() -> Iterator[tuple[str, str]]:
    for entry in files(__package__).joinpath(_FOLDER).iterdir():
        if entry.name.endswith(".toml"):
            yield entry.name, entry.read_text(encoding="utf-8")


def _material_of(table: dict[str, Any], file: str) -> Material:
    known = [field.name for field in fields(Material)]
    for key, value in table.items():
        if key not in known:
            raise InputError(
                f"The material {file} has the unknown key {key!r}. Known are {', '.join(known)}:"
                " remove it."
            )
        if key not in _TEXTS:
            _check_number(file, key, value)
    if not 0.0 < table.get("k_factor", 0.5) < 1.0:
        raise InputError(
            f"The material {file} has the k_factor {table['k_factor']}. Give a share of the"
            " thickness between 0 and 1."
        )
    name = table.get("name")
    if not isinstance(name, str) or not name.strip():
        raise InputError(f'The material {file} has no name. Add a text: name = "...".')
    return Material(**table)


def _check_number(file: str, key: str, value: Any) -> None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    # An integer of 400 digits is no float.
    if not is_number or not 0.0 <= value < math.inf or value > _LARGEST:
        raise InputError(
            f"The material {file} has {key} = {repr(value)[:_LISTED]}. Give a number from 0 to"
            f" {_LARGEST:g}."
        )

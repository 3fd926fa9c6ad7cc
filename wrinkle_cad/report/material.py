"""What a material allows: limits given one by one or as a TOML file.

name = "calf leather, 1.2 mm"
thickness_mm = 1.2
k_factor = 0.5
smallest_bend_radius_mm = 2.0
largest_twist_deg = 4.0
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Final

from wrinkle_cad.errors import InputError
from wrinkle_cad.options.option import option

_KEYS: Final = ("name", "thickness_mm", "k_factor", "smallest_bend_radius_mm", "largest_twist_deg")


@dataclass(frozen=True, kw_only=True)
class LimitSettings:
    """What a user may ask of a strip; None is no limit."""

    title: ClassVar[str] = "limits"

    max_fold_deg: float | None = field(
        default=None,
        metadata=option(
            "largest fold angle at a bridge that passes",
            unit="deg",
            least=0.0,
            most=360.0,
            flag="--max-fold",
        ),
    )
    max_twist_deg: float | None = field(
        default=None,
        metadata=option(
            "largest turn of the normal along a bridge that passes",
            unit="deg",
            least=0.0,
            most=360.0,
            flag="--max-twist",
        ),
    )
    max_invalid_percent: float | None = field(
        default=None,
        metadata=option(
            "largest share of both rails under bridges that are not locally convex, inflection"
            " rulings left out, that passes",
            unit="percent",
            least=0.0,
            most=100.0,
            flag="--max-invalid",
        ),
    )


@dataclass(frozen=True, kw_only=True)
class Limits(LimitSettings):
    """What a strip may not exceed, a material's own limits included; None is no limit."""

    smallest_bend_radius_mm: float | None = None
    """How sharply the material may be bent."""
    thickness_mm: float = 0.0
    """Of the material: bends finer than this are one bend to it."""
    k_factor: float | None = None
    """Where the neutral layer lies in a bend, as a share of the thickness from its inner face."""
    material: str = ""
    """Name of the material."""

    @property
    def stated(self) -> tuple[str, ...]:
        """The limits in words, in a fixed order; empty when there are none."""
        named = f" ({self.material})" if self.material else ""
        lines = (
            ("fold at most {:g}°", self.max_fold_deg),
            ("twist at most {:g}°", self.max_twist_deg),
            ("invalid bridges on at most {:g} per cent of the rails", self.max_invalid_percent),
            ("bend radius at least {:g} mm" + named, self.smallest_bend_radius_mm),
        )
        return tuple(words.format(limit) for words, limit in lines if limit is not None)


def read_material(path: Path, limits: Limits | None = None) -> Limits:
    """Adds a material's limits to those given one by one.

    Args:
        path: a TOML file with ``name``, ``thickness_mm``, ``k_factor``, ``smallest_bend_radius_mm``
            and ``largest_twist_deg``; all but the name may be missing.
        limits: those given one by one; a twist limit among them wins over the material's.

    Raises:
        InputError: not TOML, an unknown or a missing key, or a value out of its range.
    """
    limits = limits or Limits()
    table = _read_table(path)
    twist = table.get("largest_twist_deg")
    return replace(
        limits,
        material=table["name"],
        thickness_mm=table.get("thickness_mm", 0.0),
        k_factor=table.get("k_factor"),
        smallest_bend_radius_mm=table.get("smallest_bend_radius_mm"),
        max_twist_deg=twist if limits.max_twist_deg is None else limits.max_twist_deg,
    )


def _read_table(path: Path) -> dict[str, Any]:
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(
            f"material {path.name} - cannot be read as TOML: {error} - correct the file"
        ) from error
    for key, value in table.items():
        if key not in _KEYS:
            raise InputError(
                f"material {path.name} - unknown key {key!r} - known: {', '.join(_KEYS)} -"
                " remove it"
            )
        if key != "name":
            _check_length(path, key, value)
    if not 0.0 < table.get("k_factor", 0.5) < 1.0:
        raise InputError(
            f"The material {path.name} has the k_factor {table['k_factor']}. Give a share of the "
            "thickness between 0 and 1."
        )
    if not isinstance(table.get("name"), str) or not table["name"].strip():
        raise InputError(f'material {path.name} - no name - a text - add name = "..."')
    return table


def _check_length(path: Path, key: str, value: Any) -> None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or value < 0.0:
        raise InputError(
            f"material {path.name} - {key} is {value!r} - a finite number from 0 - correct it"
        )

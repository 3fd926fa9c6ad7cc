"""What a strip may not exceed: limits given one by one, and those of a material."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

from wrinkle_cad import settings
from wrinkle_cad.options.option import option

from .material import Material


@dataclass(frozen=True, kw_only=True)
class LimitSettings:
    """What a user may ask of a strip; None is no limit."""

    title: ClassVar[str] = "limits"

    max_strain_percent: float | None = field(
        default=None,
        metadata=option(
            "largest strain of a flat sheet that passes",
            unit="percent",
            least=0.0,
            most=100.0,
            flag="--max-strain",
        ),
    )
    max_crease_deg: float | None = field(
        default=None,
        metadata=option(
            "sharpest crease that passes; with other limits and without this one, none does",
            unit="deg",
            least=0.0,
            most=180.0,
            flag="--max-crease",
        ),
    )
    min_radius_mm: float | None = field(
        default=None,
        metadata=option(
            "smallest bend radius at the material's inner face that passes",
            unit="mm",
            least=0.0,
            most=1e9,
            flag="--min-radius",
        ),
    )
    max_twist_deg: float | None = field(
        default=None,
        metadata=option(
            "largest turn of the tangent plane along a ruling that passes",
            unit="deg",
            least=0.0,
            most=360.0,
            flag="--max-twist",
        ),
    )
    max_fold_deg: float | None = field(
        default=None,
        metadata=option(
            "largest fold angle at a bridge that passes; it shrinks with the tolerance",
            unit="deg",
            least=0.0,
            most=360.0,
            flag="--max-fold",
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
    """What a strip may not exceed, a material's own limits included; None is no limit.

    >>> from wrinkle_cad.report.material import Material
    >>> board = Material(name="board", largest_strain_percent=1.0, largest_twist_deg=4.0)
    >>> Limits(max_twist_deg=2.0).of(board).stated
    ('strain at most 1%', 'twist at most 2°', 'no crease of 5° or more')
    """

    made_of: Material | None = None
    """The material; its limits are among the others."""
    min_radius_across_grain_mm: float | None = None
    """Smallest bend radius for bends across the grain; None: as along it."""

    def of(self, material: Material) -> Limits:
        """Returns these limits with those of a material where none is given."""
        own = material.smallest_bend_radius_mm if self.min_radius_mm is None else None
        return replace(
            self,
            made_of=material,
            min_radius_mm=own if self.min_radius_mm is None else self.min_radius_mm,
            min_radius_across_grain_mm=(
                None if own is None else material.smallest_bend_radius_across_grain_mm
            ),
            max_strain_percent=_first(self.max_strain_percent, material.largest_strain_percent),
            max_twist_deg=_first(self.max_twist_deg, material.largest_twist_deg),
        )

    @property
    def thickness_mm(self) -> float:
        """Of the material; 0 when nothing is known of it."""
        return self.made_of.thickness_mm or 0.0 if self.made_of else 0.0

    @property
    def k_factor(self) -> float | None:
        """Where the neutral layer lies in a bend, in shares of the thickness from inside."""
        return self.made_of.k_factor if self.made_of else None

    @property
    def material(self) -> str:
        """The material's name; empty without one."""
        return self.made_of.name if self.made_of else ""

    @property
    def allowed_crease_deg(self) -> float:
        """The sharpest crease that passes; of one that nobody allowed, the least that is one."""
        return settings.CREASE_DEG if self.max_crease_deg is None else self.max_crease_deg

    @property
    def stated(self) -> tuple[str, ...]:
        """The limits in words, in a fixed order; empty when there are none."""
        along = "" if self.min_radius_across_grain_mm is None else " along the grain"
        lines = (
            ("strain at most {:g}%", self.max_strain_percent),
            ("creases of at most {:g}°", self.max_crease_deg),
            ("bend radius at least {:g} mm" + along, self.min_radius_mm),
            ("bend radius at least {:g} mm across the grain", self.min_radius_across_grain_mm),
            ("twist at most {:g}°", self.max_twist_deg),
            ("fold at most {:g}°", self.max_fold_deg),
            ("invalid bridges on at most {:g}% of the rails", self.max_invalid_percent),
        )
        said = tuple(words.format(limit) for words, limit in lines if limit is not None)
        if said and self.max_crease_deg is None:
            return (*said, f"no crease of {settings.CREASE_DEG:g}° or more")
        return said


def _first(own: float | None, material: float | None) -> float | None:
    return material if own is None else own

"""The numbers of one strip as a frozen value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal

import numpy as np

from wrinkle_cad.strip.bend_radius import smallest_bend_radius
from wrinkle_cad.strip.flat.unrolling import Unrolling
from wrinkle_cad.strip.gaps import Gap, covered_lengths, gap_entry
from wrinkle_cad.strip.triangulation import Triangulation

Role = Literal["strip", "band"]


@dataclass(frozen=True, slots=True)
class SeamLength:
    """One seam's length in mm."""

    space: float
    """Along the surface in space."""
    pattern: float
    """Along the flat pattern's sew line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StripReport:
    """What a strip is, in numbers; bridges are counted between the first and the last."""

    name: str
    """The strip's name."""
    role: Role
    """``strip``, or ``band`` between a strip and the body."""
    samples_p: int
    """Samples of directrix P."""
    samples_q: int
    """Samples of directrix Q."""
    interior_bridges: int
    """Bridges but for the first and the last."""
    invalid_bridges: int
    """Interior bridges that are not locally convex."""
    inflection_bridges: int
    """Those of them where a developable surface changes the sign of its bending."""
    invalid_length_p_mm: float
    """Length of P that bridges which are invalid, and no inflections, cover."""
    invalid_length_q_mm: float
    """Likewise of Q."""
    faces: int
    """Faces of the surface."""
    bending: float
    """Bending energy of the triangulation (dimensionless)."""
    least_bending: float
    """Bending energy of the triangulation that bends least, whatever its validity."""
    area_3d_mm2: float
    """Area of the surface in space."""
    area_pattern_mm2: float
    """Area of the flat pattern."""
    max_fold_deg: float
    """Largest fold angle at a bridge."""
    max_twist_deg: float
    """Largest turn of the normal along a ruling."""
    smallest_bend_radius_mm: float
    """How sharply the surface is bent at its sharpest place; infinite where it is flat."""
    seam_lengths_mm: dict[str, SeamLength]
    """Seam lengths by rail, ``p`` and ``q``."""
    overlaps: bool
    """Whether the flat pattern covers itself."""
    gaps: tuple[Gap, ...]
    """The runs of invalid bridges."""

    @property
    def is_developable(self) -> bool:
        """Whether every interior bridge is locally convex, inflections apart."""
        return self.invalid_bridges == self.inflection_bridges

    def as_json(self) -> dict[str, Any]:
        """The report as plain values, as it stands in NAME.json."""
        entry = {field.name: getattr(self, field.name) for field in fields(self)}
        seams = {rail: asdict(seam) for rail, seam in self.seam_lengths_mm.items()}
        gaps = [gap_entry(gap) for gap in self.gaps]
        return {**entry, "seam_lengths_mm": seams, "gaps": gaps}


def report_on(
    name: str,
    triangulation: Triangulation,
    unrolling: Unrolling,
    *,
    role: Role,
    area_mm2: float,
    face_count: int,
    lengths_mm: tuple[float, float],
    least_bending: float,
    gaps: Sequence[Gap],
    thickness_mm: float = 0.0,
) -> StripReport:
    """Collects the numbers of one strip.

    Args:
        name: the strip's name.
        triangulation: of the strip.
        unrolling: of the same triangulation.
        role: of the strip.
        area_mm2: of the surface in space.
        face_count: of the same surface.
        lengths_mm: of the directrices P and Q in space.
        least_bending: energy of the least-bending triangulation of the same rails.
        gaps: the runs of invalid bridges.
        thickness_mm: of the material; bends finer than it count as one.
    """
    fold, twist = triangulation.fold, triangulation.twist
    failed = ~triangulation.valid & ~triangulation.inflection
    failed[[0, -1]] = False
    p_invalid, q_invalid = covered_lengths(triangulation, failed)
    return StripReport(
        name=name,
        role=role,
        samples_p=len(triangulation.p),
        samples_q=len(triangulation.q),
        interior_bridges=triangulation.interior_count,
        invalid_bridges=triangulation.invalid_count,
        inflection_bridges=triangulation.inflection_count,
        invalid_length_p_mm=p_invalid,
        invalid_length_q_mm=q_invalid,
        faces=face_count,
        bending=triangulation.bending,
        least_bending=least_bending,
        area_3d_mm2=area_mm2,
        area_pattern_mm2=unrolling.area,
        max_fold_deg=math.degrees(float(np.abs(fold).max(initial=0.0))),
        max_twist_deg=math.degrees(float(np.abs(twist).max(initial=0.0))),
        smallest_bend_radius_mm=smallest_bend_radius(triangulation, thickness=thickness_mm),
        seam_lengths_mm={
            "p": SeamLength(lengths_mm[0], unrolling.p_length),
            "q": SeamLength(lengths_mm[1], unrolling.q_length),
        },
        overlaps=unrolling.overlaps,
        gaps=tuple(gaps),
    )

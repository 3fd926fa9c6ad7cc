"""The numbers of one strip as a frozen value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.strip.flat.unrolling import Unrolling
from wrinkle_cad.strip.invalid_runs import InvalidRun, covered_lengths, run_entry
from wrinkle_cad.strip.rulings.surface import RuledStrip
from wrinkle_cad.strip.triangulation import Triangulation

from .cut_report import CutReport
from .gap_report import GapReport

Role = Literal["strip", "band"]
State = Literal["folded", "creased", "stretched", "developable"]
"""What a strip is, the first that applies: folded back or through itself, creased by
``settings.CREASE_DEG`` or more, stretched by more than ``settings.STRETCH_PERCENT``, or none."""


@dataclass(frozen=True, slots=True)
class SeamLength:
    """One seam's length in mm."""

    space: float
    """Along the surface in space."""
    pattern: float
    """Along the flat pattern's sew line."""


@dataclass(frozen=True, slots=True)
class CreaseReport:
    """One ruling at which the surface is folded."""

    angle_deg: float
    """By how much."""
    p_mm: float
    """Along rail P from its start."""
    q_mm: float
    """Along rail Q from its start."""
    cause: Literal["corner", "strip"]
    """A corner of a rail, or the strip's own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StripReport:
    """What a strip is, in numbers; bridges are counted between the first and the last.

    Example:
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> WrinkleStrip(p, q, name="tent").report
        StripReport('tent', creased, 3048.2 mm2)
    """

    name: str
    """The strip's name."""
    role: Role
    """``strip``, or ``band`` between a strip and the body."""
    closed: bool
    """Whether the strip's last bridge is its first one again."""
    state: State
    """Folded, creased, stretched or developable."""
    developable_share: float
    """Share, 0 to 1, of both rails under torsal pieces, cones and planes."""
    max_strain_percent: float
    """What a flat sheet must give at most to take the strip's shape."""
    p95_strain_percent: float
    """What it must give on all but a twentieth of the strip's length."""
    stretched_mm: float
    """Length along the middle of the strip that is stretched."""
    creases: tuple[CreaseReport, ...]
    """Rulings at which the surface is folded, in order along the strip."""
    smallest_bend_radius_mm: float
    """Of the surface at its sharpest place; 0 at a crease, infinite when flat."""
    inner_bend_radius_mm: float
    """The same at the inner face of the material."""
    bend_radius_along_grain_mm: float
    """At the inner face, of the bend along the material's grain."""
    bend_radius_across_grain_mm: float
    """Likewise across it."""
    max_twist_deg: float
    """Largest turn of the tangent plane along a ruling."""
    samples_p: int
    """Samples of directrix P."""
    samples_q: int
    """Samples of directrix Q."""
    interior_bridges: int
    """Bridges but for the first and the last."""
    invalid_bridges: int
    """Interior bridges that are not locally convex."""
    inflection_bridges: int
    """Those of them where a developable surface changes the sign of its bending, or is flat."""
    counted_invalid_bridges: int
    """Those of the invalid ones at which the strip bends: what the search counted."""
    fold_backs: int
    """Interior bridges at which the strip lies on itself: folds of 180 degrees."""
    price: float | None
    """What an invalid bridge more was worth, in mean bending energies; None where it had none."""
    invalid_length_p_mm: float
    """Length of P that bridges which are invalid, and no inflections, cover."""
    invalid_length_q_mm: float
    """Likewise of Q."""
    unused_p_mm: tuple[float, float]
    """Length of P that free ends left: before the strip and behind it."""
    unused_q_mm: tuple[float, float]
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
    seam_lengths_mm: dict[str, SeamLength]
    """Seam lengths by rail, ``p`` and ``q``."""
    overlaps: bool
    """Whether the flat pattern covers itself."""
    cut: CutReport
    """How the piece that is cut differs from the surface that strain, creases, share, radius and
    twist are of."""
    gaps: tuple[GapReport, ...]
    """Stretches where a flat sheet must give, in order along the strip, with what closes them."""
    invalid_runs: tuple[InvalidRun, ...]
    """Runs of bridges that are not locally convex: figures of the search."""

    def __repr__(self) -> str:
        return f"StripReport({self.name!r}, {self.state}, {self.area_3d_mm2:.1f} mm2)"

    @property
    def is_developable(self) -> bool:
        """Whether the strip is a developable surface, and not only near enough to one for a sheet.

        Its state is ``developable``, and exact rulings cover nearly all of both rails. A narrow
        helicoid may have that state, for a sheet hardly gives to take its shape, and is none.
        """
        is_ruled = self.developable_share >= settings.DEVELOPABLE_SHARE
        return self.state == "developable" and is_ruled

    def as_json(self) -> dict[str, Any]:
        """The report as plain values, as it stands in NAME.json; no bend has no radius: None."""
        entry = {field.name: getattr(self, field.name) for field in fields(self)}
        radii = [name for name in entry if "radius" in name and entry[name] == math.inf]
        entry.update(dict.fromkeys(radii))
        seams = {rail: asdict(seam) for rail, seam in self.seam_lengths_mm.items()}
        runs = [run_entry(run) for run in self.invalid_runs]
        gaps = [asdict(gap) for gap in self.gaps]
        creases = [asdict(crease) for crease in self.creases]
        lists = {"gaps": gaps, "invalid_runs": runs, "creases": creases, "cut": asdict(self.cut)}
        return {**entry, "seam_lengths_mm": seams, **lists}


def report_on(
    name: str,
    triangulation: Triangulation,
    unrolling: Unrolling,
    ruled: RuledStrip,
    *,
    role: Role,
    area_mm2: float,
    face_count: int,
    lengths_mm: tuple[float, float],
    least_bending: float,
    gaps: Sequence[GapReport],
    invalid_runs: Sequence[InvalidRun],
    inner_radii_mm: tuple[float, float, float],
    cut: CutReport,
    is_folded: bool = False,
    is_closed: bool = False,
) -> StripReport:
    """Collects the numbers of one strip.

    Args:
        name: the strip's name.
        triangulation: of the strip.
        unrolling: of the same triangulation.
        ruled: the exact surface near it.
        role: of the strip.
        area_mm2: of the surface in space.
        face_count: of the same surface.
        lengths_mm: of the directrices P and Q in space.
        least_bending: energy of the least-bending triangulation of the same rails.
        gaps: its gaps, with what closes them.
        invalid_runs: the runs of invalid bridges.
        inner_radii_mm: smallest bend radii at the material's inner face: in all, along the grain
            and across it.
        cut: how its piece differs from that surface.
        is_folded: whether it folds back on itself or passes through itself.
        is_closed: whether its rails are.
    """
    radius = ruled.smallest_bend_radius(math.radians(settings.CREASE_DEG))
    inner, along, across = inner_radii_mm if radius > 0.0 else (0.0, 0.0, 0.0)
    failed = ~triangulation.valid & ~triangulation.inflection
    failed[[0, -1]] = False
    p_invalid, q_invalid = covered_lengths(triangulation, failed)
    return StripReport(
        name=name,
        role=role,
        closed=is_closed,
        state=_state(ruled, is_folded=is_folded),
        developable_share=ruled.developable_share,
        max_strain_percent=100.0 * ruled.strain.largest,
        p95_strain_percent=100.0 * ruled.strain.percentile(0.95),
        stretched_mm=ruled.strain.length_above(settings.STRETCH_PERCENT / 100.0),
        creases=tuple(
            CreaseReport(math.degrees(crease.angle), crease.p_arc, crease.q_arc, crease.cause)
            for crease in ruled.creases
        ),
        smallest_bend_radius_mm=radius,
        inner_bend_radius_mm=inner,
        bend_radius_along_grain_mm=along,
        bend_radius_across_grain_mm=across,
        max_twist_deg=math.degrees(ruled.largest_twist),
        samples_p=len(triangulation.p),
        samples_q=len(triangulation.q),
        interior_bridges=triangulation.interior_count,
        invalid_bridges=triangulation.invalid_count,
        inflection_bridges=triangulation.inflection_count,
        counted_invalid_bridges=triangulation.counted_invalid_count,
        fold_backs=triangulation.fold_back_count,
        price=triangulation.price,
        invalid_length_p_mm=p_invalid,
        invalid_length_q_mm=q_invalid,
        unused_p_mm=triangulation.unused[:2],
        unused_q_mm=triangulation.unused[2:],
        faces=face_count,
        bending=triangulation.bending,
        least_bending=least_bending,
        area_3d_mm2=area_mm2,
        area_pattern_mm2=unrolling.area,
        max_fold_deg=_largest_fold_deg(triangulation),
        seam_lengths_mm={
            "p": SeamLength(lengths_mm[0], unrolling.p_length),
            "q": SeamLength(lengths_mm[1], unrolling.q_length),
        },
        overlaps=unrolling.overlaps,
        cut=cut,
        gaps=tuple(gaps),
        invalid_runs=tuple(invalid_runs),
    )


def _state(ruled: RuledStrip, *, is_folded: bool) -> State:
    if is_folded:
        return "folded"
    if math.degrees(ruled.largest_crease) >= settings.CREASE_DEG:
        return "creased"
    is_stretched = 100.0 * ruled.strain.largest > settings.STRETCH_PERCENT
    return "stretched" if is_stretched else "developable"


def _largest_fold_deg(triangulation: Triangulation) -> float:
    return math.degrees(float(np.abs(triangulation.fold).max(initial=0.0)))

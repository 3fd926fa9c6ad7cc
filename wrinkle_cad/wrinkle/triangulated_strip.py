"""``TriangulatedStrip``: a strip that was found, and all that is made of it."""

from __future__ import annotations

from copy import copy
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.faces.exact_surface import exact_surface, rail_curve
from wrinkle_cad.cad.faces.smooth_surface import SmoothSurface, smooth_surface
from wrinkle_cad.errors import Finding
from wrinkle_cad.options.checking import check_known
from wrinkle_cad.options.signature import takes_options_of
from wrinkle_cad.pattern.piece.options import PatternArguments, PieceSettings, SurfaceSide
from wrinkle_cad.strip.convexity import validity_matrix
from wrinkle_cad.strip.curve.polyline import polyline_length
from wrinkle_cad.strip.flat.flat_map import FlatMap
from wrinkle_cad.strip.flat.smooth_unrolling import unroll_smooth
from wrinkle_cad.strip.flat.unrolling import Unrolling, unroll, unroll_cones
from wrinkle_cad.strip.invalid_runs import find_invalid_runs
from wrinkle_cad.strip.rulings.held import NOTHING_HELD, Held
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

from .cut_report import CutReport, cut_findings, cut_report
from .gap_report import GapReport, gap_reports
from .grain import Stock, inner_radii
from .loudness import warn_of
from .mapped_strip import MappedStrip
from .strip_findings import (
    FOLDED,
    area_findings,
    flat_findings,
    shape_findings,
    sheet_findings,
)
from .strip_report import Role, StripReport, report_on
from .surface_map import map_of

if TYPE_CHECKING:
    from build123d import Shell
    from matplotlib.axes import Axes
    from OCP.TopoDS import TopoDS_Shell

    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.rulings.smooth_path import SmoothPath
    from wrinkle_cad.strip.rulings.surface import RuledStrip

    from .cut_pattern import Pattern


_NO_STOCK: Final = Stock()


class TriangulatedStrip(MappedStrip):
    """A triangulated strip between two sampled directrices.

    Surfaces, unrolling and report are made when first asked for. A strip does not change.

    Args:
        p: directrix P.
        q: directrix Q, in the same direction.
        p_samples: the samples of P.
        q_samples: the samples of Q.
        triangulation: of these samples.
        tolerance: mm; the chord tolerance of the samples.
        name: label of the surface and of the pattern.
        color: of the surface, (red, green, blue) from 0 to 1.
        surface: ``cones``, ``smooth`` or ``facets``.
        smooth: its smooth surface, if that was made before.
        role: ``strip``, or ``band`` between a strip and the body.
        stock: thickness, K-factor and grain of the material, and which side of it the surface is.
        findings: what was noticed while it was made.
        held: what was asked of the rulings; the triangulation keeps it.
    """

    def __init__(
        self,
        p: Directrix,
        q: Directrix,
        p_samples: Samples,
        q_samples: Samples,
        triangulation: Triangulation,
        *,
        tolerance: float,
        name: str,
        color: tuple[float, float, float] = settings.STRIP_COLOR,
        surface: settings.Surface = settings.SURFACE,
        smooth: SmoothSurface | None = None,
        role: Role = "strip",
        stock: Stock = _NO_STOCK,
        findings: tuple[Finding, ...] = (),
        held: Held = NOTHING_HELD,
    ) -> None:
        self.p, self.q = p, q
        self.p_samples, self.q_samples = p_samples, q_samples
        self.triangulation = triangulation
        self.tolerance = tolerance
        self.name = name
        self.color = color
        self.surface: settings.Surface = surface
        self._made_smooth = smooth
        self.role: Role = role
        self.stock = stock
        self.held = held
        self._noticed = (*findings, *shape_findings(name, triangulation))
        self._is_told = warn_of(self._noticed, 3)
        self._shells: dict[str, TopoDS_Shell] = {}

    def __repr__(self) -> str:
        t = self.triangulation
        return (
            f"{type(self).__name__}({self.name!r}, {len(t.p)} x {len(t.q)} samples, "
            f"{t.invalid_count} of {t.interior_count} bridges not locally convex)"
        )

    def turned_over(self) -> Self:
        """The same strip with the other side of its surface as the right one."""
        other: dict[SurfaceSide, SurfaceSide] = {"inside": "outside", "outside": "inside"}
        twin = copy(self)
        twin.stock = replace(self.stock, surface_side=other.get(self.stock.surface_side, "middle"))
        return twin

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is unsure about the strip; asking for it makes the surface and the unrolling.

        Rails that were turned, a fold-back, a strip that passes through itself, a crease, a sheet
        that must give, a piece that is not the surface that is judged, a pattern that must be
        split, an area known to no better than 1e-6. A ``WrinkleWarning`` says so as well.
        """
        flat = flat_findings(self.name, self.unrolling)
        smooth = self._smooth.findings if self.surface == "smooth" else ()
        unsure = area_findings(self.name, self.area_error)
        return (*self._noticed, *self._judged, *smooth, *flat, *unsure)

    @cached_property
    def _judged(self) -> tuple[Finding, ...]:
        is_band = self.role == "band"
        return (
            *sheet_findings(self.name, self.ruled, is_band=is_band),
            *cut_findings(self.name, self.cut, self.triangulation, is_band=is_band),
        )

    def _tell(self, findings: tuple[Finding, ...], calls: int = 4) -> None:
        """Warns of what was found later on, unless the strip has warned before."""
        if not self._is_told:
            self._is_told = warn_of(findings, calls)

    def topods_shell(self, surface: settings.Surface | None = None) -> TopoDS_Shell:
        """The surface as the kernel's own shell, made once per kind and shared."""
        kind = self.surface if surface is None else surface
        if kind not in self._shells:
            self._shells[kind] = self._built(kind)
        return self._shells[kind]

    def _built(self, kind: settings.Surface) -> TopoDS_Shell:
        from wrinkle_cad.cad.faces.shell import build_shell

        if kind == "smooth":
            made = self._smooth.made
            return self.topods_shell("cones") if made is None else made[0]
        return build_shell(self.triangulation, self.p, self.q, self.p_samples, self.q_samples, kind)

    @cached_property
    def _smooth(self) -> SmoothSurface:
        rails, samples = (self.p, self.q), (self.p_samples, self.q_samples)
        found = self._made_smooth or smooth_surface(
            self.name, rails, samples, self.triangulation, self.ruled, self.held
        )
        self._tell(found.findings)
        return found

    def shell(self, surface: settings.Surface | None = None) -> Shell:
        """The surface as a build123d ``Shell`` with its label and color.

        Args:
            surface: ``cones``, ``smooth`` or ``facets``; the strip's own when None.

        Raises:
            CadError: the kernel could not build a valid shell.
        """
        from wrinkle_cad.cad.build123d_objects import to_build123d

        return to_build123d(self.topods_shell(surface), label=self.name, color=self.color)

    @property
    def unrolling(self) -> Unrolling:
        """The strip laid flat, as its surface is: smooth pieces, cones or facets."""
        return self._unrolled

    @cached_property
    def _unrolled(self) -> Unrolling:
        unrolling = self._laid_flat()
        self._tell(flat_findings(self.name, unrolling))
        return unrolling

    def _laid_flat(self) -> Unrolling:
        if self.surface == "facets":
            return unroll(self.triangulation)
        tolerance = settings.FLAT_LINE_PER_TOLERANCE * self.tolerance
        samples, curves = (self.p_samples, self.q_samples), (self.p.point_at, self.q.point_at)
        if self._path is not None:
            return unroll_smooth(self._path, samples, curves, tolerance=tolerance)
        return unroll_cones(self.triangulation, *samples, *curves, tolerance=tolerance)

    @property
    def _path(self) -> SmoothPath | None:
        """The pieces of a smooth surface."""
        made = self._smooth.made if self.surface == "smooth" else None
        return None if made is None else made[1]

    def _mapped(self) -> FlatMap:
        rails, samples = (self.p, self.q), (self.p_samples, self.q_samples)
        is_faceted = self.surface == "facets"
        return map_of(rails, samples, self.triangulation, self.unrolling, self._path, is_faceted)

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """The validity matrix, (m, n) bool: which bridges are locally convex."""
        return validity_matrix(
            self.p_samples.points, self.q_samples.points, planarity=self.triangulation.planarity
        )

    @cached_property
    def least_bending(self) -> Triangulation:
        """The triangulation that bends least, whatever its validity (GMBT)."""
        return self._found_by(("bending",), "global")

    @cached_property
    def local(self) -> Triangulation:
        """What the local search finds (LODT and LMBT)."""
        return self._found_by(("invalid", "bending"), "local")

    def _found_by(
        self, criteria: tuple[settings.Criterion, ...], search: settings.Search
    ) -> Triangulation:
        return triangulate(
            self.p_samples.points,
            self.q_samples.points,
            criteria=criteria,
            search=search,
            energy=self.triangulation.energy,
            planarity=self.triangulation.planarity,
        )

    @cached_property
    def report(self) -> StripReport:
        """The strip's numbers."""
        from wrinkle_cad.cad.kernel.topology import faces_of

        return self._report_with(self.gaps, self.area_mm2, len(faces_of(self.topods_shell())))

    @cached_property
    def trial_report(self) -> StripReport:
        """The same without what takes longest: no faces, no gaps, the area that of the pattern."""
        return self._report_with((), self.unrolling.area, 0)

    def _report_with(
        self, gaps: tuple[GapReport, ...], area_mm2: float, face_count: int
    ) -> StripReport:
        self._tell(self._judged, calls=5)
        return report_on(
            self.name,
            self.triangulation,
            self.unrolling,
            self.ruled,
            role=self.role,
            area_mm2=area_mm2,
            face_count=face_count,
            lengths_mm=self._rail_lengths(),
            least_bending=self.least_bending.bending,
            gaps=gaps,
            invalid_runs=find_invalid_runs(self.triangulation),
            is_closed=self.p.is_closed and self.q.is_closed,
            is_folded=any(finding.code in FOLDED for finding in self._noticed),
            inner_radii_mm=inner_radii(self.triangulation, self.unrolling, self.ruled, self.stock),
            cut=self.cut,
        )

    @cached_property
    def cut(self) -> CutReport:
        """How the piece that is cut differs from the exact surface, which is judged."""
        rails, samples = (self.p, self.q), (self.p_samples, self.q_samples)
        return cut_report(self.ruled, self.unrolling, rails, samples, self.tolerance)

    @cached_property
    def ruled(self) -> RuledStrip:
        """The exact surface between the two curves: rulings, pieces, strain, creases, radii."""
        rails, samples = (self.p, self.q), (self.p_samples, self.q_samples)
        return exact_surface(*rails, *samples, self.triangulation, self.held)

    @cached_property
    def gaps(self) -> tuple[GapReport, ...]:
        """Where a flat sheet must give, and which turn of a rail was tried that closes it."""
        return gap_reports(
            (rail_curve(self.p), rail_curve(self.q)),
            self.ruled,
            self.triangulation,
            is_closed=self.p.is_closed and self.q.is_closed,
            may_turn=self.role == "strip" and self.held == NOTHING_HELD,
        )

    @property
    def area_mm2(self) -> float:
        """Area of the surface in space."""
        return self._measured_area[0]

    @property
    def area_error(self) -> float:
        """The relative error to which the area was integrated."""
        return self._measured_area[1]

    @cached_property
    def _measured_area(self) -> tuple[float, float]:
        from wrinkle_cad.cad.kernel.measures import area_as_exact_as_can_be

        area, error = area_as_exact_as_can_be(self.topods_shell())
        self._tell(area_findings(self.name, error))
        return area, error

    def _rail_lengths(self) -> tuple[float, float]:
        if self.surface != "facets":
            return self.p.length, self.q.length
        return polyline_length(self.triangulation.p), polyline_length(self.triangulation.q)

    @takes_options_of(PatternArguments)
    def pattern(self, piece_settings: PieceSettings | None = None, **options: Any) -> Pattern:
        """The flat pattern.

        Args:
            piece_settings: allowances, notches, texts and the rest; when None, the defaults with
                the strip's own tolerance and material.
            options: fields of ``PieceSettings`` by name; they go before ``piece_settings``.

        Raises:
            InputError: the flat strip covers itself and the settings forbid to split it, or an
                option is unknown or out of its range.
        """
        from .cut_pattern import pattern_of_strips

        check_known(options, (option.name for option in fields(PieceSettings)), "pattern()")
        base = piece_settings or PieceSettings(
            tolerance=self.tolerance,
            thickness=self.stock.thickness,
            k_factor=self.stock.k_factor,
            grain=self.stock.grain,
            surface_side=self.stock.surface_side,
            material=self.stock.name,
        )
        return pattern_of_strips([self], replace(base, **options))

    def plot_validity(self, ax: Axes) -> Axes:
        """Draws the validity matrix with this strip's path and the local one's."""
        from wrinkle_cad.report.figures import plot_validity

        return plot_validity(ax, self.valid, self.triangulation, others=(self.local,))

    def plot_energy(self, ax: Axes) -> Axes:
        """Draws the bending energy along the strip beside the local and the least-bending one."""
        from wrinkle_cad.report.figures import plot_energy

        return plot_energy(ax, self.triangulation, (self.local, self.least_bending))

    def plot_pattern(self, ax: Axes, piece_settings: PieceSettings | None = None) -> Axes:
        """Draws the pattern to scale on matplotlib axes; the settings are those of ``pattern``."""
        from wrinkle_cad.report.figures import plot_pattern

        return plot_pattern(ax, self.pattern(piece_settings).pieces)

    def export_step(
        self, path: str | Path, *, schema: settings.StepSchema = settings.STEP_SCHEMA
    ) -> None:
        """Writes the surface as STEP.

        Raises:
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.cad.exchange.shapes import Part
        from wrinkle_cad.cad.exchange.write import write_step

        part = Part(self.topods_shell(), self.name, self.color)
        write_step(Path(path), [part], schema=schema)

    def export_stl(self, path: str | Path) -> None:
        """Writes the surface as binary STL, meshed to the strip's tolerance.

        Raises:
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.cad.exchange.write import write_stl

        write_stl(Path(path), self.topods_shell(), tolerance=self.tolerance)

"""Stitches wrinkles into an upper that was carved for them (Fig. 11d of the paper)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Shell

from wrinkle_cad import settings
from wrinkle_cad.cad.exchange.shapes import FaceStyle, Part
from wrinkle_cad.cad.kernel.curves import edge_ends, edge_middle
from wrinkle_cad.cad.kernel.measures import check_valid, face_areas, tolerance_of
from wrinkle_cad.cad.kernel.topology import edges_of, faces_of, solid_inside
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.options.checking import check_numbers
from wrinkle_cad.options.signature import knows_its_options
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import norm
from wrinkle_cad.strip.ways import unused_text

from .bands import Band, StripLike, check_beside, check_sewable, make_band
from .border_check import compared_border
from .carve import carve_shapes
from .drawing import upper_drawing
from .end_fans import end_fan
from .opening import Opening, one_per_body
from .seam_angle import SeamAngle, seam_angles
from .sew import Sewn, sew

if TYPE_CHECKING:
    from build123d import Shell, Solid

Floats = NDArray[np.float64]
STEP = "stitch the wrinkle into the upper"
BODY = "body"


@dataclass(frozen=True, slots=True, eq=False)
class StitchReport:
    """What a stitched upper was measured to be."""

    face_count: int
    """Faces of the shell."""
    free_edges_before: int
    """Free edges of the upper."""
    free_edges_after: int
    """Free edges of the shell: the upper's own, in more pieces where a strip ends on them."""
    free_length_before_mm: float
    """Their length in the upper."""
    free_length_after_mm: float
    """Their length in the shell."""
    max_edge_tolerance_mm: float
    """The largest tolerance of an edge of the shell."""
    area_balance_mm2: float
    """Body and removed part together, less the upper."""
    area_mm2: float
    """Area of the shell."""
    is_valid: bool
    """Whether the kernel's own check finds no fault."""
    seams: tuple[SeamAngle, ...]
    """The angles along all seams."""
    bands: tuple[Band, ...]
    """The bands, in the order of the openings, P before Q."""

    def __repr__(self) -> str:
        state = "valid" if self.is_valid else "not valid"
        return (
            f"StitchReport({self.face_count} faces, {self.free_edges_after} free edges,"
            f" {self.area_mm2:.6g} mm2, {state})"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Stitched:
    """An upper with its wrinkles.

    Example:
        >>> from wrinkle_cad import WrinkleStrip, carve, stitch, wrinkle_profiles
        >>> from build123d import Edge, Face
        >>> upper = Face.make_rect(100, 60)
        >>> p, q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> opening = carve(upper, p, q, margin=2)
        >>> wrinkle = WrinkleStrip(*wrinkle_profiles(opening, waves=3, height=2), name="wrinkle")
        >>> type(stitch(opening, wrinkle).shell).__name__
        'Shell'
    """

    shell_shape: TopoDS_Shell
    """One shell, its normals as in the upper."""
    report: StitchReport
    """What it was measured to be."""
    parts: tuple[tuple[str, tuple[TopoDS_Face, ...]], ...]
    """The shell's faces by what they are: ``body``, then per strip its name and bands."""
    source: object
    """The object that the upper came in."""

    def __repr__(self) -> str:
        report = self.report
        return f"Stitched({report.face_count} faces, {report.free_edges_after} free edges)"

    def _repr_html_(self) -> str:
        """What a notebook shows: figures and a drawing of all edges."""
        from wrinkle_cad.pattern.formats.notebook import figures_with_drawing

        report = self.report
        figures = {
            "faces": f"{report.face_count}",
            "free edges before and after": f"{report.free_edges_before}, {report.free_edges_after}",
            "area": f"{report.area_mm2:.2f} mm2",
            "area balance": f"{report.area_balance_mm2:.2g} mm2",
            "largest edge tolerance": f"{report.max_edge_tolerance_mm:.2g} mm",
        }
        return figures_with_drawing("stitched upper", figures, upper_drawing(self.parts, BODY))

    @property
    def shell(self) -> Shell:
        """The shell as build123d has it, with the upper's name and color."""
        from wrinkle_cad.cad.exchange.likeness import alike

        return cast("Shell", alike(self.shell_shape, self.source, "upper"))

    def solid(self) -> Solid:
        """Returns the solid inside, with the upper's name and color: of a closed upper.

        Raises:
            InputError: the upper has a border.
        """
        from wrinkle_cad.cad.exchange.likeness import alike

        if self.report.free_edges_after:
            raise InputError(
                f"The upper has a border of {self.report.free_length_after_mm:.6g} mm, so it bounds"
                " no solid. Close it, or take the shell."
            )
        return cast("Solid", alike(solid_inside(self.shell_shape), self.source, "upper"))

    def export_step(
        self, path: str | Path, *, schema: settings.StepSchema = settings.STEP_SCHEMA
    ) -> None:
        """Writes the shell as STEP, its faces named after the body, the wrinkles and their bands.

        Raises:
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.cad.exchange.write import write_step

        write_step(Path(path), [self._part()], schema=schema)

    def export_stl(self, path: str | Path, *, tolerance: float = settings.TOLERANCE) -> None:
        """Writes the shell as binary STL.

        Args:
            path: of the file.
            tolerance: mm; how far the triangles may lie off the shell.

        Raises:
            ExportError: the file could not be written; what stood there before is untouched.
        """
        from wrinkle_cad.cad.exchange.write import write_stl

        write_stl(Path(path), self.shell_shape, tolerance=tolerance)

    def _part(self) -> Part:
        color = getattr(self.source, "color", None)
        upper = settings.UPPER_COLOR if color is None else tuple(color)[:3]
        styles = [
            FaceStyle(face, name, upper if name == BODY else settings.BAND_COLOR)
            for name, faces in self.parts
            for face in faces
        ]
        label = str(getattr(self.source, "label", "") or "upper")
        return Part(self.shell_shape, label, upper, styles)


@knows_its_options
def stitch(
    openings: Opening | Sequence[Opening],
    strips: StripLike | Sequence[StripLike],
    *,
    tolerance: float = settings.TOLERANCE,
) -> Stitched:
    """Joins an upper's body and the wrinkles in its openings to one shell.

    Where a profile leaves its opening's boundary, a band closes the gap; where the end bridge of a
    wrinkle leaves the opening's end, a fan does. Several openings may have been carved one after
    the other from each other's bodies, or each from the same upper: these are cut anew, at once.

    Args:
        openings: one, or several in order.
        strips: one per opening, between its profiles, which run as its rails do.
        tolerance: mm; chords of the bands along the openings.

    Raises:
        InputError: not as many strips as openings; a profile that does not belong to its opening;
            a band without width or that folds over.
        CadError: the parts do not become one valid shell with the upper's border.

    Example:
        >>> from wrinkle_cad import WrinkleStrip, carve, wrinkle_profiles
        >>> from build123d import Edge, Face
        >>> upper = Face.make_rect(100, 60)
        >>> p, q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> opening = carve(upper, p, q, margin=2)
        >>> p, q = wrinkle_profiles(opening, waves=3, height=2)
        >>> stitched = stitch(opening, WrinkleStrip(p, q, name="wrinkle"))
        >>> [name for name, _ in stitched.parts], stitched.report.is_valid
        (['body', 'wrinkle', 'wrinkle band P', 'wrinkle band Q'], True)
    """
    check_numbers(tolerance=tolerance)
    given = list(openings) if isinstance(openings, Sequence) else [openings]
    wanted = list(strips) if isinstance(strips, Sequence) else [strips]
    _check_kinds(given, wanted)
    if len(given) != len(wanted) or not given:
        raise InputError(
            f"{len(given)} openings and {len(wanted)} strips cannot be stitched: pass lists of"
            " equal length, one strip per opening."
        )
    chained = _carved_together(given, wanted)
    faces, parts, bands = _all_faces(chained, wanted, tolerance)
    sewn = sew(faces, settings.SEWING)
    return _stitched(given, chained, sewn, parts, bands)


def _check_kinds(openings: Sequence[object], strips: Sequence[object]) -> None:
    """Refuses what is no opening or no strip, and the two in the wrong order."""
    if any(isinstance(strip, Opening) for strip in strips):
        raise InputError(
            "stitch() was given an opening in place of a strip: pass the opening first and the"
            " strip second, stitch(opening, strip)."
        )
    for opening in openings:
        if not isinstance(opening, Opening):
            raise InputError(
                f"An opening cannot be a {type(opening).__name__}: pass what carve() returned."
            )
    for strip in strips:
        if not hasattr(strip, "topods_shell"):
            raise InputError(
                f"A strip cannot be a {type(strip).__name__}: pass a WrinkleStrip between the"
                " opening's profiles."
            )
        check_sewable(cast("StripLike", strip))


def _carved_together(openings: Sequence[Opening], strips: Sequence[StripLike]) -> list[Opening]:
    """Returns the openings with one body, or each carved from the body of those before.

    Openings that were cut from one and the same upper, each for itself, are cut anew, all at once.
    """
    chained: list[Opening] = []
    pairs = list(zip(openings, strips, strict=True))
    while pairs:
        given = pairs[0][0].given_shape
        count = next((i for i, (o, _) in enumerate(pairs) if not o.given_shape.IsSame(given)), None)
        run, pairs = pairs[:count], [] if count is None else pairs[count:]
        held = [opening for opening, _ in run]
        upper = chained[-1].body_shape if chained else given
        is_one = all(opening.body_shape.IsSame(held[0].body_shape) for opening in held)
        if not is_one or not given.IsSame(upper):
            named = [replace(opening.request, name=strip.name) for opening, strip in run]
            held = carve_shapes(upper, named, source=held[0].source)
        chained += held
    return chained


def _all_faces(
    openings: Sequence[Opening], strips: Sequence[StripLike], tolerance: float
) -> tuple[list[TopoDS_Face], list[str], list[Band]]:
    """Returns the faces to be sewn, what part each is of, and the bands."""
    faces = faces_of(openings[-1].body_shape)
    parts, bands = [BODY] * len(faces), list[Band]()
    for opening, strip in zip(openings, strips, strict=True):
        name = strip.name
        pieces: list[tuple[str, Sequence[TopoDS_Face]]] = [(name, faces_of(strip.topods_shell()))]
        ends = []
        for i, (edges, profile, samples) in enumerate(
            (
                (opening.p_edges, strip.p, strip.p_samples),
                (opening.q_edges, strip.q, strip.q_samples),
            )
        ):
            if profile.is_closed:
                check_beside(samples, edges, "PQ"[i])
            else:
                ends.append(_side_ends(edges, profile, "PQ"[i]))
                _check_reach(strip, ends[-1], profile)
            band = make_band(opening, i, strip, tolerance)
            if band is not None:
                bands.append(band)
                pieces.append((band.name, faces_of(band.shell)))
        both_ends = ((0, opening.start_edges), (1, opening.end_edges)) if len(ends) == 2 else ()
        for at, edges in both_ends:
            bridge = np.array([strip.p_samples.points[-at], strip.q_samples.points[-at]])
            corners = np.array([ends[0][at], ends[1][at]])
            pieces.append((f"{name} end {at + 1}", end_fan(edges, bridge, corners)))
        for part, made in pieces:
            faces.extend(made)
            parts.extend([part] * len(made))
    return faces, parts, bands


def _side_ends(edges: Sequence[TopoDS_Edge], profile: Directrix, rail: str) -> Floats:
    """Returns (2, 3) mm: where a side starts and ends; checks that the profile is its own."""
    ends = np.array([edge_ends(edges[0])[0], edge_ends(edges[-1])[1]])
    tips = profile.point_at(np.array(profile.interval))
    gap = float(np.linalg.norm(tips - ends, axis=1).max())
    if gap > settings.RAIL_OFF_UPPER:
        raise InputError(
            f"The ends of profile {rail} are {gap:.3g} mm from those of the opening, at most"
            f" {settings.RAIL_OFF_UPPER:.3g} mm is allowed. Pass the profiles of this opening."
        )
    return ends


def _check_reach(strip: StripLike, ends: Floats, profile: Directrix) -> None:
    """Refuses a strip that left rail at an end of the opening."""
    tips = profile.point_at(np.array(profile.interval))
    unused = strip.triangulation.unused
    shortest = min((left for left in unused if left > 0.0), default=math.inf)
    if float(row_lengths(tips - ends).max()) > min(0.5 * shortest, settings.RAIL_OFF_UPPER):
        raise InputError(
            f"{strip.name} leaves {unused_text(unused)}, so it does not fill its opening. Leave its"
            " ends fixed, or shorten the rails by so much before the upper is carved: in a script"
            " carve(upper, strip.p, strip.q), and a strip with fixed ends between its p and q."
        )


def _stitched(
    openings: Sequence[Opening],
    chained: Sequence[Opening],
    sewn: Sewn,
    parts: Sequence[str],
    bands: Sequence[Band],
) -> Stitched:
    upper = chained[0].upper_shape
    grouped: dict[str, list[TopoDS_Face]] = {}
    for face, part in zip(sewn.faces, parts, strict=True):
        grouped.setdefault(part, []).append(face)
    border = compared_border(
        upper,
        sewn.shell,
        sum(opening.lost_border for opening in chained),
        sum(_gaps_bridged(opening) for opening in chained),
    )
    check_valid(sewn.shell, STEP, "Change the margin, or move the rails a little.")
    report = StitchReport(
        face_count=len(sewn.faces),
        free_edges_before=border.before,
        free_edges_after=border.after,
        free_length_before_mm=border.length_before,
        free_length_after_mm=border.length_after,
        max_edge_tolerance_mm=_checked_tolerance(sewn.shell, upper),
        area_balance_mm2=sum(opening.area_balance for opening in one_per_body(chained)),
        area_mm2=chained[-1].areas[1]
        + sum(face_areas(sewn.faces[parts.count(BODY) :], relative_error=settings.AREA_BALANCE)),
        is_valid=True,
        seams=seam_angles(sewn.faces, parts),
        bands=tuple(bands),
    )
    parted = tuple((name, tuple(held)) for name, held in grouped.items())
    return Stitched(sewn.shell, report, parted, openings[0].source)


def _gaps_bridged(opening: Opening) -> float:
    """Returns mm: how much new border stands across gaps of the upper that an opening meets."""
    bridged = 0.0
    for edges in (opening.p_edges, opening.q_edges):
        for before, after in pairwise(edges):
            gap = norm(edge_ends(after)[0] - edge_ends(before)[1])
            bridged += gap if gap > settings.GAP_CROSSED else 0.0
    return bridged


def _checked_tolerance(shell: TopoDS_Shell, upper: TopoDS_Shape) -> float:
    found, own = tolerance_of(shell), tolerance_of(upper)
    limit = max(settings.EDGE_TOLERANCE_LIMIT, own)
    if found > limit:
        widest = next(edge for edge in edges_of(shell) if BRep_Tool.Tolerance_s(edge) == found)
        raise CadError(
            STEP,
            f"the largest edge tolerance is {found:.2g} mm, at"
            f" {place_text(edge_middle(widest), 0.0)}, the upper's own {own:.2g} mm,"
            f" at most {limit:.2g} mm is allowed. Change the margin, or move the rails a little.",
        )
    return found

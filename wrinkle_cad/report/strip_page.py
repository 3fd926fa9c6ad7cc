"""A strip of a script as people look at it: the page of a run, and the few lines of a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.options.checking import check_known
from wrinkle_cad.options.option import options_of
from wrinkle_cad.pattern.formats.notebook import figures_with_drawing
from wrinkle_cad.pattern.formats.svg import drawing_of
from wrinkle_cad.pattern.piece.piece import PatternPiece

from .limits import Limits, LimitSettings
from .material import Material, find_material
from .page import write_page
from .verdict import entries_of, judge
from .versions import installed_versions
from .views import MeshView, StripView

if TYPE_CHECKING:
    from wrinkle_cad.wrinkle.cut_pattern import Pattern
    from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip
    from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

    from .verdict import Verdict

_SURFACE_SAMPLES: Final = 3000
"""The page shows the triangles themselves of a strip of more samples: no eye tells them apart."""
_SURFACE_SAG: Final = 5e-4
"""Of the strip's size; how far the triangles of the drawn surface may lie from it."""
_SURFACE_ANGLE: Final = 0.2
"""rad; how far the normals of its neighbouring triangles may differ."""
_MATRIX_BRIDGES: Final = 50_000_000
"""The page shows no validity matrix of more possible bridges: they alone would take 50 MB."""


def strip_view(strip: TriangulatedStrip, pieces: Sequence[PatternPiece]) -> StripView:
    """Returns what a page shows of a strip.

    Args:
        strip: the strip.
        pieces: its pieces.
    """
    m, n = len(strip.triangulation.p), len(strip.triangulation.q)
    return StripView(
        surface=_surface(strip) if m + n <= _SURFACE_SAMPLES else None,
        name=strip.name,
        triangulation=strip.triangulation,
        unrolling=strip.unrolling,
        pieces=tuple(pieces),
        valid=strip.valid if m * n <= _MATRIX_BRIDGES else None,
        local=strip.local,
        least_bending=strip.least_bending,
        role=strip.role,
    )


def _surface(strip: TriangulatedStrip) -> MeshView:
    from wrinkle_cad.cad.kernel.mesh import mesh_of

    points = np.vstack((strip.triangulation.p, strip.triangulation.q))
    sag = _SURFACE_SAG * float(np.ptp(points, axis=0).max())
    vertices, faces = mesh_of(
        strip.topods_shell(),
        tolerance=sag / settings.MESH_SAG_PER_TOLERANCE,
        angular_tolerance=_SURFACE_ANGLE,
    )
    return MeshView(strip.name, vertices.astype(np.float32), faces.astype(np.int32))


def write_strip_page(
    path: Path, strip: WrinkleStrip, pattern: Pattern, judging: Mapping[str, Any]
) -> None:
    """Writes the page of a strip that a script made.

    Args:
        path: the file; replaced as a whole.
        strip: the strip.
        pattern: whose pieces are shown.
        judging: limits by name, and ``material``, for which the strip's own stands.

    Raises:
        InputError: a limit or the material cannot be used.
        ExportError: the file cannot be written.
    """
    limits = _limits(judging, strip.material, "export_html()")
    strip = _made_of(strip, limits)
    shown = {key: at.name if isinstance(at, Path) else at for key, at in judging.items()}
    entries = entries_of([strip.report], limits)
    summary = {
        "input": {"file": strip.name},
        "settings": {"tolerance": strip.tolerance, "surface": strip.surface, **shown},
        "versions": installed_versions(),
        "strips": entries,
        "verdict": judge(entries, limits).as_json(),
        "findings": [asdict(finding) for finding in (*strip.findings, *pattern.findings)],
    }
    page = write_page(summary, [strip_view(strip, pattern.pieces)])
    write_export(path, "HTML", page.encode("utf-8"))


def strip_verdict(strip: WrinkleStrip, judging: Mapping[str, Any]) -> Verdict:
    """Judges a strip that a script made.

    Args:
        strip: the strip.
        judging: limits by name, and ``material``, for which the strip's own stands.

    Raises:
        InputError: a limit or the material cannot be used.
    """
    limits = _limits(judging, strip.material, "verdict()")
    strip = _made_of(strip, limits)
    return judge(entries_of([strip.report], limits), limits)


def _made_of(strip: WrinkleStrip, limits: Limits) -> WrinkleStrip:
    """The strip, as thick as the material that it is judged by where nothing else was asked for."""
    if not limits.thickness_mm or strip.stock.thickness:
        return strip
    twin = copy(strip)
    k_factor = limits.k_factor or strip.stock.k_factor
    twin.stock = replace(strip.stock, thickness=limits.thickness_mm, k_factor=k_factor)
    vars(twin).pop("report", None)  # its inner radii are of a sheet without thickness
    return twin


def _limits(judging: Mapping[str, Any], own: Material | None, function: str) -> Limits:
    known = options_of(LimitSettings)
    check_known(judging, [*known, "material"], function)
    limits = Limits(**{name: value for name, value in judging.items() if name in known})
    named = judging.get("material")
    material = own if named is None else find_material(str(named))
    return limits if material is None else limits.of(material)


def strip_in_notebook(strip: TriangulatedStrip) -> str:
    """Returns the figures of a strip and its flat pattern as HTML.

    Args:
        strip: the strip.
    """
    report = strip.trial_report
    seams = report.seam_lengths_mm
    figures = {
        "state": report.state,
        "developable share": f"{100.0 * report.developable_share:.1f} %",
        "largest strain": f"{report.max_strain_percent:.3g} %",
        "largest fold": f"{report.max_fold_deg:.2f} degrees",
        "largest twist": f"{report.max_twist_deg:.2f} degrees",
        "area": f"{strip.area_mm2:.2f} mm2",
        "P and Q": f"{seams['p'].space:.2f} and {seams['q'].space:.2f} mm",
        "samples": f"{report.samples_p} x {report.samples_q}",
    }
    return figures_with_drawing(strip.name, figures, drawing_of(strip.pattern().pieces))

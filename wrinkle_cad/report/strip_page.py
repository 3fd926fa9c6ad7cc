"""A strip of a script as people look at it: the page of a run, and the few lines of a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.options.checking import check_known
from wrinkle_cad.options.option import options_of
from wrinkle_cad.pattern.formats.notebook import figures_with_drawing
from wrinkle_cad.pattern.formats.svg import drawing_of
from wrinkle_cad.pattern.piece.piece import PatternPiece

from .limits import Limits, LimitSettings
from .material import find_material
from .page import write_page
from .verdict import entries_of, judge
from .versions import installed_versions
from .views import StripView

if TYPE_CHECKING:
    from wrinkle_cad.wrinkle.cut_pattern import Pattern
    from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip

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
        name=strip.name,
        triangulation=strip.triangulation,
        unrolling=strip.unrolling,
        pieces=tuple(pieces),
        valid=strip.valid if m * n <= _MATRIX_BRIDGES else None,
        local=strip.local,
        least_bending=strip.least_bending,
        role=strip.role,
    )


def write_strip_page(
    path: Path, strip: TriangulatedStrip, pattern: Pattern, judging: Mapping[str, Any]
) -> None:
    """Writes the page of a strip that a script made.

    Args:
        path: the file; replaced as a whole.
        strip: the strip.
        pattern: whose pieces are shown.
        judging: limits by name, and ``material``.

    Raises:
        InputError: a limit or the material cannot be used.
        ExportError: the file cannot be written.
    """
    limits = _limits(judging)
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


def _limits(judging: Mapping[str, Any]) -> Limits:
    known = options_of(LimitSettings)
    check_known(judging, [*known, "material"], "export_html()")
    limits = Limits(**{name: value for name, value in judging.items() if name in known})
    material = judging.get("material")
    return limits if material is None else limits.of(find_material(str(material)))


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

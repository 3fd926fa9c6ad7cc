"""Whether the piece that is cut is the surface that the verdict is about."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from wrinkle_cad.cad.faces.exact_surface import rail_curve
from wrinkle_cad.errors import Finding, Severity
from wrinkle_cad.strip.rulings.cut_difference import FlatRail, cut_difference

if TYPE_CHECKING:
    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.rulings.surface import RuledStrip
    from wrinkle_cad.strip.triangulation import Triangulation


DIFFERS_PERCENT: Final = 1.0
"""The piece that is cut is another surface than the verdict's if its area differs by more, or if
along a ruling it is longer by more ..."""
DIFFERS_TOLERANCES: Final = 4.0
"""... and by more than so many tolerances: on 12 strips whose piece is the verdict's surface, the
two lengths differed by a third of the tolerance at most."""


@dataclass(frozen=True, slots=True)
class CutReport:
    """How the piece that is cut differs from the surface of least twist, which is judged."""

    longer_mm: float
    """At the ruling of that surface where this is largest, how much longer it is on the piece;
    negative if shorter."""
    longer_percent: float
    """The same, of the ruling's length."""
    p_mm: float
    """Where that ruling is, along P from its start."""
    larger_percent: float
    """How much larger the piece's area is."""
    differs: bool
    """Whether they are two surfaces: by more than ``DIFFERS_PERCENT`` and
    ``DIFFERS_TOLERANCES`` along a ruling, or by that percentage in area."""


def cut_report(
    ruled: RuledStrip,
    unrolling: Unrolling,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
    tolerance: float,
) -> CutReport:
    """Compares the piece with the surface that is judged.

    Args:
        ruled: the surface.
        unrolling: the piece.
        rails: directrices P and Q.
        samples: those of P and of Q.
        tolerance: mm; the chord tolerance of the samples.
    """
    lines = (
        (unrolling.p_line, unrolling.p_arc, unrolling.p_index),
        (unrolling.q_line, unrolling.q_arc, unrolling.q_index),
    )
    flat = []
    for (line, arc, index), rail, sampled in zip(lines, rails, samples, strict=True):
        # Facets, and rails given as points, have the lengths of chords.
        at = rail_curve(rail).arc_at(sampled.parameters)
        flat.append(FlatRail(np.interp(arc, arc[index], at), line))
    is_closed = all(rail.is_closed for rail in rails)
    found = cut_difference(ruled.sheet, (flat[0], flat[1]), unrolling.area, is_closed=is_closed)
    return CutReport(
        longer_mm=found.longer,
        longer_percent=100.0 * found.share,
        p_mm=found.p_arc,
        larger_percent=100.0 * found.larger,
        differs=found.is_beyond(DIFFERS_PERCENT / 100.0, DIFFERS_TOLERANCES * tolerance),
    )


def cut_findings(
    name: str, cut: CutReport, triangulation: Triangulation, *, is_band: bool
) -> tuple[Finding, ...]:
    """Returns that the piece is not the surface that is judged, where it is not.

    Args:
        name: of the strip.
        cut: how they differ.
        triangulation: that the piece unrolls.
        is_band: whether the program made the strip: then it is worth knowing, and no warning.
    """
    if not cut.differs:
        return ()
    severity: Severity = "info" if is_band else "warning"
    largest_fold = float(np.abs(triangulation.fold).max(initial=0.0))
    message = (
        f"The piece of {name} is not the surface that the verdict is about: {cut_words(cut)}. It"
        f" folds by up to {math.degrees(largest_fold):.1f} degrees at a bridge."
    )
    if not is_band:
        message += (
            " Cut a sample first, or cut that surface itself (--surface smooth, where it has few"
            " pieces), or the strip that bends least (--criteria bending), which is often near it."
        )
    return (Finding("cut-differs", severity, message),)


def cut_words(cut: CutReport) -> str:
    """Returns by how much a piece differs.

    >>> cut_words(CutReport(1.96, 14.0, 30.5, 2.75, True))
    'along the rulings it is up to 14.0% (1.96 mm) longer, at 30.5 mm of P, its area 2.8% larger'
    """
    way = "longer" if cut.longer_mm >= 0.0 else "shorter"
    size = "larger" if cut.larger_percent >= 0.0 else "smaller"
    return (
        f"along the rulings it is up to {abs(cut.longer_percent):.1f}%"
        f" ({abs(cut.longer_mm):.2f} mm) {way}, at {cut.p_mm:.1f} mm of P, its area"
        f" {abs(cut.larger_percent):.1f}% {size}"
    )

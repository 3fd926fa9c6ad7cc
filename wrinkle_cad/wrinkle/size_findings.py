"""Whether a strip is so small that its unit may be another one than millimetres."""

from __future__ import annotations

from typing import Final

from wrinkle_cad.errors import Finding
from wrinkle_cad.strip.curve.polyline import polyline_length
from wrinkle_cad.strip.triangulation import Triangulation

LENGTH: Final = 200.0
"""In tolerances: a strip that is no longer loses its shape to them."""
WIDTH: Final = 10.0
"""The same for one that is no wider."""
BOTH: Final = 3.0
"""So many times these it may have, if it is as short as it is narrow."""
MM_PER_UNIT: Final = {"m": 1000.0, "ft": 304.8, "inch": 25.4, "cm": 10.0}
LARGEST: Final = 50_000.0
"""mm; the longest strip that a unit is thought of for."""


def size_findings(name: str, triangulation: Triangulation, tolerance: float) -> tuple[Finding, ...]:
    """Returns whether a strip is only a few tolerances large, and which unit would explain it.

    Args:
        name: of the strip.
        triangulation: of the strip.
        tolerance: mm; of its chords.
    """
    length = max(polyline_length(triangulation.p), polyline_length(triangulation.q))
    width = triangulation.area / length
    shares = length / (LENGTH * tolerance), width / (WIDTH * tolerance)
    if min(shares) > 1.0 and max(shares) > BOTH:
        return ()
    unit = next((unit for unit, mm in MM_PER_UNIT.items() if length * mm <= LARGEST), None)
    likely = "" if unit is None else f"; in {unit} it would be {_size(unit, length, width)} mm"
    way = (
        "Give a finer tolerance."
        if unit is None
        else f"If its numbers are {unit}, read the file with --unit {unit}, export it in its true"
        f" unit, or multiply by {MM_PER_UNIT[unit]:g} in the script; else give a finer tolerance."
    )
    message = (
        f"{name} is {length:.3g} mm long and {width:.3g} mm wide{likely}. That is"
        f" {length / tolerance:.0f} and {width / tolerance:.0f} times its tolerance of"
        f" {tolerance:g} mm, too few to keep its shape. {way}"
    )
    return (Finding("size-near-tolerance", "warning", message),)


def _size(unit: str, length: float, width: float) -> str:
    factor = MM_PER_UNIT[unit]
    return f"{length * factor:.0f} x {width * factor:.0f}"

"""The gap list as it stands in the JSON and on the page: where to change a rail."""

from __future__ import annotations

import math
from typing import Any, Final

from wrinkle_cad.strip.gaps import Gap, Kind

ADVICE: Final[dict[Kind, str]] = {
    "inflection": "Nothing to change: the bend changes sides here. A finer tolerance narrows it.",
    "twist": (
        "The rails turn against each other here: let their waves run in step, make them lower, or"
        " bring the rails closer together."
    ),
    "fan end": (
        "The strip runs into a fan or crease here: smooth the rail on the side that moves, or move"
        " its end so that no long fan is needed."
    ),
}
"""What to do about each kind of gap."""


def gap_entry(gap: Gap) -> dict[str, Any]:
    """A gap as plain values for the JSON: lengths in mm, angles in degrees."""
    return {
        "kind": gap.kind,
        "first_bridge": gap.first,
        "last_bridge": gap.last,
        "start": list(gap.start),
        "end": list(gap.end),
        "p_length_mm": gap.p_length,
        "q_length_mm": gap.q_length,
        "angle_defect_deg": math.degrees(gap.angle_defect),
        "twist_deg": math.degrees(gap.twist),
        "advice": ADVICE[gap.kind],
    }

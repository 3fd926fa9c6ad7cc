"""Every default and tolerance, named once.

The user gives one ``tolerance`` in mm; whatever else is a tolerance is derived from it here.
Lengths are in mm and angles in radians unless a name ends in another unit.
"""

from __future__ import annotations

from typing import Final

VERSION: Final = "0.1.0"

TOLERANCE: Final = 0.05
"""mm; how far a chord may lie from its curve when the user says nothing."""

PLANARITY_PER_TOLERANCE: Final = 1e-3
"""A neighbour may lie this share of the chord tolerance on the wrong side of a tangent plane.

Near the chord tolerance itself every bridge would count as valid; at zero, round-off rejects
bridges of exact developables.
"""

SHORTEST_SEGMENT_PER_LENGTH: Final = 1e-6
"""No sampled segment is shorter than this share of its curve's length."""

CRITERIA: Final = ("invalid", "bending")
"""GODT+GMBT: as many locally convex bridges as possible, then least bending."""

SEARCH: Final = "global"
ENERGY: Final = "hinge"
SURFACE: Final = "cones"
STEP_SCHEMA: Final = "AP214"

CONFUSION: Final = 1e-7
"""mm; points nearer than this are one point to the CAD kernel (its own fixed constant)."""

LENGTH_ERROR: Final = 1e-9
"""mm; how exactly the CAD kernel integrates the length of an edge."""

AREA_RELATIVE_ERROR: Final = 1e-9
"""How exactly the CAD kernel integrates the area of a face; its own default is some 1e-5."""


def planarity_from(tolerance: float) -> float:
    """Returns the planarity in mm that fits a chord tolerance in mm."""
    return PLANARITY_PER_TOLERANCE * tolerance

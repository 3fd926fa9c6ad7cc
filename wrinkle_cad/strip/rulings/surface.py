"""The exact surface of a strip, from its curves: its pieces, and what they ask of a sheet."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .bending import radius_along
from .chains import with_exact_fans
from .creases import Crease, creases_of
from .held import (
    NOTHING_HELD,
    Held,
    Place,
    Section,
    corners_entered,
    held_rulings,
    joined,
    places_between,
    sections_of,
)
from .least_twist import Pairing, finer_pairing, first_spacing, pairing_near
from .pieces import Piece, developable_share, pieces_of
from .rail_curve import RailCurve
from .sheet import Sheet, sheet_of
from .stations import slid, stations_of
from .strain import Strain, strain_of

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MOST_FINER: Final = 2
"""A grid is made finer at most so often ..."""
STABLE_SHARE: Final = 0.005
"""... and until the largest strain changes by no more than this share of it ..."""
STABLE_STRAIN: Final = 1e-5
"""... or by no more than this."""


@dataclass(frozen=True, slots=True, eq=False)
class RuledStrip:
    """The surface between two curves near a triangulation, as exact rulings in ordered pieces."""

    sheet: Sheet
    """Rulings and tangent planes."""
    pieces: tuple[Piece, ...]
    """Torsal pieces, cones, planes and gaps, in order along the strip."""
    creases: tuple[Crease, ...]
    """Where the tangent plane jumps, in order along the strip."""
    strain: Strain
    """What a flat sheet must give."""
    radius: Floats
    """(k - 1,) float64, mm; smallest bend radius in each interval between rulings; inf if flat."""

    def __repr__(self) -> str:
        return f"RuledStrip({len(self.pieces)} pieces, {len(self.creases)} creases)"

    @property
    def developable_share(self) -> float:
        """Share, 0 to 1, of both rails' length that pieces other than gaps cover."""
        return developable_share(self.sheet)

    @property
    def largest_twist(self) -> float:
        """rad, not negative; the largest turn of the tangent plane along a ruling."""
        return float(np.abs(self.sheet.twist).max(initial=0.0))

    @property
    def largest_crease(self) -> float:
        """rad; the angle of the sharpest crease, 0 without any."""
        return max((crease.angle for crease in self.creases), default=0.0)

    def smallest_bend_radius(self, least_crease: float) -> float:
        """Returns mm: the radius at the sharpest place; 0 at a crease, inf for a flat strip.

        Args:
            least_crease: rad; creases below it do not count.
        """
        if self.largest_crease >= least_crease:
            return 0.0
        return float(self.radius.min(initial=math.inf))


def rule_strip(
    p: RailCurve,
    q: RailCurve,
    bridges: tuple[Floats, Floats],
    max_lean: float | None = None,
    held: Held = NOTHING_HELD,
) -> RuledStrip:
    """Returns the surface between two curves that is nearest to developable near a triangulation.

    Args:
        p: the curve P.
        q: the curve Q, run the same way.
        bridges: (k,) float64 each; parameters on P and Q of the triangulation's bridges, in order.
        max_lean: rad; how far a ruling may lean from the shortest crossing; any way when None.
        held: rulings that must be, which then end pieces, and stretches that none may join; the
            triangulation keeps both.
    """
    return ruled_strip_of(rule_sheet(p, q, bridges, max_lean, held), p, q)


@dataclass(frozen=True, slots=True, eq=False)
class FoundSheet:
    """The tangent planes of a surface, and how they were found."""

    sheet: Sheet
    """The tangent planes."""
    spacing: float
    """mm between the nodes that they were found on."""
    held: Ints
    """Numbers of the rulings that were held."""


def rule_sheet(
    p: RailCurve,
    q: RailCurve,
    bridges: tuple[Floats, Floats],
    max_lean: float | None = None,
    held: Held = NOTHING_HELD,
) -> FoundSheet:
    """Returns the tangent planes of that surface.

    Args:
        p: the curve P.
        q: the curve Q.
        bridges: as for `rule_strip`.
        max_lean: likewise.
        held: likewise.
    """
    pinned = list(held.pinned)
    for _ in range(len(held.forbidden) + 1):
        places = places_between(p, q, pinned)
        sheet, spacing = _between(p, q, bridges, max_lean, places)
        corners = corners_entered(sheet.rulings, bridges, held.forbidden)
        if not corners:
            break
        pinned += corners
    return FoundSheet(sheet, spacing, held_rulings(sheet.rulings, places))


def _between(
    p: RailCurve,
    q: RailCurve,
    bridges: tuple[Floats, Floats],
    max_lean: float | None,
    places: list[Place],
) -> tuple[Sheet, float]:
    """The sheet that has some rulings, and the mm between its nodes."""
    sections = sections_of(p, q, bridges, places)
    spacing = first_spacing(p, q, bridges)
    found = [pairing_near(one.p, one.q, one.bridges, spacing, max_lean) for one in sections]
    strain = strain_of(_exact(p, q, sections, found)).largest
    for _ in range(MOST_FINER):
        found = [
            finer_pairing(one.p, one.q, pairing, max_lean)
            for one, pairing in zip(sections, found, strict=True)
        ]
        sheet = _exact(p, q, sections, found)
        before, strain = strain, strain_of(sheet).largest
        if abs(strain - before) <= max(STABLE_STRAIN, STABLE_SHARE * strain):
            break
    return sheet, found[0].spacing


def ruled_strip_of(found: FoundSheet, p: RailCurve, q: RailCurve) -> RuledStrip:
    """Returns the pieces and figures of a sheet; rulings that were held end pieces.

    Args:
        found: its tangent planes.
        p: the curve P.
        q: the curve Q.
    """
    sheet = found.sheet
    creases = creases_of(sheet, p, q, found.spacing)
    at = np.array([crease.ruling for crease in creases], dtype=np.int64)
    pieces = pieces_of(sheet, np.union1d(at, found.held))
    return RuledStrip(sheet, pieces, creases, strain_of(sheet), radius_along(sheet, pieces))


def _exact(p: RailCurve, q: RailCurve, sections: list[Section], found: list[Pairing]) -> Sheet:
    spacing = found[0].spacing
    rulings = []
    for one, pairing in zip(sections, found, strict=True):
        own = with_exact_fans(pairing.p, pairing.q, stations_of(pairing), spacing)
        rulings.append(slid(one.p, one.q, own, spacing))
    return sheet_of(p, q, joined(sections, rulings), spacing)

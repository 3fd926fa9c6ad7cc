"""The gaps of a strip in numbers and words, each with the turn of a rail that closes it, tried."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.rulings.cures import Cure, cure_of
from wrinkle_cad.strip.rulings.gaps import Gap, gaps_of
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip
from wrinkle_cad.strip.rulings.turned_rail import Stays
from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]
Rails = tuple[RailCurve, RailCurve]

MOST_TRIED: Final = 4
"""So many gaps of a strip are tried, those that ask most of a sheet."""
_WHOLE: Final = 0.999
"""A gap that covers so much of a rail is the whole of it, in words."""


@dataclass(frozen=True, slots=True)
class TurnReport:
    """A turn of a rail within a gap that was tried and helps."""

    rail: Literal["P", "Q"]
    """The rail that is turned."""
    turn_deg: float
    """By how much, where the gap asks most of a sheet; right-handed (clockwise) as seen from P
    to Q."""
    stays: Stays
    """The end of the rail that stays where it is; the other one moves along."""
    at_mm: float
    """Along the rail from its start: where ``move_mm`` is taken, the end of the turn; the place of
    the largest move where both ends stay."""
    move_mm: tuple[float, float, float]
    """How the rail moves there."""
    strain_percent: float
    """The largest strain that is left in the gap."""


@dataclass(frozen=True, slots=True)
class GapReport:
    """A stretch of a strip where a flat sheet must give."""

    p_from_mm: float
    """Along rail P from its start."""
    p_to_mm: float
    """Likewise; below ``p_from_mm`` where a closed rail's start lies inside."""
    q_from_mm: float
    """Along rail Q from its start."""
    q_to_mm: float
    """Likewise."""
    length_mm: float
    """Along the middle of the strip."""
    twist_deg: float
    """Turn of the tangent plane along the ruling that strains a sheet most; right-handed
    (clockwise) as seen from P to Q."""
    max_strain_percent: float
    """What a flat sheet must give at most."""
    first_bridge: int
    """Number of the bridge nearest to its start."""
    last_bridge: int
    """Number of the bridge nearest to its end."""
    turn: TurnReport | None
    """The least turn of a rail that was tried and helps; None if none did, or none was tried."""
    advice: str
    """What to do, or what was tried in vain."""


def gap_reports(
    rails: Rails,
    ruled: RuledStrip,
    triangulation: Triangulation,
    *,
    is_closed: bool,
    may_turn: bool,
) -> tuple[GapReport, ...]:
    """Returns the gaps in order along the strip; tries what closes those that stretch a sheet.

    Args:
        rails: the curves P and Q.
        ruled: the exact surface between them.
        triangulation: of the same strip.
        is_closed: whether both rails end where they start.
        may_turn: whether the rails are the user's to turn; those of a band are not.
    """
    gaps = gaps_of(ruled)
    enough = settings.STRETCH_PERCENT / 100.0
    stretching = [gap for gap in gaps if gap.strain > enough]
    tried = sorted(stretching, key=lambda gap: -gap.strain)[:MOST_TRIED] if may_turn else []
    cures = {
        gap.first: cure_of(rails, ruled, gap, is_closed=is_closed, enough=enough) for gap in tried
    }
    places = _bridge_places(triangulation)
    reports = []
    for gap in gaps:
        cure = cures.get(gap.first)
        turn = None if cure is None else _turn_report(cure, rails, is_closed=is_closed)
        if gap.strain <= enough:
            advice = (
                f"Nothing to change: it asks {_percent(gap.strain)} of a sheet, and up to"
                f" {settings.STRETCH_PERCENT:g}% counts as none."
            )
        elif turn is not None:
            advice = turn_words(turn, gap.strain)
        elif gap.first in cures:
            advice = (
                "P and Q were each turned against the twist here, and neither way lessens the"
                " strain by a fifth."
            )
        elif may_turn:
            advice = f"Nothing was tried here: the {MOST_TRIED} gaps that ask most were."
        else:
            advice = "It is a wall that the program made: see what was tried on the waves."
        reports.append(_report(gap, rails, ruled, places, turn, advice, is_closed=is_closed))
    return tuple(reports)


def _report(
    gap: Gap,
    rails: Rails,
    ruled: RuledStrip,
    places: Floats,
    turn: TurnReport | None,
    advice: str,
    *,
    is_closed: bool,
) -> GapReport:
    rulings = ruled.sheet.rulings
    ends = [gap.first, gap.last]
    p_from, p_to = _arcs(rails[0], rulings.u[ends], is_closed=is_closed)
    q_from, q_to = _arcs(rails[1], rulings.v[ends], is_closed=is_closed)
    first, last = (int(np.argmin(np.abs(places - at))) for at in (p_from + q_from, p_to + q_to))
    return GapReport(
        p_from_mm=p_from,
        p_to_mm=p_to,
        q_from_mm=q_from,
        q_to_mm=q_to,
        length_mm=gap.length,
        twist_deg=math.degrees(gap.twist),
        max_strain_percent=100.0 * gap.strain,
        first_bridge=first,
        last_bridge=max(first, last),
        turn=turn,
        advice=advice,
    )


def _turn_report(cure: Cure, rails: Rails, *, is_closed: bool) -> TurnReport:
    turned = cure.turned
    rail = rails[0] if turned.rail == "P" else rails[1]
    place = {"start": len(turned.parameters) - 1, "end": 0, "both": turned.farthest}[turned.stays]
    (at,) = _arcs(rail, turned.parameters[[place]], is_closed=is_closed)
    x, y, z = (float(step) for step in turned.moves[place])
    return TurnReport(
        rail=turned.rail,
        turn_deg=math.degrees(turned.turn),
        stays=turned.stays,
        at_mm=at,
        move_mm=(x, y, z),
        strain_percent=100.0 * cure.strain,
    )


def turn_words(turn: TurnReport, strain: float) -> str:
    """Returns a turn as what to do, and what came of it when it was tried.

    Args:
        turn: the turn.
        strain: of the gap before it, 0 to 1.
    """
    way = "clockwise" if turn.turn_deg > 0.0 else "anticlockwise"
    x, y, z = (round(step, 2) + 0.0 for step in turn.move_mm)
    beyond = {
        "start": " and from there to its end",
        "end": " and from there back to its start",
        "both": ", while its ends stay",
    }[turn.stays]
    return (
        f"Turn {turn.rail} by {abs(turn.turn_deg):.1f}° {way}, as seen from P to Q: it moves by"
        f" ({x:g}, {y:g}, {z:g}) mm at {turn.at_mm:.1f} mm{beyond}. Tried: of {_percent(strain)}"
        f" strain {_percent(turn.strain_percent / 100.0)} is left."
    )


def _percent(share: float) -> str:
    percent = 100.0 * share
    return "0%" if percent < 5e-4 else f"{percent:.3g}%"


def _arcs(rail: RailCurve, u: Floats, *, is_closed: bool) -> Iterator[float]:
    """Places along a rail from its start, mm."""
    first, last = rail.interval
    inside = first + np.mod(u - first, last - first) if is_closed and last > first else u
    return (float(arc) for arc in rail.arc_at(inside))


def _bridge_places(triangulation: Triangulation) -> Floats:
    i, j = triangulation.bridges.T
    points = (triangulation.p, triangulation.q)
    p_arc, q_arc = (
        arc_lengths(rail)[np.minimum(index, len(rail) - 1)]
        for rail, index in zip(points, (i, j), strict=True)
    )
    places: Floats = p_arc + q_arc
    return places

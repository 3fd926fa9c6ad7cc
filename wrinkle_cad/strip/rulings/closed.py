"""A closed strip: more than a turn is ruled, so that the turn in the middle has no ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from .creases import Crease
from .held import NOTHING_HELD, Held
from .rail_curve import RailCurve
from .sheet import Sheet
from .stations import Stations
from .surface import FoundSheet, RuledStrip, rule_sheet, ruled_strip_of
from .vectors import lengths

Floats = npt.NDArray[np.float64]

MARGIN_PER_WIDTH: Final = 8.0
"""So many times the length of the longest bridge is ruled before and behind the turn ..."""
MOST_MARGIN: Final = 0.5
"""... but no more than this share of a turn."""
SMOOTH_START: Final = 1e-6
"""rad, about; a closed rail whose tangent turns by less where it starts has no corner there."""


def rule_closed_strip(
    p: RailCurve,
    q: RailCurve,
    bridges: tuple[Floats, Floats],
    max_lean: float | None = None,
    held: Held = NOTHING_HELD,
) -> RuledStrip:
    """Returns the surface of a closed strip, over one turn; creases count arcs from rails' starts.

    Args:
        p: the curve P, which ends where it starts, or is a point.
        q: the curve Q, likewise, run the same way.
        bridges: (k,) float64 each; parameters of the bridges of one turn, in order, the last one
            a whole interval behind the first on both rails, whatever the interval's end.
        max_lean: rad; as for ``rule_strip``.
        held: likewise; on the turn of the bridges.
    """
    rails = (p, q)
    more = _with_margins(rails, bridges)
    turns = [
        _between(rail, float(at[0]), float(at[-1])) for rail, at in zip(rails, more, strict=True)
    ]
    found = rule_sheet(turns[0], turns[1], more, max_lean, held.around((_period(p), _period(q))))
    sheet = found.sheet
    along = sheet.p_arc + sheet.q_arc
    whole = p.length + q.length
    first = int(np.searchsorted(along, (along[-1] - whole) / 2.0))
    last = int(np.searchsorted(along, along[first] + whole * (1.0 - 1e-12)))
    both = ruled_strip_of(found, turns[0], turns[1])
    arcs = [
        float(rail.arc_at(_inside(rail, at[:1]))[0]) for rail, at in zip(rails, more, strict=True)
    ]
    creases = tuple(
        _counted_from_start(crease, rails, arcs, first)
        for crease in both.creases
        if first <= crease.ruling < last
    )
    # From where the turn of the bridges starts, and a turn behind it: none is negative.
    shifts = [
        rail.length - float(turned.arc_at(at[:1])[0])
        for rail, turned, at in zip(rails, turns, bridges, strict=True)
    ]
    turn = ruled_strip_of(
        FoundSheet(_part(sheet, first, last, shifts), found.spacing, found.held - first),
        turns[0],
        turns[1],
    )
    return replace(turn, creases=creases, radius=both.radius[first:last])


def _with_margins(
    rails: tuple[RailCurve, RailCurve], bridges: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """The bridges of a turn, with those of a part of the turns before and behind."""
    start, end = (rail.point_at(_inside(rail, at)) for rail, at in zip(rails, bridges, strict=True))
    steps = lengths(np.diff(start, axis=0)) + lengths(np.diff(end, axis=0))
    along = np.concatenate(([0.0], np.cumsum(steps)))
    # A way of so much on each rail counts twice.
    margin = 2.0 * MARGIN_PER_WIDTH * float(lengths(end - start).max())
    margin = min(margin, MOST_MARGIN * float(along[-1]))
    first = int(np.searchsorted(along, along[-1] - margin, side="right")) - 1
    last = int(np.searchsorted(along, margin)) + 1
    p, q = (
        np.concatenate((at[first:-1] - period, at, at[1:last] + period))
        for at, period in zip(bridges, map(_period, rails), strict=True)
    )
    return p, q


def _period(rail: RailCurve) -> float:
    return rail.interval[1] - rail.interval[0]


def _inside(rail: RailCurve, u: Floats) -> Floats:
    """The parameters on the first turn."""
    period = _period(rail)
    return rail.interval[0] + np.mod(u - rail.interval[0], period) if period > 0.0 else u


def _between(rail: RailCurve, start: float, end: float) -> RailCurve:
    """The rail from one parameter to another, round and round."""
    first, last = rail.interval
    period = last - first
    if period == 0.0:
        return rail
    ends = rail.tangents(np.array([first, last]), np.array([0, len(rail.edges) - 2]))[0]
    has_corner = float(np.abs(ends[0] - ends[1]).max()) > SMOOTH_START
    corners = [*rail.breaks, *([first] if has_corner else [])]
    shifted = [at + turn * period for at in corners for turn in range(-2, 4)]
    return RailCurve(
        lambda u: rail.point_at(_inside(rail, u)),
        lambda u: rail.velocity_at(_inside(rail, u)),
        (start, end),
        tuple(sorted(at for at in shifted if start < at < end)),
    )


def _part(sheet: Sheet, first: int, last: int, shifts: Sequence[float]) -> Sheet:
    """The sheet from one ruling to another, its arcs on P and Q moved on by so many mm."""
    rulings, at, between = sheet.rulings, slice(first, last + 1), slice(first, last)
    return Sheet(
        rulings=Stations(
            rulings.u[at],
            rulings.v[at],
            rulings.p_piece[between],
            rulings.q_piece[between],
            rulings.way[between],
        ),
        p_arc=sheet.p_arc[at] + shifts[0],
        q_arc=sheet.q_arc[at] + shifts[1],
        reach=sheet.reach[at],
        direction=sheet.direction[at],
        p_normal=sheet.p_normal[between],
        q_normal=sheet.q_normal[between],
        twist=sheet.twist[between],
        p_across=sheet.p_across[between],
        q_across=sheet.q_across[between],
    )


def _counted_from_start(
    crease: Crease, rails: tuple[RailCurve, RailCurve], arcs: list[float], first: int
) -> Crease:
    p_arc, q_arc = (
        (arc + start) % rail.length if rail.length > 0.0 else 0.0
        for arc, start, rail in zip((crease.p_arc, crease.q_arc), arcs, rails, strict=True)
    )
    return replace(crease, p_arc=p_arc, q_arc=q_arc, ruling=crease.ruling - first)

"""A closed strip: two turns are ruled, so that the one in the middle has no ends."""

from __future__ import annotations

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

Floats = npt.NDArray[np.float64]

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
    starts = [float(at[0]) for at in bridges]
    turns = [_two_turns(rail, start) for rail, start in zip(rails, starts, strict=True)]
    twice = [
        np.concatenate((at, at[1:] + (rail.interval[1] - rail.interval[0])))
        for rail, at in zip(rails, bridges, strict=True)
    ]
    period = (p.interval[1] - p.interval[0], q.interval[1] - q.interval[0])
    found = rule_sheet(turns[0], turns[1], (twice[0], twice[1]), max_lean, held.around(period))
    sheet = found.sheet
    along = sheet.p_arc + sheet.q_arc
    whole = p.length + q.length
    first = int(np.searchsorted(along, whole / 2.0))
    last = int(np.searchsorted(along, along[first] + whole * (1.0 - 1e-12)))
    both = ruled_strip_of(found, turns[0], turns[1])
    arcs = [
        float(rail.arc_at(np.array([start]))[0]) for rail, start in zip(rails, starts, strict=True)
    ]
    creases = tuple(
        _counted_from_start(crease, rails, arcs, first)
        for crease in both.creases
        if first <= crease.ruling < last
    )
    turn = ruled_strip_of(
        FoundSheet(_part(sheet, first, last), found.spacing, found.held - first),
        turns[0],
        turns[1],
    )
    return replace(turn, creases=creases, radius=both.radius[first:last])


def _two_turns(rail: RailCurve, start: float) -> RailCurve:
    """The rail from a parameter on, twice round."""
    first, last = rail.interval
    period = last - first
    if period == 0.0:
        return rail

    def inside(u: Floats) -> Floats:
        return first + np.mod(u - first, period)

    ends = rail.tangents(np.array([first, last]), np.array([0, len(rail.edges) - 2]))[0]
    has_corner = float(np.abs(ends[0] - ends[1]).max()) > SMOOTH_START
    corners = [*rail.breaks, *([first] if has_corner else [])]
    shifted = [at + turn * period for at in corners for turn in range(-1, 4)]
    return RailCurve(
        lambda u: rail.point_at(inside(u)),
        lambda u: rail.velocity_at(inside(u)),
        (start, start + 2.0 * period),
        tuple(sorted(at for at in shifted if start < at < start + 2.0 * period)),
    )


def _part(sheet: Sheet, first: int, last: int) -> Sheet:
    """The sheet from one ruling to another."""
    rulings, at, between = sheet.rulings, slice(first, last + 1), slice(first, last)
    return Sheet(
        rulings=Stations(
            rulings.u[at],
            rulings.v[at],
            rulings.p_piece[between],
            rulings.q_piece[between],
            rulings.way[between],
        ),
        p_arc=sheet.p_arc[at],
        q_arc=sheet.q_arc[at],
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

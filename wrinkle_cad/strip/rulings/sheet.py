"""The tangent planes of a strip along its rulings, and how they turn from one to the next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .pairing import FAN_P, FAN_Q, RULED
from .rail_curve import RailCurve
from .stations import Stations
from .vectors import angles, crosses, dots, lengths, units

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

SHORTEST_IN_NODES: Final = 4.0
"""A ruling of at most so many nodes' spacing has no twist."""
_ALONG: Final = 1e-7
"""A tangent within so many radians of its ruling spans no plane with it."""
SLIVER: Final = 1e-3
"""Where the rails move along the rulings, and across them by no more than this share of their way,
there is no sheet to speak of: it has the plane of what lies before."""


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """What the strip's surface does on both sides of each interval between two rulings.

    The first axis counts intervals; an axis of two is the interval's first and last ruling.
    """

    rulings: Stations
    """The rulings."""
    p_arc: Floats
    """(k,) float64, mm; arc length on P of each ruling."""
    q_arc: Floats
    """(k,) float64, mm; on Q."""
    reach: Floats
    """(k,) float64, mm; the rulings' lengths."""
    direction: Floats
    """(k, 3) float64; unit vectors from P to Q, zero where the rails meet."""
    p_normal: Floats
    """(k - 1, 2, 3) float64; unit normals at P's end of the rulings; zero where there is none."""
    q_normal: Floats
    """(k - 1, 2, 3) float64; at Q's end."""
    twist: Floats
    """(k - 1, 2) float64, rad; from the normal at P's end to that at Q's; 0 in fans."""
    p_across: Floats
    """(k - 1,) float64, mm; how far P moves across the rulings."""
    q_across: Floats
    """(k - 1,) float64, mm; likewise Q."""


def sheet_of(p: RailCurve, q: RailCurve, rulings: Stations, spacing: float) -> Sheet:
    """Measures tangent planes on both sides of every interval.

    Args:
        p: the curve.
        q: the curve.
        rulings: in order.
        spacing: mm between the nodes that they were found on; where rails meet, rulings no longer
            than a few of these have any direction, and so no twist.
    """
    ruling = q.point_at(rulings.v) - p.point_at(rulings.u)
    reach, d = lengths(ruling), units(ruling)
    ends = (slice(None, -1), slice(1, None))
    p_normals, q_normals, turns, p_speeds, q_speeds = [], [], [], [], []
    for end in ends:
        a = p.tangents(rulings.u[end], rulings.p_piece)[0]
        b = q.tangents(rulings.v[end], rulings.q_piece)[0]
        na, nb = crosses(a, d[end]), crosses(b, d[end])
        p_speeds.append(lengths(na))
        q_speeds.append(lengths(nb))
        na, nb = _plane(na, p_speeds[-1]), _plane(nb, q_speeds[-1])
        na = np.where(_column((rulings.way == FAN_P) | ~na.any(axis=1)), nb, na)
        nb = np.where(_column((rulings.way == FAN_Q) | ~nb.any(axis=1)), na, nb)
        p_normals.append(na)
        q_normals.append(nb)
        turns.append(angles(dots(crosses(na, nb), d[end]), dots(na, nb)))
    p_arc, q_arc = p.arc_at(rulings.u), q.arc_at(rulings.v)
    p_across = np.diff(p_arc) * (p_speeds[0] + p_speeds[1]) / 2
    q_across = np.diff(q_arc) * (q_speeds[0] + q_speeds[1]) / 2
    solid = p_across + q_across > SLIVER * (np.diff(p_arc) + np.diff(q_arc))
    long = np.stack([reach[end] > SHORTEST_IN_NODES * spacing for end in ends], axis=1)
    return Sheet(
        rulings=rulings,
        p_arc=p_arc,
        q_arc=q_arc,
        reach=reach,
        direction=d,
        p_normal=_over_slivers(np.stack(p_normals, axis=1), solid),
        q_normal=_over_slivers(np.stack(q_normals, axis=1), solid),
        twist=np.where(
            _column((rulings.way == RULED) & solid) & long, np.stack(turns, axis=1), 0.0
        ),
        p_across=p_across,
        q_across=q_across,
    )


def _column(chosen: Bools) -> Bools:
    return chosen[:, None]


def _plane(normal: Floats, sine: Floats) -> Floats:
    """Unit normals, zero where tangent and ruling have one direction."""
    return np.where(
        (sine > _ALONG)[:, None], normal / np.where(sine > 0.0, sine, 1.0)[:, None], 0.0
    )


def _over_slivers(normal: Floats, solid: Bools) -> Floats:
    """Normals with those of slivers replaced by what lies before them, or after the first."""
    if solid.all() or not solid.any():
        return normal
    place = np.arange(len(solid))
    before = np.maximum.accumulate(np.where(solid, place, -1))
    last, first = normal[before, 1], normal[int(np.argmax(solid)), 0]
    beside = np.where(_column(before >= 0), last, first)[:, None]
    return np.where(solid[:, None, None], normal, beside)


def turns_between(before: Floats, after: Floats) -> Floats:
    """(k,) rad, 0 to pi: angles between (k, 3) unit normals; 0 where one of them is zero."""
    turn = angles(lengths(crosses(before, after)), dots(before, after))
    return np.where(before.any(axis=1) & after.any(axis=1), turn, 0.0)

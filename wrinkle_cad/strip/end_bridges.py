"""Where the first or the last bridge of a strip runs into one of its rails.

Both are in every triangulation. In a plane none then exists that does not fold back: the rails have
the wrong ends, and that is worth more to know than where the fold is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from .portable import dot
from .triangulation import Triangulation

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class EndCrossing:
    """An end bridge that meets a rail between its ends."""

    end: Literal["first", "last"]
    """Which bridge."""
    rail: Literal["P", "Q"]
    """Which rail."""
    point: tuple[float, float, float]
    """mm; where it is met nearest to its own end of that bridge."""


def end_crossings(triangulation: Triangulation) -> tuple[EndCrossing, ...]:
    """Returns which end bridges meet a rail away from where they end on it.

    Args:
        triangulation: the strip; to within its planarity they meet. A closed one has no ends.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> hook = triangulate([[0, 0, 0], [1, 3, 0], [2, 0, 0], [9, 0, 0]], [[2, 1, 0], [9, 1, 0]])
        >>> [(one.end, one.rail) for one in end_crossings(hook)]
        [('first', 'P')]
    """
    if triangulation.is_closed:
        return ()
    found = []
    ends: tuple[tuple[Literal["first", "last"], int], ...] = (("first", 0), ("last", -1))
    rails: tuple[tuple[Literal["P", "Q"], Floats], ...] = (
        ("P", triangulation.p),
        ("Q", triangulation.q),
    )
    for end, at in ends:
        bridge = np.array([triangulation.p[at], triangulation.q[at]])
        for name, rail in rails:
            # From this end on; the bank edge that begins on the bridge meets it there.
            line = (rail if at == 0 else rail[::-1])[1:]
            point = _first_meeting(bridge, line, triangulation.planarity)
            if point is not None:
                found.append(EndCrossing(end, name, point))
    return tuple(found)


def _first_meeting(
    bridge: Floats, line: Floats, planarity: float
) -> tuple[float, float, float] | None:
    """The first place of a polyline on a segment, between the segment's ends."""
    if len(line) < 2:
        return None
    way, steps, offset = bridge[1] - bridge[0], np.diff(line, axis=0), line[:-1] - bridge[0]
    length = float(dot(way, way))
    along, across, both = dot(steps, way), dot(steps, steps), dot(offset, way)
    spread = length * across - along * along
    is_skew = spread > 1e-18 * length * across
    share = np.where(is_skew, along * both - length * dot(offset, steps), 0.0)
    share = np.clip(np.divide(share, spread, out=np.zeros_like(share), where=is_skew), 0.0, 1.0)
    at = line[:-1] + share[:, None] * steps
    place = dot(at - bridge[0], way) / max(length, 1e-300)
    gap = at - bridge[0] - np.clip(place, 0.0, 1.0)[:, None] * way
    slack = planarity / max(length**0.5, planarity)
    (met,) = np.nonzero(
        is_skew & (np.sqrt(dot(gap, gap)) <= planarity) & (place > slack) & (place < 1.0 - slack)
    )
    if not len(met):
        return None
    x, y, z = at[met[0]].tolist()
    return x, y, z

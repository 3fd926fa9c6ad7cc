"""Where a piece's grain line stands: inside, clear of outlines and bends; else beside the piece."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import shapely

from .piece import Floats, PatternPiece, frozen

CLEAR: Final = 1.0
"""mm between what is written on a piece and any line."""
SIDE: Final = 8.0
"""mm from a piece to what stands beside it."""
_ARROW_HALF: Final = 1.05
"""mm; half the breadth of an arrowhead."""
_SHORTEST_GRAIN: Final = 8.0
"""mm; a grain line that was moved or cut has room for two arrowheads."""
_GRAIN_CLEAR: Final = 0.5
"""mm between the grain line's arrowheads and the piece's outline."""
_GRAIN_TRIES: Final = 61
"""Parallel lines, across the piece, that are tried for the grain line."""


def grain_lines(piece: PatternPiece) -> tuple[Floats, ...]:
    """Returns the grain line inside a piece, then its far and its near half; else one beside it.

    Args:
        piece: with a cut line of some area.

    Returns:
        (2, 2) mm each.
    """
    line = _grain_inside(piece)
    if line is None:
        return (_grain_beside(piece),)
    tail, head = line
    middle = 0.5 * (tail + head)
    return line, frozen((middle, head)), frozen((tail, middle))


def _grain_inside(piece: PatternPiece) -> Floats | None:
    """Returns the grain line where it is clear of outlines and bends, None if it has no room.

    It is the piece's own where that is clear, else the longest of the parallel ones, at most as
    long. Rulings are broken around it; a bend is a line that a machine follows.
    """
    room = _room_for_grain(piece)
    tail, head = piece.grain_line
    if room.covers(shapely.LineString((tail, head))):
        return piece.grain_line
    length, middle = math.dist(tail.tolist(), head.tolist()), 0.5 * (tail + head)
    along = (head - tail) / length
    across = np.array((-along[1], along[0]))
    corners = piece.cut_line - middle
    sides = corners[:, 0] * across[0] + corners[:, 1] * across[1]
    reach = float(np.ptp(piece.cut_line, axis=0).sum()) * along
    best: tuple[float, Floats] | None = None
    for offset in sorted(np.linspace(sides.min(), sides.max(), _GRAIN_TRIES), key=abs):
        line = shapely.LineString(
            (middle + offset * across - reach, middle + offset * across + reach)
        )
        parts = shapely.get_parts(room.intersection(line))
        part = max(parts, key=lambda part: float(part.length), default=shapely.LineString())
        found = min(float(part.length), length)
        if found > 0.0 and (best is None or found > best[0] + 1.0):
            center = np.array(part.interpolate(0.5, normalized=True).coords[0])
            best = found, frozen((center - 0.5 * found * along, center + 0.5 * found * along))
    if best is None or best[0] < min(_SHORTEST_GRAIN, 0.5 * length):
        return None
    return best[1]


def _room_for_grain(piece: PatternPiece) -> shapely.Geometry:
    """Returns where a grain line's middle line may run, with room for its arrowheads."""
    inner = shapely.Polygon(piece.sew_line).intersection(shapely.Polygon(piece.cut_line))
    room = inner.buffer(-(_GRAIN_CLEAR + _ARROW_HALF))
    holes = [shapely.LinearRing(hole) for hole in piece.cut_outs]
    if holes:
        room = room.difference(shapely.union_all(holes).buffer(_GRAIN_CLEAR + _ARROW_HALF))
    if piece.bends is not None and len(piece.bends.lines):
        bends = shapely.union_all(shapely.linestrings(piece.bends.lines))
        room = room.difference(bends.buffer(CLEAR + _ARROW_HALF))
    return room


def _grain_beside(piece: PatternPiece) -> Floats:
    """Returns the grain line below the piece, in its own direction."""
    tail, head = piece.grain_line
    low, high = piece.cut_line.min(axis=0), piece.cut_line.max(axis=0)
    middle = np.array((0.5 * (low[0] + high[0]), low[1] - 0.5 * SIDE))
    middle[1] -= 0.5 * abs(head[1] - tail[1])
    return frozen((middle - 0.5 * (head - tail), middle + 0.5 * (head - tail)))


def arrow_lines(line: Floats) -> tuple[Floats, ...]:
    """Returns a line (2, 2) with an arrowhead at both ends as polylines, (k, 2) mm each."""
    tail, head = line
    step = head - tail
    length = float(np.hypot(*step))
    along = step / length if length > 0.0 else np.array((1.0, 0.0))
    across = np.array((-along[1], along[0]))
    size = min(3.0, 0.25 * length)

    def tip(at: Floats, back: Floats) -> Floats:
        foot = at + size * back
        return np.vstack((foot + 0.35 * size * across, at, foot - 0.35 * size * across))

    return np.vstack((tail, head)), tip(tail, along), tip(head, -along)

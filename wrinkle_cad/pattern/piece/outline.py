"""The sew line: the closed outline of a flat strip, cleaned for a cutter.

Rail P runs from the start to the end, the last bridge leads over to Q, Q runs back and the first
bridge closes the outline, counter-clockwise. A side shorter than the tolerance (rails that meet)
vanishes into one corner. Nothing is simplified but segments shorter than the tolerance.
"""

from __future__ import annotations

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.polyline import segment_lengths
from wrinkle_cad.strip.portable import atan2, dot

from .options import END_SIDE, P_SIDE, Q_SIDE, START_SIDE
from .piece import Bools, Floats, Ints, Outline, make_outline


def sew_outline(p_line: Floats, q_line: Floats, *, tolerance: float) -> Outline:
    """Returns the outline of a flat strip.

    Args:
        p_line: (k, 2) mm, the flat rail P from its start.
        q_line: (l, 2) mm, the flat rail Q from its start, on the left of P.
        tolerance: mm; no segment of the outline is shorter, corners are kept.

    Raises:
        InputError: the strip is smaller than the tolerance.
    """
    p_kept = p_line[kept_vertices(p_line, tolerance)]
    q_kept = q_line[kept_vertices(q_line, tolerance)][::-1]
    if _length(q_kept[0] - p_kept[-1]) < tolerance:
        q_kept = q_kept[1:]
        end_sides: list[int] = []
    else:
        end_sides = [END_SIDE]
    if len(q_kept) and _length(p_kept[0] - q_kept[-1]) < tolerance:
        q_kept = q_kept[:-1]
        start_sides: list[int] = []
    else:
        start_sides = [START_SIDE]
    points = np.vstack((p_kept, q_kept))
    q_count = len(points) - (len(p_kept) - 1) - len(end_sides) - len(start_sides)
    # A rail that is a point has no side of its own.
    if len(points) < 3 or q_count < (0 if len(q_line) == 1 else 1):
        size = float(np.ptp(p_line, axis=0).max())
        raise InputError(
            f"The pattern is {size:g} mm long, and its rails are nowhere further apart than the "
            f"tolerance of {tolerance:g} mm. Use a finer tolerance."
        )
    sides = np.array(
        [P_SIDE] * (len(p_kept) - 1) + end_sides + [Q_SIDE] * q_count + start_sides, dtype=np.int8
    )
    return make_outline(points, sides, corner_vertices(points, sides))


def kept_vertices(line: Floats, tolerance: float) -> Bools:
    """Returns which vertices of an open polyline stay when no segment may be below ``tolerance``.

    Args:
        line: (k, 2) mm; its ends always stay, and corners rather than other points.
        tolerance: mm.
    """
    kept = np.ones(len(line), dtype=np.bool_)
    lengths = segment_lengths(line)
    if not np.any(lengths < tolerance):
        return kept
    is_corner = np.zeros(len(line), dtype=np.bool_)
    is_corner[1:-1] = np.abs(turns(line)) > settings.PATTERN_CORNER
    last = 0
    for i in range(1, len(line)):
        if _length(line[i] - line[last]) >= tolerance:
            last = i
        elif last > 0 and (i == len(line) - 1 or (is_corner[i] and not is_corner[last])):
            kept[last] = False
            last = i
        elif i < len(line) - 1:
            kept[i] = False
    return kept


def turns(line: Floats) -> Floats:
    """Returns the signed turn in rad at each inner vertex of an open (k, 2) polyline."""
    steps = np.diff(line, axis=0)
    before, after = steps[:-1], steps[1:]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turn: Floats = atan2(cross, dot(before, after))
    return turn


def closed_turns(points: Floats) -> Floats:
    """Returns the signed turn in rad at each vertex of a closed (k, 2) polygon."""
    return turns(np.vstack((points[-1:], points, points[:1])))


def corner_vertices(points: Floats, sides: Ints) -> Bools:
    """Returns where a closed outline has corners: sharp turns and changes of side, (k,) bool."""
    changes = sides != np.roll(sides, 1)
    corners: Bools = changes | (np.abs(closed_turns(points)) > settings.PATTERN_CORNER)
    return corners


def _length(step: Floats) -> float:
    return float(np.hypot(step[0], step[1]))

"""Darts: notches in a seam so narrow that the allowances of their two edges close them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from .outline import closed_turns
from .piece import Floats, Outline

_SHARP = -0.35
"""rad; the sew line turns inward by more than this (20 degrees) at the point of a dart."""


def closed_darts(sew: Outline, cut: Outline, tolerance: float) -> Iterator[tuple[Floats, float]]:
    """Yields the point (2,) mm of each dart that its own allowance closes, and its mouth in mm.

    A dart runs from one outward corner of the sew line over an inward one to the next outward
    corner. It is closed where the cut line does not go into it.

    Args:
        sew: counter-clockwise.
        cut: its allowance's outline.
        tolerance: mm.
    """
    turn = closed_turns(sew.points)
    ring = shapely.LinearRing(cut.points)
    outward = np.flatnonzero(turn > -_SHARP)
    if len(outward) < 2:
        return
    for i in np.flatnonzero(turn < _SHARP):
        before = outward[np.searchsorted(outward, i) - 1]
        after = outward[np.searchsorted(outward, i) % len(outward)]
        count = (after - before) % len(turn) + 1
        mouth = np.roll(sew.points, -before, axis=0)[:count]
        dart = shapely.Polygon(mouth)
        # Clockwise: what lies between the mouth and the sew line is outside the piece.
        if shapely.is_ccw(dart.exterior) or dart.area < tolerance**2:
            continue
        if not ring.intersects(dart.buffer(-tolerance)):
            yield sew.points[i], float(np.hypot(*(mouth[-1] - mouth[0])))

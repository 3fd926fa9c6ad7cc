"""A piece's outline with few points, for a small picture beside its name."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from shapely.geometry import Polygon

from .piece import PatternPiece

MOST_POINTS: Final = 60
"""As many as a picture of 100 pixels shows."""
_COARSENESS: Final = 0.004
"""Of the piece's size: under half a pixel there."""


def thumbnail(piece: PatternPiece) -> list[list[float]]:
    """Returns up to 60 points of a piece's cut line.

    Args:
        piece: the piece.

    Returns:
        x and y of each point, mm from the lower left corner, with three to four digits.
    """
    line = np.asarray(piece.cut_line, dtype=np.float64)
    size = float(np.ptp(line, axis=0).max())
    shape, coarseness = Polygon(line), _COARSENESS * size
    points = np.array(shape.simplify(coarseness).exterior.coords)[:-1]
    while len(points) > MOST_POINTS:
        coarseness *= 1.5
        points = np.array(shape.simplify(coarseness).exterior.coords)[:-1]
    if size <= 0.0 or len(points) < 3:
        return []
    digits = max(0, 3 - math.floor(math.log10(size)))
    return [[round(float(part), digits) for part in point] for point in points - points.min(axis=0)]

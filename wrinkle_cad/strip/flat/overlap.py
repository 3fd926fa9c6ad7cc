"""Whether a flat strip lies over itself, read off its outline.

The outline of a strip that was unrolled triangle by triangle bounds a disc that may cover parts of
the plane twice. The area that the outline encloses with its sign counts such a part twice; the
region that it winds around an odd number of times does not. The two differ exactly where something
is covered more than once. What only touches does not overlap.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]

OVERLAP: Final = 1e-8
"""A share of the strip's area: what is covered twice by less is round-off."""


def is_overlapping(p: Floats, q: Floats) -> bool:
    """Returns whether a flat strip covers some place twice.

    Rails that meet (ends of zero length), edges that share an end, and parts of the strip that
    touch without covering each other do not overlap.

    Args:
        p: (m, 2) float64, mm: flat rail P.
        q: (n, 2) float64, mm: flat rail Q, in the same direction.

    Example:
        >>> p = np.array([[0.0, 0.0], [9.0, 0.0]])
        >>> is_overlapping(p, p + [0.0, 2.0])
        False
    """
    return covers_twice(np.concatenate((p, q[::-1])))


def covers_twice(outline: Floats) -> bool:
    """Returns whether the disc that a closed outline bounds covers some place twice.

    Args:
        outline: (k, 2) float64, mm; the first point is not repeated.

    Example:
        >>> covers_twice(np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]))
        True
    """
    corners = outline - outline[0]
    polygon = shapely.Polygon(corners)
    if polygon.is_valid:
        return False
    x, y = corners.T
    signed = 0.5 * abs(float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()))
    return bool(abs(signed - shapely.make_valid(polygon).area) > OVERLAP * signed)

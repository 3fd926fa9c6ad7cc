"""Which way a strip faces: whether its normal ``p' x (q - p)`` points to an upper's outside."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]


def faces_away(triangulation: Triangulation, points: Floats, outward: Floats) -> bool:
    """Whether a strip's normal points away from the outside, taken over its whole area.

    Wrinkles and bands stand steeply in places: what counts is the sum over all triangles of their
    area, as seen along the outward normal of the nearest point.

    Args:
        triangulation: the strip.
        points: (k, 3) mm, of the upper beside the strip.
        outward: (k, 3) unit normals of the upper there, towards its outside.

    Example:
        >>> import numpy as np
        >>> from wrinkle_cad.strip import triangulate
        >>> p = np.array([(0.0, 0.0, 0.0), (9.0, 0.0, 0.0)])
        >>> flat = triangulate(p, p + (0.0, 4.0, 0.0))
        >>> faces_away(flat, p, np.array([(0.0, 0.0, 1.0)] * 2))
        False
    """
    corners = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.column_stack(
        (
            one[:, 1] * two[:, 2] - one[:, 2] * two[:, 1],
            one[:, 2] * two[:, 0] - one[:, 0] * two[:, 2],
            one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0],
        )
    )
    middles = (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0
    total = []
    for middle, normal in zip(middles, normals, strict=True):
        away = points - middle
        squares = away[:, 0] ** 2 + away[:, 1] ** 2 + away[:, 2] ** 2
        out = outward[int(np.argmin(squares))]
        total.append(float(normal[0] * out[0] + normal[1] * out[1] + normal[2] * out[2]))
    return math.fsum(total) < 0.0

"""How sharply a strip is bent along and across the grain of its material."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.pattern.piece.flat import flat_strip
from wrinkle_cad.pattern.piece.options import Direction

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.rulings.surface import RuledStrip
    from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]

_PARALLEL = 1e-6
"""A sheet is not bent along a direction if its rulings lie along it to within so much."""


def radii_by_grain(
    triangulation: Triangulation, unrolling: Unrolling, ruled: RuledStrip, grain: Direction
) -> tuple[float, float]:
    """Returns the smallest bend radii along and across the grain, in mm; inf where none bends.

    A sheet that is bent to the radius ``r`` across its rulings has the radius ``r / cos^2`` in a
    direction that makes this angle with the bend (Euler). Bridges of the triangulation say how the
    rulings lie in the flat piece.

    Args:
        triangulation: of the strip.
        unrolling: of the same triangulation.
        ruled: the exact surface near it.
        grain: of the material, as the pattern piece has it.
    """
    flat = flat_strip(unrolling, triangulation).framed()
    along = flat.flat_direction(grain, name="grain")
    i, j = flat.bridges.T
    ruling = flat.q[j] - flat.p[i]
    length = np.hypot(ruling[:, 0], ruling[:, 1])
    known = length > 0.0
    # The bend runs across the ruling.
    cosine = np.abs(ruling[:, 0] * along[1] - ruling[:, 1] * along[0])[known] / length[known]
    at = (flat.p_arc[flat.p_index[i]] + flat.q_arc[flat.q_index[j]])[known]
    sheet = ruled.sheet
    place = sheet.p_arc + sheet.q_arc
    share = np.interp((place[:-1] + place[1:]) / 2.0, at, cosine)
    across = np.sqrt(np.maximum(0.0, 1.0 - share * share))
    return _smallest(ruled.radius, share), _smallest(ruled.radius, across)


def _smallest(radius: Floats, cosine: Floats) -> float:
    bent = cosine > _PARALLEL
    return float((radius[bent] / cosine[bent] ** 2).min(initial=math.inf))

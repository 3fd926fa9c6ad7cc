"""How sharply a strip is bent at its material's inner face, along and across the grain."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.pattern.piece.flat import flat_strip
from wrinkle_cad.pattern.piece.options import Direction, SurfaceSide
from wrinkle_cad.strip.rulings.bending import bulge_along

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.rulings.surface import RuledStrip
    from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]

_PARALLEL = 1e-6
"""A sheet is not bent along a direction if its rulings lie along it to within so much."""


@dataclass(frozen=True, slots=True)
class Stock:
    """What a strip is cut from, as far as its bends go."""

    thickness: float = 0.0
    """mm."""
    k_factor: float = settings.K_FACTOR
    """Where the neutral layer lies in a bend, in shares of the thickness from the inner face."""
    grain: Direction = "along"
    """``along`` or ``across`` the strip, or a direction in space."""
    surface_side: SurfaceSide = "middle"
    """Of the material, the side that the surface is; inside: the material lies where
    ``p' x (q - p)`` points. A surface in the middle is where lengths are kept: the neutral layer.
    """
    name: str = ""
    """Of the material; empty where nothing is known."""


def inner_radii(
    triangulation: Triangulation, unrolling: Unrolling, ruled: RuledStrip, stock: Stock
) -> tuple[float, float, float]:
    """Returns the smallest bend radii at the inner face, in mm: in all, along the grain, across it.

    inf where nothing is bent that way, 0 where the sheet cannot be so thick. A sheet that is bent
    to the radius ``r`` across its rulings has the radius ``r / cos^2`` in a direction that makes
    this angle with the bend (Euler). Bridges of the triangulation say how the rulings lie in the
    flat piece.

    Args:
        triangulation: of the strip.
        unrolling: of the same triangulation.
        ruled: the exact surface near it.
        stock: the material.
    """
    depth = _depths(ruled, stock)
    share = _shares_along(triangulation, unrolling, ruled, stock.grain)
    across = np.sqrt(np.maximum(0.0, 1.0 - share * share))
    every = np.ones_like(share)
    inner, along, over = (_smallest(ruled.radius, at, depth) for at in (every, share, across))
    return inner, along, over


def _depths(ruled: RuledStrip, stock: Stock) -> Floats:
    """(k - 1,) mm: how far the inner face lies inside each bend of the surface."""
    bulge = bulge_along(ruled.sheet)
    if stock.surface_side == "middle":
        return np.full(len(bulge), stock.k_factor * stock.thickness)
    # The material above the surface is inside of what is concave from there.
    is_outside = bulge > 0.0 if stock.surface_side == "inside" else bulge < 0.0
    return np.where(is_outside, 0.0, stock.thickness)


def _shares_along(
    triangulation: Triangulation, unrolling: Unrolling, ruled: RuledStrip, grain: Direction
) -> Floats:
    """(k - 1,) cosines of the angles between bends and grain."""
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
    cosines: Floats = np.interp((place[:-1] + place[1:]) / 2.0, at, cosine)
    return cosines


def _smallest(radius: Floats, cosine: Floats, depth: Floats) -> float:
    bent = (cosine > _PARALLEL) & (radius < math.inf)
    inner = radius[bent] / cosine[bent] ** 2 - depth[bent]
    return max(0.0, float(inner.min(initial=math.inf)))

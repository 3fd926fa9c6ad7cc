"""How sharply a strip is bent."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .triangulation import Triangulation


def smallest_bend_radius(triangulation: Triangulation, *, thickness: float = 0.0) -> float:
    """How sharply the strip is bent at its sharpest place.

    The strip bends at its bridges only. The turn of a bridge belongs to the material halfway to
    its neighbours; since bridges between two coplanar triangles do not bend at all, each is taken
    with half of both neighbours. Material of some thickness cannot be bent more finely than that:
    the turns within one thickness add up to one bend at least as wide.

    Args:
        triangulation: the strip.
        thickness: mm, of the material.

    Returns:
        The radius in mm, measured halfway along the bridges; inf for a flat strip.
    """
    if not len(triangulation.fold):
        return math.inf
    width = _share_of_material(triangulation)
    turn, reach = _with_half_neighbours(triangulation.fold), _with_half_neighbours(width)
    at = np.cumsum(width) - width / 2
    first = np.searchsorted(at, at - thickness / 2)
    last = np.searchsorted(at, at + thickness / 2, side="right")
    turned = np.concatenate(([0.0], np.cumsum(triangulation.fold)))
    is_fine = reach < thickness
    turn = np.where(is_fine, turned[last] - turned[first], turn)
    reach = np.where(is_fine, thickness, reach)
    bent = (np.abs(turn) > 0.0) & (reach > 0.0)
    if not bent.any():
        return math.inf
    return float((reach[bent] / np.abs(turn[bent])).min())


def _share_of_material(triangulation: Triangulation) -> NDArray[np.float64]:
    """(m+n-3,) mm: a quarter of the heights of the two triangles over each interior bridge."""
    points = np.vstack((triangulation.p, triangulation.q))
    corners = points[triangulation.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    i, j = triangulation.bridges[1:-1].T
    length = np.linalg.norm(triangulation.p[i] - triangulation.q[j], axis=1)
    both = area[:-1] + area[1:]
    share: NDArray[np.float64] = np.divide(
        both / 2, length, out=np.zeros_like(both), where=length > 0.0
    )
    return share


def _with_half_neighbours(values: NDArray[np.float64]) -> NDArray[np.float64]:
    padded = np.concatenate(([0.0], values, [0.0]))
    summed: NDArray[np.float64] = values + (padded[:-2] + padded[2:]) / 2
    return summed

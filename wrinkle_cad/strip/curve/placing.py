"""Vertices of a whole curve, the same whichever way it runs.

Chords that are placed from one end are others than those placed from the other end. So both are
placed on each smooth piece and one answer is made of the two that does not tell which was which.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from wrinkle_cad.strip.compiled import compiled

from .chebyshev import FloatArray, point_in_cells
from .chords import IndexArray, even_piece, excess

SAME: Final = 1e-9
"""Excesses and places closer than this share of themselves are equal but for round-off."""


@compiled
def _worst_excess(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    start: int,
    end: int,
    limits: tuple[float, float, float],
    run: FloatArray,
) -> float:
    """The largest excess of the chords from table point ``start`` over the vertices of ``run``."""
    t, x, edges, coefficients = curve
    a = (x[start, 0], x[start, 1], x[start, 2])
    first = start + 1
    worst = 0.0
    for vertex in range(len(run)):
        last = first
        while last < end and t[last] < run[vertex]:
            last += 1
        b = point_in_cells(edges, coefficients, run[vertex])
        worst = max(worst, excess(x, first, last - 1, a, b, limits, np.inf))
        a, first = b, last
    return worst


@compiled
def _mirrored(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """The curve run the other way, at the negative of its parameter."""
    t, x, edges, coefficients = curve
    turned = coefficients[::-1].copy()
    turned[:, 1::2] *= -1.0
    return -t[::-1], x[::-1].copy(), -edges[::-1], turned


@compiled
def _is_first(x: FloatArray, y: FloatArray) -> bool:
    """Whether x comes before y by the first coordinate in which they differ beyond round-off."""
    for axis in range(3):
        difference = x[axis] - y[axis]
        if abs(difference) > SAME * (abs(x[axis]) + abs(y[axis])):
            return bool(difference < 0.0)
    return True


@compiled
def _middle(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray], run: FloatArray
) -> FloatArray:
    """The sum of the vertices of a run."""
    total = np.zeros(3)
    for vertex in range(len(run)):
        point = point_in_cells(curve[2], curve[3], run[vertex])
        for axis in range(3):
            total[axis] += point[axis]
    return total


@compiled
def _undirected_piece(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    mirrored: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    start: int,
    end: int,
    limits: tuple[float, float, float],
    scratch: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> int:
    """Vertices of one smooth piece, placed from both ends; the number of chords, or -1.

    The run with fewer chords is taken; of two equally long ones the mean, or where that breaks a
    limit the run that stays farther below them. They stand in the first array of ``scratch``.
    """
    best, back, trial, cones = scratch
    size = len(curve[0]) - 1
    count = even_piece(curve, start, end, limits, best, trial, cones)
    other = even_piece(mirrored, size - end, size - start, limits, trial, back, cones)
    for i in range(other - 1):
        back[i] = -trial[other - 2 - i]
    if other < 1 or 0 < count < other:
        return count
    back[other - 1] = curve[0][end]
    if count == other:
        trial[:count] = 0.5 * (best[:count] + back[:count])
        if _worst_excess(curve, start, end, limits, trial[:count]) <= 1.0:
            best[:count] = trial[:count]
            return count
        there = _worst_excess(curve, start, end, limits, best[:count])
        here = _worst_excess(curve, start, end, limits, back[:count])
        if there < (1.0 - SAME) * here:
            return count
        if there <= (1.0 + SAME) * here and _is_first(
            _middle(curve, best[:count]), _middle(curve, back[:count])
        ):
            return count
    best[:other] = back[:other]
    return other


@compiled
def place_chords(
    t: FloatArray,
    x: FloatArray,
    edges: FloatArray,
    coefficients: FloatArray,
    corners: IndexArray,
    limits: tuple[float, float, float],
) -> tuple[FloatArray, int]:
    """Places vertices on every smooth piece between corners.

    Args:
        t: (k,) float64: parameters of a table of curve points, as ``tabulate`` makes it.
        x: (k, 3) float64, mm: its points.
        edges: (c + 1,) float64: the cells.
        coefficients: (c, 17, 3) float64, mm.
        corners: (s + 1,) int64: table points that must be vertices, first and last included.
        limits: mm; distance of the curve from a chord, longest chord (may be infinite), shortest.

    Returns:
        The vertices' parameters in order, and -1, or the piece (its index) that cannot be done
        because a chord would have to be shorter than the shortest.
    """
    curve = (t, x, edges, coefficients)
    mirrored = _mirrored(curve)
    size = 2 * len(t) + 16
    out = np.empty(size)
    scratch = (np.empty(size), np.empty(size), np.empty(size), np.empty((len(t), 5)))
    out[0] = t[0]
    filled = 1
    for piece in range(len(corners) - 1):
        start, end = corners[piece], corners[piece + 1]
        count = _undirected_piece(curve, mirrored, start, end, limits, scratch)
        if count < 0 or filled + count > size:
            return out[:filled], piece
        out[filled : filled + count] = scratch[0][:count]
        filled += count
    return out[:filled], -1

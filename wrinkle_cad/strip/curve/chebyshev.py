"""A parametric curve as polynomials on cells of its parameter, cheap to evaluate in bulk.

A caller's curve costs a Python call per evaluation; placing chords and integrating along the
curve ask for it thousands of times, one point after another. So the curve is evaluated level by
level, all open cells in one call, until a Chebyshev interpolant of degree ``DEGREE`` on every cell
is as close as asked. What a cell's own nodes cannot see is not found here; callers confirm their
results on the curve itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.compiled import compiled
from wrinkle_cad.strip.portable import cos

FloatArray = NDArray[np.float64]
PointAt = Callable[[FloatArray], FloatArray]

DEGREE: Final = 16
TAIL: Final = 4
"""So many last coefficients are looked at: both parities, and one that happens to vanish."""
TAIL_WEIGHT: Final = 8.0
"""At a jump of the second derivative coefficients fall as k^-3, and what was cut off sums to this
many times the last one."""
NOISE: Final = 256 * np.finfo(np.float64).eps
MOST_CELLS: Final = 200_000

NODES: Final = -cos(np.pi * np.arange(DEGREE + 1) / DEGREE)


def _coefficients_of_values() -> FloatArray:
    """(17, 17): from values at ``NODES`` to Chebyshev coefficients (discrete cosine transform)."""
    k = np.arange(DEGREE + 1)
    matrix = 2.0 / DEGREE * cos(np.pi * np.outer(k, DEGREE - k) / DEGREE)
    matrix[:, [0, -1]] *= 0.5
    matrix[[0, -1], :] *= 0.5
    return matrix


_TO_COEFFICIENTS: Final = _coefficients_of_values()


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """A curve as one polynomial per cell of its parameter."""

    edges: FloatArray
    """(c + 1,) float64: cell k covers the parameters from edges[k] to edges[k + 1]."""
    coefficients: FloatArray
    """(c, 17, 3) float64, mm: Chebyshev coefficients over each cell."""
    nodes: FloatArray
    """(c, 17, 3) float64, mm: the curve at the cells' Chebyshev points, both ends included."""

    @property
    def size(self) -> float:
        """mm; the largest coordinate, by which round-off is judged."""
        return float(np.max(np.abs(self.nodes)))


def evaluate(point_at: PointAt, parameters: FloatArray) -> FloatArray:
    """Evaluates a caller's curve and refuses what is not a finite point for every parameter.

    Args:
        point_at: the curve, from (k,) parameters to (k, 3) points.
        parameters: (k,) float64.

    Returns:
        (k, 3) float64, mm.

    Raises:
        InputError: the answer has another shape, or holds NaN or infinities.
    """
    points = np.asarray(point_at(parameters), dtype=np.float64)
    if points.shape != (len(parameters), 3):
        raise InputError(
            f"The curve gave an array of shape {points.shape} for {len(parameters)} parameters, "
            f"not ({len(parameters)}, 3): let point_at take and return whole arrays."
        )
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        where = parameters[int(np.argmin(finite))]
        raise InputError(
            f"The curve has a NaN or infinite point at parameter {where:.9g}. Coordinates must be "
            "finite: repair the curve or shorten the interval."
        )
    return points


def fit_cells(
    point_at: PointAt, edges: FloatArray, accuracy: float, *, share_of_extent: float
) -> Cells:
    """Interpolates a curve on cells, halving those where the interpolant is not close enough.

    Args:
        point_at: the curve, from (k,) parameters to (k, 3) points in mm.
        edges: (c + 1,) float64, increasing: where cells begin and end at first; all are kept.
        accuracy: mm; how close the polynomials are to come, as far as round-off permits.
        share_of_extent: they also come this close as a share of the curve's extent.

    Returns:
        The cells in order of the parameter.

    Raises:
        InputError: the curve is not finite, jumps, or is too rough to follow.
    """
    low, high = edges[:-1], edges[1:]
    limit = 0.0
    starts: list[FloatArray] = []
    values: list[FloatArray] = []
    tables: list[FloatArray] = []
    count = 0
    while len(low):
        nodes = _at_nodes(point_at, low, high)
        if not starts:
            extent = float(np.max(np.ptp(nodes.reshape(-1, 3), axis=0)))
            limit = min(accuracy, share_of_extent * extent)
            limit = max(limit, NOISE * float(np.max(np.abs(nodes))))
        coefficients = times_each(_TO_COEFFICIENTS, nodes)
        tail = TAIL_WEIGHT * np.abs(coefficients[:, -TAIL:]).max(axis=(1, 2))
        open_ = (tail > limit) & _can_be_halved(low, high, nodes, limit)
        starts.append(low[~open_])
        values.append(nodes[~open_])
        tables.append(coefficients[~open_])
        count += len(low)
        if count > MOST_CELLS + 2 * len(edges):
            raise InputError(
                f"The curve is still rough after {count} pieces: its polynomials must come within "
                f"{limit:.3g} mm of it. Repair the curve or raise the tolerance."
            )
        middle = 0.5 * (low[open_] + high[open_])
        low = np.concatenate((low[open_], middle))
        high = np.concatenate((middle, high[open_]))
    order = np.argsort(np.concatenate(starts), kind="stable")
    return Cells(
        np.append(np.concatenate(starts)[order], edges[-1]),
        np.concatenate(tables)[order],
        np.concatenate(values)[order],
    )


def _at_nodes(point_at: PointAt, low: FloatArray, high: FloatArray) -> FloatArray:
    """(c, 17, 3): the curve at the Chebyshev points of every cell, in one call."""
    parameters = 0.5 * ((high + low)[:, None] + (high - low)[:, None] * NODES)
    parameters[:, 0], parameters[:, -1] = low, high
    return evaluate(point_at, parameters.ravel()).reshape(len(low), DEGREE + 1, 3)


def _can_be_halved(
    low: FloatArray, high: FloatArray, nodes: FloatArray, limit: float
) -> NDArray[np.bool_]:
    """Which cells are wide enough to halve; a jump inside one that is not is refused."""
    widest = float(np.max(np.maximum(np.abs(low), np.abs(high))))
    wide: NDArray[np.bool_] = high - low > 256 * np.finfo(np.float64).eps * widest
    for cell in np.flatnonzero(~wide):
        gap = float(np.max(np.ptp(nodes[cell], axis=0)))
        if gap > 1e3 * limit:
            raise InputError(
                f"The curve jumps by {gap:.3g} mm at parameter {low[cell]:.9g}. A directrix must "
                "be continuous: join the edges or sample them one by one."
            )
    return wide


@compiled
def times_each(matrix: FloatArray, cells: FloatArray) -> FloatArray:
    """The product of a (17, 17) matrix with every (17, 3) cell, terms added in their order."""
    product = np.zeros(cells.shape)
    for cell in range(cells.shape[0]):
        for row in range(matrix.shape[0]):
            for column in range(matrix.shape[1]):
                for axis in range(cells.shape[2]):
                    product[cell, row, axis] += matrix[row, column] * cells[cell, column, axis]
    return product


@compiled
def point_in_cell(coefficients: FloatArray, u: float) -> tuple[float, float, float]:
    """Evaluates one cell's polynomials (Clenshaw) at u in [-1, 1]."""
    twice = 2.0 * u
    ax = ay = az = 0.0
    bx = by = bz = 0.0
    for k in range(coefficients.shape[0] - 1, 0, -1):
        ax, bx = twice * ax - bx + coefficients[k, 0], ax
        ay, by = twice * ay - by + coefficients[k, 1], ay
        az, bz = twice * az - bz + coefficients[k, 2], az
    return (
        u * ax - bx + coefficients[0, 0],
        u * ay - by + coefficients[0, 1],
        u * az - bz + coefficients[0, 2],
    )


@compiled
def point_in_cells(
    edges: FloatArray, coefficients: FloatArray, parameter: float
) -> tuple[float, float, float]:
    """Evaluates the curve at one parameter; at an edge, from the cell that begins there."""
    low, high = 0, len(edges) - 2
    while low < high:
        middle = (low + high + 1) // 2
        if edges[middle] <= parameter:
            low = middle
        else:
            high = middle - 1
    width = edges[low + 1] - edges[low]
    u = 2.0 * (parameter - edges[low]) / width - 1.0
    point: tuple[float, float, float] = point_in_cell(coefficients[low], min(1.0, max(-1.0, u)))
    return point

"""The cubic spline through points, C2 throughout, the same to the last digit on every processor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.compiled import compiled

Floats = NDArray[np.float64]

_DEGREE = 3


class CubicSpline(NamedTuple):
    """A cubic B-spline, clamped at both ends."""

    knots: Floats
    """(k + 4,) float64; the first and the last one four times."""
    poles: Floats
    """(k, d) float64."""


def cubic_through(parameters: Floats, points: Floats) -> CubicSpline:
    """Returns the cubic spline through points, without a knot at the second and last but one.

    Its system of equations is totally positive, so elimination needs no pivots (C. de Boor,
    A. Pinkus, doi:10.1007/BF01396189); it is done row by row in compiled code, not by LAPACK.

    Args:
        parameters: (k,) float64, increasing, k at least 4.
        points: (k, d) float64, what the spline takes at the parameters.

    Raises:
        InputError: parameters that do not increase: points that coincide.

    Example:
        >>> t = np.arange(6.0)
        >>> spline = cubic_through(t, np.stack((t, 2.0 * t), axis=1))
        >>> spline.knots.tolist()
        [0.0, 0.0, 0.0, 0.0, 2.0, 3.0, 5.0, 5.0, 5.0, 5.0]
        >>> bool(np.allclose(spline.poles[:, 1], 2.0 * spline.poles[:, 0]))
        True
    """
    still = np.flatnonzero(~(np.diff(parameters) > 0.0))
    if len(still):
        raise InputError(
            f"Points {still[0] + 1} and {still[0] + 2} of the {len(points)} of a curve coincide. A"
            " smooth curve needs points apart: remove one of them."
        )
    knots = np.concatenate(
        (np.repeat(parameters[:1], 4), parameters[2:-2], np.repeat(parameters[-1:], 4))
    )
    return CubicSpline(knots, _solved(knots, parameters, np.array(points, dtype=np.float64)))


@compiled
def _basis(knots: Floats, span: int, at: float, values: Floats) -> None:
    """Fills in the four basis functions that are not 0 between knots[span] and the next."""
    values[0] = 1.0
    for degree in range(1, _DEGREE + 1):
        saved = 0.0
        for i in range(degree):
            above = knots[span + 1 + i] - at
            below = at - knots[span + 1 + i - degree]
            share = values[i] / (above + below)
            values[i] = saved + above * share
            saved = below * share
        values[degree] = saved


@compiled
def _solved(knots: Floats, parameters: Floats, points: Floats) -> Floats:
    """The poles: Gaussian elimination on rows of five, the diagonal in the middle."""
    count = len(parameters)
    band = np.zeros((count, 5))
    values = np.empty(4)
    for i in range(count):
        span = min(max(3, i + 2), count - 1)
        _basis(knots, span, parameters[i], values)
        for k in range(4):
            column = span - 3 + k - i + 2
            if 0 <= column < 5:
                band[i, column] = values[k]
    for i in range(count):
        for below in range(i + 1, min(i + 3, count)):
            factor = band[below, i - below + 2] / band[i, 2]
            for column in range(i, min(i + 3, count)):
                band[below, column - below + 2] -= factor * band[i, column - i + 2]
            for axis in range(points.shape[1]):
                points[below, axis] -= factor * points[i, axis]
    for i in range(count - 1, -1, -1):
        for axis in range(points.shape[1]):
            value = points[i, axis]
            for column in range(i + 1, min(i + 3, count)):
                value -= band[i, column - i + 2] * points[column, axis]
            points[i, axis] = value / band[i, 2]
    return points

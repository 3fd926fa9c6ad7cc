"""Arithmetic whose last digit is the same on every processor.

numpy hands products of arrays (``@``, ``dot``, ``norm`` of one vector) to a BLAS, which adds in an
order that depends on the processor, and takes arctan2, arccos, tan, exp, log and powers from its
vector unit, if there is one. Their last digits differ, and a digit decides a sample or a triangle
sooner or later. So whatever decides, or is written, takes its sums and angles from here or from
compiled code. Safe in numpy itself, because each is exact or adds in one fixed order: + - * / and
square roots element by element, ``sum``, ``mean``, ``cumsum``, ``cross``, ``interp``, and
``np.linalg.norm`` with an axis.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .compiled import compiled

Floats = NDArray[np.float64]


def dot(first: Floats, second: Floats) -> Floats:
    """Returns the scalar products along the last axis, added from the first component on.

    Args:
        first: (..., d) float64.
        second: (..., d) float64; other axes are broadcast.

    Example:
        >>> dot(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([10.0, 1.0])).tolist()
        [12.0, 34.0]
    """
    total = first[..., 0] * second[..., 0]
    for axis in range(1, first.shape[-1]):
        total = total + first[..., axis] * second[..., axis]
    return np.asarray(total, dtype=np.float64)


def norm(vector: ArrayLike) -> float:
    """Returns the length of one vector, (d,) float64, in its unit.

    Example:
        >>> norm([3.0, 0.0, 4.0])
        5.0
    """
    components = np.asarray(vector, dtype=np.float64)
    return math.sqrt(float(dot(components, components)))


def atan2(y: ArrayLike, x: ArrayLike) -> Floats:
    """Returns the angles of the points (x, y), element by element, rad in [-pi, pi].

    Args:
        y: (...) float64.
        x: (...) float64, of the same shape or broadcast to it.

    Example:
        >>> atan2([0.0, 2.0], [1.0, 0.0]).tolist()
        [0.0, 1.5707963267948966]
    """
    above, right = np.broadcast_arrays(
        np.asarray(y, dtype=np.float64), np.asarray(x, dtype=np.float64)
    )
    return _angles(above.ravel(), right.ravel()).reshape(above.shape)


def sin(angle: ArrayLike) -> Floats:
    """Returns the sines of (...) float64, rad, element by element.

    Example:
        >>> sin([0.0, 0.5]).tolist() == [0.0, math.sin(0.5)]
        True
    """
    angles = np.asarray(angle, dtype=np.float64)
    return _sines(angles.ravel()).reshape(angles.shape)


def cos(angle: ArrayLike) -> Floats:
    """Returns the cosines of (...) float64, rad, element by element.

    Example:
        >>> cos([0.0, 0.5]).tolist() == [1.0, math.cos(0.5)]
        True
    """
    angles = np.asarray(angle, dtype=np.float64)
    return _cosines(angles.ravel()).reshape(angles.shape)


@compiled
def _angles(y: Floats, x: Floats) -> Floats:
    angles = np.empty(len(x))
    for i in range(len(x)):
        angles[i] = math.atan2(y[i], x[i])
    return angles


@compiled
def _sines(angles: Floats) -> Floats:
    result = np.empty(len(angles))
    for i in range(len(angles)):
        result[i] = math.sin(angles[i])
    return result


@compiled
def _cosines(angles: Floats) -> Floats:
    result = np.empty(len(angles))
    for i in range(len(angles)):
        result[i] = math.cos(angles[i])
    return result

"""A rail between its nodes by cubic polynomials, in compiled code, and twist with it.

Between nodes that are far closer than a strip is wide the error of a tangent is some 1e-7 rad, and
none on a cubic B-spline whose knots are not between.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.compiled import compiled

from .pairing import twist_at

Floats = npt.NDArray[np.float64]

ROUNDS: Final = 60
_NO_TWIST: Final = 1e-13
"""rad; where the secant ends, some hundred times the round-off of an angle."""
_WIDEST: Final = 8.0
"""A ruling without twist is sought so many nodes to either side, at most."""


@compiled
def point_and_tangent(u: Floats, point: Floats, velocity: Floats, at: float) -> Floats:
    """Returns (2, 3) float64: point in mm and unit tangent of a smooth piece at a parameter.

    Args:
        u: (k,) float64; parameters of the piece's nodes, k >= 2.
        point: (k, 3) float64, mm.
        velocity: (k, 3) float64, mm; derivatives by the parameter.
        at: the parameter; outside the piece its ends count.
    """
    found = np.empty((2, 3))
    at = min(max(at, u[0]), u[-1])
    cell = int(np.searchsorted(u, at, side="right")) - 1
    cell = min(max(cell, 0), u.size - 2)
    width = u[cell + 1] - u[cell]
    x = (at - u[cell]) / width
    square = 0.0
    for axis in range(3):
        low, rise = point[cell, axis], point[cell + 1, axis] - point[cell, axis]
        before, after = velocity[cell, axis] * width, velocity[cell + 1, axis] * width
        bend = before + after - 2.0 * rise
        sag = 3.0 * rise - 2.0 * before - after
        found[0, axis] = low + x * (before + x * (sag + x * bend))
        found[1, axis] = before + x * (2.0 * sag + 3.0 * x * bend)
        square += found[1, axis] * found[1, axis]
    speed = math.sqrt(square)
    if speed > 0.0:
        for axis in range(3):
            found[1, axis] /= speed
    return found


@compiled
def _twist(u: Floats, point: Floats, velocity: Floats, at: float, other: Floats) -> float:
    here = point_and_tangent(u, point, velocity, at)
    return twist_at(here[0], other[0], here[1], other[1])


@compiled
def place_without_twist(
    u: Floats, point: Floats, velocity: Floats, start: float, step: float, other: Floats
) -> float:
    """Returns the parameter near `start` at which a ruling to a fixed point does not twist.

    Args:
        u: (k,) float64; parameters of the piece's nodes, k >= 2.
        point: (k, 3) float64, mm.
        velocity: (k, 3) float64, mm; derivatives by the parameter.
        start: where to begin.
        step: the first reach to either side, in the parameter; doubled up to eight times.
        other: (2, 3) float64; the fixed point in mm and the unit tangent there.

    Returns:
        The nearest such place within the reach; `start` where there is none.
    """
    middle = _twist(u, point, velocity, start, other)
    if abs(middle) <= _NO_TWIST:
        return start
    reach = step
    while reach <= _WIDEST * step:
        low, high = max(u[0], start - reach), min(u[-1], start + reach)
        f_low = _twist(u, point, velocity, low, other)
        f_high = _twist(u, point, velocity, high, other)
        if max(abs(f_low), abs(f_high), abs(middle)) >= math.pi / 2.0:
            return start
        to_low, to_high = f_low * middle <= 0.0, f_high * middle <= 0.0
        if to_low and (not to_high or abs(f_low) < abs(f_high)):
            return _zero(u, point, velocity, other, low, start, f_low, middle)
        if to_high:
            return _zero(u, point, velocity, other, start, high, middle, f_high)
        reach *= 2.0
    return start


@compiled
def _zero(
    u: Floats,
    point: Floats,
    velocity: Floats,
    other: Floats,
    low: float,
    high: float,
    f_low: float,
    f_high: float,
) -> float:
    """The Illinois rule: secants that keep a bracket."""
    best, x = abs(f_low), low
    if abs(f_high) < best:
        best, x = abs(f_high), high
    side = 0
    for _ in range(ROUNDS):
        if best <= _NO_TWIST or f_low == f_high:
            break
        at = low + (high - low) * f_low / (f_low - f_high)
        f_at = _twist(u, point, velocity, at, other)
        if abs(f_at) < best:
            best, x = abs(f_at), at
        if f_at * f_low > 0.0:
            low, f_low = at, f_at
            if side == 1:
                f_high /= 2.0
            side = 1
        else:
            high, f_high = at, f_at
            if side == -1:
                f_low /= 2.0
            side = -1
    return x

"""B-spline curves and surfaces of the kernel from arrays of numbers, and back.

All of them are clamped and not periodic.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.gp import gp_Pnt, gp_Pnt2d

from .steps import kernel_step
from .versions import (
    IntegerRow,
    PlanePointRow,
    PointGrid,
    PointRow,
    RealGrid,
    RealRow,
)

Floats = NDArray[np.float64]


def make_curve(
    poles: ArrayLike,
    knots: ArrayLike,
    multiplicities: ArrayLike,
    degree: int,
    weights: ArrayLike | None = None,
) -> Geom_BSplineCurve:
    """Returns a clamped B-spline curve.

    Args:
        poles: (k, 3) mm.
        knots: (l,) distinct, increasing.
        multiplicities: (l,) integers, their sum is k + degree + 1.
        degree: 1 to 25.
        weights: (k,) positive, for a rational curve.
    """
    points = _point_array(np.asarray(poles, dtype=np.float64))
    values = _real_array(np.asarray(knots, dtype=np.float64))
    counts = _integer_array(np.asarray(multiplicities))
    with kernel_step("make a curve"):
        if weights is None:
            return Geom_BSplineCurve(points, values, counts, degree, False)
        shares = _real_array(np.asarray(weights, dtype=np.float64))
        return Geom_BSplineCurve(points, shares, values, counts, degree, False, True)


def make_curve_2d(
    poles: ArrayLike,
    knots: ArrayLike,
    multiplicities: ArrayLike,
    degree: int,
    weights: ArrayLike | None = None,
) -> Geom2d_BSplineCurve:
    """Returns a clamped B-spline curve in the parameters of a surface: poles (k, 2)."""
    places = np.asarray(poles, dtype=np.float64)
    points = PlanePointRow(1, len(places))
    for i, (u, v) in enumerate(places.tolist(), start=1):
        points.SetValue(i, gp_Pnt2d(u, v))
    values = _real_array(np.asarray(knots, dtype=np.float64))
    counts = _integer_array(np.asarray(multiplicities))
    with kernel_step("make a curve on a surface"):
        if weights is None:
            return Geom2d_BSplineCurve(points, values, counts, degree, False)
        shares = _real_array(np.asarray(weights, dtype=np.float64))
        return Geom2d_BSplineCurve(points, shares, values, counts, degree, False)


def curve_arrays(
    curve: Geom_BSplineCurve,
) -> tuple[Floats, Floats | None, Floats, NDArray[np.int64]]:
    """Returns poles (k, 3) mm, weights (k,) or None, knots (l,) and multiplicities (l,)."""
    count = curve.NbPoles()
    poles = np.array([(at.X(), at.Y(), at.Z()) for at in map(curve.Pole, range(1, count + 1))])
    weights = None
    if curve.IsRational():
        weights = np.array([curve.Weight(i) for i in range(1, count + 1)])
    span = range(1, curve.NbKnots() + 1)
    knots = np.array([curve.Knot(i) for i in span])
    multiplicities = np.array([curve.Multiplicity(i) for i in span], dtype=np.int64)
    return poles, weights, knots, multiplicities


def make_surface(
    poles: ArrayLike,
    knots: tuple[ArrayLike, ArrayLike],
    multiplicities: tuple[ArrayLike, ArrayLike],
    degrees: tuple[int, int],
    weights: ArrayLike | None = None,
) -> Geom_BSplineSurface:
    """Returns a clamped B-spline surface: poles (k, l, 3) mm, weights (k, l), the rest (u, v).

    Example:
        >>> corners = [[[0, 0, 0], [0, 9, 0]], [[9, 0, 0], [9, 9, 3]]]
        >>> surface = make_surface(corners, ((0, 1), (0, 1)), ((2, 2), (2, 2)), (1, 1))
        >>> surface.Value(0.5, 0.5).Z()
        0.75
    """
    grid = np.asarray(poles, dtype=np.float64)
    points = PointGrid(1, grid.shape[0], 1, grid.shape[1])
    for i, j in np.ndindex(grid.shape[0], grid.shape[1]):
        points.SetValue(i + 1, j + 1, gp_Pnt(*(float(value) for value in grid[i, j])))
    values = [_real_array(np.asarray(value, dtype=np.float64)) for value in knots]
    counts = [_integer_array(np.asarray(count)) for count in multiplicities]
    with kernel_step("make a surface"):
        if weights is None:
            return Geom_BSplineSurface(points, *values, *counts, *degrees, False, False)
        given = np.asarray(weights, dtype=np.float64)
        shares = RealGrid(1, grid.shape[0], 1, grid.shape[1])
        for i, j in np.ndindex(grid.shape[0], grid.shape[1]):
            shares.SetValue(i + 1, j + 1, float(given[i, j]))
        return Geom_BSplineSurface(points, shares, *values, *counts, *degrees, False, False)


def insert_u_knots(surface: Geom_BSplineSurface, knots: ArrayLike, gap: float) -> None:
    """Gives a surface single knots along u, all at once: one by one takes time by their square.

    Args:
        surface: is changed; its points stay where they are.
        knots: (k,) increasing parameters; none may be.
        gap: a knot nearer than this to one that is there already is that one.

    Example:
        >>> corners = [[[0, 0, 0], [0, 9, 0]], [[9, 0, 0], [9, 9, 3]]]
        >>> surface = make_surface(corners, ((0, 1), (0, 1)), ((2, 2), (2, 2)), (1, 1))
        >>> insert_u_knots(surface, [0.25, 0.5], 1e-9)
        >>> surface.NbUKnots()
        4
    """
    values = np.asarray(knots, dtype=np.float64)
    if not len(values):
        return
    values = values[np.diff(values, prepend=-np.inf) > gap]
    with kernel_step("give a surface knots"):
        counts = _integer_array(np.ones(len(values), dtype=np.int64))
        surface.InsertUKnots(_real_array(values), counts, gap, False)


def _point_array(points: Floats) -> PointRow:
    array = PointRow(1, len(points))
    for i, (x, y, z) in enumerate(points.tolist(), start=1):
        array.SetValue(i, gp_Pnt(x, y, z))
    return array


def _real_array(values: Floats) -> RealRow:
    array = RealRow(1, len(values))
    for i, value in enumerate(values.tolist(), start=1):
        array.SetValue(i, value)
    return array


def _integer_array(values: NDArray[np.int64]) -> IntegerRow:
    array = IntegerRow(1, len(values))
    for i, value in enumerate(values.tolist(), start=1):
        array.SetValue(i, value)
    return array

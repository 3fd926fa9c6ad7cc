"""Points on a rail at given arc lengths: where notches stand in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.GeomAdaptor import GeomAdaptor_Curve

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.errors import InputError

from .directrix import Directrix

Floats = NDArray[np.float64]


def points_at_arcs(rail: Directrix, arcs: ArrayLike) -> Floats:
    """Returns the points of a rail at given arc lengths.

    Args:
        rail: the rail.
        arcs: (k,) float64, mm from the rail's start, within its length.

    Returns:
        (k, 3) float64, mm.

    Raises:
        InputError: an arc length lies beyond the rail.
        CadError: the kernel cannot measure the rail.
    """
    wanted = np.asarray(arcs, dtype=np.float64)
    slack = settings.SPAN_SLACK * rail.length
    if len(wanted) and not -slack <= wanted.min() <= wanted.max() <= rail.length + slack:
        raise InputError(
            f"Arc lengths from {wanted.min():g} to {wanted.max():g} mm leave the rail, which is"
            f" {rail.length:g} mm long. Give lengths from 0 to that."
        )
    with kernel_step("measure along a rail"):
        adaptors = [GeomAdaptor_Curve(curve) for curve in rail.curves]
        lengths = [GCPnts_AbscissaPoint.Length_s(adaptor) for adaptor in adaptors]
        starts = np.concatenate(([0.0], np.cumsum(lengths)))
        points = [_point(adaptors, starts, float(arc)) for arc in wanted]
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _point(adaptors: list[GeomAdaptor_Curve], starts: Floats, arc: float) -> tuple[float, ...]:
    at = int(np.clip(np.searchsorted(starts, arc, side="right") - 1, 0, len(adaptors) - 1))
    curve = adaptors[at]
    ahead = max(arc - float(starts[at]), 0.0)
    parameter = GCPnts_AbscissaPoint(curve, ahead, curve.FirstParameter()).Parameter()
    point = curve.Value(min(parameter, curve.LastParameter()))
    return point.X(), point.Y(), point.Z()

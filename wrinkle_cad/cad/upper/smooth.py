"""One smooth B-spline through points; directrices as edges again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad.cad.kernel.splines import curve_arrays, make_curve
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths

Floats = NDArray[np.float64]

RUN_ON: Final = 24
"""Points that a ring is run on by beyond its ends: four to this power is below round-off."""


def smooth_edge(points: Floats) -> TopoDS_Edge:
    """Returns a cubic B-spline edge through (k, 3) points in mm, k >= 4, C2 throughout.

    If the last point is the first one again, it is closed and as smooth there as elsewhere.

    Example:
        >>> from build123d import Edge
        >>> points = np.array([[0, 0, 0], [10, 0, 2], [20, 0, 0], [30, 0, -2]], dtype=float)
        >>> round(Edge(smooth_edge(points)).length, 1)
        30.8
    """
    arc = arc_lengths(points)
    if not is_ring(points):
        spline = cubic_through(arc, points)
        knots, counts = np.unique(spline.knots, return_counts=True)
        return BRepBuilderAPI_MakeEdge(make_curve(spline.poles, knots, counts, 3)).Edge()
    spline = cubic_through(*around(arc, points))
    knots, counts = np.unique(spline.knots, return_counts=True)
    whole = make_curve(spline.poles, knots, counts, 3)
    with kernel_step("close a curve"):
        whole.Segment(0.0, float(arc[-1]))
    poles, _, knots, counts = curve_arrays(whole)
    poles[-1] = poles[0]
    return BRepBuilderAPI_MakeEdge(make_curve(poles, knots, counts, 3)).Edge()


def is_ring(points: Floats) -> bool:
    """Whether the last of (k, 3) points in mm is the first one again, exactly."""
    return bool((points[0] == points[-1]).all())


def around(arc: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """Returns parameters and rows of a ring, run on beyond both ends.

    A spline through them is, between the ends, as good as periodic: what it does at its own ends
    dies away by a factor of four from point to point.

    Args:
        arc: (k,) increasing from 0; the last one is the ring's length.
        rows: (k, d) the last one is the first again.
    """
    more = min(RUN_ON, len(rows) - 2)
    length = arc[-1]
    return (
        np.concatenate((arc[-1 - more : -1] - length, arc, arc[1 : 1 + more] + length)),
        np.concatenate((rows[-1 - more : -1], rows, rows[1 : 1 + more])),
    )


def curve_edges(directrix: Directrix) -> list[TopoDS_Edge]:
    """Returns a directrix as edges in a row."""
    return [BRepBuilderAPI_MakeEdge(curve).Edge() for curve in directrix.curves]


def edge_row(edges: Sequence[TopoDS_Edge]) -> TopoDS_Shape:
    """Returns edges as one wire, or as a compound where they do not meet."""
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
        if not wire.IsDone():
            return make_compound(edges)
    return wire.Wire()

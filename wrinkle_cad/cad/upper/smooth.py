"""One smooth B-spline through points; directrices as edges again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths

Floats = NDArray[np.float64]


def smooth_edge(points: Floats) -> TopoDS_Edge:
    """Returns a cubic B-spline edge through (k, 3) points in mm, k >= 4, C2 throughout.

    Example:
        >>> from build123d import Edge
        >>> points = np.array([[0, 0, 0], [10, 0, 2], [20, 0, 0], [30, 0, -2]], dtype=float)
        >>> round(Edge(smooth_edge(points)).length, 1)
        30.8
    """
    spline = cubic_through(arc_lengths(points), points)
    knots, counts = np.unique(spline.knots, return_counts=True)
    return BRepBuilderAPI_MakeEdge(make_curve(spline.poles, knots, counts, 3)).Edge()


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

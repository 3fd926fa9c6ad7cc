"""One smooth B-spline through points; directrices as edges again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape
from scipy.interpolate import make_interp_spline

from .directrix import Directrix
from .splines import make_curve

Floats = NDArray[np.float64]


def smooth_edge(points: Floats) -> TopoDS_Edge:
    """Returns a cubic B-spline edge through (k, 3) points in mm, k >= 4, C2 throughout."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    spline = make_interp_spline(np.concatenate(([0.0], np.cumsum(steps))), points, k=3)
    knots, counts = np.unique(spline.t, return_counts=True)
    return BRepBuilderAPI_MakeEdge(make_curve(spline.c, knots, counts, 3)).Edge()


def curve_edge(directrix: Directrix) -> TopoDS_Shape:
    """Returns a directrix as an edge, or as a wire if it has several."""
    edges = [BRepBuilderAPI_MakeEdge(curve).Edge() for curve in directrix.curves]
    if len(edges) == 1:
        return edges[0]
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    return wire.Wire()

"""Closes the sliver between an end bridge of a wrinkle and the end of its opening.

The end bridge is straight, the opening's end lies on the upper. Between them stands a fan: cones
over the opening's end with their apex at the middle of the end bridge. With its apex at the rail's
end instead, the fan was valid in memory and could not be oriented after a STEP round trip.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BSplineCurve
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_curve, edge_ends
from wrinkle_cad.cad.kernel.splines import curve_arrays, make_surface
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.strip.curve.polyline import segment_gaps
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]


def end_fan(
    edges: Sequence[TopoDS_Edge], bridge: Floats, corners: Floats
) -> tuple[TopoDS_Face, ...]:
    """Returns the faces between an end bridge and an end of an opening; none if they coincide.

    Args:
        edges: the opening's end, from P to Q.
        bridge: (2, 3) mm; the strip's end bridge, from P to Q.
        corners: (2, 3) mm; the ends of the opening's two sides, from P to Q. They are apart from
            the bridge's ends where a profile does not come down to the upper.
    """
    apex = bridge.mean(axis=0)
    run: list[TopoDS_Edge] = []
    if norm(corners[0] - bridge[0]) > settings.COINCIDENT:
        run.append(_straight(bridge[0], corners[0]))
    run.extend(edges)
    if norm(corners[1] - bridge[1]) > settings.COINCIDENT:
        run.append(_straight(corners[1], bridge[1]))
    if not run or _height(run, bridge) <= settings.SLIVER:
        return ()
    return tuple(_cone(edge_curve(edge), apex) for edge in run)


def _straight(start: Floats, end: Floats) -> TopoDS_Edge:
    points = (gp_Pnt(*start.tolist()), gp_Pnt(*end.tolist()))
    return BRepBuilderAPI_MakeEdge(*points).Edge()


def _height(run: Sequence[TopoDS_Edge], bridge: Floats) -> float:
    """Returns mm: how far the run of edges stands off the straight bridge."""
    worst = 0.0
    for edge in run:
        poles = curve_arrays(edge_curve(edge))[0]
        points = np.vstack((poles, *(end[None] for end in edge_ends(edge))))
        worst = max(worst, float(segment_gaps(points, *bridge).max()))
    return worst


def _cone(curve: Geom_BSplineCurve, apex: Floats) -> TopoDS_Face:
    poles, weights, knots, counts = curve_arrays(curve)
    grid = np.stack((poles, np.broadcast_to(apex, poles.shape)), axis=1)
    both = None if weights is None else np.stack((weights, weights), axis=1)
    surface = make_surface(grid, (knots, (0.0, 1.0)), (counts, (2, 2)), (curve.Degree(), 1), both)
    with kernel_step("close an end of the opening"):
        return BRepBuilderAPI_MakeFace(surface, settings.CONFUSION).Face()

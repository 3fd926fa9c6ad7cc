"""Rails across the vamp of an upper: where planes through the last's long axis meet it."""

from __future__ import annotations

import numpy as np
from build123d import Compound, Vertex
from numpy.typing import NDArray
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from shoe_examples.upper import rounded
from wrinkle_cad import smooth_edge

AXIS_HEIGHT = 2.0
"""mm above the feather edge; rays that draw a rail start on this axis."""
POINTS = 61
Floats = NDArray[np.float64]


def rail_points(
    upper: TopoDS_Shape,
    x: float,
    *,
    skew: float = 0.0,
    bow: float = 0.0,
    reach_deg: tuple[float, float] = (-62.0, 62.0),
) -> Floats:
    """Returns (k, 3) mm: points on the upper over a line across the foot, inner side first.

    Args:
        upper: what the rail lies on.
        x: mm from the heel to where the rail crosses the middle.
        skew: mm by which its outer end lies further forward, and its inner end further back.
        bow: mm by which its middle lies further forward.
        reach_deg: how far it comes down on the inner and on the outer side, from straight up.
    """
    shooter = IntCurvesFace_ShapeIntersector()
    shooter.Load(upper, 1e-7)
    points = []
    for angle in np.radians(np.linspace(*reach_deg, POINTS)):
        forward = float(x + skew * np.sin(angle) + bow * np.cos(angle))
        ray = gp_Lin(
            gp_Pnt(forward, 0.0, AXIS_HEIGHT),
            gp_Dir(0.0, float(np.sin(angle)), float(np.cos(angle))),
        )
        shooter.Perform(ray, 0.0, 1000.0)
        assert shooter.NbPnt() == 1, f"x {x} mm, {np.degrees(angle):.0f} degrees: no single hit"
        hit = shooter.Pnt(1)
        points.append((hit.X(), hit.Y(), hit.Z()))
    return rounded(points)


def vamp_rail(
    upper: TopoDS_Shape,
    x: float,
    *,
    skew: float = 0.0,
    bow: float = 0.0,
    reach_deg: tuple[float, float] = (-62.0, 62.0),
) -> TopoDS_Edge:
    """Returns a rail across the vamp as one B-spline edge; see ``rail_points``."""
    return smooth_edge(rail_points(upper, x, skew=skew, bow=bow, reach_deg=reach_deg))


def feather_rail(upper: TopoDS_Shape, x: float, *, skew: float = 0.0) -> TopoDS_Edge:
    """Returns a rail that starts and ends on the feather edge, the longest border of the upper."""
    feather = max(Compound.cast(upper).edges(), key=lambda edge: float(edge.length)).wrapped
    points = rail_points(upper, x, skew=skew, reach_deg=(-88.0, 88.0))
    ends = []
    for point in (points[0], points[-1]):
        nearest = BRepExtrema_DistShapeShape(Vertex(*point).wrapped, feather).PointOnShape2(1)
        ends.append([nearest.X(), nearest.Y(), nearest.Z()])
    return smooth_edge(rounded(np.vstack((ends[:1], points, ends[1:]))))

"""Where a face's edges lie on its surface: curves in the surface's parameters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Line
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import make_curve_2d
from wrinkle_cad.strip.portable import dot

from .face_borders import BorderEdge

Floats = NDArray[np.float64]


def on_ruling(shape: PoleCurve, u: float, base: Floats, apex: Floats) -> Geom2d_BSplineCurve:
    """Returns the parameter curve of an edge along the ruling at u, each pole dropped onto it.

    Args:
        shape: the edge's curve.
        u: the ruling's parameter; along it the other one runs from 0 to 1.
        base: (3,) mm; where the ruling starts.
        apex: (3,) mm; where it ends.
    """
    way = apex - base
    across = dot(shape.poles - base, way) / dot(way, way)
    places = np.column_stack((np.full(len(across), u), across))
    return make_curve_2d(places, shape.knots, shape.multiplicities, shape.degree, shape.weights)


def put_on_face(
    edge: TopoDS_Edge, curve: Geom2d_Line | Geom2d_BSplineCurve, face: TopoDS_Face
) -> None:
    """Tells an edge where it lies on the surface of a face."""
    BRep_Builder().UpdateEdge(edge, curve, face, settings.CONFUSION)


def degenerated_edge(
    line: Geom2d_Line, interval: tuple[float, float], vertex: TopoDS_Vertex, face: TopoDS_Face
) -> BorderEdge:
    """Returns the edge along a side of a surface that is one point, run backwards.

    Args:
        line: the side in the surface's parameters.
        interval: of the line.
        vertex: the vertex at the point.
        face: the face on the surface.
    """
    builder, edge = BRep_Builder(), TopoDS_Edge()
    builder.MakeEdge(edge)
    builder.UpdateEdge(edge, line, face, settings.CONFUSION)
    builder.Add(edge, vertex.Oriented(TopAbs_FORWARD))
    builder.Add(edge, vertex.Oriented(TopAbs_REVERSED))
    builder.Range(edge, *interval)
    builder.Degenerated(edge, True)
    nothing = PoleCurve(1, np.array(interval), np.array([2, 2]), np.empty((0, 3)), None)
    return BorderEdge(edge, nothing, vertex, vertex, is_forward=False)

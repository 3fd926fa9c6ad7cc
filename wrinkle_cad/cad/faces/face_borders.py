"""Borders: rows of shared edges between two corners of a face.

A border is mostly one edge. Where a neighbour is too thin to be made, it is the other borders of
that neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_BSplineCurve, Geom_Curve, Geom_Line
from OCP.gp import gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Edge, TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import curve_arrays
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class BorderEdge:
    """An edge as a face meets it."""

    edge: TopoDS_Edge
    """The shared edge, forward."""

    shape: PoleCurve
    """Its curve as numbers, over the edge's own parameter."""

    start: TopoDS_Vertex
    """The vertex where the edge starts."""

    end: TopoDS_Vertex
    """The vertex where the edge ends."""

    is_forward: bool = True
    """Whether the border runs along the edge."""

    def flipped(self) -> BorderEdge:
        """Returns the edge run the other way."""
        return BorderEdge(self.edge, self.shape, self.start, self.end, not self.is_forward)


Border = tuple[BorderEdge, ...]
"""Edges in order, the end of each the start of the next; empty if its ends are one vertex."""


def flipped(border: Border) -> Border:
    """Returns the border run the other way."""
    return tuple(item.flipped() for item in reversed(border))


def border_poles(border: Border) -> Floats:
    """Returns (k, 3) mm: the poles of a border's edges along it."""
    rows = [item.shape.poles if item.is_forward else item.shape.poles[::-1] for item in border]
    return np.concatenate(rows) if rows else np.empty((0, 3))


def straight_edge(start: TopoDS_Vertex, end: TopoDS_Vertex, ends: Floats) -> BorderEdge:
    """Returns the straight edge between two vertices at (2, 3) mm, its parameter the length."""
    way = ends[1] - ends[0]
    length = norm(way)
    line = Geom_Line(gp_Pnt(*ends[0].tolist()), gp_Dir(*way.tolist()))
    shape = PoleCurve(1, np.array([0.0, length]), np.array([2, 2]), ends, None)
    return BorderEdge(_edge(line, start, end, 0.0, length), shape, start, end)


def curved_edge(
    curve: Geom_BSplineCurve, start: TopoDS_Vertex, end: TopoDS_Vertex, ends: Floats
) -> BorderEdge:
    """Returns the edge on the whole of a curve, whose end poles are moved to (2, 3) mm."""
    curve.SetPole(1, gp_Pnt(*ends[0].tolist()))
    curve.SetPole(curve.NbPoles(), gp_Pnt(*ends[1].tolist()))
    poles, weights, knots, multiplicities = curve_arrays(curve)
    shape = PoleCurve(curve.Degree(), knots, multiplicities, poles, weights)
    first, last = curve.FirstParameter(), curve.LastParameter()
    return BorderEdge(_edge(curve, start, end, first, last), shape, start, end)


def sub_curve(curve: Geom_BSplineCurve, first: float, last: float) -> Geom_BSplineCurve:
    """Returns the part of a curve between two parameters, as a curve of its own."""
    part = curve.Copy()
    if not isinstance(part, Geom_BSplineCurve):
        raise CadError(
            "cut a rail at its samples",
            f"the copy of its curve is a {type(part).__name__}. Check the rail.",
        )
    part.Segment(first, last)
    return part


def _edge(
    curve: Geom_Curve, start: TopoDS_Vertex, end: TopoDS_Vertex, first: float, last: float
) -> TopoDS_Edge:
    builder, edge = BRep_Builder(), TopoDS_Edge()
    builder.MakeEdge(edge, curve, settings.CONFUSION)
    builder.Add(edge, start.Oriented(TopAbs_FORWARD))
    builder.Add(edge, end.Oriented(TopAbs_REVERSED))
    builder.Range(edge, first, last)
    return edge


def loosen(border: Border, tolerance: float) -> None:
    """Raises the tolerance of a border's edges and vertices to at least ``tolerance`` mm."""
    builder = BRep_Builder()
    for item in border:
        builder.UpdateEdge(item.edge, tolerance)
        for vertex in (item.start, item.end):
            builder.UpdateVertex(vertex, tolerance)

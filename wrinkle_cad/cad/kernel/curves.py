"""The curve of an edge, and points on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BSplineCurve, Geom_TrimmedCurve
from OCP.GeomConvert import GeomConvert
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Edge

from wrinkle_cad.errors import CadError

from .steps import kernel_step
from .topology import as_edge

Floats = NDArray[np.float64]


def edge_curve(edge: TopoDS_Edge) -> Geom_BSplineCurve:
    """Returns the curve of an edge as a B-spline of its own.

    It is in world coordinates, trimmed to the edge, clamped, and runs the way the edge does.

    Raises:
        CadError: the edge has no curve (it is degenerated), or it cannot be converted.
    """
    with kernel_step("take the curve of an edge"):
        edge = _with_curve(edge)
        adaptor = BRepAdaptor_Curve(edge)
        first, last = adaptor.FirstParameter(), adaptor.LastParameter()
        curve = BRep_Tool.Curve_s(edge, first, last)
        spline = GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))
        if spline.IsPeriodic():
            spline.SetNotPeriodic()
        if edge.Orientation() == TopAbs_REVERSED:
            spline.Reverse()
    return spline


def _with_curve(edge: TopoDS_Edge) -> TopoDS_Edge:
    if BRep_Tool.Degenerated_s(edge):
        raise CadError("take the curve of an edge", "the edge is a single point. Pass a curve.")
    if BRep_Tool.IsGeometric_s(edge) and BRep_Tool.Curve_s(edge, 0.0, 0.0) is not None:
        return edge
    own = as_edge(BRepBuilderAPI_Copy(edge).Shape())
    if not BRepLib.BuildCurve3d_s(own):
        found = "it has no 3-D curve and none could be built. Export it with one."
        raise CadError("take the curve of an edge", found)
    return own


def edge_ends(edge: TopoDS_Edge) -> tuple[Floats, Floats]:
    """Returns (3,) mm each: where the curve of an edge starts and ends, along its orientation.

    A vertex may stand off the curve by its tolerance, which in a joined upper is not small.
    """
    adaptor = BRepAdaptor_Curve(edge)
    ends = [adaptor.Value(adaptor.FirstParameter()), adaptor.Value(adaptor.LastParameter())]
    if edge.Orientation() == TopAbs_REVERSED:
        ends.reverse()
    start, end = (np.array([at.X(), at.Y(), at.Z()]) for at in ends)
    return start, end


def edge_middle(edge: TopoDS_Edge) -> Floats:
    """Returns (3,) mm: the point in the middle of an edge's parameter."""
    adaptor = BRepAdaptor_Curve(edge)
    at = adaptor.Value(0.5 * (adaptor.FirstParameter() + adaptor.LastParameter()))
    return np.array([at.X(), at.Y(), at.Z()])

"""The curve of an edge, and points on it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.Approx import Approx_Curve3d
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.Geom import Geom_BSplineCurve, Geom_Circle, Geom_Line, Geom_TrimmedCurve
from OCP.GeomAbs import GeomAbs_C1, GeomAbs_Circle, GeomAbs_Line, GeomAbs_OffsetCurve
from OCP.GeomConvert import GeomConvert
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Edge

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError

from .steps import kernel_step

Floats = NDArray[np.float64]
PIECES_MAX, DEGREE_MAX = 1000, 9


def edge_curve(edge: TopoDS_Edge) -> Geom_BSplineCurve:
    """Returns the curve of an edge as a B-spline of its own.

    It is in world coordinates, trimmed to the edge, clamped, and runs the way the edge does.

    Raises:
        CadError: the edge has no curve (it is degenerated), or it cannot be converted.
    """
    with kernel_step("take the curve of an edge"):
        if BRep_Tool.Degenerated_s(edge):
            found = "the edge is a single point. Pass a curve."
            raise CadError("take the curve of an edge", found)
        spline = _spline(BRepAdaptor_Curve(edge), edge)
        if spline.IsPeriodic():
            spline.SetNotPeriodic()
        if edge.Orientation() == TopAbs_REVERSED:
            spline.Reverse()
    return spline


def _spline(adaptor: BRepAdaptor_Curve, edge: TopoDS_Edge) -> Geom_BSplineCurve:
    first, last = adaptor.FirstParameter(), adaptor.LastParameter()
    if adaptor.GetType() == GeomAbs_OffsetCurve:
        # The kernel's own conversion leaves a curve that turns by hundredths of a millimetre.
        return _followed(adaptor, "it is an offset curve, which no B-spline")
    if adaptor.Is3DCurve():
        curve = BRep_Tool.Curve_s(edge, first, last)
    elif adaptor.GetType() == GeomAbs_Line:
        curve = Geom_Line(adaptor.Line())
    elif adaptor.GetType() == GeomAbs_Circle:
        curve = Geom_Circle(adaptor.Circle())
    else:
        return _followed(adaptor, "it has a curve on its surface only, which no curve in space")
    return GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))


def _followed(adaptor: BRepAdaptor_Curve, what: str) -> Geom_BSplineCurve:
    """Returns a B-spline along the curve of an edge that is none in space.

    Raises:
        CadError: none follows it closely enough; ``what`` begins the sentence.
    """
    found = Approx_Curve3d(adaptor, settings.CONFUSION, GeomAbs_C1, PIECES_MAX, DEGREE_MAX)
    if not found.IsDone() or found.MaxError() > 10.0 * settings.CONFUSION:
        raise CadError(
            "take the curve of an edge",
            f"{what} follows to {10.0 * settings.CONFUSION:.0e} mm. Export it as a B-spline.",
        )
    return found.Curve()


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

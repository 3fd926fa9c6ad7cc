"""Edges beside a cone's apex that other programs find on their face.

A STEP file holds edges as curves in space, and who reads it looks for each on its face at places
evenly spaced, more the more knots the curve has. Between the apex, where every direction is right,
and the place that follows, the curve found so is off by a share of the sagitta over the square of
their number: by 1e-5 mm on slivers of a hundredth of a millimetre.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.Geom import Geom_BSplineCurve
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import curve_arrays
from wrinkle_cad.cad.kernel.topology import edges_of
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.portable import norm

from .face_borders import sub_curve

KNOTS_PER_ROOT: Final = 1000.0
"""Per root of the sagitta in mm: with so many knots what is found is off by 5e-8 mm (measured: by
1.2e-5 mm at 23 places on a sagitta of 0.008 mm; readers take four places per knot)."""

KNOTS_MOST: Final = 400


def is_sliver(face: TopoDS_Face) -> bool:
    """Tells whether a face has two edges only, besides an apex."""
    edges = edges_of(face)
    return len(edges) == 3 and sum(BRep_Tool.Degenerated_s(edge) for edge in edges) == 1


def make_dense(edge: TopoDS_Edge) -> None:
    """Gives a curved edge as many knots as it takes for it to be found again; it stays in place."""
    ends = BRepAdaptor_Curve(edge)
    first, last = ends.FirstParameter(), ends.LastParameter()
    curve = BRep_Tool.Curve_s(edge, first, last)
    if not isinstance(curve, Geom_BSplineCurve) or not edge.Location().IsIdentity():
        return
    dense = sub_curve(curve, first, last)
    poles, _, knots, _ = curve_arrays(dense)
    chord = poles[-1] - poles[0]
    sagitta = float(row_lengths(np.cross(poles - poles[0], chord)).max()) / norm(chord)
    count = min(KNOTS_MOST, math.ceil(KNOTS_PER_ROOT * math.sqrt(sagitta)))
    if count <= len(knots):
        return
    for at in np.linspace(first, last, count + 2)[1:-1].tolist():
        dense.InsertKnot(at, 1, settings.KNOT_GAP)
    BRep_Builder().UpdateEdge(edge, dense, BRep_Tool.Tolerance_s(edge))
    BRep_Builder().Range(edge, first, last)

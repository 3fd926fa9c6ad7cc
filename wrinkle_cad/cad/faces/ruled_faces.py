"""Faces on ruled patches: one smooth face per piece, with the rails themselves as its edges.

The surface is a B-spline: u is the place along the piece, v runs along the rulings from P (0) to Q
(1). The rails' edges keep their own curves and parameters; on the surface they lie along its sides,
where a spline says at which place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_BSplineSurface
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt2d
from OCP.TopoDS import TopoDS_Face, TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import make_curve_2d, make_surface
from wrinkle_cad.strip.curve.quintic import DEGREE, Quintic
from wrinkle_cad.strip.rulings.patch import RuledPatch

from .face_borders import Border, BorderEdge, flipped, loosen
from .on_surface import degenerated_edge, on_ruling, put_on_face
from .plane_faces import make_wire

Floats = NDArray[np.float64]


def ruled_face(
    patch: RuledPatch,
    banks: tuple[BorderEdge, BorderEdge],
    early: Border,
    late: Border,
    meeting: tuple[TopoDS_Vertex, TopoDS_Vertex],
) -> TopoDS_Face:
    """Returns the face on a patch.

    Its normal is P's direction crossed with that from P to Q.

    Args:
        patch: its surface.
        banks: the edges along P and along Q, forward.
        early: border along its first ruling, from P to Q; empty if the rails meet there.
        late: border along its last ruling, likewise.
        meeting: the vertices on P of both rulings.
    """
    builder, face = BRep_Builder(), TopoDS_Face()
    builder.MakeFace(face, surface_of(patch), settings.CONFUSION)
    for v, (bank, way) in enumerate(zip(banks, patch.ways, strict=True)):
        loosen((bank,), settings.CONFUSION + patch.error)
        put_on_face(bank.edge, _along(bank, way, float(v)), face)
    sides = []
    ends = patch.rails.at(np.array([0.0, 1.0]))
    for u, (border, vertex) in enumerate(zip((early, late), meeting, strict=True)):
        for item in border:
            curve = on_ruling(item.shape, float(u), ends[u, :3], ends[u, 3:])
            put_on_face(item.edge, curve, face)
        tip = degenerated_edge(
            Geom2d_Line(gp_Pnt2d(float(u), 0.0), gp_Dir2d(0.0, 1.0)), (0.0, 1.0), vertex, face
        )
        sides.append(border or (tip.flipped(),))
    loop = (banks[0], *sides[1], banks[1].flipped(), *flipped(sides[0]))
    builder.Add(face, make_wire(loop))
    return face


def surface_of(patch: RuledPatch) -> Geom_BSplineSurface:
    """Returns the surface of a patch."""
    poles = patch.rails.poles
    return make_surface(
        np.stack((poles[:, :3], poles[:, 3:]), axis=1),
        (patch.rails.knots, np.array([0.0, 1.0])),
        (patch.rails.multiplicities, np.array([2, 2])),
        (DEGREE, 1),
    )


def _along(bank: BorderEdge, way: Quintic, v: float) -> Geom2d_BSplineCurve:
    """Returns where a bank lies on the surface, by the edge's own parameter."""
    low, high = (float(bank.shape.knots[at]) for at in (0, -1))
    share = (way.knots - way.knots[0]) / (way.knots[-1] - way.knots[0])
    poles = way.poles
    places = np.column_stack((poles[:, 0], np.full(len(poles), v)))
    knots = (1.0 - share) * low + share * high
    return make_curve_2d(places, knots, way.multiplicities, DEGREE)

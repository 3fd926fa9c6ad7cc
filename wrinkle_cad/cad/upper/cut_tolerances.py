"""Gives the edges that outlines cut into an upper the tolerances that they need, and bounds them.

The kernel leaves each with the tolerance of its intersection: with how far the edge is from the
ribbon that cut it, which is thrown away. What counts is how far its curve in space is from its
curves on the faces. Where that is too much, the curve in space is drawn anew on the surface.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.Adaptor3d import Adaptor3d_CurveOnSurface
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepLib import BRepLib_ValidateEdge
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.Geom2dAdaptor import Geom2dAdaptor_Curve
from OCP.GeomAbs import GeomAbs_BSplineCurve
from OCP.GeomAdaptor import GeomAdaptor_Curve, GeomAdaptor_Surface
from OCP.ShapeFix import ShapeFix_ShapeTolerance
from OCP.TopAbs import TopAbs_EDGE, TopAbs_VERTEX
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.measures import tolerance_of
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.kernel.topology import edges_of, make_compound, vertices_of
from wrinkle_cad.errors import CadError

from .drawn_edges import curve_over, knots_of
from .pieces import Split, oriented_edges

Floats = NDArray[np.float64]
STEP = "split the upper"

CUT_EDGE_TOLERANCE: Final = 1e-5
"""mm; what the tolerance of an edge that an outline cuts into an upper may be."""

CHECKS_PER_SPAN: Final = 6
"""The distance between an edge and its curve on a face is measured so densely ..."""

CHECKS_LEAST: Final = 64
"""... and at so many places at least."""

SLACK: Final = 1.2
"""Between these places it may be larger by this factor."""


@dataclass(frozen=True, slots=True, eq=False)
class _Use:
    """An edge on one of the faces beside it."""

    edge: TopoDS_Edge
    face: TopoDS_Face
    origin: int
    """Index of the face of the upper that the face is a piece of."""


def settle_tolerances(faces: Sequence[TopoDS_Face], split: Split) -> None:
    """Gives each new edge along an outline, and its vertices, the tolerance that it needs.

    Args:
        faces: of the upper, before it was split; their own edges are not written to.
        split: its pieces; the tolerances of their new edges are set.

    Raises:
        CadError: an edge's curve stays too far from its faces.
    """
    touched = [
        i
        for i, (face, pieces) in enumerate(zip(faces, split.pieces, strict=True))
        if not (len(pieces) == 1 and pieces[0].IsPartner(face))
    ]
    given = make_compound(faces[i] for i in touched)
    kept = ShapeIndex(edges_of(given))
    cuts = ShapeIndex(cut.edge for cuts in split.cuts for cut in cuts)
    uses: dict[int, list[_Use]] = {}
    beside: list[_Use] = []
    for i in touched:
        for piece in split.pieces[i]:
            for edge in oriented_edges(piece):
                use = _Use(edge, piece, i)
                beside.append(use)
                found = cuts.find(edge)
                if found >= 0 and kept.find(edge) < 0:
                    uses.setdefault(found, []).append(use)
    for own in uses.values():
        _settle_edge(own, faces)
    _settle_vertices(uses.values(), beside, ShapeIndex(vertices_of(given)))


def _settle_edge(uses: Sequence[_Use], faces: Sequence[TopoDS_Face]) -> None:
    edge, origins = uses[0].edge, {use.origin for use in uses}
    gap = max(_gap(use) for use in uses)
    limit = CUT_EDGE_TOLERANCE
    if len(origins) > 1:
        # It is part of an edge of the upper, and no better than that.
        limit = max(limit, *(tolerance_of(faces[i]) for i in origins))
    elif gap > settings.CONFUSION and _draw_anew(uses[0]):
        gap = max(_gap(use) for use in uses)
    tolerance = max(settings.CONFUSION, SLACK * gap)
    if tolerance > limit:
        at = BRepAdaptor_Curve(edge)
        x, y, z = at.Value(0.5 * (at.FirstParameter() + at.LastParameter())).Coord()
        raise CadError(
            STEP,
            f"a new edge at ({x:.1f}, {y:.1f}, {z:.1f}) mm is {gap:.2g} mm off the upper, at most"
            f" {limit:.2g} mm is allowed. Move the rails a little, or repair the upper's surface"
            " there.",
        )
    ShapeFix_ShapeTolerance().SetTolerance(edge, tolerance, TopAbs_EDGE)


def _gap(use: _Use) -> float:
    """Returns mm: the largest distance of an edge's curve from its curve on a face."""
    ends = BRepAdaptor_Curve(use.edge)
    first, last = ends.FirstParameter(), ends.LastParameter()
    flat = BRep_Tool.CurveOnSurface_s(use.edge, use.face, first, last)
    on_face = Adaptor3d_CurveOnSurface(
        Geom2dAdaptor_Curve(flat, first, last),
        GeomAdaptor_Surface(BRep_Tool.Surface_s(use.face)),
    )
    space = GeomAdaptor_Curve(BRep_Tool.Curve_s(use.edge, first, last), first, last)
    spans = flat.NbKnots() if isinstance(flat, Geom2d_BSplineCurve) else 0
    spans += space.NbKnots() if space.GetType() == GeomAbs_BSplineCurve else 0
    measured = BRepLib_ValidateEdge(space, on_face, True)
    measured.SetControlPointsNumber(max(CHECKS_LEAST, CHECKS_PER_SPAN * spans))
    measured.Process()
    return float(measured.GetMaxDistance()) if measured.IsDone() else np.inf


def _draw_anew(use: _Use) -> bool:
    """Gives an edge a curve in space that follows its curve on the face; tells whether it could."""
    ends = BRepAdaptor_Curve(use.edge)
    first, last = ends.FirstParameter(), ends.LastParameter()
    flat = BRep_Tool.CurveOnSurface_s(use.edge, use.face, first, last)
    surface = BRep_Tool.Surface_s(use.face)

    def point_at(at: Floats) -> Floats:
        places = [flat.Value(t).Coord() for t in at.tolist()]
        return np.array([surface.Value(u, v).Coord() for u, v in places])

    at = np.linspace(first, last, 9)
    if isinstance(flat, Geom2d_BSplineCurve):
        knots = np.array([flat.Knot(i) for i in range(1, flat.NbKnots() + 1)])
        at = np.union1d(at, knots[(knots > first) & (knots < last)])
    found = curve_over(point_at, at)
    if found is None:
        return False
    curve = make_curve(found[0].c, *knots_of(found[0]), 3)
    BRep_Builder().UpdateEdge(use.edge, curve, settings.CONFUSION)
    return True


def _settle_vertices(
    cut: Iterable[Sequence[_Use]], beside: Sequence[_Use], kept: ShapeIndex
) -> None:
    """Gives the ends of new edges the tolerance that all edges there need."""
    ends = ShapeIndex(
        vertex for uses in cut for vertex in vertices_of(uses[0].edge) if kept.find(vertex) < 0
    )
    needed: dict[int, tuple[TopoDS_Vertex, float]] = {}
    for use in beside:
        for is_last, vertex in enumerate(
            (TopExp.FirstVertex_s(use.edge), TopExp.LastVertex_s(use.edge))
        ):
            found = ends.find(vertex)
            if found >= 0:
                reach = max(_off(vertex, use, is_last), BRep_Tool.Tolerance_s(use.edge))
                needed[found] = vertex, max(reach, needed.get(found, (vertex, 0.0))[1])
    for vertex, reach in needed.values():
        tolerance = max(settings.CONFUSION, SLACK * reach)
        ShapeFix_ShapeTolerance().SetTolerance(vertex, tolerance, TopAbs_VERTEX)


def _off(vertex: TopoDS_Vertex, use: _Use, is_last: int) -> float:
    """Returns mm: how far a vertex is from the end of an edge, in space and on a face."""
    point, ends = BRep_Tool.Pnt_s(vertex), BRepAdaptor_Curve(use.edge)
    at = ends.LastParameter() if is_last else ends.FirstParameter()
    flat = BRep_Tool.CurveOnSurface_s(use.edge, use.face, 0.0, 1.0)
    on_face = BRep_Tool.Surface_s(use.face).Value(*flat.Value(at).Coord())
    return float(max(point.Distance(ends.Value(at)), point.Distance(on_face)))

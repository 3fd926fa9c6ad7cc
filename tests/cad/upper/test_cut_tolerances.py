"""New edges along an outline lie on their faces, and say so no worse than it is."""

from __future__ import annotations

import numpy as np
import pytest
from build123d import Box, Edge, Sphere, Wire
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.Geom import Geom_Line
from OCP.gp import gp_Dir
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from tests.cad.shoes import rails, shoe, two_panels
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import unwrap, vertex_point, vertices_of
from wrinkle_cad.cad.upper.carve import carve_request
from wrinkle_cad.cad.upper.cut_tolerances import CUT_EDGE_TOLERANCE, settle_tolerances
from wrinkle_cad.cad.upper.opening_plan import plan_opening
from wrinkle_cad.cad.upper.pieces import Split, oriented_edges
from wrinkle_cad.cad.upper.projection import UpperFaces
from wrinkle_cad.cad.upper.split import split_faces
from wrinkle_cad.errors import CadError


def over_the_top(y: float) -> Wire:
    points = [(-50, y, 0), (-50, y, 20), (50, y, 20), (50, y, 0)]
    return Wire.make_polygon(points, close=False)


def arc(y: float) -> Edge:
    """Passes the pole of a sphere of 50 at y mm."""
    height = (50.0**2 - y**2) ** 0.5
    turns = np.linspace(-0.5, 0.5, 21)
    return Edge.make_spline([(height * np.sin(t), y, height * np.cos(t)) for t in turns])


CASES = {
    "box": lambda: (unwrap(Box(100, 60, 40)), over_the_top(-8), over_the_top(8), 4.0),
    "pole": lambda: (unwrap(Sphere(50)), arc(0.01), arc(12.0), 0.0),
    "one face": lambda: (shoe(), *rails(), 4.0),
    "two panels": lambda: (two_panels(), *rails(), 4.0),
}


def split_case(name: str) -> tuple[UpperFaces, Split]:
    upper, p, q, margin = CASES[name]()
    faces = UpperFaces(upper)
    plan = plan_opening(faces, upper, carve_request(p, q, margin=margin))
    return faces, split_faces(faces, [plan])


def new_edges(faces: UpperFaces, split: Split) -> list[tuple[TopoDS_Edge, TopoDS_Face]]:
    """Each edge along the outline with each piece beside it."""
    cuts = ShapeIndex(cut.edge for cuts in split.cuts for cut in cuts)
    return [
        (edge, piece)
        for pieces in split.pieces
        for piece in pieces
        for edge in oriented_edges(piece)
        if cuts.find(edge) >= 0
    ]


def off_face(edge: TopoDS_Edge, face: TopoDS_Face) -> float:
    """mm; by an own dense sampling."""
    curve, surface = BRepAdaptor_Curve(edge), BRep_Tool.Surface_s(face)
    flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 1.0)
    at = np.linspace(curve.FirstParameter(), curve.LastParameter(), 1501).tolist()
    return max(curve.Value(t).Distance(surface.Value(*flat.Value(t).Coord())) for t in at)


@pytest.mark.parametrize("name", CASES)
def test_new_edges_lie_on_their_faces_within_their_small_tolerance(
    name: str,
) -> None:
    faces, split = split_case(name)
    for edge, face in new_edges(faces, split):
        tolerance = BRep_Tool.Tolerance_s(edge)
        assert off_face(edge, face) <= tolerance <= CUT_EDGE_TOLERANCE
        curve = BRepAdaptor_Curve(edge)
        ends = [
            np.array(curve.Value(at).Coord())
            for at in (curve.FirstParameter(), curve.LastParameter())
        ]
        for vertex in vertices_of(edge):
            off = min(float(np.linalg.norm(vertex_point(vertex) - end)) for end in ends)
            assert max(off, tolerance) <= BRep_Tool.Tolerance_s(vertex) <= 1e-5


def move_off(edge: TopoDS_Edge) -> None:
    """Puts an edge on its chord."""
    curve = BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    start, end = curve.Value(first), curve.Value(last)
    way = np.array(end.Coord()) - np.array(start.Coord())
    moved = Geom_Line(start, gp_Dir(*way.tolist()))
    BRep_Builder().UpdateEdge(edge, moved, 1e-7)


def test_an_edge_whose_curve_is_off_the_face_is_drawn_anew_on_it() -> None:
    faces, split = split_case("one face")
    edge, face = new_edges(faces, split)[0]
    move_off(edge)
    assert off_face(edge, face) > 0.1
    settle_tolerances(faces.faces, split)
    assert off_face(edge, face) <= BRep_Tool.Tolerance_s(edge) <= CUT_EDGE_TOLERANCE


def test_an_edge_that_cannot_lie_on_its_faces_is_told_with_its_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    faces, split = split_case("one face")
    monkeypatch.setattr("wrinkle_cad.cad.upper.cut_tolerances.curve_over", lambda *_: None)
    move_off(new_edges(faces, split)[0][0])
    with pytest.raises(CadError, match=r"a new edge at \(.*\) mm is [\d.]+ mm off the upper"):
        settle_tolerances(faces.faces, split)

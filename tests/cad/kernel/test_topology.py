from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Edge as B3dEdge
from build123d import Solid as B3dSolid
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from tests.cad.strips import edge_of, points_on_edge
from wrinkle_cad.cad.kernel import topology as kernel
from wrinkle_cad.errors import CadError, InputError

BOX = BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()
CYLINDER = BRepPrimAPI_MakeCylinder(10.0, 5.0).Shape()


def quarter() -> TopoDS_Edge:
    """A quarter of a circle of radius 2 from (2, 0, 0) to (0, 2, 0)."""
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2.0)
    return BRepBuilderAPI_MakeEdge(circle, 0.0, math.pi / 2).Edge()


def bow_tie() -> TopoDS_Shape:
    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in ((0, 0), (1, 1), (1, 0), (0, 1)):
        polygon.Add(gp_Pnt(x, y, 0))
    polygon.Close()
    return BRepBuilderAPI_MakeFace(gp_Pln(), polygon.Wire(), True).Face()


def test_a_shape_is_found_in_whatever_wraps_it() -> None:
    assert kernel.unwrap(BOX) is BOX
    assert kernel.unwrap(B3dSolid(BOX)).IsSame(BOX)


@pytest.mark.parametrize("source", [None, 3, "edge", TopoDS_Shape(), np.zeros((2, 3))])
def test_what_holds_no_shape_is_refused(source: object) -> None:
    with pytest.raises(InputError, match="shape - "):
        kernel.unwrap(source)


def test_a_cast_takes_the_exact_kind_only() -> None:
    face = kernel.faces_of(BOX)[0]
    assert kernel.kind_name(kernel.as_face(face)) == "face"
    for cast in (kernel.as_edge, kernel.as_wire, kernel.as_shell, kernel.as_vertex):
        with pytest.raises(CadError, match="found a face"):
            cast(face)
    with pytest.raises(CadError, match="empty"):
        kernel.as_face(TopoDS_Shape())


def test_every_piece_of_a_shape_is_found_once() -> None:
    counts = [
        len(pieces(BOX))
        for pieces in (
            kernel.vertices_of,
            kernel.edges_of,
            kernel.wires_of,
            kernel.faces_of,
            kernel.shells_of,
        )
    ]
    assert counts == [8, 12, 6, 6, 1]


def test_free_edges_bound_one_face_only() -> None:
    faces = kernel.faces_of(BOX)
    assert kernel.free_edges(BOX) == []
    assert len(kernel.free_edges(kernel.make_compound(faces[1:]))) == 4
    assert len(kernel.free_edges(kernel.make_compound(faces[:2]))) == 8


def test_a_seam_and_a_pole_are_no_free_edges() -> None:
    (side,) = (face for face in kernel.faces_of(CYLINDER) if len(kernel.edges_of(face)) == 3)
    assert len(kernel.free_edges(side)) == 2
    assert kernel.free_edges(BRepPrimAPI_MakeSphere(1.0).Shape()) == []


def test_the_curve_of_an_edge_is_trimmed_and_runs_along_it() -> None:
    _, points = points_on_edge(quarter())
    assert np.allclose(points[[0, -1]], [(2, 0, 0), (0, 2, 0)], atol=1e-15)
    assert np.allclose(np.linalg.norm(points, axis=1), 2.0, rtol=1e-15)
    _, backwards = points_on_edge(kernel.as_edge(quarter().Reversed()))
    assert np.allclose(backwards[[0, -1]], [(0, 2, 0), (2, 0, 0)], atol=1e-15)


def test_the_curve_of_a_placed_edge_is_in_world_coordinates() -> None:
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(1, 2, 3))
    _, points = points_on_edge(kernel.as_edge(quarter().Moved(TopLoc_Location(move))))
    assert np.allclose(points[[0, -1]], [(3, 2, 3), (1, 4, 3)], atol=1e-15)


def test_the_curve_of_a_full_circle_is_clamped() -> None:
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2.0)
    curve = kernel.edge_curve(BRepBuilderAPI_MakeEdge(circle).Edge())
    assert not curve.IsPeriodic()
    assert curve.StartPoint().Distance(curve.EndPoint()) < 1e-15


def test_an_edge_without_a_curve_is_refused() -> None:
    sphere = BRepPrimAPI_MakeSphere(1.0).Shape()
    pole = next(edge for edge in kernel.edges_of(sphere) if BRep_Tool.Degenerated_s(edge))
    with pytest.raises(CadError, match="single point"):
        kernel.edge_curve(pole)


def test_taking_a_curve_leaves_the_edge_as_it_was() -> None:
    edge = edge_of([(0, 0, 0), (1, 1, 0), (2, 0, 0)], 2)
    kernel.edge_curve(edge).Scale(gp_Pnt(0, 0, 0), 5.0)
    assert np.allclose(points_on_edge(edge)[1][-1], (2, 0, 0))


def test_lengths_and_areas_are_those_of_the_closed_forms() -> None:
    assert kernel.length_of(quarter()) == pytest.approx(math.pi, rel=1e-12)
    assert kernel.length_of(BOX) == pytest.approx(24.0, rel=1e-14)
    assert kernel.area_of(BOX) == pytest.approx(22.0, rel=1e-14)
    assert kernel.area_of(CYLINDER) == pytest.approx(2 * math.pi * 10 * 15, rel=1e-12)
    assert B3dEdge(quarter()).length == pytest.approx(kernel.length_of(quarter()), rel=1e-7)


def test_an_area_that_misses_its_bound_is_an_error() -> None:
    wavy = kernel.faces_of(BRepPrimAPI_MakeSphere(1.0).Shape())[0]
    with pytest.raises(CadError, match="two integrations of a face differ by"):
        kernel.area_of(wavy, relative_error=1e-30)


def test_a_face_that_crosses_itself_is_not_valid() -> None:
    assert kernel.is_valid(BOX)
    kernel.check_valid(BOX, "make a box")
    assert not kernel.is_valid(bow_tie())
    with pytest.raises(CadError, match="make a bow tie - the resulting face is not valid"):
        kernel.check_valid(bow_tie(), "make a bow tie")


def test_the_largest_edge_tolerance_is_reported() -> None:
    edges = [quarter(), quarter()]
    BRep_Builder().UpdateEdge(edges[1], 3e-4)
    assert kernel.tolerance_of(kernel.make_compound(edges)) == 3e-4
    assert kernel.tolerance_of(kernel.make_vertex((0, 0, 0))) == 0.0


def test_the_bounding_box_is_tight() -> None:
    assert np.allclose(kernel.bounding_box(BOX), [(0, 0, 0), (1, 2, 3)], atol=1e-12)
    assert np.allclose(kernel.bounding_box(quarter()), [(0, 0, 0), (2, 2, 0)], atol=1e-7)
    with pytest.raises(CadError, match="no geometry"):
        kernel.bounding_box(kernel.make_compound([]))


def test_a_vertex_stands_where_it_was_put() -> None:
    assert kernel.vertex_point(kernel.make_vertex((1, -2, 3e4))).tolist() == [1, -2, 3e4]


def test_what_the_kernel_throws_names_the_step() -> None:
    message = r"point somewhere - the CAD kernel failed: .*zero norm"
    with pytest.raises(CadError, match=message), kernel.kernel_step("point somewhere"):
        gp_Dir(0, 0, 0)


def test_errors_of_our_own_pass_through_a_step() -> None:
    with pytest.raises(InputError, match="mine"), kernel.kernel_step("anything"):
        raise InputError("mine")


def test_colors_are_srgb_from_0_to_1() -> None:
    color = kernel.occ_color((1.0, 0.5, 0.0))
    assert color.Alpha() == 1.0
    # sRGB 0.5 is 0.2140 of full light.
    assert color.GetRGB().Green() == pytest.approx(0.2140, abs=1e-4)
    assert kernel.occ_color((0, 0, 0, 0.25)).Alpha() == 0.25
    for bad in ((1, 0), (0, 0, 2), (0, 0, 0, 0, 0), (0, math.nan, 0)):
        with pytest.raises(InputError, match="color - "):
            kernel.occ_color(bad)

from __future__ import annotations

import math

import pytest
from build123d import Edge as B3dEdge
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from tests.cad.measuring import area_of
from wrinkle_cad.cad.kernel.measures import check_valid, is_valid, length_of, tolerance_of
from wrinkle_cad.cad.kernel.topology import (
    faces_of,
    make_compound,
    make_vertex,
)
from wrinkle_cad.errors import CadError

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


def test_lengths_and_areas_are_those_of_the_closed_forms() -> None:
    assert length_of(quarter()) == pytest.approx(math.pi, rel=1e-12)
    assert length_of(BOX) == pytest.approx(24.0, rel=1e-14)
    assert area_of(BOX) == pytest.approx(22.0, rel=1e-14)
    assert area_of(CYLINDER) == pytest.approx(2 * math.pi * 10 * 15, rel=1e-12)
    assert B3dEdge(quarter()).length == pytest.approx(length_of(quarter()), rel=1e-7)


def test_an_area_that_misses_its_bound_is_an_error() -> None:
    wavy = faces_of(BRepPrimAPI_MakeSphere(1.0).Shape())[0]
    with pytest.raises(CadError, match=r"two integrations of a face of .* mm.2 differ by"):
        area_of(wavy, relative_error=1e-30)


def test_a_face_that_crosses_itself_is_not_valid() -> None:
    assert is_valid(BOX)
    check_valid(BOX, "make a box", "Turn it.")
    assert not is_valid(bow_tie())
    with pytest.raises(
        CadError, match=r"^Cannot make a bow tie: .* a fault in 1 of its 1 faces\. Untie it\.$"
    ):
        check_valid(bow_tie(), "make a bow tie", "Untie it.")


def test_the_largest_edge_tolerance_is_reported() -> None:
    edges = [quarter(), quarter()]
    BRep_Builder().UpdateEdge(edges[1], 3e-4)
    assert tolerance_of(make_compound(edges)) == 3e-4
    assert tolerance_of(make_vertex((0, 0, 0))) == 0.0

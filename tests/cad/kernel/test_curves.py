from __future__ import annotations

import math

import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge

from tests.cad.strips import edge_of, points_on_edge
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.topology import (
    as_edge,
    edges_of,
)
from wrinkle_cad.errors import CadError


def quarter() -> TopoDS_Edge:
    """A quarter of a circle of radius 2 from (2, 0, 0) to (0, 2, 0)."""
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2.0)
    return BRepBuilderAPI_MakeEdge(circle, 0.0, math.pi / 2).Edge()


def test_the_curve_of_an_edge_is_trimmed_and_runs_along_it() -> None:
    _, points = points_on_edge(quarter())
    assert np.allclose(points[[0, -1]], [(2, 0, 0), (0, 2, 0)], atol=1e-15)
    assert np.allclose(np.linalg.norm(points, axis=1), 2.0, rtol=1e-15)
    _, backwards = points_on_edge(as_edge(quarter().Reversed()))
    assert np.allclose(backwards[[0, -1]], [(0, 2, 0), (2, 0, 0)], atol=1e-15)


def test_the_curve_of_a_placed_edge_is_in_world_coordinates() -> None:
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(1, 2, 3))
    _, points = points_on_edge(as_edge(quarter().Moved(TopLoc_Location(move))))
    assert np.allclose(points[[0, -1]], [(3, 2, 3), (1, 4, 3)], atol=1e-15)


def test_the_curve_of_a_full_circle_is_clamped() -> None:
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2.0)
    curve = edge_curve(BRepBuilderAPI_MakeEdge(circle).Edge())
    assert not curve.IsPeriodic()
    assert curve.StartPoint().Distance(curve.EndPoint()) < 1e-15


def test_an_edge_without_a_curve_is_refused() -> None:
    sphere = BRepPrimAPI_MakeSphere(1.0).Shape()
    pole = next(edge for edge in edges_of(sphere) if BRep_Tool.Degenerated_s(edge))
    with pytest.raises(CadError, match="single point"):
        edge_curve(pole)


def test_taking_a_curve_leaves_the_edge_as_it_was() -> None:
    edge = edge_of([(0, 0, 0), (1, 1, 0), (2, 0, 0)], 2)
    edge_curve(edge).Scale(gp_Pnt(0, 0, 0), 5.0)
    assert np.allclose(points_on_edge(edge)[1][-1], (2, 0, 0))

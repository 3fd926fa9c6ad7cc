"""Edges that have a curve in the parameters of their surface only."""

from __future__ import annotations

import math

import numpy as np
import pytest
from build123d import Edge
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_CylindricalSurface, Geom_Plane, Geom_Surface, Geom_ToroidalSurface
from OCP.Geom2d import Geom2d_Circle, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2d, gp_Ax3, gp_Dir2d, gp_Pnt2d
from OCP.TopoDS import TopoDS_Edge

from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.rail.directrix import make_directrix


def on_surface(curve: Geom2d_Curve, surface: Geom_Surface, last: float) -> TopoDS_Edge:
    edge = BRepBuilderAPI_MakeEdge(curve, surface, 0.0, last).Edge()
    BRep_Builder().Range(edge, 0.0, last)
    return edge


def line(u: float, v: float) -> Geom2d_Line:
    return Geom2d_Line(gp_Pnt2d(0.0, 0.0), gp_Dir2d(u, v))


@pytest.mark.parametrize(
    ("edge", "length"),
    [
        (on_surface(Geom2d_Circle(gp_Ax2d(), 30.0), Geom_Plane(gp_Ax3()), 3.0), 90.0),
        (on_surface(line(1.0, 0.0), Geom_CylindricalSurface(gp_Ax3(), 20.0), 2.0), 40.0),
        (on_surface(line(0.0, 1.0), Geom_CylindricalSurface(gp_Ax3(), 20.0), 15.0), 15.0),
        (
            on_surface(line(0.6, 0.8), Geom_CylindricalSurface(gp_Ax3(), 20.0), 5.0),
            math.hypot(0.6 * 20.0 * 5.0, 0.8 * 5.0),
        ),
        (on_surface(line(0.0, 1.0), Geom_ToroidalSurface(gp_Ax3(), 50.0, 10.0), 2.0), 20.0),
    ],
    ids=["circle on a plane", "circle", "generator", "helix", "circle on a torus"],
)
def test_a_curve_on_a_surface_only_is_a_rail(edge: TopoDS_Edge, length: float) -> None:
    rail = make_directrix(edge, name="P")
    points = rail.point_at(np.linspace(*rail.interval, 20_001))
    measured = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert measured == pytest.approx(length, abs=1e-5)
    assert length_of(edge) == pytest.approx(length, abs=1e-6)
    assert make_directrix(Edge(edge), name="P").point_at(np.array([0.0])) == pytest.approx(
        rail.point_at(np.array([0.0])), abs=1e-9
    )

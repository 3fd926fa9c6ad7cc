"""Triangles of cones: fans from the apex to the polyline along the bank.

Straight lines lead from the bank to the apex, so triangles whose base is near enough to the bank
are near enough to the cone everywhere. The kernel's mesher does not know that: it puts points
inside, 14 times as many triangles on a plain strip, 20,000 on each slender cone of a rail that is
long against the strip's width, and takes minutes for those.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GeomAbs import GeomAbs_BSplineCurve, GeomAbs_BSplineSurface, GeomAbs_Line
from OCP.IMeshTools import IMeshTools_Parameters
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad import settings

from .topology import as_edge, edges_of, make_compound, vertex_point, vertices_of
from .versions import ShapeMap

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_APEX_SIZE: Final = 1e-6
"""mm; how far the poles of a cone's apex may lie apart."""


def apex_of(face: TopoDS_Face) -> Floats | None:
    """Returns the apex (3,) of a face that is all of the cone between a curve and a point.

    Cones that are cut off anywhere else than along straight lines are none, and of others only
    those are one whose apex is a degenerated edge.
    """
    surface = BRepAdaptor_Surface(face, False)
    if surface.GetType() != GeomAbs_BSplineSurface or surface.VDegree() != 1:
        return None
    if surface.NbVPoles() != 2 or not any(_is_point(surface, row) for row in (1, 2)):
        return None
    tips = []
    for edge in edges_of(face):
        if BRep_Tool.Degenerated_s(edge):
            tips.append(edge)
        elif not _is_straight_inside(edge, face):
            return None
    return vertex_point(vertices_of(tips[0])[0]) if len(tips) == 1 else None


def fans_of(
    cones: Iterable[tuple[TopoDS_Face, Floats]],
    others: Iterable[TopoDS_Face],
    wanted: IMeshTools_Parameters,
) -> Iterator[tuple[Floats, Indices]]:
    """Returns the triangles of cones, with points that are those of meshes beside them.

    Args:
        cones: faces and their apices, from `apex_of`.
        others: faces that are meshed already and may share edges with them.
        wanted: how near polylines along the other edges must be; they are kept in the edges.

    Yields:
        For each cone (k, 3) float64, mm, and (l, 3) int64 into it, counter-clockwise seen from the
        side of the face's normal.
    """
    cones = list(cones)
    known, lines = _lines_beside(others)
    own = [edge for face, _ in cones for edge in edges_of(face)]
    new = [e for e in own if not known.Contains(e) and not BRep_Tool.Degenerated_s(e)]
    if new:
        BRepMesh_IncrementalMesh(make_compound(new), wanted)
    for face, apex in cones:
        yield _fan(face, apex, known, lines)


def _fan(
    face: TopoDS_Face, apex: Floats, known: ShapeMap, lines: list[Floats]
) -> tuple[Floats, Indices]:
    points, triangles, count = [apex[None]], [], 1
    edges = TopExp_Explorer(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE)
    while edges.More():
        edge = as_edge(edges.Current())
        edges.Next()
        if BRep_Tool.Degenerated_s(edge):
            continue
        line = lines[known.FindIndex(edge) - 1] if known.Contains(edge) else _own_line(edge)
        away = np.sqrt(((line - apex) ** 2).sum(axis=1)) > settings.CONFUSION
        start = count + np.flatnonzero(away[:-1] & away[1:])
        forward = edge.Orientation() != TopAbs_REVERSED
        first, second = (start, start + 1) if forward else (start + 1, start)
        triangles.append(np.column_stack((np.zeros(len(start), dtype=np.int64), first, second)))
        points.append(line)
        count += len(line)
    fan = np.vstack(triangles)
    return np.vstack(points), fan[:, ::-1] if face.Orientation() == TopAbs_REVERSED else fan


def _lines_beside(faces: Iterable[TopoDS_Face]) -> tuple[ShapeMap, list[Floats]]:
    """The edges of meshed faces, and the points that the meshes have along them."""
    known, lines = ShapeMap(), []
    for face in faces:
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        if mesh is None:
            continue
        moved = place.Transformation()
        for edge in edges_of(face):
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, place)
            if polygon is None or known.Contains(edge):
                continue
            known.Add(edge)
            nodes = [
                mesh.Node(polygon.Node(i + 1)).Transformed(moved) for i in range(polygon.NbNodes())
            ]
            lines.append(np.array([(node.X(), node.Y(), node.Z()) for node in nodes]))
    return known, lines


def _own_line(edge: TopoDS_Edge) -> Floats:
    place = TopLoc_Location()
    polygon = BRep_Tool.Polygon3D_s(edge, place)
    if polygon is None:
        return np.zeros((0, 3))
    moved = place.Transformation()
    nodes = polygon.Nodes()
    listed = [nodes.Value(i + 1).Transformed(moved) for i in range(polygon.NbNodes())]
    return np.array([(node.X(), node.Y(), node.Z()) for node in listed])


def _is_point(surface: BRepAdaptor_Surface, row: int) -> bool:
    spline = surface.BSpline()
    first = spline.Pole(1, row)
    return all(
        first.Distance(spline.Pole(i, row)) <= _APEX_SIZE for i in range(2, spline.NbUPoles() + 1)
    )


def _is_straight_inside(edge: TopoDS_Edge, face: TopoDS_Face) -> bool:
    """Whether an edge is a straight line in the parameters: no ruling meets it twice."""
    inside = BRepAdaptor_Curve2d(edge, face)
    if inside.GetType() == GeomAbs_Line:
        return True
    return bool(inside.GetType() == GeomAbs_BSplineCurve and inside.NbPoles() == 2)

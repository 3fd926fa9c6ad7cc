"""Triangles of faces and their shades, for pictures drawn with matplotlib alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face

LIGHT = np.array([0.25, 0.1, 0.96])
Floats = NDArray[np.float64]
Color = tuple[float, float, float]


def face_triangles(face: TopoDS_Face) -> Floats:
    """Returns (k, 3, 3) mm: the triangles of a meshed face, counter-clockwise from outside."""
    mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
    nodes = np.array(
        [(at.X(), at.Y(), at.Z()) for at in map(mesh.Node, range(1, mesh.NbNodes() + 1))]
    )
    corners = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)]) - 1
    if face.Orientation() == TopAbs_REVERSED:
        corners = corners[:, ::-1]
    triangles = nodes[corners]
    sides = triangles[:, 1:] - triangles[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    # Needles have no normal worth shading; their neighbours cover them.
    return np.asarray(triangles[areas > 1e-3 * (sides**2).sum(axis=2).max(axis=1)])


def shaded(triangles: Floats, color: Color, toward: Floats) -> Floats:
    """Returns (k, 4) colors of triangles lit from above and seen from a direction."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    is_inside = normals @ toward < 0.0
    normals = np.where(is_inside[:, None], -normals, normals)
    light = LIGHT / np.linalg.norm(LIGHT)
    half = (light + toward) / np.linalg.norm(light + toward)
    diffuse = (
        0.35 + 0.6 * np.clip(normals @ light, 0.0, 1.0) + 0.15 * np.clip(normals @ toward, 0, 1)
    )
    shine = 0.22 * np.clip(normals @ half, 0.0, 1.0) ** 28
    base = np.where(is_inside[:, None], 0.45 * np.array(color), np.array(color))
    return np.column_stack(
        (np.clip(base * diffuse[:, None] + shine[:, None], 0, 1), np.ones(len(base)))
    )

"""Shaded pictures of shells from two views, with matplotlib alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from build123d import Compound, Face
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face

VIEWS = ((32.0, -58.0), (38.0, 62.0))
"""Elevation and azimuth in degrees: from the outer and from the inner side, over the toe."""
CHORD = 0.06
"""mm; how far the drawn triangles may lie from the surface."""
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


def draw(
    parts: Sequence[tuple[Sequence[TopoDS_Face], Color]],
    path: Path,
    *,
    views: Sequence[tuple[float, float]] = VIEWS,
) -> None:
    """Writes a PNG of the parts, each in its color, one picture per view side by side."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    whole = Compound([Face(face) for faces, _ in parts for face in faces])
    BRepMesh_IncrementalMesh(whole.wrapped, CHORD, False, 0.08, False)
    meshed = [
        (np.concatenate([face_triangles(face) for face in faces]), color)
        for faces, color in parts
        if faces
    ]
    everything = np.concatenate([triangles for triangles, _ in meshed])
    low, high = everything.min(axis=(0, 1)), everything.max(axis=(0, 1))
    figure = plt.figure(figsize=(7.0 * len(views), 4.4), dpi=90)
    for i, (elevation, azimuth) in enumerate(views):
        axes = figure.add_subplot(1, len(views), i + 1, projection="3d", proj_type="ortho")
        e, a = np.radians([elevation, azimuth])
        toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        colors = np.concatenate([shaded(triangles, color, toward) for triangles, color in meshed])
        axes.add_collection3d(
            Poly3DCollection(
                everything, facecolors=colors, edgecolors=colors, linewidths=0.25, clip_on=False
            )
        )
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        axes.set_box_aspect(tuple(high - low), zoom=1.055)
        axes.view_init(elevation, azimuth)
        axes.set_axis_off()
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    figure.savefig(path)
    plt.close(figure)

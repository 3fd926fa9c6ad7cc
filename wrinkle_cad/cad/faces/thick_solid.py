"""A triangulated strip as a solid of constant thickness."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_Sewing,
)
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Face, TopoDS_Solid

from wrinkle_cad.cad.kernel.measures import check_valid
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import free_edges, shells_of, solid_inside
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.strip.mitred_offset import mitred_directions, triangle_normals
from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_STEP: Final = "thicken the strip"
_UNEVEN: Final = 0.02
"""Of the thickness: by so much it may differ at a corner where many planes meet."""
_SEWN: Final = 1e-6


def thick_solid(triangulation: Triangulation, thickness: float) -> TopoDS_Solid:
    """Returns the solid between a strip's triangles and their offset, creases mitred.

    Args:
        triangulation: of the strip, open or closed.
        thickness: mm, to the side that the strip faces; below 0 to the other one.

    Raises:
        InputError: the thickness is 0 or no number; the strip bends too sharply for it.
        CadError: the kernel makes no valid solid of it.
    """
    if not np.isfinite(thickness) or thickness == 0.0:
        raise InputError(f"The thickness is {thickness:g} mm. Give one other than 0.")
    points = np.vstack((triangulation.p, triangulation.q))
    triangles = _with_area(points, triangulation.triangles)
    directions = mitred_directions(points, triangles)
    offset = points + thickness * directions
    _check_room(points, offset, triangles, directions, thickness)
    last = len(points)
    faces = [*triangles[:, ::-1], *(triangles + last)]
    for start, stop in _border(triangles):
        faces += [
            np.array((start, stop, stop + last)),
            np.array((start, stop + last, start + last)),
        ]
    return _solid(np.vstack((points, offset)), faces)


def _with_area(points: Floats, triangles: Indices) -> Indices:
    normals = triangle_normals(points, triangles)
    return np.asarray(triangles[(normals != 0.0).any(axis=1)])


def _check_room(
    points: Floats, offset: Floats, triangles: Indices, directions: Floats, thickness: float
) -> None:
    """Refuses an offset whose triangles turn over, or that is not as thick everywhere."""
    normals = triangle_normals(points, triangles)
    turned = (normals * triangle_normals(offset, triangles)).sum(axis=1)
    reach = (directions[triangles] * normals[:, None, :]).sum(axis=2)
    uneven = np.abs(reach - 1.0).max(axis=1)
    for is_wrong, what in (
        (turned <= 0.0, "bends more sharply than that"),
        (uneven > _UNEVEN, f"would be {uneven.max():.0%} thicker or thinner at a corner"),
    ):
        if is_wrong.any():
            x, y, z = points[triangles[int(is_wrong.argmax())]].mean(axis=0)
            raise InputError(
                f"The strip cannot be {abs(thickness):g} mm thick: at ({x:.1f}, {y:.1f}, {z:.1f})"
                f" mm it {what}. Take less, or thicken it to the other side."
            )


def _border(triangles: Indices) -> list[tuple[int, int]]:
    """Returns the directed edges that one triangle alone has."""
    edges = np.vstack([triangles[:, [i, (i + 1) % 3]] for i in range(3)]).tolist()
    used = {(start, stop) for start, stop in edges}
    return sorted((start, stop) for start, stop in used if (stop, start) not in used)


def _solid(points: Floats, triangles: list[Indices]) -> TopoDS_Solid:
    corners = [gp_Pnt(*point) for point in points.tolist()]
    sewing = BRepBuilderAPI_Sewing(_SEWN)
    with kernel_step(_STEP):
        for triangle in triangles:
            face = _face([corners[i] for i in triangle.tolist()])
            if face is not None:
                sewing.Add(face)
        sewing.Perform()
        shells = shells_of(sewing.SewedShape())
    if len(shells) != 1 or free_edges(shells[0]):
        raise CadError(_STEP, "its faces do not close. Take another tolerance or thickness.")
    solid = solid_inside(shells[0])
    check_valid(solid, _STEP, "Take another tolerance or thickness.")
    return solid


def _face(corners: list[gp_Pnt]) -> TopoDS_Face | None:
    polygon = BRepBuilderAPI_MakePolygon(*corners, True)
    if not polygon.IsDone():
        return None
    face = BRepBuilderAPI_MakeFace(polygon.Wire(), True)
    return face.Face() if face.IsDone() else None

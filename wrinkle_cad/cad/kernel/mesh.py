"""Triangles of a shape as arrays, for whoever draws or prints it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.GeomAbs import GeomAbs_BSplineSurface, GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane
from OCP.IMeshTools import IMeshTools_Parameters
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings

from .cone_mesh import apex_of, fans_of
from .steps import kernel_step
from .topology import faces_of, make_compound

_STL_HEADER: Final = b"wrinkle_cad, millimetres"
_STL_TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("tag", "<u2")])

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


def mesh_of(
    shape: TopoDS_Shape,
    *,
    tolerance: float = settings.TOLERANCE,
    angular_tolerance: float = settings.MESH_ANGLE,
    curved_tolerance: float = 0.0,
) -> tuple[Floats, Indices]:
    """Returns the triangles of a shape's faces; vertices are not shared between faces.

    Args:
        shape: anything with faces; it is not written to.
        tolerance: mm; how far a triangle may lie from its face.
        angular_tolerance: rad; how far neighbouring normals may differ on one face.
        curved_tolerance: mm; the same for faces that are curved both ways, as an upper is and a
            strip is not, if larger than ``tolerance``; along edges shared with others these hold.

    Returns:
        (k, 3) float64, mm, and (l, 3) int64 into it, counter-clockwise seen from the outside.

    Raises:
        CadError: the kernel cannot mesh the shape.
    """
    with kernel_step("mesh the shape"):
        # A mesh is stored in the shape, and whoever owns the shape did not ask for one.
        own = BRepBuilderAPI_Copy(shape, True, False).Shape()
        BRepTools.Clean_s(own)
        meshes = list(_meshes_of(own, tolerance, angular_tolerance, curved_tolerance))
    counts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    return (
        np.vstack([np.zeros((0, 3)), *(points for points, _ in meshes)]),
        np.vstack(
            [
                np.zeros((0, 3), dtype=np.int64),
                *(mesh[1] + start for mesh, start in zip(meshes, counts[:-1], strict=True)),
            ]
        ),
    )


def _meshes_of(
    own: TopoDS_Shape, tolerance: float, angular_tolerance: float, curved_tolerance: float
) -> Iterator[tuple[Floats, Indices]]:
    """The points and triangles of each face; triangles are stored in the shape."""
    wanted = _wanted(tolerance, angular_tolerance)
    faces = faces_of(own)
    apices = [apex_of(face) for face in faces]
    others = [face for face, apex in zip(faces, apices, strict=True) if apex is None]
    cones = [(face, apex) for face, apex in zip(faces, apices, strict=True) if apex is not None]
    if curved_tolerance > tolerance:
        plain = [face for face in others if not _is_curved_both_ways(face)]
        # What is meshed already keeps its points, those on shared edges too; cones only lend those.
        _mesh(plain, wanted)
        _mesh([face for face, _ in cones], _on_edges_only(tolerance, angular_tolerance))
        _mesh(others, _wanted(curved_tolerance, angular_tolerance))
    else:
        _mesh(others, wanted)
    fans = fans_of(cones, others, wanted)
    for face, apex in zip(faces, apices, strict=True):
        if apex is not None:
            yield next(fans)
        else:
            yield from _stored_mesh(face)


def _wanted(tolerance: float, angular_tolerance: float) -> IMeshTools_Parameters:
    wanted = IMeshTools_Parameters()
    wanted.Deflection = settings.MESH_SAG_PER_TOLERANCE * tolerance
    wanted.Angle = angular_tolerance
    return wanted


def _on_edges_only(tolerance: float, angular_tolerance: float) -> IMeshTools_Parameters:
    """The same without points inside of faces."""
    own = _wanted(tolerance, angular_tolerance)
    own.InternalVerticesMode = False
    own.ControlSurfaceDeflection = False
    return own


def _mesh(faces: Sequence[TopoDS_Face], wanted: IMeshTools_Parameters) -> None:
    """Meshes faces all at once: those that share an edge must have the same points on it."""
    if faces:
        BRepMesh_IncrementalMesh(make_compound(faces), wanted)


def _is_curved_both_ways(face: TopoDS_Face) -> bool:
    """Whether no straight lines are known to lie in a face's surface."""
    surface = BRepAdaptor_Surface(face, False)
    if surface.GetType() == GeomAbs_BSplineSurface:
        return bool(surface.UDegree() > 1 and surface.VDegree() > 1)
    return surface.GetType() not in (GeomAbs_Plane, GeomAbs_Cylinder, GeomAbs_Cone)


def _stored_mesh(face: TopoDS_Face) -> Iterator[tuple[Floats, Indices]]:
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None:
        return
    moved = place.Transformation()
    nodes = (mesh.Node(i + 1).Transformed(moved) for i in range(mesh.NbNodes()))
    points = np.array([(node.X(), node.Y(), node.Z()) for node in nodes])
    corners = np.array([mesh.Triangle(i + 1).Get() for i in range(mesh.NbTriangles())])
    if face.Orientation() == TopAbs_REVERSED:
        corners = corners[:, ::-1]
    yield points, corners - 1


def binary_stl(points: Floats, triangles: Indices) -> bytes:
    """Returns a binary STL file.

    Triangles of which two corners are the same point in single precision are left out: the mesher
    makes one at the apex of every cone, and to a slicer each is an open border.

    Args:
        points: (k, 3) float64, mm.
        triangles: (l, 3) int64 into them, counter-clockwise seen from the outside.
    """
    corners = points[triangles].astype("<f4")
    same = (corners == np.roll(corners, 1, axis=1)).all(axis=2).any(axis=1)
    corners = corners[~same]
    sides = np.diff(corners.astype(np.float64), axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(corners), dtype=_STL_TRIANGLE)
    records["corners"] = corners
    records["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    count = np.array(len(records), dtype="<u4").tobytes()
    return b"".join((_STL_HEADER.ljust(80), count, records.tobytes()))


def without_doubled(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns the triangles but for pairs on the same three points: they enclose nothing.

    The kernel makes such pairs where a face is thinner than the tolerance or than the single
    precision of an STL file.

    Args:
        points: (k, 3) float64, mm.
        triangles: (l, 3) int64 into the points.
    """
    if not len(triangles):
        return triangles
    corners = _corners(points, triangles)
    _, kind, count = np.unique(
        np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    kept: NDArray[np.int64] = triangles[(count[kind.reshape(-1)] != 2) | ~_is_proper(corners)]
    return kept


def shares_edges_thrice(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> bool:
    """Tells whether more than two triangles meet in an edge, as an STL file's precision has it.

    Args:
        points: (k, 3) float64, mm.
        triangles: (l, 3) int64 into the points.
    """
    corners = _corners(points, triangles)
    corners = corners[_is_proper(corners)]
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool(count.max(initial=0) > 2)


def _corners(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """(l, 3): the corners of triangles, numbered alike where single precision has them alike."""
    _, same = np.unique(points.astype(np.float32), axis=0, return_inverse=True)
    numbered: NDArray[np.int64] = same.reshape(-1)[triangles]
    return numbered


def _is_proper(corners: NDArray[np.int64]) -> NDArray[np.bool_]:
    return np.asarray((corners != np.roll(corners, 1, axis=1)).all(axis=1), dtype=np.bool_)

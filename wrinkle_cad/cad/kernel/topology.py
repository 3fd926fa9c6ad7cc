"""Shapes and their pieces: casts, pieces in order, vertices and compounds.

A shape is a ``TopoDS_Shape``; anything with a ``.wrapped`` (build123d, CadQuery) is one after
``unwrap``. Nothing here writes to a shape it was given.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid
from OCP.BRepLib import BRepLib
from OCP.gp import gp_Pnt
from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_ShapeEnum,
    TopAbs_SHELL,
    TopAbs_VERTEX,
    TopAbs_WIRE,
)
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import (
    TopoDS,
    TopoDS_Compound,
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError, InputError

from .versions import ShapeMap

Floats = NDArray[np.float64]


def unwrap(source: object) -> TopoDS_Shape:
    """Returns the shape in a ``TopoDS_Shape`` or in anything that holds one as ``.wrapped``.

    Raises:
        InputError: there is none, or it is empty.
    """
    shape = source if isinstance(source, TopoDS_Shape) else getattr(source, "wrapped", None)
    if not isinstance(shape, TopoDS_Shape):
        raise InputError(
            f"A {type(source).__name__} is no CAD shape. Pass an edge, wire, face or shell of"
            " build123d or CadQuery, or a TopoDS_Shape."
        )
    if shape.IsNull():
        raise InputError(f"The {type(source).__name__} is an empty shape. Pass one with geometry.")
    return shape


def as_edge(shape: TopoDS_Shape) -> TopoDS_Edge:
    """Returns the shape as the edge that it is."""
    return TopoDS.Edge(_of_kind(shape, TopAbs_EDGE))


def as_wire(shape: TopoDS_Shape) -> TopoDS_Wire:
    """Returns the shape as the wire that it is."""
    return TopoDS.Wire(_of_kind(shape, TopAbs_WIRE))


def as_face(shape: TopoDS_Shape) -> TopoDS_Face:
    """Returns the shape as the face that it is."""
    return TopoDS.Face(_of_kind(shape, TopAbs_FACE))


def as_shell(shape: TopoDS_Shape) -> TopoDS_Shell:
    """Returns the shape as the shell that it is."""
    return TopoDS.Shell(_of_kind(shape, TopAbs_SHELL))


def kind_name(shape: TopoDS_Shape) -> str:
    """Returns what a shape is, in one lower-case word ("edge", "shell", ...)."""
    return str(shape.ShapeType().name).removeprefix("TopAbs_").lower()


def _of_kind(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> TopoDS_Shape:
    if shape.IsNull() or shape.ShapeType() != kind:
        found = "an empty shape" if shape.IsNull() else f"a {kind_name(shape)}"
        wanted = str(kind.name).removeprefix("TopAbs_").lower()
        raise CadError(f"take a shape as {wanted}", f"it is {found}. Pass a {wanted}.")
    return shape


def edges_of(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """Returns the edges of a shape, each once, in the kernel's order, degenerated ones too."""
    return [TopoDS.Edge(edge) for edge in _unique(shape, TopAbs_EDGE)]


def faces_of(shape: TopoDS_Shape) -> list[TopoDS_Face]:
    """Returns the faces of a shape, each once, in the kernel's order."""
    return [TopoDS.Face(face) for face in _unique(shape, TopAbs_FACE)]


def vertices_of(shape: TopoDS_Shape) -> list[TopoDS_Vertex]:
    """Returns the vertices of a shape, each once, in the kernel's order."""
    return [TopoDS.Vertex(vertex) for vertex in _unique(shape, TopAbs_VERTEX)]


def shells_of(shape: TopoDS_Shape) -> list[TopoDS_Shell]:
    """Returns the shells of a shape, each once, in the kernel's order."""
    return [TopoDS.Shell(shell) for shell in _unique(shape, TopAbs_SHELL)]


def wires_of(shape: TopoDS_Shape) -> list[TopoDS_Wire]:
    """Returns the wires of a shape, each once, in the kernel's order."""
    return [TopoDS.Wire(wire) for wire in _unique(shape, TopAbs_WIRE)]


def _unique(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    found = ShapeMap()
    TopExp.MapShapes_s(shape, kind, found)
    return [found.FindKey(i) for i in range(1, found.Extent() + 1)]


def free_edges(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """Returns the edges that bound one face only, once; a seam bounds its face twice."""
    index = ShapeMap()
    uses: list[int] = []
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        edges = TopExp_Explorer(faces.Current(), TopAbs_EDGE)
        while edges.More():
            i = index.Add(edges.Current())
            if i > len(uses):
                uses.append(0)
            uses[i - 1] += 1
            edges.Next()
        faces.Next()
    once = (TopoDS.Edge(index.FindKey(i + 1)) for i, count in enumerate(uses) if count == 1)
    return [edge for edge in once if not BRep_Tool.Degenerated_s(edge)]


def make_vertex(point: ArrayLike) -> TopoDS_Vertex:
    """Returns a vertex at (3,) mm."""
    x, y, z = (float(value) for value in np.asarray(point, dtype=np.float64))
    vertex = TopoDS_Vertex()
    BRep_Builder().MakeVertex(vertex, gp_Pnt(x, y, z), settings.CONFUSION)
    return vertex


def vertex_point(vertex: TopoDS_Vertex) -> Floats:
    """Returns (3,) mm: where a vertex is."""
    point = BRep_Tool.Pnt_s(vertex)
    return np.array([point.X(), point.Y(), point.Z()])


def solid_inside(shell: TopoDS_Shell) -> TopoDS_Solid:
    """Returns the solid that a closed shell bounds, its faces looking out."""
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def make_compound(shapes: Iterable[TopoDS_Shape]) -> TopoDS_Compound:
    """Returns a compound that holds the shapes, unchanged and in order."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound

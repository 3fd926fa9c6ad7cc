"""Small functions over raw OCP: statuses checked, errors named, version differences hidden.

Every other module of this folder asks here first. A shape is a ``TopoDS_Shape``; anything with a
``.wrapped`` (build123d, CadQuery) is one after ``unwrap``. Nothing here writes to a shape it was
given. OCP 7.9 and 8.0 differ in where collections live and in casts; both are dealt with here.

Not handled: shapes without geometry of their own (polygons on triangulations only).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP import Geom as Geom_module
from OCP import Standard, StdFail
from OCP import TopoDS as TopoDS_module
from OCP import gp as gp_module
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepLib import BRepLib
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.Geom import Geom_BSplineCurve, Geom_TrimmedCurve
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.Quantity import Quantity_Color, Quantity_ColorRGBA, Quantity_TOC_sRGB
from OCP.TopAbs import (
    TopAbs_EDGE,
    TopAbs_FACE,
    TopAbs_REVERSED,
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
    TopoDS_Vertex,
    TopoDS_Wire,
)

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError, InputError

try:  # OCP 7.9
    from OCP.TopTools import TopTools_IndexedMapOfShape
except ImportError:  # OCP 8.0 keeps every collection in one module
    from OCP.collections import (
        IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as TopTools_IndexedMapOfShape,
    )

Floats = NDArray[np.float64]

# The bindings register each class on its own: they share no base but Exception.
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(
        kind
        for module in (Standard, StdFail, TopoDS_module, Geom_module, gp_module)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Exception)
    ),
    RuntimeError,
)


@contextmanager
def kernel_step(step: str) -> Iterator[None]:
    """Turns what the kernel throws inside the block into a ``CadError`` that names the step."""
    try:
        yield
    except KERNEL_ERRORS as error:
        message = " ".join(str(error).split()) or type(error).__name__
        raise CadError(step, f"the CAD kernel failed: {message} - check the input shape") from error


def unwrap(source: object) -> TopoDS_Shape:
    """Returns the shape in a ``TopoDS_Shape`` or in anything that holds one as ``.wrapped``.

    Raises:
        InputError: there is none, or it is empty.
    """
    shape = source if isinstance(source, TopoDS_Shape) else getattr(source, "wrapped", None)
    if not isinstance(shape, TopoDS_Shape):
        raise InputError(
            f"shape - found {type(source).__name__} - a CAD shape (build123d, CadQuery or TopoDS)"
            " is needed - pass an edge, wire, face or shell"
        )
    if shape.IsNull():
        raise InputError(f"shape - the {type(source).__name__} is empty - pass one with geometry")
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


def as_vertex(shape: TopoDS_Shape) -> TopoDS_Vertex:
    """Returns the shape as the vertex that it is."""
    return TopoDS.Vertex(_of_kind(shape, TopAbs_VERTEX))


def kind_name(shape: TopoDS_Shape) -> str:
    """Returns what a shape is, in one lower-case word ("edge", "shell", ...)."""
    return str(shape.ShapeType().name).removeprefix("TopAbs_").lower()


def _of_kind(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> TopoDS_Shape:
    if shape.IsNull() or shape.ShapeType() != kind:
        found = "an empty shape" if shape.IsNull() else f"a {kind_name(shape)}"
        wanted = str(kind.name).removeprefix("TopAbs_").lower()
        raise CadError(f"take a shape as {wanted}", f"found {found} - a {wanted} is needed")
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


def wires_of(shape: TopoDS_Shape) -> list[TopoDS_Wire]:
    """Returns the wires of a shape, each once, in the kernel's order."""
    return [TopoDS.Wire(wire) for wire in _unique(shape, TopAbs_WIRE)]


def shells_of(shape: TopoDS_Shape) -> list[TopoDS_Shell]:
    """Returns the shells of a shape, each once, in the kernel's order."""
    return [TopoDS.Shell(shell) for shell in _unique(shape, TopAbs_SHELL)]


def _unique(shape: TopoDS_Shape, kind: TopAbs_ShapeEnum) -> list[TopoDS_Shape]:
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return [found.FindKey(i) for i in range(1, found.Extent() + 1)]


def free_edges(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """Returns the edges that bound one face only, once; a seam bounds its face twice."""
    index = TopTools_IndexedMapOfShape()
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


def edge_curve(edge: TopoDS_Edge) -> Geom_BSplineCurve:
    """Returns the curve of an edge as a B-spline of its own.

    It is in world coordinates, trimmed to the edge, clamped, and runs the way the edge does.

    Raises:
        CadError: the edge has no curve (it is degenerated), or it cannot be converted.
    """
    with kernel_step("take the curve of an edge"):
        edge = _with_curve(edge)
        adaptor = BRepAdaptor_Curve(edge)
        first, last = adaptor.FirstParameter(), adaptor.LastParameter()
        curve = BRep_Tool.Curve_s(edge, first, last)
        spline = GeomConvert.CurveToBSplineCurve_s(Geom_TrimmedCurve(curve, first, last))
        if spline.IsPeriodic():
            spline.SetNotPeriodic()
        if edge.Orientation() == TopAbs_REVERSED:
            spline.Reverse()
    return spline


def _with_curve(edge: TopoDS_Edge) -> TopoDS_Edge:
    if BRep_Tool.Degenerated_s(edge):
        raise CadError("take the curve of an edge", "the edge is a single point - pass a curve")
    if BRep_Tool.IsGeometric_s(edge) and BRep_Tool.Curve_s(edge, 0.0, 0.0) is not None:
        return edge
    own = as_edge(BRepBuilderAPI_Copy(edge).Shape())
    if not BRepLib.BuildCurve3d_s(own):
        raise CadError("take the curve of an edge", "it has no 3-D curve and none could be built")
    return own


def length_of(shape: TopoDS_Shape) -> float:
    """Returns the length in mm of an edge, or of all the edges in a shape, each counted once."""
    with kernel_step("measure a length"):
        return float(
            sum(
                GCPnts_AbscissaPoint.Length_s(BRepAdaptor_Curve(edge), settings.LENGTH_ERROR)
                for edge in edges_of(shape)
                if not BRep_Tool.Degenerated_s(edge)
            )
        )


def area_of(shape: TopoDS_Shape, *, relative_error: float = settings.AREA_RELATIVE_ERROR) -> float:
    """Returns the area in mm^2 of the faces in a shape, each counted once.

    What the kernel reports as its error is not one (0 where a face was off by 1e-5): the bound that
    it is given chooses the order of its integration. So each face is integrated at rising orders
    until two agree, to ``relative_error`` of the face or of the mean face, whichever is larger.

    Raises:
        CadError: they do not agree at the highest order either.
    """
    faces = faces_of(shape)
    with kernel_step("measure an area"):
        first = [_integrated_area(face, settings.AREA_ORDERS[0]) for face in faces]
        mean = sum(first) / max(len(faces), 1)
        return float(
            sum(
                _settled_area(face, area, relative_error * max(area, mean))
                for face, area in zip(faces, first, strict=True)
            )
        )


def _integrated_area(face: TopoDS_Face, order: float) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, found, order, False)
    return abs(float(found.Mass()))


def _settled_area(face: TopoDS_Face, area: float, limit: float) -> float:
    change = math.inf
    for order in settings.AREA_ORDERS[1:]:
        before, area = area, _integrated_area(face, order)
        change = abs(area - before)
        if change <= limit:
            return area
    raise CadError(
        "measure an area",
        f"two integrations of a face differ by {change:.1e} mm^2 - limit {limit:.1e} mm^2 - ask for"
        " less accuracy or simplify the face",
    )


def is_valid(shape: TopoDS_Shape) -> bool:
    """Tells whether the kernel's own check finds no fault in a shape, geometry included."""
    with kernel_step("check a shape"):
        return bool(BRepCheck_Analyzer(shape, True).IsValid())


def check_valid(shape: TopoDS_Shape, step: str) -> None:
    """Raises a ``CadError`` for the step if the kernel's own check finds a fault in its result."""
    if not is_valid(shape):
        raise CadError(step, f"the resulting {kind_name(shape)} is not valid - change the input")


def tolerance_of(shape: TopoDS_Shape) -> float:
    """Returns the largest tolerance in mm of the edges of a shape; 0 if it has none."""
    return max((float(BRep_Tool.Tolerance_s(edge)) for edge in edges_of(shape)), default=0.0)


def bounding_box(shape: TopoDS_Shape) -> Floats:
    """Returns (2, 3) mm: the lowest and the highest coordinates of the geometry of a shape."""
    box = Bnd_Box()
    with kernel_step("measure the size of a shape"):
        BRepBndLib.AddOptimal_s(shape, box, False, False)
    if box.IsVoid():
        raise CadError("measure the size of a shape", "it has no geometry - pass one that has")
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]])


def make_vertex(point: ArrayLike, tolerance: float = settings.CONFUSION) -> TopoDS_Vertex:
    """Returns a vertex at (3,) mm."""
    x, y, z = (float(value) for value in np.asarray(point, dtype=np.float64))
    vertex = TopoDS_Vertex()
    BRep_Builder().MakeVertex(vertex, gp_Pnt(x, y, z), tolerance)
    return vertex


def vertex_point(vertex: TopoDS_Vertex) -> Floats:
    """Returns (3,) mm: where a vertex is."""
    point = BRep_Tool.Pnt_s(vertex)
    return np.array([point.X(), point.Y(), point.Z()])


def make_compound(shapes: Iterable[TopoDS_Shape]) -> TopoDS_Compound:
    """Returns a compound that holds the shapes, unchanged and in order."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def occ_color(color: Sequence[float]) -> Quantity_ColorRGBA:
    """Returns the kernel's color for (3,) red, green, blue or (4,) with opacity, sRGB, 0 to 1.

    Raises:
        InputError: not three or four numbers from 0 to 1.
    """
    values = [float(value) for value in color]
    if len(values) not in (3, 4) or not all(0.0 <= value <= 1.0 for value in values):
        raise InputError(f"color - found {tuple(color)} - 3 or 4 numbers from 0 to 1 are needed")
    opacity = values[3] if len(values) == 4 else 1.0
    return Quantity_ColorRGBA(Quantity_Color(*values[:3], Quantity_TOC_sRGB), opacity)

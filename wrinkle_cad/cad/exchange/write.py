"""STEP and STL out: names, colors, those of single faces too, the same bytes every time.

Each part becomes a product of its own, side by side at the identity placement, so that no program
has to resolve an assembly. The file appears under its final name only when it is whole.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Final

from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy, BRepBuilderAPI_Transform
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from wrinkle_cad import settings
from wrinkle_cad.cad.exchange.step.bytes import Header, face_placeholder, finished_text, placeholder
from wrinkle_cad.cad.kernel.mesh import binary_stl, mesh_of, shares_edges_thrice, without_doubled
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import faces_of
from wrinkle_cad.cad.kernel.versions import ShapeMap
from wrinkle_cad.errors import CadError, ExportError
from wrinkle_cad.files.atomic import write_export
from wrinkle_cad.files.names import one_line

from .face_styles import carried_over, styles_in
from .shapes import Part
from .xde import kernel_parameters, new_document, set_name, silence_kernel

_SCHEMAS: Final = {"AP214": "AP214IS", "AP242": "AP242DIS"}
_PARAMETERS: Final[dict[str, str | int]] = {
    "write.step.unit": "MM",
    "write.surfacecurve.mode": 0,
    "write.precision.mode": 0,
    "write.step.assembly": 0,
    "write.step.nonmanifold": 0,
    "write.stepcaf.subshapes.name": 1,
}


def write_step(
    path: Path,
    parts: Sequence[Part],
    *,
    schema: str = settings.STEP_SCHEMA,
    timestamp: datetime | None = None,
) -> None:
    """Writes named and colored shapes into one STEP file, in mm.

    Args:
        path: the file; it is replaced as a whole.
        parts: at least one; in this order in the file.
        schema: ``AP214`` or ``AP242``.
        timestamp: the time in the header; the start of 1970 when None, so that equal input gives
            equal bytes.

    Raises:
        ExportError: the kernel cannot write a shape, or the file cannot be written; what stood
            there before is untouched.

    Example:
        >>> from build123d import Edge
        >>> from wrinkle_cad import Part, read_cad
        >>> p = Edge.make_line((0, 0), (90, 0))
        >>> write_step(Path("rail.step"), [Part(p.wrapped, "P")])
        >>> [str(shape) for shape in read_cad(Path("rail.step")).shapes]
        ["[1] 'P' edge 90 mm"]
    """
    header = Header(path.name, timestamp)
    try:
        content = step_bytes(parts, header, schema=schema)
    except CadError as error:
        raise ExportError(path, "STEP", error.message) from error
    write_export(path, "STEP", content)


def step_bytes(
    parts: Sequence[Part], header: Header, *, schema: str = settings.STEP_SCHEMA
) -> bytes:
    """Returns the content of a STEP file, for who writes it elsewhere; see ``write_step``.

    Raises:
        CadError: no parts, an unknown schema, a face that its part does not hold, or the kernel
            cannot write a shape.
    """
    if schema not in _SCHEMAS:
        raise CadError(
            "write STEP", f"the schema is {schema!r}. Choose one of {', '.join(_SCHEMAS)}."
        )
    if not parts:
        raise CadError("write STEP", "there are no shapes. Pass at least one.")
    ordered = [_with_faces_in_order(part) for part in parts]
    silence_kernel()
    with kernel_step("write STEP"):
        shapes = _apart([part.shape for part in ordered])
        own = [
            replace(part, shape=shape, faces=carried_over(part.faces, part.shape, shape))
            for part, shape in zip(ordered, shapes, strict=True)
        ]
        raw = _kernel_text(own, _SCHEMAS[schema])
    return finished_text(raw, own, header)


def _with_faces_in_order(part: Part) -> Part:
    """Returns the part with one style per face, in the order of its faces.

    Raises:
        CadError: it is empty, it is a single face and has a face, or does not hold one.
    """
    name = one_line(part.name)
    if part.shape.IsNull():
        raise CadError("write STEP", f"part '{name}' is empty. Leave it out.")
    if not part.faces:
        return part
    if part.shape.ShapeType() == TopAbs_FACE:
        raise CadError(
            "write STEP", f"part '{name}' is one face. Name and color the part, not its face."
        )
    held = ShapeIndex(faces_of(part.shape))
    strange = sum(held.find(style.face) < 0 for style in part.faces)
    if strange:
        raise CadError(
            "write STEP",
            f"{strange} of {len(part.faces)} named or colored faces are not in part '{name}'."
            " Take them from its shape.",
        )
    (faces,) = styles_in([part.shape], part.faces)
    return replace(part, faces=faces)


def _kernel_text(parts: Sequence[Part], schema: str) -> bytes:
    document = new_document()
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    for i, part in enumerate(parts):
        label = tool.AddShape(part.shape, False)
        set_name(label, placeholder(i))
        for k, style in enumerate(part.faces):
            set_name(tool.AddSubShape(label, style.face), face_placeholder(i, k))
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.SetColorMode(False)
    stream = io.BytesIO()
    with kernel_parameters({"write.step.schema": schema, **_PARAMETERS}):
        if not writer.Transfer(document, STEPControl_AsIs):
            raise CadError("write STEP", "the CAD kernel cannot translate the shapes. Check them.")
        if writer.WriteStream(stream) != IFSelect_RetDone:
            raise CadError("write STEP", "the CAD kernel cannot write the shapes. Check them.")
    return stream.getvalue()


def _apart(shapes: Sequence[TopoDS_Shape]) -> list[TopoDS_Shape]:
    """Returns the shapes in world coordinates, none sharing a piece with an earlier one.

    The kernel writes a shape that is part of another one as nothing at all, and one that carries a
    placement as an assembly.
    """
    seen = ShapeMap()
    own: list[TopoDS_Shape] = []
    for shape in shapes:
        pieces = ShapeMap()
        TopExp.MapShapes_s(shape, pieces)
        is_shared = seen.Extent() > 0 and any(
            seen.Contains(pieces.FindKey(i)) for i in range(1, pieces.Extent() + 1)
        )
        place = shape.Location()
        if not place.IsIdentity():
            inner = shape.Located(TopLoc_Location())
            own.append(BRepBuilderAPI_Transform(inner, place.Transformation(), True).Shape())
        else:
            own.append(BRepBuilderAPI_Copy(shape).Shape() if is_shared else shape)
        TopExp.MapShapes_s(shape, seen)
    return own


_OTHER_MESHES: Final = (0.7, 0.5, 0.35)
"""Shares of the tolerance that are tried in turn where a mesh overlaps itself: on faces thinner
than the tolerance the kernel's mesher sometimes lays triangles upon each other."""


def write_stl(
    path: Path,
    shape: TopoDS_Shape,
    *,
    tolerance: float = settings.TOLERANCE,
    curved_tolerance: float = 0.0,
) -> None:
    """Writes the triangles of a shape as a binary STL file, in mm.

    Args:
        path: the file; it is replaced as a whole.
        shape: anything with faces; triangles that it already carries are not used.
        tolerance: mm; how far a triangle may lie from its face.
        curved_tolerance: mm; the same for faces curved both ways, if larger.

    Raises:
        ExportError: there are no faces, the kernel cannot mesh them, or the file cannot be written;
            what stood there before is untouched.
    """
    try:
        content = stl_bytes(shape, tolerance=tolerance, curved_tolerance=curved_tolerance)
    except CadError as error:
        raise ExportError(path, "STL", error.message) from error
    write_export(path, "STL", content)


def stl_bytes(
    shape: TopoDS_Shape,
    *,
    tolerance: float = settings.TOLERANCE,
    curved_tolerance: float = 0.0,
) -> bytes:
    """Returns the content of a binary STL file; see ``write_stl``.

    Raises:
        CadError: there are no faces, or the kernel cannot mesh them.
    """
    if not faces_of(shape):
        raise CadError("mesh the shape", "it has no faces. Pass a face, shell or solid.")
    silence_kernel()
    for share in (1.0, *_OTHER_MESHES):
        points, triangles = mesh_of(
            shape, tolerance=share * tolerance, curved_tolerance=share * curved_tolerance
        )
        triangles = without_doubled(points, triangles)
        if not shares_edges_thrice(points, triangles):
            break
    if not len(triangles):
        raise CadError("mesh the shape", "the CAD kernel made no triangles. Check the shape.")
    return binary_stl(points, triangles)

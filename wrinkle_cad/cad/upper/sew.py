"""Sews faces that were made apart into one shell, and proves that nothing was lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
from OCP.Geom import Geom_BSplineCurve
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape, TopoDS_Shell

from wrinkle_cad.cad.faces.dense_edges import is_sliver, make_dense
from wrinkle_cad.cad.faces.face_borders import sub_curve
from wrinkle_cad.cad.kernel.curves import edge_middle
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import as_shell, edges_of, faces_of, shells_of
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.places import place_text

from .pieces import oriented_edges

STEP = "sew the wrinkle to the body"


@dataclass(frozen=True, slots=True, eq=False)
class Sewn:
    """Faces that became one shell."""

    shell: TopoDS_Shell
    """The shell, its normals as in the first face given."""
    faces: tuple[TopoDS_Face, ...]
    """What each face given has become, in order, as the shell holds it."""


def joined(faces: Sequence[TopoDS_Face], tolerance: float) -> tuple[TopoDS_Shape, list[int]]:
    """Joins the faces of an upper whose borders lie within a tolerance in mm of each other.

    Returns:
        The faces, sewn where they meet, and for each of its faces the index of the one given.

    Raises:
        CadError: a face went missing.
    """
    with kernel_step("join the faces of the upper"):
        sewing = BRepBuilderAPI_Sewing(tolerance)
        for face in faces:
            sewing.Add(face)
        sewing.Perform()
        sewn = sewing.SewedShape()
    places = ShapeIndex(faces_of(sewn))
    origin = [-1] * len(faces_of(sewn))
    for i, face in enumerate(faces):
        at = places.find(sewing.Modified(face) if sewing.IsModified(face) else face)
        if at >= 0:
            origin[at] = i
    if len(origin) != len(faces) or min(origin) < 0:
        raise CadError(
            "join the faces of the upper",
            f"{len(origin)} of {len(faces)} faces are left at a tolerance of {tolerance:.2g} mm,"
            " all are needed. Lower it.",
        )
    return sewn, origin


def sew(faces: Sequence[TopoDS_Face], tolerance: float) -> Sewn:
    """Sews faces whose common edges lie within a tolerance in mm of each other.

    Raises:
        CadError: the result is not one shell, or a face went missing, or an edge has more than two.
    """
    with kernel_step(STEP):
        sewing = BRepBuilderAPI_Sewing(tolerance)
        sewing.SetNonManifoldMode(False)
        for face in faces:
            sewing.Add(face)
        sewing.Perform()
        sewn = sewing.SewedShape()
    shells = shells_of(sewn) if not sewn.IsNull() else []
    found = len(faces_of(shells[0])) if shells else 0
    lost = sewing.NbDeletedFaces() + sewing.NbMultipleEdges()
    if len(shells) != 1 or found != len(faces) or lost:
        raise CadError(
            STEP,
            f"found {len(shells)} shells, the first of {found} faces, {sewing.NbDeletedFaces()}"
            f" faces deleted, {sewing.NbMultipleEdges()} edges with more than two faces, instead of"
            f" 1 shell of {len(faces)} faces. Change the margin or move the rails a little.",
        )
    shell = as_shell(shells[0])
    held = ShapeIndex(faces_of(shell))
    places = [held.find(sewing.Modified(face)) for face in faces]
    if min(places) < 0 or len(set(places)) < len(faces):
        raise CadError(
            STEP,
            "two faces, whose borders lie within"
            f" {tolerance:.2g} mm of each other, became one. Widen the margin.",
        )
    if faces_of(shell)[places[0]].Orientation() != faces[0].Orientation():
        shell = as_shell(shell.Reversed())
    kept = faces_of(shell)
    _check_oriented(shell)
    _trim_curves(shell, faces)
    return Sewn(shell, tuple(kept[place] for place in places))


def _trim_curves(shell: TopoDS_Shell, given: Sequence[TopoDS_Face]) -> None:
    """Gives each edge that sewing made the part of its curve that it uses, dense beside an apex.

    Sewing cuts an edge into many on one and the same curve, and a STEP file holds it for each.
    """
    old = ShapeIndex(edge for face in given for edge in oriented_edges(face))
    for edge in edges_of(shell):
        if old.find(edge) >= 0 or BRep_Tool.Degenerated_s(edge):
            continue
        ends = BRepAdaptor_Curve(edge)
        first, last = ends.FirstParameter(), ends.LastParameter()
        curve = BRep_Tool.Curve_s(edge, first, last)
        if (
            isinstance(curve, Geom_BSplineCurve)
            and curve.NbKnots() > 2
            and edge.Location().IsIdentity()
        ):
            part = sub_curve(curve, first, last)
            BRep_Builder().UpdateEdge(edge, part, BRep_Tool.Tolerance_s(edge))
            BRep_Builder().Range(edge, first, last)
    for face in faces_of(shell):
        if is_sliver(face):
            for edge in edges_of(face):
                if not BRep_Tool.Degenerated_s(edge):
                    make_dense(edge)


def _check_oriented(shell: TopoDS_Shell) -> None:
    """Checks that two faces that share an edge run along it in opposite directions."""
    index, forward, reverse = ShapeIndex(), list[int](), list[int]()
    for face in faces_of(shell):
        for edge in oriented_edges(face):
            at = index.add(edge)
            if at == len(forward):
                forward.append(0)
                reverse.append(0)
            if edge.Orientation() == TopAbs_REVERSED:
                reverse[at] += 1
            else:
                forward[at] += 1
    wrong = [at for at, uses in enumerate(zip(forward, reverse, strict=True)) if max(uses) > 1]
    if wrong:
        first = next(edge for edge in edges_of(shell) if index.find(edge) == wrong[0])
        raise CadError(
            STEP,
            f"{len(wrong)} edges, the first at {place_text(edge_middle(first), 0.0)}, are run along"
            " twice in the same direction. Check that all faces of the upper face the same way.",
        )

"""Kernel shapes -> the list of shapes that can be chosen, in the file's order.

What a product consists of is taken apart only as far as somebody would choose it: solids one by
one; all its free faces and shells together; its free edges and wires; its points together. A shape
is free if it bounds nothing larger.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt, gp_Trsf
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_COMPOUND, TopAbs_COMPSOLID
from OCP.TopoDS import TopoDS_Iterator, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.kernel.topology import edges_of, kind_name, make_compound, vertices_of
from wrinkle_cad.errors import CadError

from .face_styles import carried_over, styles_in
from .shapes import CURVE_KINDS, FaceStyle, Holder, NamedShape
from .sniff import Source

Color = tuple[float, float, float]
_SURFACES = ("face", "shell")


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A shape to be listed, before it is measured and numbered."""

    shape: TopoDS_Shape
    """The kernel's shape."""
    name: str = ""
    """Its name; empty without one."""
    color: Color | None = None
    """Its color, or None."""
    is_free: bool = True
    """Whether it is part of no other shape."""
    faces: Sequence[FaceStyle] = ()
    """Names and colors of single faces."""
    named_by: str = ""
    """What carries the name: ``curve``, ``set``, ``layer``, ``product``, ..."""
    is_hidden: bool = False
    """Whether the file says that it is not shown."""
    holders: tuple[Holder, ...] = ()
    """Everything that has a name and holds it, the nearest first, itself included."""


def take_apart(
    shape: TopoDS_Shape,
    name: str = "",
    color: Color | None = None,
    faces: Sequence[FaceStyle] = (),
) -> list[Found]:
    """Returns the shapes of one product that can be chosen, all under its name and color.

    Args:
        shape: the product.
        name: of the product.
        color: of the product.
        faces: that have names or colors of their own.
    """
    parts = list(_free_parts(shape))
    kinds = [kind_name(part) for part in parts]
    surfaces = [part for part, kind in zip(parts, kinds, strict=True) if kind in _SURFACES]
    points = [part for part, kind in zip(parts, kinds, strict=True) if kind == "vertex"]
    alone = [part for part, kind in zip(parts, kinds, strict=True) if kind == "solid"]
    curves = [part for part, kind in zip(parts, kinds, strict=True) if kind in CURVE_KINDS]
    groups = [_together(group) for group in (surfaces, points) if group]
    ordered = [*alone, *groups[:1], *curves, *groups[1:]]
    return [
        Found(part, name, color, faces=own)
        for part, own in zip(ordered, styles_in(ordered, faces), strict=True)
    ]


def _free_parts(shape: TopoDS_Shape) -> Iterator[TopoDS_Shape]:
    if shape.ShapeType() not in (TopAbs_COMPOUND, TopAbs_COMPSOLID):
        yield shape
        return
    inner = TopoDS_Iterator(shape)
    while inner.More():
        yield from _free_parts(inner.Value())
        inner.Next()


def _together(shapes: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    return shapes[0] if len(shapes) == 1 else make_compound(shapes)


def listed(source: Source, found: Sequence[Found], mm_per_unit: float) -> tuple[NamedShape, ...]:
    """Measures, scales to mm and numbers the shapes; drops those without geometry.

    Raises:
        InputError: nothing is left, or a shape lies further out than any real one, or cannot be
            measured because it is damaged.
    """
    kept: list[NamedShape] = []
    for item in found:
        shape = _scaled(item.shape, mm_per_unit)
        kind = kind_name(shape)
        is_curve = kind in CURVE_KINDS
        if is_curve and all(BRep_Tool.Degenerated_s(edge) for edge in edges_of(shape)):
            continue
        _check_extent(source, shape, item.name)
        try:
            measure = length_of(shape) if is_curve else _rough_area(shape)
        except CadError as error:
            raise source.fail(f"damaged, a {kind} cannot be measured: {error.message}") from error
        if measure <= 0.0 and not vertices_of(shape):
            continue
        index = len(kept) + 1
        faces = carried_over(item.faces, item.shape, shape)
        kept.append(
            NamedShape(
                item.name,
                index,
                kind,
                shape,
                measure,
                item.color,
                item.is_free,
                faces,
                item.named_by,
                item.is_hidden,
                item.holders,
            )
        )
    return tuple(kept)


def _scaled(shape: TopoDS_Shape, mm_per_unit: float) -> TopoDS_Shape:
    if mm_per_unit == 1.0:
        return shape
    scaling = gp_Trsf()
    scaling.SetScale(gp_Pnt(0.0, 0.0, 0.0), mm_per_unit)
    return BRepBuilderAPI_Transform(shape, scaling, True).Shape()


def _check_extent(source: Source, shape: TopoDS_Shape, name: str) -> None:
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    if box.IsVoid():
        return
    if box.IsOpen():
        reach = np.inf
    else:
        corners = (box.CornerMin(), box.CornerMax())
        reach = max(abs(value) for at in corners for value in (at.X(), at.Y(), at.Z()))
    # A NaN fails this comparison, too.
    if not reach <= settings.LARGEST_COORDINATE:
        raise source.fail(
            f"damaged: {kind_name(shape)} '{name}' reaches to {reach:.3g} mm,"
            f" the limit is {settings.LARGEST_COORDINATE:.3g} mm. Check the numbers and the unit."
        )


def _rough_area(shape: TopoDS_Shape) -> float:
    """Returns mm^2, good to some 1e-5: enough to tell the shapes of a list apart."""
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found)
    return float(abs(found.Mass()))

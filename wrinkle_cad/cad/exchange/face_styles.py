"""Names and colors of single faces, found again in the shapes that hold them and in copies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import faces_of

from .shapes import FaceStyle


def styles_in(
    shapes: Sequence[TopoDS_Shape], styles: Sequence[FaceStyle]
) -> list[tuple[FaceStyle, ...]]:
    """Returns for each shape the styles of its own faces, in the order of the faces.

    Args:
        shapes: any.
        styles: of faces in any of the shapes, or of others; the last one of a face counts.
    """
    if not styles:
        return [() for _ in shapes]
    numbers = ShapeIndex()
    style_of = {numbers.add(style.face): style for style in styles}
    return [
        tuple(
            replace(style_of[at], face=face)
            for face in faces_of(shape)
            if (at := numbers.find(face)) >= 0
        )
        for shape in shapes
    ]


def carried_over(
    styles: Sequence[FaceStyle], before: TopoDS_Shape, after: TopoDS_Shape
) -> tuple[FaceStyle, ...]:
    """Returns the styles of a shape's faces for a copy of it, moved or scaled or not."""
    if not styles:
        return ()
    numbers, copies = ShapeIndex(faces_of(before)), faces_of(after)
    return tuple(replace(style, face=copies[numbers.find(style.face)]) for style in styles)

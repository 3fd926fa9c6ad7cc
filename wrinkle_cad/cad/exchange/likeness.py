"""Gives what was made from a caller's object the names and colors of that object."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from wrinkle_cad.cad.build123d_objects import to_build123d
from wrinkle_cad.cad.kernel.connectivity import joined_faces
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import faces_of

if TYPE_CHECKING:
    from build123d import Compound, Face, Shell


def alike(shape: TopoDS_Shape, source: object, label: str = "") -> Face | Shell | Compound:
    """Returns a shape as a build123d object with the label and color of a source object.

    Args:
        shape: what was made; shared, not copied.
        source: build123d object that it was made from, or anything.
        label: what to call it where the source has no label.
    """
    made = to_build123d(shape, label=str(getattr(source, "label", "") or label))
    made.color = _color_of(source)
    return made


def body_alike(
    body: TopoDS_Shape, origin: Sequence[int], upper: TopoDS_Shape, source: object
) -> Face | Shell | Compound:
    """Returns a body as a build123d object with all names and colors of the upper.

    Where the upper was an assembly, so is the body: each child keeps what is left of its faces.

    Args:
        body: what is left of the upper.
        origin: per face of the body, the index of the upper's face.
        upper: the upper as it was given.
        source: the object that it was given in.
    """
    children = [child for child in getattr(source, "children", ()) if hasattr(child, "wrapped")]
    if not children:
        return alike(body, source, "body")
    faces = faces_of(body)
    given = ShapeIndex(faces_of(upper))
    made = []
    for child in children:
        own = {given.find(face) for face in faces_of(child.wrapped)}
        left: list[TopoDS_Face] = [
            face for face, index in zip(faces, origin, strict=True) if index in own
        ]
        if left:
            made.append(alike(joined_faces(left), child))
    from build123d import Compound

    assembly = Compound(label=str(getattr(source, "label", "") or "body"), children=made)
    assembly.color = _color_of(source)
    return assembly


def _color_of(source: object) -> Any:
    return getattr(source, "color", None) if hasattr(source, "wrapped") else None

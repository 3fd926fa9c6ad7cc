"""A stitched upper as one part to be written: each face looks like what it was made from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from OCP.TopoDS import TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.exchange.shapes import FaceStyle, NamedShape, Part
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import faces_of

from .opening import Opening, one_per_body
from .stitch import BODY, Stitched


def stitched_part(
    stitched: Stitched,
    openings: Sequence[Opening],
    upper: NamedShape,
    name: str,
    colors: Mapping[str, Sequence[float]],
) -> Part:
    """Returns the shell with its faces' names and colors.

    The body keeps those that the upper's faces have in the file; what has none looks like the whole
    upper. The other faces are called after their wrinkle, band or end.

    Args:
        stitched: the upper with its wrinkles.
        openings: carved one after the other, the first one from the upper.
        upper: as the file has it.
        name: of the shell.
        colors: of the wrinkles and bands by their names, red, green, blue from 0 to 1.
    """
    origin = _origin_of_body(openings)
    styles: list[FaceStyle] = []
    for part, faces in stitched.parts:
        # A strip may be called as the body is; the body's faces come first.
        count = len(origin) if part == BODY else 0
        styles += _body_styles(faces[:count], origin, upper)
        color = colors.get(part, settings.BAND_COLOR)
        styles += [FaceStyle(face, part, color) for face in faces[count:]]
    color = settings.UPPER_COLOR if upper.color is None else upper.color
    return Part(stitched.shell_shape, name, color, styles)


def _origin_of_body(openings: Sequence[Opening]) -> tuple[int, ...]:
    """Returns for each face of the last body which face of the upper it is, or is part of."""
    first, *later = one_per_body(openings)
    origin = first.face_origin
    for opening in later:
        origin = tuple(origin[i] for i in opening.face_origin)
    return origin


def _body_styles(
    faces: Sequence[TopoDS_Face], origin: Sequence[int], upper: NamedShape
) -> Iterator[FaceStyle]:
    if not faces:
        return
    given = faces_of(upper.shape)
    numbers = ShapeIndex(given)
    style_of = {numbers.find(style.face): style for style in upper.faces}
    for face, i in zip(faces, origin, strict=True):
        if i in style_of:
            yield FaceStyle(face, style_of[i].name, style_of[i].color)

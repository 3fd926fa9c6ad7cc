"""Objects of build123d, made only where a caller gets them: importing it costs seconds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.gp import gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from wrinkle_cad.cad.kernel.colors import occ_color
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.errors import CadError, InputError

if TYPE_CHECKING:
    from build123d import Sketch


def to_build123d(
    shape: TopoDS_Shape, label: str = "", color: Sequence[float] | str | None = None
) -> Any:
    """Returns a shape as build123d's Edge, Wire, Face, Shell, Solid or Compound.

    Args:
        shape: the shape; it is shared, not copied.
        label: what viewers and files call it.
        color: red, green, blue and perhaps opacity, sRGB, 0 to 1; or a name build123d knows.

    Raises:
        InputError: a color that is none of these.
    """
    from build123d import Color, Compound

    result = Compound.cast(shape)
    result.label = label
    if isinstance(color, str):
        try:
            result.color = Color(color)
        except ValueError as error:
            raise InputError(f"{color!r} is no color's name: {error}.") from error
    elif color is not None:
        result.color = Color(occ_color(color))
    return result


def material_on(source: object) -> tuple[str, float | None] | None:
    """Returns the name of the material that a build123d object is made of, and its thickness in mm.

    Args:
        source: a shape, or a list of shapes, of which the first with a material counts. Anything
            else has none.

    Returns:
        The name as ``bd_materials`` has it, and the middle of the thicknesses that it comes in,
        None where that is not known; None without a material.
    """
    items = source if isinstance(source, Sequence) and not isinstance(source, str) else [source]
    for item in items:
        known = getattr(getattr(item, "material", None), "material", None)
        if isinstance(name := getattr(known, "name", None), str):
            ranged = getattr(known, "thickness", None)
            ends = [getattr(ranged, end, None) for end in ("min", "max")]
            numbers = [float(end) for end in ends if isinstance(end, int | float)]
            return name, sum(numbers) / len(numbers) if numbers else None
    return None


def sketch_from_outline(outlines: Sequence[ArrayLike]) -> Sketch:
    """Returns a build123d sketch on XY, its faces looking up, with one face for each outline.

    Args:
        outlines: each (k, 2) mm, k >= 3: the corners of a polygon that does not cross itself, in
            either direction; the first may be repeated at the end.

    Raises:
        InputError: an outline that is no polygon.
        CadError: an outline that crosses itself.
    """
    from build123d import Sketch

    faces = [_polygon_face(np.asarray(outline, dtype=np.float64)) for outline in outlines]
    return Sketch(make_compound(faces))


def _polygon_face(corners: np.ndarray[Any, np.dtype[np.float64]]) -> TopoDS_Face:
    from shapely import Polygon

    if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        raise InputError(
            f"The outline is an array of shape {corners.shape}. Pass finite (k, 2) corners in mm."
        )
    moves = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    corners = corners[moves > 0.0]
    if len(corners) < 3:
        raise InputError(f"The outline has {len(corners)} corners, at least 3 are needed.")
    x, y = corners.T
    if (x * np.roll(y, -1)).sum() < (y * np.roll(x, -1)).sum():
        corners = corners[::-1]
    # The kernel's own check takes 16 s for 4,000 corners.
    if not Polygon(corners).is_valid:
        raise CadError("make a sketch", "the outline crosses itself. Cut the pattern into pieces.")
    with kernel_step("make a sketch"):
        polygon = BRepBuilderAPI_MakePolygon()
        for x_at, y_at in corners.tolist():
            polygon.Add(gp_Pnt(x_at, y_at, 0.0))
        polygon.Close()
        maker = BRepBuilderAPI_MakeFace(gp_Pln(), polygon.Wire(), True)
        if not maker.IsDone():
            raise CadError(
                "make a sketch", f"the CAD kernel says {maker.Error()}. Check the outline."
            )
        return maker.Face()

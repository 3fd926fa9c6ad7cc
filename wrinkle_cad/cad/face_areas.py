"""Areas of many faces, as exact as an area balance needs and no more: exactness takes seconds."""

from __future__ import annotations

from collections.abc import Iterable

from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError

from . import kernel


def face_areas(faces: Iterable[TopoDS_Face], relative_error: float) -> list[float]:
    """Returns the area in mm^2 of each face.

    The kernel's own error estimate is none, so each face is integrated at rising orders until two
    agree to ``relative_error``.

    Raises:
        CadError: they do not agree at the highest order either.
    """
    with kernel.kernel_step("measure an area"):
        return [_face_area(face, relative_error) for face in faces]


def _face_area(face: TopoDS_Face, relative_error: float) -> float:
    before = _integrated(face, settings.AREA_BALANCE_ORDERS[0])
    for order in settings.AREA_BALANCE_ORDERS[1:]:
        area = _integrated(face, order)
        if abs(area - before) <= relative_error * abs(area):
            return area
        before = area
    raise CadError(
        "measure an area",
        f"integrations of a face of {before:.6g} mm^2 do not settle - {relative_error:.0e} of it is"
        " the limit - simplify the face",
    )


def _integrated(face: TopoDS_Face, order: float) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, found, order, False)
    return abs(float(found.Mass()))

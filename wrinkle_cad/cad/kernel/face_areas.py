"""Areas of many faces, as exact as an area balance needs and no more: exactness takes seconds."""

from __future__ import annotations

from collections.abc import Iterable

from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError

from . import topology as kernel


def face_areas(faces: Iterable[TopoDS_Face], relative_error: float) -> list[float]:
    """Returns the area in mm^2 of each face.

    The kernel's own error estimate is none, so each face is integrated at rising orders until two
    agree to ``relative_error`` of the face or of the mean face, whichever is larger.

    Raises:
        CadError: they do not agree at the highest order either.
    """
    with kernel.kernel_step("measure an area"):
        given = list(faces)
        first = [_integrated(face, settings.AREA_BALANCE_ORDERS[0]) for face in given]
        mean = sum(first) / max(len(first), 1)
        return [
            _settled(face, area, relative_error * max(area, mean))
            for face, area in zip(given, first, strict=True)
        ]


def _settled(face: TopoDS_Face, before: float, limit: float) -> float:
    for order in settings.AREA_BALANCE_ORDERS[1:]:
        area = _integrated(face, order)
        if abs(area - before) <= limit:
            return area
        before = area
    raise CadError(
        "measure an area",
        f"integrations of a face of {before:.6g} mm^2 do not settle - {limit:.1e} mm^2 is"
        " the limit - simplify the face",
    )


def _integrated(face: TopoDS_Face, order: float) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, found, order, False)
    return abs(float(found.Mass()))

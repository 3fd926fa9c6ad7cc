"""How long, how large and how sound a shape is: measured to a stated accuracy."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.errors import CadError

from .steps import kernel_step
from .topology import edges_of, faces_of, kind_name


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


def face_areas(
    faces: Iterable[TopoDS_Face], *, relative_error: float = settings.AREA_RELATIVE_ERROR
) -> list[float]:
    """Returns the area in mm^2 of each face.

    What the kernel reports as its error is not one (0 where a face was off by 1e-5): the bound that
    it is given chooses the order of its integration. So each face is integrated at rising orders
    until two agree, to ``relative_error`` of the face or of the mean face, whichever is larger. A
    coarse answer is asked for at a low order first: exactness takes seconds.

    Raises:
        CadError: they do not agree at the highest order either.
    """
    first_at = settings.AREA_FIRST_ORDER_PER_ERROR * relative_error
    orders = [order for order in settings.AREA_ORDERS if order <= first_at]
    orders = orders if len(orders) > 1 else list(settings.AREA_ORDERS[-2:])
    given = list(faces)
    with kernel_step("measure an area"):
        first = [_integrated_area(face, orders[0]) for face in given]
        mean = sum(first) / max(len(given), 1)
        return [
            _settled_area(face, area, relative_error * max(area, mean), orders[1:])
            for face, area in zip(given, first, strict=True)
        ]


def area_as_exact_as_can_be(shape: TopoDS_Shape) -> tuple[float, float]:
    """Returns the area in mm^2 of a shape, and the relative error to which it could be had.

    A sound strip does not fail for the last digits of its area.
    """
    faces = faces_of(shape)
    *tried, coarsest = settings.AREA_RELATIVE_ERRORS
    for error in tried:
        with contextlib.suppress(CadError):
            return sum(face_areas(faces, relative_error=error)), error
    return sum(face_areas(faces, relative_error=coarsest)), coarsest


def _integrated_area(face: TopoDS_Face, order: float) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, found, order, False)
    return abs(float(found.Mass()))


def _settled_area(face: TopoDS_Face, area: float, limit: float, orders: Iterable[float]) -> float:
    change = 0.0
    for order in orders:
        before, area = area, _integrated_area(face, order)
        change = abs(area - before)
        if change <= limit:
            return area
    raise CadError(
        "measure an area",
        f"two integrations of a face of {area:.6g} mm^2 differ by {change:.1e} mm^2, at most"
        f" {limit:.1e} mm^2 is allowed. Ask for less accuracy or simplify the face.",
    )


def is_valid(shape: TopoDS_Shape) -> bool:
    """Tells whether the kernel's own check finds no fault in a shape, geometry included."""
    with kernel_step("check a shape"):
        return bool(BRepCheck_Analyzer(shape, True).IsValid())


def check_valid(shape: TopoDS_Shape, step: str, advice: str) -> None:
    """Raises a ``CadError`` for the step if the kernel's own check finds a fault in its result.

    Args:
        shape: the result.
        step: what was being done.
        advice: a sentence that says what to do about it.
    """
    if not is_valid(shape):
        faces = faces_of(shape)
        faulty = sum(not is_valid(face) for face in faces)
        raise CadError(
            step,
            f"the resulting {kind_name(shape)} does not pass the CAD kernel's own check, which"
            f" finds a fault in {faulty} of its {len(faces)} faces. {advice}",
        )


def tolerance_of(shape: TopoDS_Shape) -> float:
    """Returns the largest tolerance in mm of the edges of a shape; 0 if it has none."""
    return max((float(BRep_Tool.Tolerance_s(edge)) for edge in edges_of(shape)), default=0.0)

"""Measures of whole shapes that only the tests need."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.measures import face_areas
from wrinkle_cad.cad.kernel.topology import faces_of


def area_of(shape: TopoDS_Shape, relative_error: float = settings.AREA_RELATIVE_ERROR) -> float:
    """mm^2 of all the faces of a shape."""
    return sum(face_areas(faces_of(shape), relative_error=relative_error))


def bounding_box(shape: TopoDS_Shape) -> NDArray[np.float64]:
    """(2, 3) mm: the lowest and the highest coordinates of the geometry of a shape."""
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]])

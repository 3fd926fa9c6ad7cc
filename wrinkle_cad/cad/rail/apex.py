"""Rails that are a point: the strip to them is a cone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.splines import curve_arrays
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of, vertex_point, vertices_of

Floats = NDArray[np.float64]


def apex_in(source: object) -> Floats | None:
    """Returns (3,) mm: the point that a rail consists of; None if it has a length.

    Args:
        source: what a rail is made from. A vertex, an edge without length or a degenerate one, as
            at the apex of a cone, or a single row of coordinates is a point.
    """
    if isinstance(source, np.ndarray):
        is_row = source.shape == (1, 3) and bool(np.isfinite(source).all())
        return source[0].copy() if is_row else None
    shape = source if isinstance(source, TopoDS_Shape) else getattr(source, "wrapped", None)
    if not isinstance(shape, TopoDS_Shape) or shape.IsNull():
        return None
    if shape.ShapeType() == TopAbs_VERTEX:
        return vertex_point(vertices_of(shape)[0])
    points = [_without_length(as_edge(edge)) for edge in edges_of(shape)]
    found = [point for point in points if point is not None]
    return found[0] if found and len(found) == len(points) else None


def _without_length(edge: TopoDS_Edge) -> Floats | None:
    """Returns the place of an edge that has no length, else None."""
    if BRep_Tool.Degenerated_s(edge):
        return vertex_point(vertices_of(edge)[0])
    poles, *_ = curve_arrays(edge_curve(edge))
    size = float(np.ptp(poles, axis=0).max())
    return np.array(poles[0]) if size <= settings.CONFUSION else None

"""A parametric shoe upper: radial sections of a last, lofted into one closed B-spline face.

Each section is a quartic Bezier curve that climbs from the feather edge (where the upper meets
the sole) to the collar (where the foot goes in). Twenty of them stand around the last; a periodic
cubic spline runs through their control points, so the upper is smooth everywhere and its seam
lies at the heel. x points from heel to toe, y to the outer side, z up; lengths are in mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.Geom import Geom_BSplineSurface
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape
from scipy.interpolate import CubicSpline, make_interp_spline

from wrinkle_cad import make_surface

SIZE = 42
CONFUSION = 1e-7
SEAM_TOLERANCE = 1e-6
DECIMALS = 9
"""Of the coordinates in mm that are written."""

OUTER = (
    # feather x, y, z;  bulge out, up;  shoulder x, y, z;  crown x, y, z;  collar x, y, z
    (0, 0, 6, 7, 21, -4, 0, 40, 5, 0, 52, 9, 0, 65),
    (9, 20, 6, 6, 20, 6, 25, 39, 12, 21, 51, 16, 17, 63),
    (34, 30, 5, 6, 17, 33, 35, 35, 36, 32, 47, 38, 26, 56),
    (70, 31, 4, 6, 15, 69, 37, 31, 68, 36, 44, 66, 29, 51),
    (108, 29, 2, 6, 16, 105, 41, 33, 99, 37, 50, 91, 27, 55),
    (146, 34, 1, 7, 18, 141, 47, 38, 128, 38, 59, 110, 20, 64),
    (182, 44, 0, 8, 18, 176, 54, 38, 152, 36, 61, 121, 13, 69.5),
    (214, 46, 1, 8, 18, 208, 50, 41, 171, 29, 59, 127, 8, 72),
    (243, 38, 3, 6, 19, 237, 36, 44, 185, 19, 57, 130, 4, 73),
    (265, 22, 5, 6, 21, 257, 20, 46, 194, 9, 57, 131, 2, 73.5),
)
TOE = (277, -4, 7, 6, 22, 268, -4, 46, 197, -2, 57, 131.5, 0, 73.7)
INNER_WIDTH = 0.95
"""The inner side of a foot is this much narrower about the long axis of the last."""


def section_poles() -> NDArray[np.float64]:
    """Returns the control points (20, 5, 3), mm, of the sections: heel, inner side, toe, outer."""
    outer = np.array(OUTER, dtype=np.float64)
    inner = outer[1:].copy()
    inner[:, [1, 6, 9, 12]] *= -INNER_WIDTH
    table = np.vstack((outer[:1], inner, [TOE], outer[:0:-1]))
    feather, bulge = table[:, :3], table[:, 3:5]
    along = np.roll(feather, -1, axis=0) - np.roll(feather, 1, axis=0)
    outward = np.stack((along[:, 1], -along[:, 0], np.zeros(len(along))), axis=1)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    wall = feather + bulge[:, :1] * outward + bulge[:, 1:] * np.array([0.0, 0.0, 1.0])
    return np.stack((feather, wall, table[:, 5:8], table[:, 8:11], table[:, 11:14]), axis=1)


def upper_surface(size: float = SIZE) -> Geom_BSplineSurface:
    """Returns the whole upper: u runs around the last from the heel, v from feather to collar.

    Its normals point outward. Sizes scale it as a whole: Paris points, two thirds of a cm each.
    """
    poles = section_poles() * (size / SIZE)
    closed = np.concatenate((poles, poles[:1]))
    stations = np.arange(len(closed), dtype=np.float64)
    slope = CubicSpline(stations, closed, bc_type="periodic")(0.0, 1)
    spline = make_interp_spline(stations, closed, k=3, bc_type=([(1, slope)], [(1, slope)]))
    knots, counts = np.unique(spline.t, return_counts=True)
    # Solvers differ in their last digits from processor to processor, and the file must not.
    poles = rounded(spline.c)
    return make_surface(poles, (knots, (0.0, 1.0)), (counts, (5, 5)), (3, 4))


def rounded(coordinates: ArrayLike) -> NDArray[np.float64]:
    """Returns coordinates as they are written, without a minus before a zero."""
    return np.round(np.asarray(coordinates, dtype=np.float64), DECIMALS) + 0.0


def upper_face(size: float = SIZE) -> TopoDS_Face:
    """Returns the upper as one face, closed at the heel by a seam, open at feather and collar."""
    return BRepBuilderAPI_MakeFace(upper_surface(size), CONFUSION).Face()


def upper_panels(cuts: Sequence[float], size: float = SIZE) -> list[TopoDS_Face]:
    """Returns the upper cut into panels from feather to collar, which share no edges yet.

    Args:
        cuts: where panels meet, in sections from the heel: 0, ..., 20; 10 is the middle of the toe.
        size: of the shoe.
    """
    panels = []
    for start, end in pairwise(cuts):
        surface = upper_surface(size)
        surface.Segment(start, end, 0.0, 1.0)
        panels.append(BRepBuilderAPI_MakeFace(surface, CONFUSION).Face())
    return panels


def sewn(panels: Sequence[TopoDS_Face]) -> TopoDS_Shape:
    """Returns the panels as one shell."""
    sewing = BRepBuilderAPI_Sewing(SEAM_TOLERANCE)
    for panel in panels:
        sewing.Add(panel)
    sewing.Perform()
    return sewing.SewedShape()

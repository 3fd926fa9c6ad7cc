"""Draws the outline of an opening onto one face: edges with a curve in space and in parameters.

Splitting a face with edges that lie on it is some twenty times faster than with ribbons that cross
it. It serves where the whole outline lies on one face, away from its seam.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.gp import gp_Pnt
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face
from scipy.interpolate import BSpline

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import make_curve, make_curve_2d
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths

from .opening_outline import Side
from .smooth import is_ring

Floats = NDArray[np.float64]

DRAWN_EDGE_GAP: Final = 2e-6
"""mm; an outline that cannot be drawn on a face this exactly is cut with ribbons instead."""

DRAWN_EDGE_HALVINGS: Final = 12
"""How often a stretch of a side is halved, at most, until its curve in space is exact enough."""

CLOSED: Final = 1e-6
"""Ends of a ring closer than this share of its extent in parameters are one place."""

BETWEEN: Final = np.array([0.25, 0.5, 0.75])


def drawn_edges(face: TopoDS_Face, sides: Sequence[Side]) -> list[TopoDS_Edge] | None:
    """Returns one edge per side, or None where a side cannot be drawn on the face exactly enough.

    The curve in parameters runs through the side's points; the curve in space follows it on the
    surface, and the edge's tolerance is what they differ by.
    """
    surface = ShapeAnalysis_Surface(BRep_Tool.Surface_s(face))
    edges = []
    for side in sides:
        uv = _parameters(surface, side.points)
        if uv is None:
            return None
        arc = arc_lengths(side.points)
        edge = _drawn_edge(face, surface, BSpline(*cubic_through(arc, uv), 3), arc)
        if edge is None:
            return None
        edges.append(edge)
    return edges


def _drawn_edge(
    face: TopoDS_Face, surface: ShapeAnalysis_Surface, flat: BSpline, arc: Floats
) -> TopoDS_Edge | None:
    """Returns the edge over a curve in parameters, its curve in space as dense as it has to be.

    Points are added where the curve in space is off the surface, and beside such places: a spline
    through points is off where the surface's own knots bend it.
    """
    at = arc
    for _ in range(DRAWN_EDGE_HALVINGS):
        space = BSpline(*cubic_through(at, _on_surface(surface, flat(at))), 3)
        between = (at[:-1, None] + np.diff(at)[:, None] * BETWEEN).ravel()
        apart = np.linalg.norm(_on_surface(surface, flat(between)) - space(between), axis=1)
        gap = float(apart.max())
        if gap <= DRAWN_EDGE_GAP:
            return _edge(face, space, flat, gap)
        is_off = apart.reshape(-1, len(BETWEEN)).max(axis=1) > 0.5 * DRAWN_EDGE_GAP
        is_near = is_off.copy()
        is_near[1:] |= is_off[:-1]
        is_near[:-1] |= is_off[1:]
        halves = 0.5 * (at[:-1] + at[1:])[is_near]
        at = np.sort(np.concatenate((at, halves)))
    return None


def _on_surface(surface: ShapeAnalysis_Surface, uv: Floats) -> Floats:
    """Returns (k, 3) mm at (k, 2) surface parameters."""
    points = [surface.Value(u, v) for u, v in uv.tolist()]
    return np.array([(at.X(), at.Y(), at.Z()) for at in points])


def _parameters(surface: ShapeAnalysis_Surface, points: Floats) -> Floats | None:
    """Returns (k, 2) surface parameters of points on it, None if they leave it or jump a seam."""
    found = []
    at = None
    for point in points.tolist():
        if at is None:
            at = surface.ValueOfUV(gp_Pnt(*point), settings.CONFUSION)
        else:
            at = surface.NextValueOfUV(at, gp_Pnt(*point), settings.CONFUSION)
        if surface.Gap() > DRAWN_EDGE_GAP:
            return None
        found.append((at.X(), at.Y()))
    uv = np.array(found)
    if is_ring(points) and np.abs(uv[-1] - uv[0]).max() > CLOSED * np.ptp(uv, axis=0).max():
        # It goes around the face, and starts and ends on either side of the seam.
        return None
    moves = np.abs(np.diff(uv, axis=0)).max(axis=0)
    # Along a smooth line the largest step is no multiple of the whole way.
    return None if (moves > 0.25 * np.abs(np.diff(uv, axis=0)).sum(axis=0) + 1e-9).any() else uv


def _edge(face: TopoDS_Face, space: BSpline, flat: BSpline, gap: float) -> TopoDS_Edge:
    edge = BRepBuilderAPI_MakeEdge(make_curve(space.c, *_knots(space), 3)).Edge()
    tolerance = max(settings.CONFUSION, 1.5 * gap)
    curve = make_curve_2d(flat.c, *_knots(flat), 3)
    BRep_Builder().UpdateEdge(edge, curve, BRep_Tool.Surface_s(face), TopLoc_Location(), tolerance)
    return edge


def _knots(spline: BSpline) -> tuple[Floats, NDArray[np.int64]]:
    knots, counts = np.unique(spline.t, return_counts=True)
    return knots, counts

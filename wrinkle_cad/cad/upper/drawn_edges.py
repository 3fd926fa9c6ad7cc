"""Draws a side of an opening onto one face: edges with a curve in space and in parameters.

Splitting a face with edges that lie on it is some twenty times faster than with ribbons that cross
it. It serves where the whole side lies on one face; at its seam and in its poles a side is
parted, since its curve in parameters jumps there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face
from scipy.interpolate import BSpline

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import make_curve, make_curve_2d
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths

from .face_parameters import Curve, FaceParameters, Piece
from .opening_outline import Side

Floats = NDArray[np.float64]

DRAWN_EDGE_GAP: Final = 2e-6
"""mm; an outline that cannot be drawn on a face this exactly is cut with ribbons instead."""

CURVE_GAP: Final = 8e-8
"""mm; what the curve in space and the one on the face may differ by: a program that reads the edge
takes it to lie on the face within its own precision."""

NEAREST_PLACES: Final = 1e-9
"""mm; a spline takes no points nearer to each other along it."""

HALVINGS: Final = 16
"""How often a stretch of a side is halved, at most, until its curves are exact enough."""

BETWEEN: Final = np.array([0.25, 0.5, 0.75])


def drawn_edges(face: TopoDS_Face, side: Side) -> list[TopoDS_Edge] | None:
    """Returns the edges of a side, or None where it cannot be drawn on the face exactly enough.

    The curve in parameters runs through the feet of the side; the curve in space follows it on the
    surface, and the edge's tolerance is what they differ by.
    """
    parameters = FaceParameters(face)
    arc = arc_lengths(side.points)
    line = BSpline(*cubic_through(arc, parameters.led_through_poles(side.points)), 3)
    pieces = parameters.pieces(line, arc)
    if pieces is None or _largest_gap(parameters, pieces, line, arc) > DRAWN_EDGE_GAP:
        return None
    edges = [_drawn_edge(face, parameters, line, piece) for piece in pieces]
    return None if None in edges else [edge for edge in edges if edge is not None]


def _largest_gap(
    parameters: FaceParameters, pieces: Sequence[Piece], line: BSpline, arc: Floats
) -> float:
    """Returns mm: how far the side's own points are from their feet; between them the line sags."""
    at, uv = np.concatenate([p.at for p in pieces]), np.vstack([p.uv for p in pieces])
    own = np.isin(at, arc)
    apart = parameters.points(uv[own]) - line(at[own])
    return float(np.linalg.norm(apart, axis=1).max())


def _drawn_edge(
    face: TopoDS_Face, parameters: FaceParameters, line: BSpline, piece: Piece
) -> TopoDS_Edge | None:
    """Returns the edge of one piece of a side."""
    flat = _flat_curve(parameters, line, piece)
    return None if flat is None else _edge_over(face, parameters, flat, piece.at)


def _flat_curve(parameters: FaceParameters, line: BSpline, piece: Piece) -> BSpline | None:
    """Returns the curve in parameters, through as many feet of the side as it has to."""
    at, uv = piece.at, piece.uv
    for _ in range(HALVINGS):
        flat = BSpline(*cubic_through(at, uv), 3)
        middles = 0.5 * (at[:-1] + at[1:])
        feet = parameters.feet_near(line(middles), flat(middles))
        apart = np.linalg.norm(parameters.points(feet) - parameters.points(flat(middles)), axis=1)
        is_off = apart > 0.5 * DRAWN_EDGE_GAP
        if not is_off.any():
            return flat
        at = np.concatenate((at, middles[is_off]))
        order = np.argsort(at, kind="stable")
        at, uv = at[order], np.vstack((uv, feet[is_off]))[order]
    return None


def _edge_over(
    face: TopoDS_Face, parameters: FaceParameters, flat: BSpline, at: Floats
) -> TopoDS_Edge | None:
    """Returns the edge over a curve in parameters."""
    found = curve_over(lambda at: parameters.points(flat(at)), np.union1d(at, flat.t))
    return None if found is None else _edge(face, found[0], flat, found[1])


def curve_over(point_at: Curve, at: Floats) -> tuple[BSpline, float] | None:
    """Returns a spline that follows a curve on a surface, as dense as it has to be.

    Points are added where it is off the surface, and beside such places: a spline through points is
    off where the surface's own knots bend it.

    Args:
        point_at: the curve.
        at: (k,) parameters to begin with, rising, k at least 4.

    Returns:
        The spline and by how much in mm it is off: ``CURVE_GAP`` at most, ``DRAWN_EDGE_GAP`` where
        too many points do not do; None where these do not either.
    """
    for _ in range(HALVINGS):
        space = BSpline(*cubic_through(at, point_at(at)), 3)
        between = (at[:-1, None] + np.diff(at)[:, None] * BETWEEN).ravel()
        apart = np.linalg.norm(point_at(between) - space(between), axis=1)
        gap = float(apart.max())
        if gap <= CURVE_GAP:
            break
        is_off = apart.reshape(-1, len(BETWEEN)).max(axis=1) > 0.5 * CURVE_GAP
        is_near = is_off.copy()
        is_near[1:] |= is_off[:-1]
        is_near[:-1] |= is_off[1:]
        is_near &= np.diff(at) > 2.0 * NEAREST_PLACES
        if not is_near.any():
            break
        at = np.sort(np.concatenate((at, 0.5 * (at[:-1] + at[1:])[is_near])))
    return (space, gap) if gap <= DRAWN_EDGE_GAP else None


def _edge(face: TopoDS_Face, space: BSpline, flat: BSpline, gap: float) -> TopoDS_Edge:
    edge = BRepBuilderAPI_MakeEdge(make_curve(space.c, *knots_of(space), 3)).Edge()
    tolerance = max(settings.CONFUSION, 1.5 * gap)
    curve = make_curve_2d(flat.c, *knots_of(flat), 3)
    # The face's own surface and placement: a copy of the surface is unknown to the kernel.
    BRep_Builder().UpdateEdge(edge, curve, face, tolerance)
    return edge


def knots_of(spline: BSpline) -> tuple[Floats, NDArray[np.int64]]:
    """Returns (l,) distinct knots and how often each occurs."""
    knots, counts = np.unique(spline.t, return_counts=True)
    return knots, counts

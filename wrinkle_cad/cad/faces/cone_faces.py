"""Faces on cones over curves: exactly developable, with the rail itself as an edge.

A cone is a B-spline surface: u runs along the bank and v from the bank (0) to the apex (1), where a
whole side is one point (a degenerated edge). Where the rails meet, the apex is an end of the bank
itself: the cone's directions are then the curve's chords from that end, which are polynomials one
degree lower, and the bank runs diagonally through the parameters.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_BSplineSurface
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt2d
from OCP.TopoDS import TopoDS_Face, TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import insert_u_knots, make_curve_2d, make_surface

from .dense_edges import make_dense
from .face_borders import Border, BorderEdge
from .on_surface import degenerated_edge, on_ruling, put_on_face
from .plane_faces import cross_rows, make_wire

Floats = NDArray[np.float64]


def cone_face(
    bank: BorderEdge,
    to_apex: Border,
    from_apex: Border,
    apex: Floats,
    vertex: TopoDS_Vertex,
    knots: Floats,
) -> TopoDS_Face:
    """Returns the face on the cone over a bank.

    Its normal is the bank's direction crossed with the direction to the apex.

    Args:
        bank: the edge that the cone stands on, forward.
        to_apex: border from the end of the bank to the apex; empty if the bank ends there.
        from_apex: border from the apex to the start of the bank; empty if the bank starts there.
        apex: (3,) mm.
        vertex: the vertex at the apex.
        knots: (k,) parameters of the bank where the surface gets a knot, and others where its
            normal turns fast. They change nothing but how exactly others integrate it: the
            kernel's default takes a few points per span, and was off by 4e-4 on a long one.
    """
    shape = bank.shape
    first, last = float(shape.knots[0]), float(shape.knots[-1])
    builder, face = BRep_Builder(), TopoDS_Face()
    surface = _surface(shape, apex, is_start=not from_apex, is_end=not to_apex)
    if to_apex and from_apex:
        knots = _refined(shape, apex, np.clip(knots, first, last))
    insert_u_knots(surface, knots[(knots > first) & (knots < last)], settings.KNOT_GAP)
    builder.MakeFace(face, surface, settings.CONFUSION)
    low, high = (1.0 if not from_apex else 0.0), (1.0 if not to_apex else 0.0)
    if not (to_apex and from_apex):
        make_dense(bank.edge)
    put_on_face(bank.edge, _straight(first, last, (first, low), (last, high)), face)
    for border, u, base in ((to_apex, last, shape.poles[-1]), (from_apex, first, shape.poles[0])):
        for item in border:
            put_on_face(item.edge, on_ruling(item.shape, u, base, apex), face)
    along = Geom2d_Line(gp_Pnt2d(0.0, 1.0), gp_Dir2d(1.0, 0.0))
    tip = degenerated_edge(along, (first, last), vertex, face)
    builder.Add(face, make_wire((bank, *to_apex, tip, *from_apex)))
    return face


def _refined(shape: PoleCurve, apex: Floats, knots: Floats) -> Floats:
    """Returns the knots with others between them where the cone's normal turns too far.

    It does so where the bank comes near to pointing at the apex; its area per parameter then has
    all but a corner there.
    """
    for _ in range(settings.KNOT_HALVINGS):
        normal = cross_rows(shape.velocity_at(knots), apex - shape.point_at(knots))
        size = np.sqrt((normal * normal).sum(axis=1))
        dots = (normal[:-1] * normal[1:]).sum(axis=1)
        turns = dots < math.cos(settings.KNOT_TURN) * size[:-1] * size[1:]
        turns &= np.diff(knots) > 4.0 * settings.KNOT_GAP
        if not turns.any():
            break
        middles = (knots[:-1][turns] + knots[1:][turns]) / 2.0
        knots = np.sort(np.concatenate((knots, middles)))
    return knots


def _surface(
    shape: PoleCurve, apex: Floats, *, is_start: bool, is_end: bool
) -> Geom_BSplineSurface:
    degree, poles, weights = shape.degree, shape.poles, shape.weights
    knots, multiplicities = shape.knots, shape.multiplicities
    if is_start or is_end:
        degree, poles = _chord_poles(shape, apex, is_start=is_start)
        multiplicities = np.array([degree + 1, degree + 1])
    grid = np.stack((poles, np.broadcast_to(apex, poles.shape)), axis=1)
    both = None if weights is None else np.stack((weights, weights), axis=1)
    return make_surface(
        grid,
        (knots, np.array([0.0, 1.0])),
        (multiplicities, np.array([2, 2])),
        (degree, 1),
        both,
    )


def _chord_poles(shape: PoleCurve, apex: Floats, *, is_start: bool) -> tuple[int, Floats]:
    """Returns the poles of the curve (C - apex) / s + apex of a Bezier curve C that starts there.

    Its degree is one less. s runs from 0 to 1, from the apex: for a curve that ends at the apex,
    against the curve. A rational curve keeps its weights, and so its degree.
    """
    degree, weights = shape.degree, shape.weights
    away = shape.poles - apex
    if weights is not None:
        away = away * weights[:, None]
    rank = np.arange(degree)[:, None]
    if is_start:
        chords = away[1:] * (degree / (rank + 1.0))
    else:
        chords = away[:-1] * (degree / (degree - rank))
    if weights is None:
        return degree - 1, apex + chords
    share = np.arange(degree + 1)[:, None] / degree
    padded = np.concatenate((chords[:1], chords, chords[-1:]))
    return degree, apex + (share * padded[:-1] + (1.0 - share) * padded[1:]) / weights[:, None]


def _straight(
    first: float, last: float, start: tuple[float, float], end: tuple[float, float]
) -> Geom2d_Line | Geom2d_BSplineCurve:
    """Returns the line between two places in the parameters over the interval of an edge."""
    if start[1] == end[1] and start[0] == first and end[0] == last:
        return Geom2d_Line(gp_Pnt2d(0.0, start[1]), gp_Dir2d(1.0, 0.0))
    knots, multiplicities = np.array([first, last]), np.array([2, 2])
    return make_curve_2d(np.array([start, end]), knots, multiplicities, 1)

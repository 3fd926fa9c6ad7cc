"""Planar faces from shared edges; a plane needs no curves in its parameters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Plane
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Face, TopoDS_Wire

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.strip.portable import dot, norm

from .face_borders import Border, border_poles

Floats = NDArray[np.float64]


def make_wire(loop: Border) -> TopoDS_Wire:
    """Returns the closed wire of a loop of shared edges."""
    builder, wire = BRep_Builder(), TopoDS_Wire()
    builder.MakeWire(wire)
    for item in loop:
        builder.Add(
            wire, item.edge.Oriented(TopAbs_FORWARD if item.is_forward else TopAbs_REVERSED)
        )
    wire.Closed(True)
    return wire


def plane_face(loop: Border, normal: Floats | None = None) -> TopoDS_Face:
    """Returns the planar face inside a loop, which runs counter-clockwise seen from outside.

    Args:
        loop: its edges.
        normal: (3,); to the outside. By default it is that of the polygon of the edges' poles.
    """
    poles = border_poles(loop)
    normal = loop_normal(poles) if normal is None else normal
    along = poles[1] - poles[0]
    along = along if along.any() else poles[-1] - poles[0]
    axes = gp_Ax3(gp_Pnt(*poles[0].tolist()), gp_Dir(*normal.tolist()), gp_Dir(*along.tolist()))
    builder, face = BRep_Builder(), TopoDS_Face()
    builder.MakeFace(face, Geom_Plane(axes), settings.CONFUSION)
    builder.Add(face, make_wire(loop))
    return face


def loop_normal(poles: Floats) -> Floats:
    """Returns (3,) mm^2: twice the area vector of the closed polygon through (k, 3) mm."""
    here, there = poles[1:-1] - poles[0], poles[2:] - poles[0]
    normal: Floats = cross_rows(here, there).sum(axis=0)
    return normal


def cross_rows(first: Floats, second: Floats) -> Floats:
    """Returns (k, 3): the cross products of (k, 3) rows, without np.cross's 50 microseconds."""
    x, y, z = first.T
    a, b, c = second.T
    return np.stack((y * c - z * b, z * a - x * c, x * b - y * a), axis=1)


def is_plane_sector(curve: PoleCurve, apex: Floats) -> bool:
    """Tells whether a curve and an apex bound a simple region of a plane.

    Args:
        curve: the curve; if it turns back somewhere, but by less than a thirtieth of a span,
            that is not seen.
        apex: (3,) mm; may be the curve's start or end.

    Returns:
        Whether all poles and the apex lie in one plane and the curve turns one way about the apex.
    """
    if len(curve.poles) == 2:
        return True
    spokes = _spokes(curve.poles, apex)
    turns = np.cross(spokes[:-1], spokes[1:])
    normal = turns.sum(axis=0)
    size = norm(normal)
    if size == 0.0 or np.abs(dot(spokes, normal)).max() > settings.PLANE_GAP * size:
        return False
    if (dot(turns, normal) > 0.0).all():
        # A B-spline crosses no line more often than the polygon of its poles does.
        return True
    share = np.linspace(0.0, 1.0, 33)[:-1, None]
    along = ((1.0 - share) * curve.knots[:-1] + share * curve.knots[1:]).T.ravel()
    spokes = _spokes(curve.point_at(np.append(along, curve.knots[-1])), apex)
    return bool((dot(np.cross(spokes[:-1], spokes[1:]), normal) > 0.0).all())


def _spokes(points: Floats, apex: Floats) -> Floats:
    """Returns (k, 3) mm from an apex to points, without an end point that is the apex."""
    spokes = points - apex
    return spokes[0 if spokes[0].any() else 1 : None if spokes[-1].any() else -1]

"""Curves as polylines: how a curve comes through a map that moves points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakePolygon
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_EDGE, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Iterator, TopoDS_Shape, TopoDS_Wire

from .curves import edge_curve
from .evaluation import PoleCurve
from .splines import curve_arrays
from .steps import kernel_step
from .topology import as_edge, wires_of

Floats = NDArray[np.float64]
Carry = Callable[[Floats], Floats]
"""From (k, 3) mm to (k, d) mm."""

FIRST_POINTS: Final = 4
"""Points that each span of a curve begins with."""
HALVINGS: Final = 10
"""Chords are halved so often at most."""


def outlines_of(shape: TopoDS_Shape) -> list[list[TopoDS_Edge]]:
    """Returns the edges of a shape, wire by wire; each edge outside wires is a row of its own."""
    rows = [_edges_in(wire) for wire in wires_of(shape)]
    loose = TopExp_Explorer(shape, TopAbs_EDGE, TopAbs_WIRE)
    while loose.More():
        rows.append([as_edge(loose.Current())])
        loose.Next()
    return rows


def _edges_in(wire: TopoDS_Wire) -> list[TopoDS_Edge]:
    held, edges = TopoDS_Iterator(wire), []
    while held.More():
        edges.append(as_edge(held.Value()))
        held.Next()
    return edges[::-1] if wire.Orientation() == TopAbs_REVERSED else edges


def carried(edges: Sequence[TopoDS_Edge], carry: Carry, tolerance: float) -> Floats:
    """Returns (k, d) mm: the polyline that edges in a row become under a map.

    Args:
        edges: each begins where the one before it ends.
        carry: the map.
        tolerance: mm; how far the polyline may be off the mapped edges, about.
    """
    rows = [_carried_edge(edge, carry, tolerance) for edge in edges]
    return np.concatenate([rows[0], *(row[1:] for row in rows[1:])])


def _carried_edge(edge: TopoDS_Edge, carry: Carry, tolerance: float) -> Floats:
    drawn = edge_curve(edge)
    poles, weights, knots, multiplicities = curve_arrays(drawn)
    curve = PoleCurve(drawn.Degree(), knots, multiplicities, poles, weights)
    share = np.arange(FIRST_POINTS) / FIRST_POINTS
    at = np.append((knots[:-1, None] + np.diff(knots)[:, None] * share).ravel(), knots[-1])

    def points(parameters: Floats) -> Floats:
        return carry(curve.point_at(parameters))

    moved = points(at)
    for _ in range(HALVINGS):
        middle = (at[:-1] + at[1:]) / 2.0
        between = points(middle)
        gap = np.sqrt(((between - (moved[:-1] + moved[1:]) / 2.0) ** 2).sum(axis=1))
        far = np.flatnonzero(gap > tolerance)
        if not far.size:
            break
        at = np.insert(at, far + 1, middle[far])
        moved = np.insert(moved, far + 1, between[far], axis=0)
    return moved


def polyline_wire(points: Floats) -> TopoDS_Wire:
    """Returns the wire through (k, 3) mm, closed if it ends where it starts."""
    is_closed = bool(np.abs(points[-1] - points[0]).max() <= 1e-9)
    builder = BRepBuilderAPI_MakePolygon()
    with kernel_step("draw a polyline"):
        for x, y, z in points[: -1 if is_closed else None].tolist():
            builder.Add(gp_Pnt(x, y, z))
        if is_closed:
            builder.Close()
        return builder.Wire()

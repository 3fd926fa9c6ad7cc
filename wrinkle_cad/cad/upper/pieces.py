"""Tells which pieces of a split upper lie in which opening.

A piece lies in an opening if it is on the inner side of its outline at each of the edges that the
outline cut, or joins such a piece without crossing the outline.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GeomLProp import GeomLProp_SLProps
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_middle
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import dot, norm

from .opening_outline import Side, unit
from .opening_plan import OpeningPlan

Floats = NDArray[np.float64]
STEP = "split the upper"


@dataclass(frozen=True, slots=True, eq=False)
class CutEdge:
    """An edge that the outline cut into the upper."""

    edge: TopoDS_Edge
    """Oriented along its side."""
    side: int
    """Index of the side."""
    at: float
    """Where its middle stands along the side, in samples."""


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """The pieces of an upper."""

    pieces: tuple[tuple[TopoDS_Face, ...], ...]
    """Per face of the upper: what has become of it."""
    inside: tuple[tuple[int, ...], ...]
    """Per piece: the index of the opening that it lies in, -1 for none."""
    cuts: tuple[tuple[CutEdge, ...], ...]
    """Per opening: all edges along its outline, in order along each side."""


@dataclass(frozen=True, slots=True, eq=False)
class _WayIn:
    """The way from an edge into a piece beside it."""

    point: Floats
    """(3,) mm, the edge's middle."""
    into: Floats
    """(3,) unit vector along the piece, away from the edge."""
    inward: Floats
    """(3,) unit vector along the upper, into the opening."""


class _Outlines:
    """The sides of all openings, ready to be asked for the nearest one to a point."""

    def __init__(self, plans: Sequence[OpeningPlan]) -> None:
        self._sides = [
            (k, i, side) for k, plan in enumerate(plans) for i, side in enumerate(plan.sides)
        ]
        self._low = np.array([side.points.min(axis=0) for _, _, side in self._sides])
        self._high = np.array([side.points.max(axis=0) for _, _, side in self._sides])

    def nearest(self, point: Floats) -> tuple[int, int, Side, float]:
        """Returns opening, index of the side, the side, and the place on it in samples."""
        reach = np.maximum(np.maximum(self._low - point, point - self._high), 0.0)
        away = np.linalg.norm(reach, axis=1)
        best, found = np.inf, (0, 0, self._sides[0][2], 0.0)
        for j in np.argsort(away, kind="stable"):
            if away[j] > best:
                break
            k, i, side = self._sides[j]
            distance, at = position_on(side.points, point)
            if (distance, k, i) < (best, *found[:2]):
                best, found = distance, (k, i, side, at)
        return found


def sorted_pieces(
    pieces: tuple[tuple[TopoDS_Face, ...], ...],
    section: ShapeIndex,
    plans: Sequence[OpeningPlan],
) -> Split:
    """Returns which pieces lie in which opening, and the edges along its outline.

    Args:
        pieces: per face of the upper.
        section: all edges that the outlines cut.
        plans: of the openings.

    Raises:
        CadError: a piece lies on both sides of an outline.
        InputError: an opening lies in another.
    """
    flat = [piece for group in pieces for piece in group]
    face_of = [i for i, group in enumerate(pieces) for _ in group]
    votes: list[dict[int, list[float]]] = [{} for _ in flat]
    cuts: dict[int, tuple[int, CutEdge]] = {}
    joined, outlines = ShapeIndex(), _Outlines(plans)
    neighbours: dict[int, list[int]] = {}
    parted: list[dict[int, list[int]]] = [{} for _ in plans]
    ways: dict[int, list[_WayIn]] = {}
    for i, piece in enumerate(flat):
        for edge in oriented_edges(piece):
            found = section.find(edge)
            if found < 0:
                neighbours.setdefault(joined.add(edge), []).append(i)
            elif edge.Orientation() in (TopAbs_FORWARD, TopAbs_REVERSED):
                of, cut, way = _cut_edge(edge, piece, outlines)
                cuts[found] = of, cut
                ways.setdefault(found, []).append(way)
                parted[of].setdefault(found, []).append(i)
    for found, (of, cut) in cuts.items():
        beside = parted[of].get(found, [])
        inward = _inward(ways[found], [face_of[i] for i in beside], plans[of], cut.side)
        for i, vote in zip(beside, inward, strict=False):
            votes[i].setdefault(of, []).append(vote)
    inside = [-1] * len(flat)
    for k in range(len(plans)):
        # Only its own outline parts an opening from what lies around it.
        others = [group for j, own in enumerate(parted) if j != k for group in own.values()]
        decided = _decide(
            [cast.get(k, []) for cast in votes], [*neighbours.values(), *others], flat
        )
        for i, is_in in enumerate(decided):
            if is_in and inside[i] >= 0:
                raise _nested(plans, inside[i], k)
            inside[i] = k if is_in else inside[i]
    ordered = sorted(cuts.values(), key=lambda cut: (cut[0], cut[1].side, cut[1].at))
    grouped, at = [], 0
    for group in pieces:
        grouped.append(tuple(inside[at : at + len(group)]))
        at += len(group)
    per_plan = tuple(tuple(cut for of, cut in ordered if of == k) for k in range(len(plans)))
    return Split(pieces, tuple(grouped), per_plan)


def _nested(plans: Sequence[OpeningPlan], first: int, second: int) -> InputError:
    inner, outer = sorted((plans[first], plans[second]), key=_span)
    x, y, z = inner.rails[0].points[len(inner.rails[0].points) // 2]
    return InputError(
        f"{inner.heading}, at ({x:.1f}, {y:.1f}, {z:.1f}) mm, lies"
        f" inside {outer.title}. Each wrinkle needs a place of its own: move the rails of one out"
        " of the other."
    )


def _span(plan: OpeningPlan) -> float:
    return norm(np.ptp(plan.points, axis=0))


def _decide(
    votes: Sequence[Sequence[float]],
    joints: Sequence[Sequence[int]],
    pieces: Sequence[TopoDS_Face],
) -> list[bool]:
    """Returns which pieces lie inside: by their own edges, or else as the pieces they join."""
    known: dict[int, bool] = {}
    for i, cast in enumerate(votes):
        if not cast:
            continue
        inner = sum(vote > 0.0 for vote in cast)
        if 0 < inner < len(cast):
            place = place_text(edge_middle(edges_of(pieces[i])[0]), 0.0)
            raise CadError(
                STEP,
                f"a piece at {place} has {inner} of its {len(cast)} new edges on the inner side of"
                " the opening, neither all nor none. Keep the outline away from folds and borders"
                " of the upper, or change the margin.",
            )
        known[i] = inner > 0
    grown = True
    while grown:
        grown = False
        for group in joints:
            decided = [known[i] for i in group if i in known]
            if decided and len(decided) < len(group):
                known.update(dict.fromkeys(group, decided[0]))
                grown = True
    return [known.get(i, False) for i in range(len(votes))]


def oriented_edges(face: TopoDS_Face) -> list[TopoDS_Edge]:
    """Returns the edges of a face as its wires run, a seam twice, degenerated ones left out."""
    found, edges = [], TopExp_Explorer(face, TopAbs_EDGE)
    while edges.More():
        edge = as_edge(edges.Current())
        if not BRep_Tool.Degenerated_s(edge):
            found.append(edge)
        edges.Next()
    return found


def _cut_edge(
    edge: TopoDS_Edge, piece: TopoDS_Face, outlines: _Outlines
) -> tuple[int, CutEdge, _WayIn]:
    """Returns whose it is, its place on the outline, and the way from it into the piece."""
    point, tangent, normal = edge_frame(edge, piece)
    if edge.Orientation() == TopAbs_REVERSED:
        tangent = -tangent
    material = np.cross(normal, tangent)
    of, i, side, at = outlines.nearest(point)
    j = min(int(at), len(side.points) - 2)
    along = float(dot(tangent, side.points[j + 1] - side.points[j])) > 0.0
    forward = edge if along else as_edge(edge.Reversed())
    return of, CutEdge(forward, i, at), _WayIn(point, material, side.inward[round(at)])


def _inward(
    ways: Sequence[_WayIn], faces: Sequence[int], plan: OpeningPlan, side: int
) -> list[float]:
    """Returns for each piece beside an edge whether it lies inward of it: positive if so.

    An outline may run along an edge between two faces of the upper, a sharp one too: of the two
    pieces that one lies inside through which the way leads towards the other rail.
    """
    if len(set(faces)) < 2 or side > 1:
        return [float(dot(way.into, way.inward)) for way in ways]
    rail = plan.rails[1 - side].points
    away = rail - ways[0].point
    target = away[(away**2).sum(axis=1).argmin()]
    shares = [float(dot(way.into, target)) for way in ways]
    return [2.0 * share - sum(shares) for share in shares]


def edge_frame(edge: TopoDS_Edge, face: TopoDS_Face) -> tuple[Floats, Floats, Floats]:
    """Returns the middle of an edge (3,) mm, its unit tangent and the face's outward normal there.

    The tangent is that of the edge's curve, whatever the orientation of the edge.
    """
    adaptor = BRepAdaptor_Curve(edge)
    at = 0.5 * (adaptor.FirstParameter() + adaptor.LastParameter())
    point, velocity = gp_Pnt(), gp_Vec()
    adaptor.D1(at, point, velocity)
    pcurve = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 1.0)
    uv = pcurve.Value(at)
    measured = GeomLProp_SLProps(BRep_Tool.Surface_s(face), uv.X(), uv.Y(), 1, settings.CONFUSION)
    direction = measured.Normal()
    normal = np.array([direction.X(), direction.Y(), direction.Z()])
    if face.Orientation() == TopAbs_REVERSED:
        normal = -normal
    tangent = unit(np.array([[velocity.X(), velocity.Y(), velocity.Z()]]))[0]
    return np.array([point.X(), point.Y(), point.Z()]), tangent, normal


def position_on(line: Floats, point: Floats) -> tuple[float, float]:
    """Returns the distance in mm of a point from a polyline (k, 3), and where, in vertices."""
    found = nearest_on_polyline(point[None], line)
    return float(found.distance[0]), int(found.segment[0]) + float(found.share[0])

"""Cuts the faces of an upper along an outline and tells which pieces lie inside.

An outline on one face is drawn onto it. Any other becomes narrow ribbons that stand on the upper,
one per side, which cross seams, gaps and borders without being told of them. The kernel splits the
faces with these edges or ribbons. A piece lies inside if it is on the inner side of the outline at
each of its new edges, or joins such a piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.GeomLProp import GeomLProp_SLProps
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.splines import make_surface
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import as_edge, as_face
from wrinkle_cad.cad.kernel.versions import shape_list
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.portable import dot, norm

from .drawn_edges import drawn_edges
from .opening_outline import Side, unit

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
    is_inside: tuple[tuple[bool, ...], ...]
    """Per piece: whether it lies inside the outline."""
    cuts: tuple[CutEdge, ...]
    """All edges along the outline, in order along each side."""


def split_faces(
    faces: Sequence[TopoDS_Face],
    upper: TopoDS_Shape,
    sides: Sequence[Side],
    height: float,
    overrun: Sequence[tuple[float, float]],
) -> Split:
    """Splits the faces of an upper along the sides of an outline.

    Args:
        faces: of the upper.
        upper: holds them.
        sides: p, q and the ends.
        height: mm; how far ribbons stand out on both sides of the upper.
        overrun: per side, mm by which its ribbon runs on beyond its start and its end.

    Raises:
        CadError: the kernel cannot split, or a piece lies on both sides of the outline.
    """
    with kernel_step(STEP):
        drawn = _drawn(faces, sides, overrun)
        tools = drawn or [
            _ribbon(side, height, over) for side, over in zip(sides, overrun, strict=True)
        ]
        splitter = BRepAlgoAPI_Splitter()
        splitter.SetArguments(shape_list([upper]))
        splitter.SetTools(shape_list(tools))
        splitter.SetNonDestructive(True)
        splitter.SetRunParallel(False)
        splitter.Build()
        if not splitter.IsDone():
            raise CadError(STEP, "the kernel's splitter failed. Move the rails a little.")
        pieces = tuple(_pieces_of(splitter, face) for face in faces)
        section = ShapeIndex(splitter.SectionEdges())
        for edge in drawn or ():
            for part in list(splitter.Modified(edge)) or [edge]:
                section.add(part)
    return _sorted(pieces, section, sides)


def _drawn(
    faces: Sequence[TopoDS_Face], sides: Sequence[Side], overrun: Sequence[tuple[float, float]]
) -> list[TopoDS_Edge] | None:
    """Returns the outline as edges on the face that holds all of it, None if none does."""
    owners = np.unique(np.concatenate([side.faces for side in sides]))
    if len(owners) > 1 or any(max(over) > 0.0 for over in overrun):
        return None
    return drawn_edges(faces[int(owners[0])], sides)


def _pieces_of(splitter: BRepAlgoAPI_Splitter, face: TopoDS_Face) -> tuple[TopoDS_Face, ...]:
    if splitter.IsDeleted(face):
        return ()
    pieces = tuple(as_face(piece.Oriented(face.Orientation())) for piece in splitter.Modified(face))
    return pieces or (face,)


def _ribbon(side: Side, height: float, overrun: tuple[float, float]) -> TopoDS_Face:
    points, normals = side.points, side.normals
    for first, extra in ((True, overrun[0]), (False, overrun[1])):
        if extra > 0.0:
            points, normals = _extended(points, normals, first, extra)
    arc = arc_lengths(points)
    rows = np.stack((points - height * normals, points + height * normals), axis=1)
    spline = cubic_through(arc, rows.reshape(len(rows), 6))
    knots, counts = np.unique(spline.knots, return_counts=True)
    surface = make_surface(
        spline.poles.reshape(-1, 2, 3), (knots, (0.0, 2.0 * height)), (counts, (2, 2)), (3, 1)
    )
    return BRepBuilderAPI_MakeFace(surface, settings.CONFUSION).Face()


def _extended(points: Floats, normals: Floats, first: bool, extra: float) -> tuple[Floats, Floats]:
    """Runs a side on beyond one end, straight, in steps as long as its own."""
    sense = 1 if first else -1
    run, turn = points[::sense], normals[::sense]
    step = norm(run[1] - run[0])
    direction = unit((run[0] - run[2])[None])[0]
    count = max(2, int(np.ceil(extra / step)))
    beyond = run[0] + np.arange(count, 0, -1)[:, None] * (extra / count) * direction
    grown = np.vstack((beyond, run))
    turned = np.vstack((np.repeat(turn[:1], count, axis=0), turn))
    return grown[::sense], turned[::sense]


def _sorted(
    pieces: tuple[tuple[TopoDS_Face, ...], ...],
    section: ShapeIndex,
    sides: Sequence[Side],
) -> Split:
    flat = [piece for group in pieces for piece in group]
    votes: list[list[float]] = [[] for _ in flat]
    cuts: dict[int, CutEdge] = {}
    joined = ShapeIndex()
    neighbours: dict[int, list[int]] = {}
    for i, piece in enumerate(flat):
        for edge in oriented_edges(piece):
            found = section.find(edge)
            if found < 0:
                neighbours.setdefault(joined.add(edge), []).append(i)
            elif edge.Orientation() in (TopAbs_FORWARD, TopAbs_REVERSED):
                cut, inward = _cut_edge(edge, piece, sides)
                cuts[found] = cut
                votes[i].append(inward)
    inside = _decide(votes, list(neighbours.values()))
    ordered = sorted(cuts.values(), key=lambda cut: (cut.side, cut.at))
    grouped, at = [], 0
    for group in pieces:
        grouped.append(tuple(inside[at : at + len(group)]))
        at += len(group)
    return Split(pieces, tuple(grouped), tuple(ordered))


def _decide(votes: Sequence[Sequence[float]], joints: Sequence[Sequence[int]]) -> list[bool]:
    """Returns which pieces lie inside: by their own edges, or else as the pieces they join."""
    known: dict[int, bool] = {}
    for i, cast in enumerate(votes):
        if not cast:
            continue
        inner = sum(vote > 0.0 for vote in cast)
        if 0 < inner < len(cast):
            raise CadError(
                STEP,
                f"a piece has {inner} of its {len(cast)} new edges on the inner side of the"
                " opening, neither all nor none. Keep the outline away from folds and borders of"
                " the upper, or change the margin.",
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
    edge: TopoDS_Edge, piece: TopoDS_Face, sides: Sequence[Side]
) -> tuple[CutEdge, float]:
    """Returns the edge in its place on the outline, and how far the piece lies inward of it."""
    point, tangent, normal = edge_frame(edge, piece)
    if edge.Orientation() == TopAbs_REVERSED:
        tangent = -tangent
    material = np.cross(normal, tangent)
    places = [position_on(side.points, point) for side in sides]
    i = int(np.argmin([distance for distance, _ in places]))
    side, at = sides[i], places[i][1]
    j = min(int(at), len(side.points) - 2)
    along = float(dot(tangent, side.points[j + 1] - side.points[j])) > 0.0
    forward = edge if along else as_edge(edge.Reversed())
    return CutEdge(forward, i, at), float(dot(material, side.inward[round(at)]))


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

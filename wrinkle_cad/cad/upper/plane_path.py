"""The way along an upper from one point to another in a plane, over sharp edges too."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import edges_of, make_compound
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import arc_lengths, points_at
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]
EDGE_POINTS = 33
"""Each edge of the section is followed by so many points."""


def path_in_plane(
    faces: Sequence[TopoDS_Face], start: Floats, end: Floats, across: Floats, count: int
) -> Floats | None:
    """Returns the shortest way from one point to another along the section of faces by a plane.

    Args:
        faces: near both points.
        start: (3,) mm, on a face.
        end: (3,) mm, on a face.
        across: (3,) the plane's normal; the plane holds both points.
        count: of the points returned, evenly spaced.

    Returns:
        (count, 3) mm; None where the section does not lead from one to the other.
    """
    lines = [_points_along(edge) for edge in _section(faces, start, across)]
    nodes, links = list[Floats](), dict[int, list[tuple[float, int, Floats]]]()

    def node(point: Floats) -> int:
        for i, known in enumerate(nodes):
            if norm(known - point) <= settings.SEWING:
                return i
        nodes.append(point)
        return len(nodes) - 1

    first, last = node(start), node(end)
    for line in lines:
        for part in _parted(line, (start, end)):
            a, b, length = node(part[0]), node(part[-1]), float(arc_lengths(part)[-1])
            links.setdefault(a, []).append((length, b, part))
            links.setdefault(b, []).append((length, a, part[::-1]))
    way = _shortest(links, first, last)
    if way is None:
        return None
    path = np.vstack([start[None], *[part[1:] for part in way]])
    path[-1] = end
    arc = arc_lengths(path)
    return points_at(path, arc, np.linspace(0.0, arc[-1], count))


def _section(faces: Sequence[TopoDS_Face], point: Floats, across: Floats) -> list[TopoDS_Edge]:
    with kernel_step("cut the upper by the plane of an end"):
        plane = gp_Pln(gp_Pnt(*point.tolist()), gp_Dir(*across.tolist()))
        section = BRepAlgoAPI_Section(make_compound(list(faces)), plane, False)
        section.Approximation(False)
        section.Build()
        return edges_of(section.Shape())


def _points_along(edge: TopoDS_Edge) -> Floats:
    curve = BRepAdaptor_Curve(edge)
    found = []
    for at in np.linspace(curve.FirstParameter(), curve.LastParameter(), EDGE_POINTS).tolist():
        point = curve.Value(at)
        found.append((point.X(), point.Y(), point.Z()))
    return np.array(found)


def _parted(line: Floats, ends: Sequence[Floats]) -> list[Floats]:
    """Returns a line, parted where it passes one of two points."""
    cuts = []
    for point in ends:
        found = nearest_on_polyline(point[None], line)
        # The chords of a curved section pass it at some distance.
        chord = 0.1 * norm(line[1] - line[0]) + settings.SEWING
        if found.distance[0] <= chord:
            cuts.append((float(found.segment[0]) + float(found.share[0]), point))
    parts, rest, passed = [], line, 0.0
    for at, point in sorted(cuts, key=lambda cut: cut[0]):
        index = int(at - passed)
        head = np.vstack((rest[: index + 1], point))
        if len(head) > 1 and norm(head[0] - point) > settings.SEWING:
            parts.append(head)
        rest, passed = np.vstack((point, rest[index + 1 :])), passed + index
    if len(rest) > 1:
        parts.append(rest)
    return parts


def _shortest(
    links: dict[int, list[tuple[float, int, Floats]]], first: int, last: int
) -> list[Floats] | None:
    """Returns the parts of the shortest way between two nodes (Dijkstra)."""
    best: dict[int, tuple[float, int, Floats]] = {}
    queue: list[tuple[float, int]] = [(0.0, first)]
    known = {first: 0.0}
    while queue:
        length, here = heapq.heappop(queue)
        if here == last:
            break
        for step, there, part in links.get(here, []):
            if length + step < known.get(there, np.inf):
                known[there] = length + step
                best[there] = (length + step, here, part)
                heapq.heappush(queue, (length + step, there))
    if last not in best:
        return None
    way, here = [], last
    while here != first:
        _, before, part = best[here]
        way.append(part)
        here = before
    return way[::-1]

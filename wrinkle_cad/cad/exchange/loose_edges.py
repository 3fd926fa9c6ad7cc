"""Loose edges -> wires: a wire that went through a STEP file comes back as separate edges."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeWire
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape, TopoDS_Wire

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import vertex_point

_NEIGHBOURS: Final = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))


def chain_edges(edges: Sequence[TopoDS_Edge]) -> list[tuple[int, TopoDS_Shape]]:
    """Joins edges end to end where exactly two of them meet, within ``settings.RAIL_GAP``.

    Args:
        edges: in any order and direction.

    Returns:
        Wires, and edges that meet no other, each with the index of its first edge, in that order.
        Where three or more edges meet, all of them end.
    """
    chains = edge_chains(edges, settings.RAIL_GAP)
    return [(min(chain), _joined([edges[i] for i in chain])) for chain in chains]


def edge_chains(edges: Sequence[TopoDS_Edge], gap: float) -> list[list[int]]:
    """Returns which edges follow one another, end to end, where exactly two of them meet.

    Args:
        edges: in any order and direction.
        gap: mm; ends no further apart than this meet.

    Returns:
        Indices of the edges, those of one chain from its one end to its other.
    """
    nodes = _nodes(edges, gap)
    at_node: dict[int, list[int]] = defaultdict(list)
    for i, ends in enumerate(nodes):
        for node in ends:
            at_node[node].append(i)
    left = set(range(len(edges)))
    chains = []
    for i in range(len(edges)):
        if i in left:
            chains.append(_chain_through(i, nodes, at_node, left))
    return chains


def _nodes(edges: Sequence[TopoDS_Edge], gap: float) -> list[tuple[int, int]]:
    """Numbers the distinct end points; returns the two numbers of each edge."""
    points = [
        vertex_point(vertex)
        for edge in edges
        for vertex in (TopExp.FirstVertex_s(edge, True), TopExp.LastVertex_s(edge, True))
    ]
    # Cells of one gap's width: whatever is near lies in the same or in a neighbouring cell.
    cells: dict[tuple[float, ...], list[int]] = defaultdict(list)
    numbers: list[int] = []
    for i, point in enumerate(points):
        home = np.floor(point / gap)
        around = (tuple(home + step) for step in _NEIGHBOURS)
        near = [j for cell in around for j in cells.get(cell, ()) if _apart(points, i, j) <= gap]
        if not near:
            cells[tuple(home)].append(i)
        numbers.append(min(near, default=i))
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def _apart(points: list[NDArray[np.float64]], i: int, j: int) -> float:
    return math.dist(points[i], points[j])


def _chain_through(
    start: int, nodes: list[tuple[int, int]], at_node: dict[int, list[int]], left: set[int]
) -> list[int]:
    """Takes the whole chain that an edge belongs to out of ``left``, from one end to the other."""
    left.discard(start)
    first, last = nodes[start]
    after = _walk(last, nodes, at_node, left)
    before = _walk(first, nodes, at_node, left)
    return [*reversed(before), start, *after]


def _walk(
    node: int, nodes: list[tuple[int, int]], at_node: dict[int, list[int]], left: set[int]
) -> list[int]:
    found: list[int] = []
    while len(at_node[node]) == 2:
        following = [i for i in at_node[node] if i in left]
        if not following:
            break
        left.discard(following[0])
        found.append(following[0])
        ends = nodes[following[0]]
        node = ends[1] if ends[0] == node else ends[0]
    return found


def _joined(edges: list[TopoDS_Edge]) -> TopoDS_Shape:
    if len(edges) == 1:
        return edges[0]
    with kernel_step("join the edges of a curve"):
        maker = BRepBuilderAPI_MakeWire()
        for edge in edges:
            maker.Add(edge)
            if not maker.IsDone():
                return _as_they_are(edges)
        return maker.Wire()


def _as_they_are(edges: list[TopoDS_Edge]) -> TopoDS_Wire:
    """Returns a wire whose edges do not share vertices: the kernel joins exact ends only."""
    wire, builder = TopoDS_Wire(), BRep_Builder()
    builder.MakeWire(wire)
    for edge in edges:
        builder.Add(wire, edge)
    return wire

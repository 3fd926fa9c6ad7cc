"""Which faces hang together, and the stretches of border between two points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Shell

from wrinkle_cad.strip.portable import norm

from .curves import edge_ends
from .shape_index import ShapeIndex
from .topology import as_edge, edges_of, make_compound

Floats = NDArray[np.float64]


def connected_groups(faces: Sequence[TopoDS_Face]) -> list[list[int]]:
    """Returns the indices of the faces that hang together by shared edges, in order."""
    group_of = list(range(len(faces)))

    def root(i: int) -> int:
        while group_of[i] != i:
            group_of[i] = group_of[group_of[i]]
            i = group_of[i]
        return i

    seen, first = ShapeIndex(), list[int]()
    for i, face in enumerate(faces):
        for edge in edges_of(face):
            if BRep_Tool.Degenerated_s(edge):
                continue
            at = seen.add(edge)
            if at == len(first):
                first.append(i)
            else:
                a, b = sorted((root(i), root(first[at])))
                group_of[b] = a
    groups: dict[int, list[int]] = {}
    for i in range(len(faces)):
        groups.setdefault(root(i), []).append(i)
    return list(groups.values())


def joined_faces(faces: Sequence[TopoDS_Face]) -> TopoDS_Shape:
    """Returns a shell of the faces, or a compound of one shell per group that hangs together."""
    shells = []
    for group in connected_groups(faces):
        shell, builder = TopoDS_Shell(), BRep_Builder()
        builder.MakeShell(shell)
        for i in group:
            builder.Add(shell, faces[i])
        shells.append(shell)
    return shells[0] if len(shells) == 1 else make_compound(shells)


def border_chain(
    edges: Sequence[TopoDS_Edge], start: Floats, end: Floats
) -> tuple[TopoDS_Edge, ...]:
    """Returns the edges that lead from one point (3,) mm to another, oriented that way.

    Each next edge is the one that starts or ends nearest to where the chain stands; the chain ends
    with the edge that comes nearest to the end point.
    """
    left = [(edge, edge_ends(edge)) for edge in edges]
    chain: list[TopoDS_Edge] = []
    here, best, length = start, np.inf, 0
    while left:
        gaps = [(norm(ends[k] - here), i, k) for i, (_, ends) in enumerate(left) for k in (0, 1)]
        _, i, k = min(gaps)
        edge, ends = left.pop(i)
        chain.append(edge if k == 0 else as_edge(edge.Reversed()))
        here = ends[1 - k]
        if norm(here - end) < best:
            best, length = norm(here - end), len(chain)
    return tuple(chain[:length])

"""Curves of a file with gaps between them -> the curves that they were meant to be.

Edges that meet are one curve when a file is read. Wider gaps are closed only where somebody asks
for it, and then only between the candidates for one role.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, product
from typing import Final

from OCP.TopExp import TopExp

from wrinkle_cad.cad.kernel.topology import edges_of, make_compound, vertex_point
from wrinkle_cad.strip.portable import norm

from .loose_edges import edge_chains
from .shapes import NamedShape

_MOST_CURVES: Final = 200
_HINTED: Final = 0.02
"""A gap of at most this share of the shortest curve looks like one that nobody meant."""


def joined_curves(curves: Sequence[NamedShape], join: float) -> list[NamedShape]:
    """Returns the curves, those in one whose ends are near enough, in the file's order.

    Args:
        curves: the candidates.
        join: mm; exactly two ends that are no further apart than this belong together. Nothing is
            joined when it is 0.

    Returns:
        Joined curves have the number, the name and the holders of their first one.
    """
    if not join > 0.0 or len(curves) < 2:
        return list(curves)
    edges = [(i, edge) for i, curve in enumerate(curves) for edge in edges_of(curve.shape)]
    chains = edge_chains([edge for _, edge in edges], join)
    members = [sorted({edges[at][0] for at in chain}) for chain in chains]
    if sum(map(len, members)) != len(curves):
        return list(curves)  # a curve of several edges went to pieces: ends meet inside it
    return [_one([curves[i] for i in group]) for group in sorted(members)]


def _one(curves: list[NamedShape]) -> NamedShape:
    if len(curves) == 1:
        return curves[0]
    return replace(
        curves[0],
        kind="wire",
        shape=make_compound(curve.shape for curve in curves),
        measure=sum(curve.measure for curve in curves),
        parts=tuple(curve.index for curve in curves),
    )


def gap_hint(curves: Sequence[NamedShape], count: int) -> str:
    """Returns a sentence on the gap that keeps curves from being fewer; empty if it is no slip.

    Args:
        curves: the candidates.
        count: how many they should be.
    """
    if not count < len(curves) <= _MOST_CURVES:
        return ""
    # The largest of the gaps is the smallest possible one if the narrowest are closed first.
    group = list(range(len(curves)))
    for gap, i, j in sorted(_gaps(curves)):
        if group[i] != group[j]:
            group = [group[i] if one == group[j] else one for one in group]
        if len(set(group)) == count:
            is_slip = gap <= _HINTED * min(curve.measure for curve in curves)
            return f" Gaps of {gap:.3g} mm are closed with --join {2 * gap:.2g}." if is_slip else ""
    return ""


def _gaps(curves: Sequence[NamedShape]) -> list[tuple[float, int, int]]:
    """Returns mm between the nearest ends of each two curves, and which these are."""
    ends = [
        [
            vertex_point(vertex)
            for edge in edges_of(curve.shape)
            for vertex in (TopExp.FirstVertex_s(edge, True), TopExp.LastVertex_s(edge, True))
        ]
        for curve in curves
    ]
    return [
        (min(norm(a - b) for a, b in product(ends[i], ends[j])), i, j)
        for i, j in combinations(range(len(curves)), 2)
    ]

"""From the bridges of a triangulation to the pairing of least twist near them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.curve.nearest import nearest_on_polyline

from .nodes import Nodes, place_nodes
from .pairing import corridor, pair_nodes
from .rail_curve import RailCurve
from .vectors import crosses, lengths

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.int8]

NODES: Final = 256
"""A strip's first grid has so many nodes on a rail of mean length ..."""
NODES_ACROSS: Final = 8
"""... or so many in a stretch as long as its median ruling, if that is more ..."""
MOST_NODES: Final = 2048
"""... but no more than this."""
FINER: Final = 4
"""Each grid is so many times finer than the one before."""
REACH_PER_BRIDGE: Final = 1.5
"""Rulings are sought so far beside the bridges, in shares of a bridge's length: then 120 of 120
random strips had one surface at four tolerances (with 1.0 one in 120 had two, with 0.25 some in
twenty) ..."""
REACH_PER_EDGE: Final = 1.5
"""... or so many bank edges beside them, if that is more."""
REACH_HELD: Final = 0.5
"""A pairing that is held to the bridges is sought so far beside them."""
MOST_OTHER_AREA: Final = 1.2
"""A surface whose area is so many times that of the bridges', or that many times smaller, is that
of another strip: a steep helicoid's rails also span half a cylinder of 1.3 times its area."""
REACH_IN_NODES: Final = 4
"""On a finer grid: so many nodes of the coarser one beside the pairing found on that."""

BENDING: Final = 0.005
"""Weight, on the first grid, of the squared turn of the sheet over a stretch as long as the ruling:
of pairings without twist the one that bends less is taken, and torsal pieces before fans."""
BENDING_FINER: Final = FINER * FINER
"""On a finer grid it weighs so many times less, as the twist that the grid itself makes."""
MOST_ROUNDS: Final = 64
"""Often enough for a pairing to settle; three or four rounds are usual."""


@dataclass(frozen=True, slots=True, eq=False)
class Pairing:
    """A pairing of the nodes of two rails."""

    p: Nodes
    """Nodes of P."""
    q: Nodes
    """Nodes of Q."""
    pairs: Ints
    """(k, 2) int64; numbers of nodes, from the rails' starts to their ends."""
    ways: Bytes
    """(k - 1,) int8; RULED, FAN_P or FAN_Q, for each step from pair to pair."""
    spacing: float
    """mm between nodes."""
    bending: float
    """The weight of bending with which it was found."""


def first_spacing(p: RailCurve, q: RailCurve, bridges: tuple[Floats, Floats]) -> float:
    """Returns mm between the nodes of the first grid.

    Args:
        p: the curve.
        q: the curve.
        bridges: (k,) float64 each; parameters on P and Q of the bridges.
    """
    mean = (p.length + q.length) / 2.0
    width = float(np.median(lengths(q.point_at(bridges[1]) - p.point_at(bridges[0]))))
    fine = width / NODES_ACROSS if width > 0.0 else mean
    return max(min(mean / NODES, fine), mean / MOST_NODES)


def pairing_near(
    p: RailCurve,
    q: RailCurve,
    bridges: tuple[Floats, Floats],
    spacing: float,
    max_lean: float | None = None,
) -> Pairing:
    """Returns the pairing of least twist near the bridges of a triangulation.

    It is sought in a corridor around the bridges, and then around what was found until that stays
    what it is: the bridges decide where it is sought, not what is found. Should that lead to a
    surface of quite another area, it is that of another strip between the same rails, and the
    pairing is held to the corridor around the bridges.

    Args:
        p: the curve.
        q: the curve.
        bridges: (k,) float64 each; parameters on P and Q of the bridges, in order.
        spacing: mm between nodes.
        max_lean: rad; how far a ruling may lean from the shortest crossing.
    """
    arcs = (p.arc_at(bridges[0]), q.arc_at(bridges[1]))
    ends = (p.point_at(bridges[0]), q.point_at(bridges[1]))
    bridge = lengths(ends[1] - ends[0])
    edges = np.zeros_like(bridge)
    for arc in arcs:
        edge = np.diff(arc)
        edge = np.maximum(np.concatenate(([0.0], edge)), np.concatenate((edge, [0.0])))
        edges = np.maximum(edges, REACH_PER_EDGE * edge)
    nodes = (place_nodes(p, spacing), place_nodes(q, spacing))
    found = _paired(
        nodes, arcs, np.maximum(edges, REACH_PER_BRIDGE * bridge), spacing, BENDING, max_lean
    )
    found = _settled(found, nodes, spacing, max_lean)
    area = _area(*ends)
    if area / MOST_OTHER_AREA <= _area(*_ends(found)) <= area * MOST_OTHER_AREA:
        return found
    return _paired(nodes, arcs, np.maximum(edges, REACH_HELD * bridge), spacing, BENDING, max_lean)


def _settled(
    found: Pairing, nodes: tuple[Nodes, Nodes], spacing: float, max_lean: float | None
) -> Pairing:
    """The pairing that is the best in the corridor around itself."""
    for _ in range(MOST_ROUNDS):
        last = found
        start, end = _ends(last)
        reach = REACH_PER_BRIDGE * lengths(end - start)
        found = _paired(nodes, _arcs(last), reach, spacing, BENDING, max_lean)
        if np.array_equal(last.pairs, found.pairs):
            break
    return found


def _ends(pairing: Pairing) -> tuple[Floats, Floats]:
    """Points on P and on Q of each pair."""
    return pairing.p.point[pairing.pairs[:, 0]], pairing.q.point[pairing.pairs[:, 1]]


def _area(start: Floats, end: Floats) -> float:
    """The area in mm2 of the triangles between segments in order."""
    across, along, back = end - start, np.diff(start, axis=0), np.diff(end, axis=0)
    twice = lengths(crosses(along, across[1:])) + lengths(crosses(back, across[:-1]))
    return float(np.cumsum(twice)[-1]) / 2.0 if len(twice) else 0.0


def finer_pairing(
    p: RailCurve, q: RailCurve, coarse: Pairing, max_lean: float | None = None
) -> Pairing:
    """Returns the pairing of least twist near another one, on a grid that is FINER times finer.

    Args:
        p: the curve.
        q: the curve.
        coarse: the other one.
        max_lean: rad; how far a ruling may lean from the shortest crossing.
    """
    spacing = coarse.spacing / FINER
    arcs = _arcs(coarse)
    reach = np.full(len(arcs[0]), REACH_IN_NODES * coarse.spacing)
    nodes = (place_nodes(p, spacing), place_nodes(q, spacing))
    return _paired(nodes, arcs, reach, spacing, coarse.bending / BENDING_FINER, max_lean)


def _leaning(
    nodes: tuple[Nodes, Nodes],
    low: Ints,
    high: Ints,
    arcs: tuple[Floats, Floats],
    slope: float,
    spacing: float,
) -> tuple[Ints, Ints]:
    """The corridor, no wider at each node of P than rulings may lean to either side of its foot.

    Known pairs stay in it: along curved rails they may lean no more and yet end further away.
    """
    p, q = nodes
    foot = nearest_on_polyline(p.point, q.point)
    at = q.arc[foot.segment] + foot.share * (q.arc[foot.segment + 1] - q.arc[foot.segment])
    # Two nodes to either side are kept, so that a way through is left.
    slack = 2.0 * spacing
    reach = slope * foot.distance + slack
    last = len(arcs[0]) - 1
    before = arcs[1][np.maximum(np.searchsorted(arcs[0], p.arc, side="right") - 1, 0)]
    behind = arcs[1][np.minimum(np.searchsorted(arcs[0], np.append(p.arc[1:], p.arc[-1])), last)]
    first = np.searchsorted(q.arc, np.minimum(at - reach, before - slack))
    final = np.searchsorted(q.arc, np.maximum(at + reach, behind + slack), side="right") - 1
    narrow_low, narrow_high = np.maximum(low, first), np.minimum(high, final)
    narrow_low[0], narrow_high[-1] = 0, len(q.arc) - 1
    narrow_high = np.maximum.accumulate(narrow_high)
    narrow_low = np.minimum.accumulate(narrow_low[::-1])[::-1]
    return narrow_low.astype(np.int64), narrow_high.astype(np.int64)


def _arcs(pairing: Pairing) -> tuple[Floats, Floats]:
    return pairing.p.arc[pairing.pairs[:, 0]], pairing.q.arc[pairing.pairs[:, 1]]


def _paired(
    nodes: tuple[Nodes, Nodes],
    arcs: tuple[Floats, Floats],
    reach: Floats,
    spacing: float,
    bending: float,
    max_lean: float | None,
) -> Pairing:
    p, q = nodes
    low, high = corridor(p.arc, q.arc, *arcs, np.maximum(reach, REACH_IN_NODES * spacing))
    if max_lean is not None:
        low, high = _leaning(nodes, low, high, arcs, math.tan(max_lean), spacing)
    pairs, ways = pair_nodes(
        p.point, q.point, p.tangent, q.tangent, p.arc, q.arc, low, high, bending
    )
    return Pairing(p, q, pairs, ways, spacing, bending)

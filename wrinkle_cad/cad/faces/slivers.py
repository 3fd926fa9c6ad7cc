"""Banks that start or end at their own apex: where the rails of a strip meet.

Between such a bank and its chord lies a sliver. It is a cone of polynomials over the bank's first
span only, so the bank is cut at its next knot, and what follows is an ordinary cone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.kernel.topology import make_vertex
from wrinkle_cad.strip.portable import norm

from .face_borders import Border, BorderEdge, curved_edge, flipped, loosen, straight_edge, sub_curve

Floats = NDArray[np.float64]

Sector = tuple[BorderEdge, Border, Border]
"""A bank, the border from its end to the apex, and the border from the apex to its start."""


def cut_at_knots(sector: Sector, apex: Floats, vertex: TopoDS_Vertex, limit: float) -> list[Sector]:
    """Returns the sectors that a sector consists of; mostly itself.

    Args:
        sector: a bank and the borders that lead to its apex; one of them is empty where the bank
            starts or ends there.
        apex: (3,) mm.
        vertex: the vertex at the apex.
        limit: mm; a sliver no wider than this is left out, and its bank stands for its chord.
    """
    bank, to_apex, from_apex = sector
    knots = bank.shape.knots
    if (to_apex and from_apex) or len(knots) == 2:
        return [sector]
    at = 1 if not from_apex else len(knots) - 2
    before, after, cut, point = _halves(bank, float(knots[at]))
    ends = np.array([point, apex])
    spoke: Border = (straight_edge(cut, vertex, ends),)
    if not from_apex and _is_thin(before, ends, limit):
        loosen((before,), settings.CONFUSION + limit)
        return cut_at_knots((after, to_apex, (before,)), apex, vertex, limit)
    if from_apex and _is_thin(after, ends, limit):
        loosen((after,), settings.CONFUSION + limit)
        return cut_at_knots((before, (after,), from_apex), apex, vertex, limit)
    first, second = (before, spoke, from_apex), (after, to_apex, flipped(spoke))
    return [
        *cut_at_knots(first, apex, vertex, limit),
        *cut_at_knots(second, apex, vertex, limit),
    ]


def _halves(bank: BorderEdge, at: float) -> tuple[BorderEdge, BorderEdge, TopoDS_Vertex, Floats]:
    """Returns the bank before and after a parameter, and the vertex between at (3,) mm."""
    shape = bank.shape
    curve = make_curve(shape.poles, shape.knots, shape.multiplicities, shape.degree, shape.weights)
    (point,) = shape.point_at(np.array([at]))
    cut = make_vertex(point)
    ends = shape.poles[[0, -1]]
    before = curved_edge(
        sub_curve(curve, float(shape.knots[0]), at), bank.start, cut, np.array([ends[0], point])
    )
    after = curved_edge(
        sub_curve(curve, at, float(shape.knots[-1])), cut, bank.end, np.array([point, ends[1]])
    )
    return before, after, cut, point


def _is_thin(bank: BorderEdge, chord: Floats, limit: float) -> bool:
    way = (chord[1] - chord[0]) / norm(chord[1] - chord[0])
    gaps = np.linalg.norm(np.cross(bank.shape.poles - chord[0], way), axis=1)
    return bool(gaps.max() <= limit)

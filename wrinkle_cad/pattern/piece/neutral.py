"""Lengths at the neutral layer of a thick material.

The layer at distance d from a faceted surface consists of the facets, moved along their normals,
and of a part of a cylinder of radius d around every bridge (Steiner's parallel surfaces). Unrolled,
the facets keep their shape and every bridge with fold angle theta opens by a parallel gap of width
d * theta, across the bridge: wider for a mountain when the layer lies on the right side, narrower
(negative) when it lies below. On a cylinder of radius R that makes (R + d) times the angle.

In a bend the neutral layer lies at K thicknesses from the inner face, which is the lower one of a
mountain and the upper one of a valley: d depends on the sign of theta.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .flat import FlatStrip, Indices
from .options import PieceSettings
from .piece import Floats, frozen


def neutral_layer(
    strip: FlatStrip, chosen: PieceSettings, *, turned_over: bool = False
) -> FlatStrip:
    """Returns the flat strip with the lengths that it has at the material's neutral layer.

    A rail's sample at the middle of a fold takes half of it; where several bridges meet at a
    sample it takes their mean, so a rail stays one line without steps. Arc lengths stay those of
    the surface, so that seams and notches still match the edge they are sewn to.

    The bend between an end bridge and the middle of the facet beside it shows at no bridge; it is
    taken from the bend between that facet and the next one on the same rail.

    Args:
        strip: the flat surface.
        chosen: thickness, K-factor and on which side of the surface the material lies.
        turned_over: whether the right side is the one that the surface normal points away from.
    """

    def opening(fold: Floats) -> Floats:
        gaps: Floats = chosen.neutral_offsets(fold, turned_over=turned_over) * fold
        return gaps

    if not np.any(opening(strip.fold)):
        return strip
    ends = strip.bridges
    span = strip.q[ends[:, 1]] - strip.p[ends[:, 0]]
    length = np.hypot(span[:, 0], span[:, 1])
    forward = np.column_stack((span[:, 1], -span[:, 0])) / np.where(length > 0, length, 1)[:, None]
    gap = opening(strip.fold)[:, None] * forward
    shift = np.cumsum(gap, axis=0) - 0.5 * gap
    at_start, at_end = opening(np.array(_end_bends(strip)))
    shift[1:] += at_start * _first_direction(forward)
    shift[-1] += at_end * _first_direction(forward[::-1])
    p_shift = _mean_shift(shift, ends[:, 0])
    q_shift = _mean_shift(shift, ends[:, 1])
    return replace(
        strip,
        p=frozen(strip.p + p_shift),
        q=frozen(strip.q + q_shift),
        p_line=frozen(strip.p_line + _between(p_shift, strip.p_arc, strip.p_index)),
        q_line=frozen(strip.q_line + _between(q_shift, strip.q_arc, strip.q_index)),
    )


def _end_bends(strip: FlatStrip) -> tuple[float, float]:
    """Returns the bend in rad that lies before the first facet's middle, and after the last's."""
    steps = np.diff(strip.bridges, axis=0)
    is_p_step = steps[:, 0] > 0
    normal = np.cumsum(strip.fold)[:-1]
    edges = np.where(
        is_p_step,
        np.linalg.norm(strip.p[strip.bridges[1:, 0]] - strip.p[strip.bridges[:-1, 0]], axis=1),
        np.linalg.norm(strip.q[strip.bridges[1:, 1]] - strip.q[strip.bridges[:-1, 1]], axis=1),
    )
    bends = []
    for same, sign in ((is_p_step == is_p_step[0], 0), (is_p_step == is_p_step[-1], -1)):
        index = np.flatnonzero(same)
        if len(index) < 2:
            bends.append(0.0)
            continue
        outer, inner = (index[0], index[1]) if sign == 0 else (index[-1], index[-2])
        bend = abs(edges[outer] / (edges[outer] + edges[inner]))
        bends.append(float(bend * (normal[max(outer, inner)] - normal[min(outer, inner)])))
    return bends[0], bends[1]


def _first_direction(forward: Floats) -> Floats:
    """Returns the first direction that is one: a bridge where the rails meet has none."""
    known = np.flatnonzero(np.any(forward != 0.0, axis=1))
    direction: Floats = forward[known[0]]
    return direction


def _mean_shift(shift: Floats, samples: Indices) -> Floats:
    """Returns the mean shift (k, 2) over the bridges of each sample; the ends take their own."""
    count = np.bincount(samples)
    mean = np.column_stack(
        [np.bincount(samples, weights=shift[:, axis]) / count for axis in (0, 1)]
    )
    mean[0], mean[-1] = shift[0], shift[-1]
    return mean


def _between(shift: Floats, arcs: Floats, index: Indices) -> Floats:
    return np.column_stack([np.interp(arcs, arcs[index], shift[:, axis]) for axis in (0, 1)])

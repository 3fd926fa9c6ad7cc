"""Samples that a strip which folds back on itself lacks: where the bridges of its corners land.

In a plane a corner of one rail may see only a short piece of the other, and without a sample there
no triangulation exists that does not fold. A search between the same rails with many samples shows
where these pieces are. Of its bridges those of the corners matter: between them both rails are
straight, and a plane quadrangle always has a diagonal inside. So the ends of the corners' bridges
are taken as samples, and the many others are dropped again.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from .curve.chebyshev import PointAt
from .curve.joint import CORNER, with_places
from .curve.nearest import nearest_on_polyline
from .curve.polyline import arc_lengths, points_at, turnings
from .curve.sampling import Samples
from .triangulation import Triangulation

Floats = NDArray[np.float64]
Pair = tuple[Samples, Samples]
Search = Callable[[Floats, Floats], Triangulation]

DENSITIES: Final = (16, 64)
"""Samples per largest width in the search for partners, tried in turn ..."""
MOST_SAMPLES: Final = 1500
"""... but at most about so many per rail."""
TURNS: Final = (CORNER, 0.0)
"""Vertices that turn a rail by more get partners, tried in turn."""
SAME_PLACE: Final = 1e-9
"""Places along a rail closer than this share of its length are one place."""


def without_fold_backs(
    found: Triangulation,
    rails: Pair,
    curves: tuple[PointAt | None, PointAt | None],
    tolerance: float,
    search: Search,
) -> tuple[Triangulation, Pair]:
    """Returns a strip with fewer fold-backs if samples that its rails lack allow for it.

    Args:
        found: the best triangulation between the rails as they are sampled.
        rails: their samples.
        curves: the rails themselves, from (k,) float64 parameters to (k, 3) points in mm; None for
            a rail that is to keep its samples.
        tolerance: mm; largest distance from a curve point to its chord.
        search: how the best triangulation between two rows of points is found.

    Returns:
        The triangulation and the samples it belongs to; those given if there is no better one, if
        a rail is a point, which sees the other from one side only, or if the strip is closed.
    """
    best, samples = found, rails
    if found.is_closed or min(len(rail.points) for rail in rails) < 2:
        return best, samples
    for density in DENSITIES:
        if best.fold_back_count == 0:
            break
        arcs = tuple(_dense_arcs(rails, k, density) for k in range(2))
        points = [
            points_at(rail.points, arc_lengths(rail.points), arc)
            for rail, arc in zip(rails, arcs, strict=True)
        ]
        dense = search(points[0], points[1])
        if dense.fold_back_count >= best.fold_back_count:
            continue
        for turn in TURNS:
            tried = _with_partners(dense, rails, curves, arcs, turn, tolerance)
            other = search(tried[0].points, tried[1].points)
            if other.fold_back_count < best.fold_back_count:
                best, samples = other, tried
            if best.fold_back_count == 0:
                break
    return best, samples


def _dense_arcs(rails: Pair, k: int, density: int) -> Floats:
    """(l,) mm along rail k: its vertices, and places between them."""
    line, other = rails[k].points, rails[1 - k].points
    width = max(
        float(nearest_on_polyline(line, other).distance.max()),
        float(nearest_on_polyline(other, line).distance.max()),
    )
    arc = arc_lengths(line)
    steps = np.diff(arc)
    spacing = max(width / density, float(arc[-1]) / MOST_SAMPLES)
    parts = np.maximum(np.ceil(steps / spacing - 1e-6), 1.0).astype(np.int64)
    first = np.repeat(np.cumsum(parts) - parts, parts)
    share = (np.arange(parts.sum()) - first) / np.repeat(parts, parts)
    dense: Floats = np.append(np.repeat(arc[:-1], parts) + share * np.repeat(steps, parts), arc[-1])
    return dense


def _with_partners(
    dense: Triangulation,
    rails: Pair,
    curves: tuple[PointAt | None, PointAt | None],
    arcs: tuple[Floats, ...],
    turn: float,
    tolerance: float,
) -> Pair:
    """The rails with samples where the bridges of the other's corners end."""
    more = []
    for k in range(2):
        curve, rail, other = curves[k], rails[k], rails[1 - k]
        if curve is None:
            more.append(rail)
            continue
        corners = arc_lengths(other.points)[turnings(other.points) > turn]
        rows = np.searchsorted(arcs[1 - k], corners - SAME_PLACE * arcs[1 - k][-1])
        ours, theirs = dense.bridges[:, k], dense.bridges[:, 1 - k]
        first = np.searchsorted(theirs, rows, side="left")
        last = np.searchsorted(theirs, rows, side="right") - 1
        places = arcs[k][np.unique(ours[np.concatenate((first, last))])]
        own = arc_lengths(rail.points)
        after = np.clip(np.searchsorted(own, places), 1, len(own) - 1)
        gap = np.minimum(np.abs(places - own[after - 1]), np.abs(own[after] - places))
        places = places[gap > SAME_PLACE * own[-1]]
        more.append(with_places(curve, rail, places, tolerance))
    return more[0], more[1]

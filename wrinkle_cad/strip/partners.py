"""Samples that a sharply folded strip lacks: where the bridges of its corners land.

In a plane a corner of one rail may see only a short piece of the other, and without a sample there
no triangulation exists that does not fold back; where the plane is rolled up, none that does not
fold sharply. A search between the same rails with many samples shows where these pieces are. Of its
bridges those of the corners matter: between them both rails are straight, and a plane quadrangle
always has a diagonal inside. So the ends of the corners' bridges are taken as samples, and the many
others are dropped again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.errors import ConstraintError

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
SHARP: Final = math.pi / 2.0
"""A strip with a fold above this is worth a search for the samples it may lack."""
CLEARLY_LESS: Final = 0.5
"""Without fewer fold-backs, samples are added where the strip bends by less than this share of what
it did: a fold for the lack of a sample costs ten or a hundred times the rest."""
SAME_PLACE: Final = 1e-9
"""Places along a rail closer than this share of its length are one place."""


def without_fold_backs(
    found: Triangulation,
    rails: Pair,
    curves: tuple[PointAt | None, PointAt | None],
    tolerance: float,
    search: Search,
) -> tuple[Triangulation, Pair]:
    """Returns a strip that folds back less, or bends far less, if samples that it lacks allow it.

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
    if (
        found.is_closed
        or min(len(rail.points) for rail in rails) < 2
        or all(curve is None for curve in curves)
    ):
        return best, samples
    for density in DENSITIES:
        if not _is_sharp(best):
            break
        arcs = tuple(_dense_arcs(rails, k, density) for k in range(2))
        points = [
            points_at(rail.points, arc_lengths(rail.points), arc)
            for rail, arc in zip(rails, arcs, strict=True)
        ]
        dense = _searched(search, points[0], points[1])
        if dense is None or (dense.fold_back_count, _largest(dense)) >= (
            best.fold_back_count,
            _largest(best),
        ):
            continue
        for turn in TURNS:
            tried = _with_partners(dense, rails, curves, arcs, turn, tolerance)
            other = _searched(search, tried[0].points, tried[1].points)
            if other is not None and _is_better(other, best):
                best, samples = other, tried
            if not _is_sharp(best):
                break
    return best, samples


def _searched(search: Search, p: Floats, q: Floats) -> Triangulation | None:
    """The best triangulation, None if none keeps what is asked of it between these samples."""
    try:
        return search(p, q)
    except ConstraintError:
        return None


def _largest(strip: Triangulation) -> float:
    return float(np.abs(strip.fold).max(initial=0.0))


def _is_sharp(strip: Triangulation) -> bool:
    return strip.fold_back_count > 0 or _largest(strip) > SHARP


def _is_better(other: Triangulation, best: Triangulation) -> bool:
    if other.fold_back_count != best.fold_back_count:
        return other.fold_back_count < best.fold_back_count
    is_allowed = other.price is not None or (
        other.counted_invalid_count <= best.counted_invalid_count
    )
    return is_allowed and other.bending < CLEARLY_LESS * best.bending


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

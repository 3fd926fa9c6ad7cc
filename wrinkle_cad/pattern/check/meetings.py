"""Pairs of lines that meet, in bounded time and memory: a hostile file has all of them meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from wrinkle_cad.pattern.piece.flat import Indices
from wrinkle_cad.pattern.piece.piece import Floats

from . import limits

_MOST_AT_ONCE = 1024
_ENOUGH_AT_ONCE = 10_000


def meeting_pairs(
    shapes: Sequence[shapely.Geometry], *, distance: float = 0.0
) -> tuple[Indices, Indices]:
    """Returns the pairs (first, second), first < second, of shapes no further apart than that.

    No more than ``limits.MOST_PAIRS`` are looked for, among no more shapes with overlapping boxes
    than have ``limits.MOST_COMPARED`` vertices together.

    Args:
        shapes: lines.
        distance: mm.
    """
    everything = np.asarray(shapes, dtype=object)
    tree = shapely.STRtree(everything)
    boxes = shapely.bounds(everything) + distance * np.array([-1.0, -1.0, 1.0, 1.0])
    weights = shapely.get_num_coordinates(everything)
    found: list[Indices] = [np.zeros((2, 0), dtype=np.int64)]
    count = compared = start = 0
    at_once = 1
    while start < len(everything):
        near = tree.query(shapely.box(*boxes[start : start + at_once].T))
        near[0] += start
        start += at_once
        at_once = min(_MOST_AT_ONCE, 2 * at_once) if near.shape[1] < _ENOUGH_AT_ONCE else 1
        near = near[:, near[0] < near[1]]
        near = near[:, np.lexsort((near[1], near[0]))]
        work = compared + np.cumsum(weights[near].sum(axis=0))
        # One pair is always looked at: two contours may be as long as the file has room for.
        near = near[:, (work <= limits.MOST_COMPARED) | (np.arange(near.shape[1]) < int(not count))]
        found.append(near[:, _meet(everything, near, distance)])
        compared = int(work[-1]) if len(work) else compared
        count += found[-1].shape[1]
        if count >= limits.MOST_PAIRS or compared > limits.MOST_COMPARED:
            break
    first, second = np.hstack(found)[:, : limits.MOST_PAIRS]
    return first, second


def _meet(shapes: np.ndarray, pairs: Indices, distance: float) -> np.ndarray:
    """Returns (k,) bool, which pairs meet."""
    first, second = shapes[pairs]
    # Comparing with a line that is prepared takes the time of a search, not of a product.
    shapely.prepare(first)
    if distance > 0.0:
        return np.asarray(shapely.dwithin(first, second, distance))
    return np.asarray(shapely.intersects(first, second))


def meeting_place(first: Floats, second: Floats) -> Floats:
    """Returns (2,) a point of two contours that meet, without looking for all.

    Args:
        first: (k, 2) points along a contour.
        second: (l, 2) those along another one.
    """
    segments = shapely.linestrings(np.stack((first[:-1], first[1:]), axis=1))
    tree = shapely.STRtree(segments)
    others = shapely.linestrings(np.stack((second[:-1], second[1:]), axis=1))
    for other in others:
        hit = tree.query(other, predicate="intersects")
        if len(hit):
            met = shapely.intersection(segments[hit.min()], other)
            return np.array(met.coords[0])
    return np.asarray(first[0])


def shared_lengths(first: Floats, second: Floats) -> Floats:
    """Returns (k,) over what length segments lie on each other, to ``limits.ZERO``; mm.

    Args:
        first: (k, 2, 2) start and end of segments with a length.
        second: (k, 2, 2) those of as many others.
    """
    is_longer = _length(second) > _length(first)
    first, second = (
        np.where(is_longer[:, None, None], one, other)
        for one, other in ((second, first), (first, second))
    )
    length = _length(first)
    along = first[:, 1] - first[:, 0]
    along = along / length[:, None]
    x, y = np.moveaxis(second - first[:, :1], 2, 0)
    here = x * along[:, :1] + y * along[:, 1:]
    beside = np.abs(x * along[:, 1:] - y * along[:, :1]).max(axis=1)
    ends = np.minimum(here.max(axis=1), length)
    starts = np.maximum(here.min(axis=1), 0.0)
    return np.where(beside <= limits.ZERO, np.maximum(ends - starts, 0.0), 0.0)


def _length(segments: Floats) -> Floats:
    along = segments[:, 1] - segments[:, 0]
    return np.asarray(np.hypot(along[:, 0], along[:, 1]))

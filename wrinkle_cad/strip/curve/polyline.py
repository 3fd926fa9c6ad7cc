"""Polylines: lengths along them, points on them.

Every sum runs over the coordinates in their order and every product is an operation of its own, so
that the last bit is the same on any processor: what follows decides where samples and notches go.

Not handled: closed polylines, unless their first point is repeated at the end.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wrinkle_cad.strip.portable import atan2, dot

Floats = NDArray[np.float64]


def row_lengths(vectors: ArrayLike) -> Floats:
    """Returns the lengths of vectors.

    Args:
        vectors: (..., d) float64, d at least 1.

    Returns:
        (...) float64, in the unit of the vectors.

    Example:
        >>> row_lengths([[3.0, 4.0, 0.0], [0.0, 0.0, 2.0]]).tolist()
        [5.0, 2.0]
    """
    rows = np.asarray(vectors, dtype=np.float64)
    return np.sqrt(dot(rows, rows))


def segment_lengths(points: ArrayLike) -> Floats:
    """Returns the length of each segment of a polyline.

    Args:
        points: (k, d) float64, mm.

    Returns:
        (k-1,) float64, mm.

    Example:
        >>> segment_lengths([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]]).tolist()
        [5.0, 2.0]
    """
    return row_lengths(np.diff(np.asarray(points, dtype=np.float64), axis=0))


def arc_lengths(points: ArrayLike) -> Floats:
    """Returns the length of a polyline from its start to each of its vertices.

    Args:
        points: (k, d) float64, mm; k at least 1.

    Returns:
        (k,) float64, mm, from 0, ascending.

    Example:
        >>> arc_lengths([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]]).tolist()
        [0.0, 5.0, 7.0]
    """
    return np.concatenate(([0.0], np.cumsum(segment_lengths(points))))


def polyline_length(points: ArrayLike) -> float:
    """Returns the length in mm of a polyline (k, d), 0 for a single point.

    Example:
        >>> polyline_length([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]])
        7.0
    """
    return float(segment_lengths(points).sum())


def points_at(points: ArrayLike, arcs: ArrayLike, at: ArrayLike) -> Floats:
    """Returns the points of a polyline at given places; beyond its ends, the ends.

    Args:
        points: (k, d) float64, mm.
        arcs: (k,) float64, ascending: the place of each vertex; `arc_lengths(points)`, or any other
            measure along the line.
        at: (l,) float64: the places asked for, in any order.

    Returns:
        (l, d) float64, mm. Where several vertices have one place, the last of them.

    Example:
        >>> points_at([[0.0, 0.0], [4.0, 0.0]], [0.0, 1.0], [0.25, 9.0]).tolist()
        [[1.0, 0.0], [4.0, 0.0]]
    """
    line, places = np.asarray(points, dtype=np.float64), np.asarray(arcs, dtype=np.float64)
    asked = np.clip(np.asarray(at, dtype=np.float64), places[0], places[-1])
    i = np.searchsorted(places, asked, side="right") - 1
    last = np.minimum(i + 1, len(places) - 1)
    span = places[last] - places[i]
    span = np.where(span > 0.0, span, 1.0)[:, None]
    return (line[last] - line[i]) / span * (asked - places[i])[:, None] + line[i]


def segment_gaps(points: ArrayLike, starts: ArrayLike, ends: ArrayLike) -> Floats:
    """Returns how far points are from straight segments, point by point.

    Args:
        points: (..., d) float64, mm.
        starts: (..., d) float64, mm, of one shape with the points or broadcast to it.
        ends: the same for the other end; a segment may be a point.

    Returns:
        (...) float64, mm.

    Example:
        >>> segment_gaps([[1.0, 2.0], [7.0, 4.0]], [0.0, 0.0], [4.0, 0.0]).tolist()
        [2.0, 5.0]
    """
    start = np.asarray(starts, dtype=np.float64)
    chord = np.asarray(ends, dtype=np.float64) - start
    offset = np.asarray(points, dtype=np.float64) - start
    square = dot(chord, chord)
    along = dot(offset, chord) / np.where(square > 0.0, square, 1.0)
    return row_lengths(offset - np.clip(along, 0.0, 1.0)[..., None] * chord)


def turnings(points: ArrayLike) -> Floats:
    """Returns the angle by which a polyline in space turns at each vertex; 0 at both ends.

    Args:
        points: (k, 3) float64, mm.

    Returns:
        (k,) float64, radians from 0 to pi.

    Example:
        >>> turnings([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]).round(4).tolist()
        [0.0, 1.5708, 0.0]
    """
    steps = np.diff(np.asarray(points, dtype=np.float64), axis=0)
    turned = np.zeros(len(steps) + 1)
    sines = row_lengths(np.cross(steps[:-1], steps[1:]))
    turned[1:-1] = atan2(sines, dot(steps[:-1], steps[1:]))
    return turned

"""Contours to be cut: closed, simple, apart from each other, each segment once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from wrinkle_cad import settings
from wrinkle_cad.errors import Finding
from wrinkle_cad.pattern.piece.piece import Floats

from .reading import FileLine


def judge_contours(lines: Sequence[FileLine]) -> Iterator[Finding]:
    """Yields what is wrong with the lines on the cut layers of a file.

    Loose lines and arcs that meet end to end count as one contour.

    Args:
        lines: on the cut layers, of all spaces.
    """
    for space in dict.fromkeys(line.space for line in lines):
        here = [line for line in lines if line.space == space and len(line.points) > 1]
        rings = [_ring(line) for line in here if line.is_closed and len(line.points) > 2]
        loose = [line.points for line in here if not line.is_closed]
        joined, open_ends = _joined(loose)
        yield from _gaps(open_ends)
        rings += joined
        yield from _crossings(rings)
        yield from _overlaps([line for line in here if not line.is_curved])


def _ring(line: FileLine) -> Floats:
    return np.vstack((line.points, line.points[:1]))


def _joined(loose: Sequence[Floats]) -> tuple[list[Floats], Floats]:
    """Returns the closed contours that loose lines make, and the ends that meet nothing, (k, 2)."""
    grid = settings.CHECK_ZERO
    snapped = {}
    for points in loose:
        rounded = np.round(points / grid) * grid
        distinct = np.any(np.diff(rounded, axis=0) != 0.0, axis=1)
        if distinct.any():
            line = shapely.LineString(rounded[np.concatenate(([True], distinct))])
            snapped[line.normalize().wkb] = line
    merged = shapely.line_merge(shapely.MultiLineString(list(snapped.values())))
    parts = [part for part in shapely.get_parts(merged) if not part.is_empty]
    rings = [np.array(part.coords) for part in parts if part.is_closed]
    ends = [part.coords[i] for part in parts if not part.is_closed for i in (0, -1)]
    return rings, np.array(ends, dtype=np.float64).reshape(-1, 2)


def _gaps(ends: Floats) -> Iterator[Finding]:
    """Yields near misses (free ends that nearly meet), then what stays open."""
    free = list(range(len(ends)))
    while len(free) > 1:
        first = free.pop(0)
        distances = np.linalg.norm(ends[free] - ends[first], axis=1)
        nearest = int(np.argmin(distances))
        gap = float(distances[nearest])
        if gap <= settings.CHECK_NEAR_MISS:
            yield Finding(
                "near-miss-gap",
                "error",
                f"contour - gap of {gap:.4g} mm at {_place(ends[first])} - ends must meet to "
                f"{settings.CHECK_ZERO:g} mm - join them",
            )
            free.pop(nearest)
        else:
            yield _open(ends[first])
    for last in free:
        yield _open(ends[last])


def _open(end: Floats) -> Finding:
    return Finding(
        "open-contour",
        "error",
        f"contour - open at {_place(end)} - closed - close it, or move the line off the cut layer",
    )


def _crossings(rings: Sequence[Floats]) -> Iterator[Finding]:
    contours = [shapely.LinearRing(ring) for ring in rings if len(ring) > 3]
    for contour in contours:
        if not contour.is_simple:
            at = np.array(shapely.node(contour).geoms[0].coords[-1])
            yield Finding(
                "self-intersection",
                "error",
                f"contour - crosses itself at {_place(at)} - simple - correct the outline",
            )
    if len(contours) < 2:
        return
    first, second = shapely.STRtree(contours).query(contours, predicate="intersects")
    for i, j in zip(first, second, strict=True):
        if i < j and not contours[i].equals(contours[j]):
            meeting = shapely.intersection(contours[i], contours[j])
            at = np.array(meeting.representative_point().coords[0])
            yield Finding(
                "contours-touch",
                "error",
                f"two contours - meet at {_place(at)} - apart - move one",
            )


def _overlaps(lines: Sequence[FileLine]) -> Iterator[Finding]:
    """Yields segments of different lines, or of one, that run over each other for a length."""
    starts, stops = [], []
    for line in lines:
        points = _ring(line) if line.is_closed else line.points
        starts.append(points[:-1])
        stops.append(points[1:])
    if not starts:
        return
    segments = np.stack((np.vstack(starts), np.vstack(stops)), axis=1)
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    segments = segments[lengths > settings.CHECK_ZERO]
    drawn = shapely.linestrings(segments)
    first, second = shapely.STRtree(drawn).query(drawn, predicate="intersects")
    pairs = first < second
    shared = shapely.length(shapely.intersection(drawn[first[pairs]], drawn[second[pairs]]))
    for i in np.flatnonzero(shared > settings.CHECK_NEAR_MISS)[:1]:
        at = segments[first[pairs][i], 0]
        count = int(np.count_nonzero(shared > settings.CHECK_NEAR_MISS))
        yield Finding(
            "overlap",
            "error",
            f"cut layer - {count} pairs of segments run over each other, first near {_place(at)} - "
            "every line once - remove one",
        )


def _place(point: Floats) -> str:
    return f"({point[0]:.3f}, {point[1]:.3f}) mm"

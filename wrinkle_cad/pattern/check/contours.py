"""Contours to be cut: closed, simple, apart from each other, each segment once."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wrinkle_cad.errors import Finding
from wrinkle_cad.pattern.piece.piece import Floats

from . import limits
from .entities import FileLine
from .meetings import meeting_pairs, meeting_place, shared_lengths


def judge_contours(lines: Sequence[FileLine]) -> Iterator[Finding]:
    """Yields what is wrong with the lines on the cut layers of a file.

    Loose lines and arcs that meet end to end count as one contour.

    Args:
        lines: on the cut layers, of all spaces.
    """
    for space in dict.fromkeys(line.space for line in lines):
        here = [line for line in lines if line.space == space and len(line.points) > 1]
        rings, open_ends = closed_contours(here)
        yield from _gaps(open_ends)
        yield from _crossings(rings)
        yield from _overlaps([line for line in here if not line.is_curved])


def closed_contours(lines: Sequence[FileLine]) -> tuple[list[Floats], Floats]:
    """Returns the closed contours (k, 2) that lines make, first point repeated, and loose ends.

    The loose ends, (l, 2), are those of lines that meet nothing.
    """
    rings = [_ring(line) for line in lines if line.is_closed and len(line.points) > 2]
    loose = _meeting([line.points for line in lines if not line.is_closed and len(line.points) > 1])
    merged = shapely.line_merge(shapely.MultiLineString(_distinct(*loose)))
    parts = [part for part in shapely.get_parts(merged) if part.length > limits.ZERO]
    rings += [np.array(part.coords) for part in parts if part.is_closed]
    ends = [part.coords[i] for part in parts if not part.is_closed for i in (0, -1)]
    return rings, np.array(ends, dtype=np.float64).reshape(-1, 2)


def _distinct(points: Floats, counts: NDArray[np.int64]) -> list[shapely.LineString]:
    """Returns lines of so many points each, every one once, whichever way it runs."""
    lines = shapely.linestrings(points, indices=np.repeat(np.arange(len(counts)), counts))
    keys = shapely.to_wkb(shapely.normalize(lines)).tolist()
    return list(dict(zip(keys, lines.tolist(), strict=True)).values())


def _ring(line: FileLine) -> Floats:
    return np.vstack((line.points, line.points[:1]))


def _meeting(loose: Sequence[Floats]) -> tuple[Floats, NDArray[np.int64]]:
    """Returns the lines' points (k, 2), ends that meet made equal, and how many each line has."""
    counts = np.array([len(points) for points in loose], dtype=np.int64)
    if not loose:
        return np.zeros((0, 2)), counts
    # scipy loads in a fifth of a second, and most drawings have closed contours only.
    from scipy.spatial import cKDTree

    points, stops = np.vstack(loose), np.cumsum(counts)
    at = np.column_stack((stops - counts, stops - 1)).reshape(-1)
    places, index = np.unique(points[at], axis=0, return_inverse=True)
    near = cKDTree(places).query_pairs(limits.ZERO, output_type="ndarray")
    first = np.arange(len(places))
    for i, j in near[np.lexsort((near[:, 1], near[:, 0]))]:
        first[j] = min(first[i], first[j])
    points[at] = places[first[index.reshape(-1)]]
    return points, counts


def _gaps(ends: Floats) -> Iterator[Finding]:
    """Yields near misses (free ends that nearly meet), then what stays open."""
    if not len(ends):
        return
    from scipy.spatial import cKDTree

    places, count = np.unique(ends, axis=0, return_counts=True)
    for at in places[count > 1]:
        yield _finding(
            "branching-contour",
            f"Three or more lines meet at {_place(at)}. A contour has one way on: remove a line, "
            "or move it off the cut layer.",
        )
    single = places[count == 1]
    free = np.ones(len(single), dtype=np.bool_)
    if len(single) > 1:
        distance, nearest = (np.asarray(row)[:, 1] for row in cKDTree(single).query(single, k=2))
        for i in np.argsort(distance, kind="stable"):
            j = nearest[i]
            if distance[i] <= limits.NEAR_MISS and free[i] and free[j]:
                free[[i, j]] = False
                yield _finding(
                    "near-miss-gap",
                    f"A contour has a gap of {distance[i]:.4g} mm at {_place(single[i])}. Its ends "
                    f"must meet to {limits.ZERO:g} mm: join them.",
                )
    for at in single[free]:
        yield _finding(
            "open-contour",
            f"A contour is open at {_place(at)}. Close it, or move the line off the cut layer.",
        )


def _crossings(rings: Sequence[Floats]) -> Iterator[Finding]:
    contours = [shapely.LinearRing(ring) for ring in rings if len(ring) > 3]
    for contour in contours:
        if not contour.is_simple:
            yield _finding(
                "self-intersection",
                f"A contour crosses itself at {_crossing(contour)}. Correct the outline.",
            )
    if len(contours) < 2:
        return
    pairs = meeting_pairs(contours, distance=limits.HAIR)
    is_first = True
    for i, j in zip(*(index.tolist() for index in pairs), strict=True):
        first, second = contours[i], contours[j]
        if _is_double(first, second):
            if not first.equals(second):
                yield _finding(
                    "doubled-contour",
                    f"Two contours lie within {limits.HAIR:g} mm of each other all around, "
                    f"from {_place(np.array(first.coords[0]))}. Cut it once: remove one.",
                )
        elif first.intersects(second):
            # Only the first one's place is told in the end, and to find it takes a search.
            where = _common_place(first, second) if is_first else f"as numbers {i + 1} and {j + 1}"
            yield _finding("contours-touch", f"Two contours meet {where}. Move one away.")
            is_first = False


def _common_place(first: shapely.LinearRing, second: shapely.LinearRing) -> str:
    return f"at {_place(meeting_place(*map(shapely.get_coordinates, (first, second))))}"


def _is_double(first: shapely.LinearRing, second: shapely.LinearRing) -> bool:
    """Whether every vertex of each lies no further from the other than a hair."""
    apart = np.abs(np.subtract(first.bounds, second.bounds)).max()
    if apart > limits.HAIR:
        return False
    for one, other in ((first, second), (second, first)):
        shapely.prepare(one)
        vertices = shapely.points(shapely.get_coordinates(other))
        if not shapely.dwithin(one, vertices, limits.HAIR).all():
            return False
    return True


def _crossing(contour: shapely.LinearRing) -> str:
    """Returns where a ring crosses itself: GEOS tells one place without looking for all."""
    told = re.search(r"\[(\S+) (\S+)\]", shapely.is_valid_reason(shapely.Polygon(contour.coords)))
    place = tuple(map(float, told.groups())) if told else contour.coords[0]
    return _place(np.array(place))


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
    along = segments[:, 1] - segments[:, 0]
    segments = segments[np.hypot(along[:, 0], along[:, 1]) > limits.ZERO]
    drawn = shapely.linestrings(segments)
    first, second = meeting_pairs(drawn)
    shared = shared_lengths(segments[first], segments[second])
    longest = np.flatnonzero(shared > limits.NEAR_MISS)
    if len(longest):
        yield _finding(
            "overlap",
            f"{len(longest)} pairs of segments on the cut layers run over each other, first near "
            f"{_place(segments[first[longest[0]], 0])}. Cut every line once: remove one.",
        )


def _place(point: Floats) -> str:
    return f"({point[0]:.3f}, {point[1]:.3f}) mm"


def _finding(code: str, message: str) -> Finding:
    return Finding(code, "error", message)

"""The seam allowance: the cut line around a sew line, one width per side.

The cut-out region is the union of the piece and, for every segment, the rectangle of its side's
width on its outside; convex corners get a mitre that is clipped at a limit, convex points of a
curve a fan of facets around the arc. Every point of the region lies within the width of its side
(mitres apart), so the union trims an offset that crosses itself wherever it does. The union is
shapely's: nothing here intersects curves by hand.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
import shapely

from wrinkle_cad import settings
from wrinkle_cad.strip.portable import cos, dot, sin

from .options import PerSide
from .outline import closed_turns, corner_vertices
from .piece import Floats, Ints, Outline, frozen, make_outline

_FACETS_PER_TOLERANCE: Final = 0.3
"""The facets around an arc leave it by this share of the chord tolerance."""


def cut_outline(
    sew: Outline, widths: PerSide, *, mitre_limit: float, tolerance: float
) -> tuple[Outline, tuple[Floats, ...]]:
    """Returns the cut line and the cut-outs that the allowance encloses, if any.

    Args:
        sew: the sew line, a simple polygon.
        widths: mm, in the order of ``SIDES``; with all of them 0 the cut line is the sew line.
        mitre_limit: corners reach at most this many widths from the sew line.
        tolerance: mm; arcs are approximated, and short segments merged, within it.
    """
    if not any(width > 0.0 for width in widths):
        return sew, ()
    allowance = shapely.union_all(_parts(sew, np.array(widths), mitre_limit, tolerance))
    beyond = shapely.union_all(list(_beyond_bare_edges(sew, np.array(widths), mitre_limit)))
    region = shapely.union(allowance.difference(beyond), shapely.Polygon(sew.points))
    if region.geom_type != "Polygon":
        region = max(region.geoms, key=lambda part: part.area)
    cut = _cleaned(region.exterior, tolerance)
    holes = (
        _cleaned(ring, tolerance)
        for ring in region.interiors
        if not shapely.Polygon(ring).buffer(-tolerance).is_empty
    )
    sides = _nearest_sides(cut, sew, np.array(widths))
    outline = make_outline(cut, sides, corner_vertices(cut, sides))
    return outline, tuple(frozen(hole) for hole in holes)


def _parts(
    sew: Outline, widths: Floats, mitre_limit: float, tolerance: float
) -> list[shapely.Polygon]:
    """Returns polygons whose union is the region to cut.

    Neighbours share their corners to the last bit: else the union would keep cracks between them.
    """
    after = np.roll(sew.points, -1, axis=0)
    along = after - sew.points
    along = along / np.linalg.norm(along, axis=1)[:, None]
    outward = np.column_stack((along[:, 1], -along[:, 0]))
    width = widths[sew.sides]
    first, second = (points + width[:, None] * outward for points in (sew.points, after))
    has_width = width > 0.0
    rings = np.stack((sew.points, first, second, after), axis=1)[has_width]
    parts: list[shapely.Polygon] = [shapely.Polygon(sew.points), *shapely.polygons(rings)]
    turn = closed_turns(sew.points)
    for i in np.flatnonzero((turn > 0.0) & (has_width | np.roll(has_width, 1))):
        j = i - 1
        if sew.corners[i]:
            tips = _mitre(along[j], along[i], width[j], width[i], mitre_limit)
        else:
            tips = _fan(outward[i], float(turn[i]), width[i], _FACETS_PER_TOLERANCE * tolerance)
        ring = np.vstack((sew.points[i], second[j], sew.points[i] + tips, first[i]))
        parts.append(shapely.Polygon(ring))
    return parts


def _beyond_bare_edges(
    sew: Outline, widths: Floats, mitre_limit: float
) -> Iterator[shapely.Polygon]:
    """Yields what lies beyond the line of an edge of width 0 at an obtuse corner beside it.

    There the allowance of the other edge ends on that line, as it does at a mitred corner, and not
    square to its own edge, which would leave a tip beside the bare edge.
    """
    after = np.roll(sew.points, -1, axis=0)
    along = after - sew.points
    along = along / np.hypot(along[:, 0], along[:, 1])[:, None]
    width = widths[sew.sides]
    turn = closed_turns(sew.points)
    for i in np.flatnonzero(sew.corners & (turn > 0.0) & (turn < 0.5 * np.pi)):
        width_in, width_on = float(width[i - 1]), float(width[i])
        if (width_in > 0.0) == (width_on > 0.0):
            continue
        reach = max(width_in, width_on) / math.sin(turn[i])
        if reach > mitre_limit * max(width_in, width_on):
            continue
        bare = along[i - 1] if width_in == 0.0 else along[i]
        ahead = reach * (bare if width_in == 0.0 else -bare)
        aside = reach * np.array((bare[1], -bare[0]))
        corner = sew.points[i]
        yield shapely.Polygon((corner, corner + ahead, corner + ahead + aside, corner + aside))


def _mitre(
    into: Floats, onward: Floats, width_in: float, width_on: float, mitre_limit: float
) -> Floats:
    """Returns the tip of a corner's wedge, or both ends of a clipped tip, or none: (0...2, 2).

    ``into`` and ``onward`` are the unit directions of the two sides, turning left.
    """
    start = width_in * np.array((into[1], -into[0]))
    stop = width_on * np.array((onward[1], -onward[0]))
    sine = into[0] * onward[1] - into[1] * onward[0]
    cosine = float(dot(into, onward))
    reach = mitre_limit * max(width_in, width_on)
    axis = into - onward
    if sine > 1e-9:
        ahead = (width_on - width_in * cosine) / sine
        behind = (width_in - width_on * cosine) / sine
        if ahead < 0.0 or behind < 0.0:
            return np.zeros((0, 2))
        tip: Floats = start + ahead * into
        if np.hypot(*tip) <= reach:
            return np.vstack((tip,))
        axis = tip
    axis = axis / np.hypot(*axis)
    first = start + (reach - dot(start, axis)) / dot(into, axis) * into
    second = stop + (reach - dot(stop, axis)) / dot(onward, axis) * onward
    return np.vstack((first, second))


def _fan(outward: Floats, turn: float, width: float, tolerance: float) -> Floats:
    """Returns the tips of facets around an arc, outside it by at most ``tolerance``, (c, 2).

    The arc of ``turn`` rad ends where its segment starts, which looks ``outward``.
    """
    largest = 2.0 * math.acos(width / (width + tolerance))
    count = max(1, math.ceil(turn / largest))
    angle = math.atan2(outward[1], outward[0]) - turn
    angles = angle + turn * (np.arange(count) + 0.5) / count
    radius = width / math.cos(0.5 * turn / count)
    tips: Floats = radius * np.column_stack((cos(angles), sin(angles)))
    return tips


def _cleaned(ring: shapely.LinearRing, tolerance: float) -> Floats:
    """Returns a ring as (k, 2), counter-clockwise, without the short segments of the union.

    It is simple as a file has it, rounded; a crack too narrow for that is closed.
    """
    whole = shapely.Polygon(ring)
    closed = whole.buffer(tolerance, join_style="mitre").buffer(-tolerance, join_style="mitre")
    for region in (whole, closed):
        points = np.array(region.normalize().exterior.coords[:-1])[::-1]
        for share in (1.0, 0.1, 0.0):
            trial = _without_short_segments(points, share * tolerance)
            rounded = np.round(trial, settings.DXF_DECIMALS)
            if len(trial) >= 3 and shapely.Polygon(rounded).is_valid:
                return trial
    return points


def _without_short_segments(points: Floats, tolerance: float) -> Floats:
    """Returns a closed polygon without the vertices that stand too close or say nothing."""
    while len(points) > 3:
        lengths = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        turn = np.abs(closed_turns(points))
        nearest = np.minimum(lengths, np.roll(lengths, 1))
        # A vertex may go when it stands closer than the tolerance to a neighbour, the one that
        # turns less first, or on the line of its neighbours to within what the file can say.
        sagitta = turn * nearest
        flat = (sagitta < 10.0**-settings.DXF_DECIMALS) & (turn < 1.0)
        may_go = flat | (nearest < tolerance)
        order = np.empty(len(points), dtype=np.int64)
        order[np.argsort(np.where(may_go, sagitta, np.inf), kind="stable")] = np.arange(len(points))
        lowest = may_go & (order < np.roll(order, 1)) & (order < np.roll(order, -1))
        if not lowest.any():
            return points
        points = points[~lowest]
    return points


def _nearest_sides(cut: Floats, sew: Outline, widths: Floats) -> Ints:
    """Returns for each cut segment the side whose allowance it bounds, (k,) side indices."""
    middles = shapely.points(0.5 * (cut + np.roll(cut, -1, axis=0)))
    closed = np.vstack((sew.points, sew.points[:1]))
    misses = np.full((len(widths), len(cut)), np.inf)
    for side in np.unique(sew.sides):
        index = np.flatnonzero(sew.sides == side)
        segments = shapely.linestrings(np.stack((closed[index], closed[index + 1]), axis=1))
        _, distance = shapely.STRtree(segments).query_nearest(
            middles, return_distance=True, all_matches=False
        )
        misses[side] = distance - widths[side]
    nearest: Ints = np.argmin(misses, axis=0).astype(np.int8)
    return nearest

"""Notches on a piece: from arc lengths on the rails to marks on the cut line, or a reason why not.

A notch stands where the seam point's normal meets the cut line within the mitre's reach. Where the
allowance is trimmed, that may lie on another side or far away; the notch is then refused, and its
partner with it. Slits keep apart from each other and from the corners of the cut line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely

from .flat import FlatStrip
from .notch_forms import notch_lines
from .notches import corner_arcs, notch_arcs, points_and_directions
from .options import END_SIDE, P_SIDE, Q_SIDE, START_SIDE, NotchRule, PerSide, PieceSettings
from .piece import Floats, Notch, Outline, frozen

_DEPTH_PER_ALLOWANCE: Final = 0.6
"""A notch never eats more than this share of the seam allowance."""
_APART: Final = 0.5
"""mm; least distance of a notch from the next one and from a corner of the cut line."""
_TRIMMED: Final = 0.5
"""A notch is refused where less than this share of the allowance is left."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """A notch that cannot stand: side index, mm along it, and what is in its way."""

    side: int
    """Index into ``SIDES``."""
    arc: float
    """mm along that side."""
    reason: str
    """What is in its way."""


def seam_arcs(
    strip: FlatStrip, parts: Sequence[FlatStrip], chosen: PieceSettings
) -> tuple[Floats, Floats]:
    """Returns the arc lengths in mm of the notches on P and on Q of the whole strip.

    Kinks of the rails and the places where the strip is split are corners, so no notch of any
    part stands on one.
    """
    p_corners, q_corners = seam_corners(strip, parts)
    p_rule, q_rule = chosen.notch_rules
    return (
        _rail_arcs(float(strip.p_arc[-1]), p_corners, p_rule),
        _rail_arcs(float(strip.q_arc[-1]), q_corners, q_rule),
    )


def seam_corners(strip: FlatStrip, parts: Sequence[FlatStrip]) -> tuple[Floats, Floats]:
    """Returns the arc lengths in mm at which P and Q have corners: kinks and cuts."""
    p_cuts = [part.p_arc[0] for part in parts[1:]]
    q_cuts = [part.q_arc[0] for part in parts[1:]]
    return (
        np.append(corner_arcs(strip.p_line, strip.p_arc), p_cuts),
        np.append(corner_arcs(strip.q_line, strip.q_arc), q_cuts),
    )


def _rail_arcs(length: float, corners: Floats, rule: NotchRule) -> Floats:
    return notch_arcs(length, rule, corners=[*corners.tolist(), *rule.partner_corners])


@dataclass(frozen=True, slots=True, eq=False)
class _Ground:
    """What a notch stands on: the piece's outlines, ready to be asked."""

    rings: shapely.MultiLineString
    sew: shapely.Polygon
    corners: shapely.MultiPoint
    widths: PerSide


def placed_notches(
    strip: FlatStrip,
    arcs: tuple[Floats, Floats],
    outlines: tuple[Outline, Outline],
    cut_outs: Sequence[Floats],
    widths: PerSide,
    chosen: PieceSettings,
) -> tuple[tuple[Notch, ...], tuple[Refusal, ...]]:
    """Returns the notches of one piece, sorted by side, then by arc, and those that cannot stand.

    Args:
        strip: the piece's part of the strip, in the piece's frame.
        arcs: of the notches on the whole rails P and Q; those off this part are left out.
        outlines: its sew line and its cut line.
        cut_outs: (k, 2) mm each, what its allowance encloses.
        widths: mm, its allowances in the order of ``SIDES``.
        chosen: form and depth of a notch.
    """
    sew, cut = outlines
    ground = _Ground(
        shapely.MultiLineString([np.vstack((ring, ring[:1])) for ring in (cut.points, *cut_outs)]),
        shapely.Polygon(sew.points),
        shapely.MultiPoint(cut.points[cut.corners]),
        widths,
    )
    shapely.prepare(ground.sew)
    notches: list[Notch] = []
    refused: list[Refusal] = []
    for side, line, rail_arcs, at in _seams(strip, arcs):
        feet, along = points_and_directions(line, rail_arcs, at)
        # P and the end are walked with the piece on the left, Q and the start on the right.
        turn = 1.0 if side in (P_SIDE, END_SIDE) else -1.0
        outward = turn * np.column_stack((along[:, 1], -along[:, 0]))
        for arc, foot, out in zip(at.tolist(), feet, outward, strict=True):
            made = _notch(side, arc, foot, out, ground, chosen)
            if isinstance(made, Notch):
                notches.append(made)
            else:
                refused.append(Refusal(side, arc, made))
    kept, crossing = _apart(notches)
    return tuple(kept), (*refused, *crossing)


def _seams(
    strip: FlatStrip, arcs: tuple[Floats, Floats]
) -> list[tuple[int, Floats, Floats, Floats]]:
    """Returns (side, line, arc lengths of its points, arcs of notches) of the sides with notches.

    A ruling at which a longer strip was cut apart has two notches.
    """
    seams = []
    for side, line, rail_arcs, at in (
        (P_SIDE, strip.p_line, strip.p_arc, arcs[0]),
        (Q_SIDE, strip.q_line, strip.q_arc, arcs[1]),
    ):
        seams.append((side, line, rail_arcs, at[(at > rail_arcs[0]) & (at < rail_arcs[-1])]))
    for side, is_cut, i in (
        (START_SIDE, strip.starts_at_cut, 0),
        (END_SIDE, strip.ends_at_cut, -1),
    ):
        if is_cut:
            line = np.vstack((strip.p_line[i], strip.q_line[i]))
            length = float(np.hypot(*(line[1] - line[0])))
            at = notch_arcs(length, NotchRule(count=2))
            seams.append((side, line, np.array([0.0, length]), at))
    return seams


def _notch(
    side: int, arc: float, foot: Floats, out: Floats, ground: _Ground, chosen: PieceSettings
) -> Notch | str:
    """Returns the notch of a seam point, or why there can be none."""
    width = ground.widths[side]
    reach = chosen.mitre_limit * width
    position = _on_cut_line(foot, out, width, reach, ground, chosen.tolerance)
    if isinstance(position, str):
        return position
    left = float(np.hypot(*(position - foot)))
    is_cut = width > 0.0
    if left < _TRIMMED * width:
        return f"only {left:.2g} of {width:g} mm of its allowance are left"
    depth = min(chosen.notch_depth, 0.25 * _room(ground.rings, position, -out))
    if is_cut:
        depth = min(depth, _DEPTH_PER_ALLOWANCE * min(width, left))
    notch = Notch(
        side=side,
        arc=arc,
        seam=frozen(foot),
        position=frozen(position),
        direction=frozen(-out),
        depth=depth,
        width=min(chosen.notch_width, 2.0 * depth),
        kind=chosen.notch_kind,
        is_cut=is_cut,
    )
    corner = float(_shape(notch).distance(ground.corners))
    if corner < _APART:
        return f"it would stand {corner:.2g} mm from a corner of the cut line"
    return notch


def _on_cut_line(
    foot: Floats, out: Floats, width: float, reach: float, ground: _Ground, tolerance: float
) -> Floats | str:
    """Returns where the cut line lies straight out from a foot on the sew line, or why nowhere."""
    rings = ground.rings
    expected = foot + width * out
    if rings.distance(shapely.Point(expected)) > tolerance:
        # Trimmed or mitred here: the first crossing of the cut line on the way out.
        ray = shapely.LineString((foot, foot + max(reach, tolerance) * out))
        crossing = shapely.intersection(rings, ray)
        if crossing.is_empty:
            far = float(np.hypot(*np.subtract(rings.bounds[2:], rings.bounds[:2])))
            long_ray = shapely.LineString((foot, foot + far * out))
            met = shapely.intersection(rings, long_ray)
            away = shapely.distance(shapely.Point(foot), shapely.get_parts(met))
            return (
                f"straight out, the cut line is {float(away.min()):.3g} mm away; at most "
                f"{reach:g} mm are allowed"
            )
        distances = shapely.distance(shapely.Point(foot), shapely.get_parts(crossing))
        expected = foot + float(distances.min()) * out
    snapped = np.array(shapely.shortest_line(rings, shapely.Point(expected)).coords[0])
    way = shapely.LineString((foot, snapped))
    # The flat sew line is cleaned within the tolerance, so a foot may lie that far inside.
    if shapely.intersection(way, ground.sew).length > 2.0 * tolerance:
        return "the way to its cut line leads through the piece itself"
    return snapped


def _room(rings: shapely.MultiLineString, position: Floats, inward: Floats) -> float:
    """Returns the way in mm from the cut line straight to the other side of the piece."""
    far = float(np.hypot(*np.subtract(rings.bounds[2:], rings.bounds[:2])))
    ray = shapely.LineString((position + 1e-6 * far * inward, position + far * inward))
    crossing = shapely.intersection(rings, ray)
    return far if crossing.is_empty else float(crossing.distance(shapely.Point(position)))


def _shape(notch: Notch) -> shapely.MultiLineString:
    return shapely.MultiLineString(notch_lines(notch))


def _apart(notches: Sequence[Notch]) -> tuple[list[Notch], list[Refusal]]:
    """Returns the notches that keep apart from all before them, and the others."""
    kept: list[Notch] = []
    shapes: list[shapely.Geometry] = []
    refused = []
    for notch in notches:
        shape = _shape(notch)
        nearest = min((float(shape.distance(other)) for other in shapes), default=np.inf)
        if nearest < _APART:
            reason = f"it would stand {nearest:.2g} mm from another notch"
            refused.append(Refusal(notch.side, notch.arc, reason))
        else:
            kept.append(notch)
            shapes.append(shape)
    return kept, refused

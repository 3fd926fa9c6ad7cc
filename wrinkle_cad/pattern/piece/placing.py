"""Notches on a piece: from arc lengths on the rails to marks on the cut line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from wrinkle_cad import settings as defaults

from .flat import FlatStrip
from .notches import corner_arcs, notch_arcs, points_at
from .options import END_SIDE, P_SIDE, Q_SIDE, START_SIDE, NotchRule, PerSide, PieceSettings
from .piece import Floats, Notch, Outline, frozen


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


def placed_notches(
    strip: FlatStrip,
    arcs: tuple[Floats, Floats],
    cut: Outline,
    widths: PerSide,
    chosen: PieceSettings,
) -> tuple[Notch, ...]:
    """Returns the notches of one piece, sorted by side, then by arc.

    Args:
        strip: the piece's part of the strip, in the piece's frame.
        arcs: of the notches on the whole rails P and Q; those off this part are left out.
        cut: its cut line.
        widths: mm, its allowances in the order of ``SIDES``.
        chosen: form and depth of a notch.
    """
    ring = shapely.LinearRing(cut.points)
    notches: list[Notch] = []
    for side, line, rail_arcs, at in (
        (P_SIDE, strip.p_line, strip.p_arc, arcs[0]),
        (Q_SIDE, strip.q_line, strip.q_arc, arcs[1]),
    ):
        here = at[(at > rail_arcs[0]) & (at < rail_arcs[-1])]
        notches += _on_line(side, line, rail_arcs, here, ring, widths[side], chosen)
    for side, is_cut, i in (
        (START_SIDE, strip.starts_at_cut, 0),
        (END_SIDE, strip.ends_at_cut, -1),
    ):
        line = np.vstack((strip.p_line[i], strip.q_line[i]))
        length = float(np.hypot(*(line[1] - line[0])))
        if is_cut:
            at = notch_arcs(length, NotchRule(count=2))
            rail_arcs = np.array([0.0, length])
            notches += _on_line(side, line, rail_arcs, at, ring, widths[side], chosen)
    return tuple(notches)


def _on_line(
    side: int,
    line: Floats,
    arcs: Floats,
    at: Floats,
    ring: shapely.LinearRing,
    width: float,
    chosen: PieceSettings,
) -> list[Notch]:
    if not len(at):
        return []
    feet, along = points_at(line, arcs, at)
    # P and the end are walked with the piece on the left, Q and the start with it on the right.
    turn = 1.0 if side in (P_SIDE, END_SIDE) else -1.0
    outward = turn * np.column_stack((along[:, 1], -along[:, 0]))
    notches = []
    for arc, foot, out in zip(at, feet, outward, strict=True):
        position = _on_ring(ring, foot, out, width, chosen.tolerance)
        room = _room(ring, position, -out)
        depth = min(chosen.notch_depth, 0.25 * room)
        if width > 0.0:
            depth = min(depth, defaults.NOTCH_DEPTH_PER_ALLOWANCE * width)
        notches.append(
            Notch(
                side=side,
                arc=float(arc),
                seam=frozen(foot),
                position=frozen(position),
                direction=frozen(-out),
                depth=depth,
                width=min(chosen.notch_width, 2.0 * depth),
                kind=chosen.notch_kind,
            )
        )
    return notches


def _on_ring(
    ring: shapely.LinearRing, foot: Floats, out: Floats, width: float, tolerance: float
) -> Floats:
    """Returns where the cut line lies straight out from a foot on the sew line."""
    expected = foot + width * out
    if ring.distance(shapely.Point(expected)) > tolerance:
        # Trimmed or mitred here: the first crossing of the cut line on the way out.
        ray = shapely.LineString((foot, foot + 100.0 * max(width, tolerance) * out))
        crossing = shapely.intersection(ring, ray)
        if not crossing.is_empty:
            reach = shapely.distance(shapely.Point(foot), shapely.get_parts(crossing))
            expected = foot + float(reach.min()) * out
    snapped = ring.interpolate(ring.project(shapely.Point(expected)))
    return np.array(snapped.coords[0])


def _room(ring: shapely.LinearRing, position: Floats, inward: Floats) -> float:
    """Returns the way in mm from the cut line straight to the other side of the piece."""
    far = float(np.hypot(*np.subtract(ring.bounds[2:], ring.bounds[:2])))
    ray = shapely.LineString((position + 1e-6 * far * inward, position + far * inward))
    crossing = shapely.intersection(ring, ray)
    return far if crossing.is_empty else float(crossing.distance(shapely.Point(position)))

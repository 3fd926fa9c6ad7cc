"""Where notches stand on a rail: one rule for the pattern and for the edge it is sewn to.

A position is an arc length along the rail in space. The pattern's P seam and the opening's P edge
are equally long, so equal arc lengths are points that meet when sewn.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.polyline import points_at, row_lengths

from .options import NotchRule
from .outline import turns
from .piece import Floats


def notch_arcs(
    length: float,
    rule: NotchRule,
    *,
    corners: Sequence[float] = (),
) -> Floats:
    """Returns the arc lengths of the notches on a rail, (k,) mm from its start, ascending.

    Counted and spaced notches nearer to a corner than ``settings.NOTCH_CLEARANCE`` move to the
    nearest place with room; those that would crowd another there are left out, so fewer may come
    back.

    Args:
        length: mm, of the rail in space.
        rule: how many, how far apart, or where.
        corners: mm; arc lengths of corners between the ends, which are corners themselves.

    Raises:
        InputError: a position given by the user lies on a corner or off the rail.
    """
    clearance = settings.NOTCH_CLEARANCE
    stops = np.unique(np.concatenate(([0.0], np.asarray(corners, dtype=np.float64), [length])))
    if rule.at:
        arcs = np.unique(np.array(rule.at, dtype=np.float64))
        nearest = np.abs(arcs[:, None] - stops).min(axis=1)
        outside = (arcs < 0.0) | (arcs > length)
        for i in np.flatnonzero(outside | (nearest < clearance)):
            raise InputError(
                f"The notch at {arcs[i]:g} mm is {nearest[i]:g} mm from a corner or end of a rail "
                f"of {length:g} mm. Move it to at least {clearance:g} mm from them, on the rail."
            )
        return arcs
    count = rule.count
    if rule.spacing is not None:
        count = max(0, round(length / rule.spacing) - 1)
    arcs = length * np.arange(1, count + 1) / (count + 1)
    return _off_corners(arcs, stops, clearance)


def _off_corners(arcs: Floats, stops: Floats, clearance: float) -> Floats:
    """Returns the arcs moved to the nearest place that is clear of the stops, crowded ones left."""
    low, high = stops[:-1] + clearance, stops[1:] - clearance
    low, high = low[low <= high], high[low <= high]
    if not len(low) or not len(arcs):
        return np.zeros(0)
    places = np.clip(arcs[:, None], low, high)
    nearest = np.argmin(np.abs(places - arcs[:, None]), axis=1)
    moved = np.unique(places[np.arange(len(arcs)), nearest])
    least = min(clearance, 0.5 * float(arcs[0]))
    kept = [float(moved[0])]
    for arc in moved[1:]:
        if arc - kept[-1] >= least:
            kept.append(float(arc))
    return np.array(kept)


def corner_arcs(line: Floats, arcs: Floats) -> Floats:
    """Returns the arc lengths at which a flat rail has a corner, ends not counted.

    Args:
        line: (k, 2) mm, the flat rail.
        arcs: (k,) mm, arc length in space at each of its points.
    """
    if len(line) < 3:
        return np.zeros(0)
    inner: Floats = arcs[1:-1][np.abs(turns(line)) > settings.PATTERN_CORNER]
    return inner


def points_and_directions(line: Floats, arcs: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Returns points (k, 2) mm and unit directions (k, 2) on a flat rail at given arc lengths.

    Args:
        line: (l, 2) mm.
        arcs: (l,) mm, arc length in space at each of its points, ascending.
        at: (k,) mm, on the rail.
    """
    i = np.clip(np.searchsorted(arcs, at, side="right") - 1, 0, len(arcs) - 2)
    step = line[i + 1] - line[i]
    lengths = row_lengths(step)
    return points_at(line, arcs, at), step / np.where(lengths > 0.0, lengths, 1.0)[:, None]

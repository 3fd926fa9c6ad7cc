"""Gaps: the stretches of a strip whose rulings twist, so that a flat sheet must give there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from .surface import RuledStrip

NEAR_PER_WIDTH: Final = 0.05
"""Gaps so close to each other, in shares of the ruling between them, are one."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A stretch without exact rulings, between two that have them or an end of the strip."""

    first: int
    """Number of its first ruling."""
    last: int
    """Number of its last ruling."""
    length: float
    """mm along the middle of the strip."""
    twist: float
    """rad, where the strain is largest: the turn from the tangent plane at P's end of the ruling
    to that at Q's; positive if right-handed about the direction from P to Q."""
    strain: float
    """The largest strain, 0 to 1."""
    place: int
    """Number of the interval between rulings where that is."""


def gaps_of(strip: RuledStrip) -> tuple[Gap, ...]:
    """Returns the gaps in order along the strip.

    Args:
        strip: its exact surface.
    """
    bounds: list[tuple[int, int]] = []
    for piece in strip.pieces:
        if piece.kind != "gap":
            continue
        if bounds and _is_near(strip, bounds[-1][1], piece.first):
            bounds[-1] = (bounds[-1][0], piece.last)
        else:
            bounds.append((piece.first, piece.last))
    return tuple(_gap(strip, first, last) for first, last in bounds)


def _is_near(strip: RuledStrip, before: int, after: int) -> bool:
    between = float(np.cumsum(strip.strain.length[before:after])[-1]) if after > before else 0.0
    return between <= NEAR_PER_WIDTH * float(strip.sheet.reach[before])


def _gap(strip: RuledStrip, first: int, last: int) -> Gap:
    sheet, run = strip.sheet, slice(first, last)
    twist = (sheet.twist[run, 0] + sheet.twist[run, 1]) / 2.0
    share = strip.strain.share[run]
    worst = int(np.argmax(share)) if share.max() > 0.0 else int(np.argmax(np.abs(twist)))
    return Gap(
        first=first,
        last=last,
        length=float(np.cumsum(strip.strain.length[run])[-1]),
        twist=float(twist[worst]),
        strain=float(share[worst]),
        place=first + worst,
    )

"""What is cut for a notch: its form as polylines."""

from __future__ import annotations

import numpy as np

from .options import NotchKind
from .piece import Floats, Notch, frozen


def notch_lines(notch: Notch) -> tuple[Floats, ...]:
    """Returns the polylines, (k, 2) mm each, of a notch, from the cut line inward.

    A mark (where there is no allowance to cut into) is one straight line.
    """
    along = np.array((notch.direction[1], -notch.direction[0]))
    foot = notch.position
    tip = foot + notch.depth * notch.direction
    if not notch.is_cut:
        return (frozen(np.vstack((foot, tip))),)
    half = 0.5 * notch.width * along
    shoulder = 0.75 * notch.depth * notch.direction
    shapes: dict[NotchKind, tuple[tuple[Floats, ...], ...]] = {
        "slit": ((foot, tip),),
        "v": ((foot - half, tip, foot + half),),
        "t": ((foot, tip), (tip - half, tip + half)),
        "castle": ((foot - half, tip - half, tip + half, foot + half),),
        "check": ((foot, tip, foot + half),),
        "u": (
            (
                foot - half,
                foot - half + shoulder,
                tip - 0.5 * half,
                tip + 0.5 * half,
                foot + half + shoulder,
                foot + half,
            ),
        ),
    }
    return tuple(frozen(np.vstack(line)) for line in shapes[notch.kind])

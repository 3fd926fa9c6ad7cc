"""Which steps of a triangulation become one face.

A fan is a run of steps on one rail that share their apex on the other. It ends where the rail is
not C1, so that no face has a crease, and before and after a step whose triangle is thin: that has
an apex in line with its bank edge, as where the rails meet, and is looked at on its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.triangulation import Q_STEP, Triangulation

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Fan:
    """A run of steps with one apex; bridges are counted along the path."""

    side: int
    """P_STEP: the bank is on P and the apex on Q; Q_STEP: the other way round."""

    early: int
    """The bridge before the first step."""

    late: int
    """The bridge after the last step."""

    start: int
    """Index of the sample on the bank's rail where the bank starts."""

    end: int
    """... and where it ends."""

    apex: int
    """Index of the apex on the other rail."""

    is_thin: bool
    """Whether the only triangle is thin."""


def fans_of(
    triangulation: Triangulation,
    corners: tuple[Bools, Bools],
    thin: Bools,
    *,
    is_merged: bool,
) -> list[Fan]:
    """Returns the fans of a triangulation along its path.

    Args:
        triangulation: the strip.
        corners: (m,) and (n,) bool; samples of P and of Q that no face may reach across.
        thin: (m+n-2,) bool; triangles that are looked at on their own.
        is_merged: whether steps are merged at all; if not, each is a fan.
    """
    steps, bridges = triangulation.steps, triangulation.bridges
    inner = bridges[1:-1]
    is_q = steps[1:] == Q_STEP
    corner = np.where(is_q, corners[1][inner[:, 1]], corners[0][inner[:, 0]])
    joins = (steps[1:] == steps[:-1]) & ~corner & ~thin[1:] & ~thin[:-1] & is_merged
    firsts = np.concatenate(([0], np.flatnonzero(~joins) + 1, [len(steps)]))
    fans = []
    for early, late in zip(firsts[:-1].tolist(), firsts[1:].tolist(), strict=True):
        side = int(steps[early])
        start, apex = (
            int(at) for at in (bridges[early] if side != Q_STEP else bridges[early][::-1])
        )
        fans.append(Fan(side, early, late, start, start + late - early, apex, bool(thin[early])))
    return fans


def thin_triangles(triangulation: Triangulation, limit: float) -> Bools:
    """Returns (m+n-2,) bool: triangles no higher over their longest side than ``limit`` mm."""
    points = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles]
    sides = np.roll(points, -1, axis=1) - points
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    area2 = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return np.asarray(area2 <= limit * longest, dtype=np.bool_)

"""Which steps of a triangulation become one face.

A flat part is a run of steps in one plane. Elsewhere a fan is a run of steps on one rail that share
their apex on the other. It ends where the rail is not C1, so that no face has a crease, and before
and after a step whose triangle is thin: that has an apex in line with its bank edge, as where the
rails meet, and is looked at on its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.flat.planes import plane_normal
from wrinkle_cad.strip.triangulation import P_STEP, Q_STEP, Triangulation

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Bank:
    """A stretch of a rail without a corner inside."""

    side: int
    """P_STEP: it is on P; Q_STEP: on Q."""

    start: int
    """Index of the sample where it starts."""

    end: int
    """... and where it ends."""


@dataclass(frozen=True, slots=True)
class Fan:
    """A run of steps with one apex; bridges are counted along the path."""

    bank: Bank
    """What it stands on; its apex is on the other rail."""

    early: int
    """The bridge before the first step."""

    late: int
    """The bridge after the last step."""

    apex: int
    """Index of the apex on the other rail."""

    is_thin: bool
    """Whether the only triangle is thin."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatPart:
    """A run of steps in one plane; bridges are counted along the path."""

    early: int
    """The bridge before the first step."""

    late: int
    """The bridge after the last step."""

    banks: tuple[Bank, ...]
    """Its outline on P and on Q, each in the order of its rail."""

    normal: Floats
    """(3,); unit, to where its triangles are counter-clockwise."""


def flat_part(
    triangulation: Triangulation, corners: tuple[Bools, Bools], early: int, late: int
) -> FlatPart:
    """Returns the flat part between two bridges.

    Args:
        triangulation: the strip.
        corners: (m,) and (n,) bool; samples of P and of Q where a bank ends.
        early: the bridge before it.
        late: the bridge after it.
    """
    banks = []
    for side in (P_STEP, Q_STEP):
        start, end = (int(triangulation.bridges[at][side]) for at in (early, late))
        stops = [start, *(start + 1 + np.flatnonzero(corners[side][start + 1 : end])), end]
        banks += [Bank(side, int(a), int(b)) for a, b in pairwise(stops) if a < b]
    return FlatPart(early, late, tuple(banks), plane_normal(triangulation, early, late))


def fans_of(
    triangulation: Triangulation,
    corners: tuple[Bools, Bools],
    thin: Bools,
    flat: Bools,
    *,
    is_merged: bool,
) -> list[Fan]:
    """Returns the fans of a triangulation along its path, but for its flat parts.

    Args:
        triangulation: the strip.
        corners: (m,) and (n,) bool; samples of P and of Q that no face may reach across.
        thin: (m+n-2,) bool; triangles that are looked at on their own.
        flat: (m+n-2,) bool; steps that lie in flat parts.
        is_merged: whether steps are merged at all; if not, each is a fan.
    """
    steps, bridges = triangulation.steps, triangulation.bridges
    inner = bridges[1:-1]
    is_q = steps[1:] == Q_STEP
    corner = np.where(is_q, corners[1][inner[:, 1]], corners[0][inner[:, 0]])
    alone = thin | flat
    joins = (steps[1:] == steps[:-1]) & ~corner & ~alone[1:] & ~alone[:-1] & is_merged
    firsts = np.concatenate(([0], np.flatnonzero(~joins) + 1, [len(steps)]))
    spans = zip(firsts[:-1].tolist(), firsts[1:].tolist(), strict=True)
    return [
        fan_between(triangulation, early, late, is_thin=bool(thin[early]))
        for early, late in spans
        if not flat[early]
    ]


def fan_between(triangulation: Triangulation, early: int, late: int, *, is_thin: bool) -> Fan:
    """Returns the fan between two bridges; all steps between them are of one kind."""
    side = int(triangulation.steps[early])
    start, apex = (int(at) for at in triangulation.bridges[early][:: 1 if side == P_STEP else -1])
    return Fan(Bank(side, start, start + late - early), early, late, apex, is_thin)


def thin_triangles(triangulation: Triangulation, limit: float) -> Bools:
    """Returns (m+n-2,) bool: triangles no higher over their longest side than ``limit`` mm."""
    points = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles]
    sides = np.roll(points, -1, axis=1) - points
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    area2 = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return np.asarray(area2 <= limit * longest, dtype=np.bool_)

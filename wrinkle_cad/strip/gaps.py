"""The gap list: where along a strip it is not developable, how far, and why.

Kinds of gap:

- `inflection`: the bending changes sign there and the sampling cannot show the ruling; no defect.
- `twist`: the sheet would have to turn along its rulings; what it turns is undone further on.
- `fan end`: the sheet turns into or out of a fan of rulings (a cone through one sample) or another
  crease and does not turn back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import TWIST_PER_FOLD

from .triangulation import P_STEP, Triangulation

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Kind = Literal["inflection", "twist", "fan end"]


@dataclass(frozen=True, slots=True, eq=False)
class Gap:
    """A run of invalid interior bridges between valid ones."""

    first: int
    """Number of its first bridge on the path."""
    last: int
    """Number of its last bridge on the path; first and last are the same for a single bridge."""
    start: tuple[int, int]
    """Samples i of P and j of Q of the first bridge."""
    end: tuple[int, int]
    """Samples i of P and j of Q of the last bridge."""
    p_length: float
    """mm of P that its bridges cover."""
    q_length: float
    """mm of Q that its bridges cover."""
    angle_defect: float
    """rad; the largest angle by which the tangent planes at both ends of a bridge differ, 0 if all
    its bridges stand inside a fan. Positive if the plane that follows Q is turned right-handed
    about the direction from P to Q against the one that follows P."""
    twist: float
    """rad, not negative; the largest twist of its bridges."""
    kind: Kind
    """Why its bridges are invalid."""


def find_gaps(triangulation: Triangulation) -> tuple[Gap, ...]:
    """Returns the runs of invalid interior bridges, in order along the strip."""
    invalid = ~triangulation.valid
    invalid[[0, -1]] = False
    edges = np.flatnonzero(np.diff(invalid)) + 1
    shares = [_shares(triangulation, rail) for rail in (0, 1)]
    defect = _defects(triangulation)
    return tuple(
        _gap(triangulation, int(first), int(stop), shares, defect)
        for first, stop in zip(edges[::2], edges[1::2], strict=True)
    )


def covered_lengths(triangulation: Triangulation, marked: npt.ArrayLike) -> tuple[float, float]:
    """Returns how many mm of P and of Q the marked bridges cover.

    A bridge covers each bank edge beside it by half; all bridges together cover both rails.

    Args:
        triangulation: the strip.
        marked: (m+n-1,) bool; for instance `~triangulation.valid & ~triangulation.inflection`.
    """
    chosen = np.asarray(marked, dtype=np.bool_)
    p_share, q_share = (_shares(triangulation, rail) for rail in (0, 1))
    return float(p_share[chosen].sum()), float(q_share[chosen].sum())


def _shares(triangulation: Triangulation, rail: int) -> Floats:
    """What each bridge covers of a rail, (k,) float64, mm."""
    points = triangulation.q if rail else triangulation.p
    moved = np.diff(points[triangulation.bridges[:, rail]], axis=0)
    half = 0.5 * np.sqrt((moved * moved).sum(axis=1))
    shares: Floats = np.append(half, 0.0) + np.append(0.0, half)
    return shares


def _defects(triangulation: Triangulation) -> Floats:
    """Turn of the plane along Q against the plane along P at each bridge, (k,) float64, rad."""
    before, after = triangulation.steps[:-1], triangulation.steps[1:]
    sign = np.where(before == P_STEP, 1.0, -1.0) * (before != after)
    return np.concatenate(([0.0], sign * triangulation.fold, [0.0]))


def _gap(
    triangulation: Triangulation, first: int, stop: int, shares: list[Floats], defect: Floats
) -> Gap:
    here = slice(first, stop)
    start, end = triangulation.bridges[first], triangulation.bridges[stop - 1]
    twist = float(triangulation.twist[here].max())
    steepest = float(np.abs(triangulation.fold[first - 1 : stop - 1]).max())
    kind: Kind = "fan end"
    if triangulation.inflection[here].all():
        kind = "inflection"
    elif twist > TWIST_PER_FOLD * steepest:
        kind = "twist"
    return Gap(
        first=first,
        last=stop - 1,
        start=(int(start[0]), int(start[1])),
        end=(int(end[0]), int(end[1])),
        p_length=float(shares[0][here].sum()),
        q_length=float(shares[1][here].sum()),
        angle_defect=float(defect[here][np.abs(defect[here]).argmax()]),
        twist=twist,
        kind=kind,
    )

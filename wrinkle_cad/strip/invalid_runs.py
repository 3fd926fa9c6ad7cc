"""Runs of bridges that are not locally convex: figures of the search, not of the sheet.

Kinds of run:

- `inflection`: the bending changes sign there and the sampling cannot show the ruling; no defect.
- `twist`: the rails' tangents differ along the rulings, and the surface turns with them.
- `fan end`: they differ, but the surface does not turn: rulings gather in a fan (a cone through one
  sample), and the rail through its apex leaves the tangent plane where the fan begins or ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import TWIST_PER_DEFECT
from wrinkle_cad.strip.portable import atan2

from .curve.polyline import segment_lengths
from .cut_open import cut_at
from .sightlines import BEFORE_P, BEFORE_Q, NEXT_P, NEXT_Q, look_along_path, padded_banks
from .triangulation import Triangulation

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Kind = Literal["inflection", "twist", "fan end"]


@dataclass(frozen=True, slots=True, eq=False)
class InvalidRun:
    """A run of invalid interior bridges between valid ones.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> x = np.linspace(0.0, 40.0, 9)
        >>> p = np.stack((x, 0 * x, 2 * np.sin(x / 4)), axis=1)
        >>> q = np.stack((x, 0 * x + 15, 2 * np.cos(x / 3)), axis=1)
        >>> [(run.kind, run.first, run.last) for run in find_invalid_runs(triangulate(p, q))]
        [('inflection', 7, 7), ('inflection', 12, 12)]
    """

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
    """rad, in (-pi, pi]; the largest angle from P's tangent to Q's, seen along one of its bridges;
    positive if right-handed about the direction from P to Q. Turning one rail's
    tangent by as much makes it locally convex."""
    twist: float
    """rad, not negative; the largest twist of its bridges."""
    kind: Kind
    """Why its bridges are invalid."""


def find_invalid_runs(triangulation: Triangulation) -> tuple[InvalidRun, ...]:
    """Returns the runs of invalid interior bridges, in order along the strip.

    A run of a closed strip may go on past its last bridge, which is its first one again; its
    numbers then do so too, and if no bridge is valid there is one run of them all.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> flat = triangulate([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 0], [1, 1, 0], [2, 1, 0]])
        >>> find_invalid_runs(flat)
        ()
    """
    count = len(triangulation.steps)
    if triangulation.is_closed:
        return _runs_around(triangulation, count)
    invalid = ~triangulation.valid
    invalid[[0, -1]] = False
    return _runs_in(triangulation, invalid)


def _runs_around(closed: Triangulation, count: int) -> tuple[InvalidRun, ...]:
    """The runs of a closed strip, looked for from a valid bridge on, around to it again."""
    valid = np.flatnonzero(closed.valid[:-1])
    first = int(valid[0]) if len(valid) else 0
    # Three turns, so that every bridge of the one that is looked at has both its neighbours.
    around = cut_at(closed, first, turns=3)
    invalid = ~around.valid
    invalid[:count] = invalid[2 * count :] = False
    shift = closed.bridges[first]
    m, n = len(closed.p), len(closed.q)

    def placed(at: tuple[int, int]) -> tuple[int, int]:
        return (at[0] + int(shift[0])) % m, (at[1] + int(shift[1])) % n

    return tuple(
        replace(
            run,
            first=(run.first - count + first) % count,
            last=(run.first - count + first) % count + run.last - run.first,
            start=placed(run.start),
            end=placed(run.end),
        )
        for run in _runs_in(around, invalid)
    )


def _runs_in(triangulation: Triangulation, invalid: Bools) -> tuple[InvalidRun, ...]:
    edges = np.flatnonzero(np.diff(invalid)) + 1
    shares = [_shares(triangulation, rail) for rail in (0, 1)]
    defect = _defects(triangulation)
    return tuple(
        _run(triangulation, int(first), int(stop), shares, defect)
        for first, stop in zip(edges[::2], edges[1::2], strict=True)
    )


def covered_lengths(triangulation: Triangulation, marked: npt.ArrayLike) -> tuple[float, float]:
    """Returns how many mm of P and of Q the marked bridges cover.

    A bridge covers each bank edge beside it by half; all bridges together cover both rails.

    Args:
        triangulation: the strip.
        marked: a bool per bridge; for instance `~triangulation.valid & ~triangulation.inflection`.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> flat = triangulate([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 0], [1, 1, 0], [3, 1, 0]])
        >>> covered_lengths(flat, flat.valid)
        (2.0, 3.0)
    """
    chosen = np.asarray(marked, dtype=np.bool_)
    p_share, q_share = (_shares(triangulation, rail) for rail in (0, 1))
    return float(p_share[chosen].sum()), float(q_share[chosen].sum())


def _shares(triangulation: Triangulation, rail: int) -> Floats:
    """What each bridge covers of a rail, (k,) float64, mm."""
    points = triangulation.q if rail else triangulation.p
    half = 0.5 * segment_lengths(points[triangulation.bridges[:, rail] % len(points)])
    shares: Floats = np.append(half, 0.0) + np.append(0.0, half)
    if triangulation.is_closed:
        # The first bridge stands for the last one too.
        shares[0], shares[-1] = shares[0] + shares[-1], 0.0
    return shares


def _defects(triangulation: Triangulation) -> Floats:
    """Angle from the tangent of P to that of Q seen along each bridge, (k,) float64, rad.

    The tangent at a sample is the direction from the one before it to the one after.
    """
    p, q = triangulation.p, triangulation.q
    columns = np.ascontiguousarray(q.T)
    view = look_along_path(p, padded_banks(p), columns, padded_banks(q), triangulation.bridges)
    ax, ay = view[NEXT_P : NEXT_P + 2] - view[BEFORE_P : BEFORE_P + 2]
    bx, by = view[NEXT_Q : NEXT_Q + 2] - view[BEFORE_Q : BEFORE_Q + 2]
    angle: Floats = atan2(ax * by - ay * bx, ax * bx + ay * by)
    return angle


def _run(
    triangulation: Triangulation, first: int, stop: int, shares: list[Floats], defect: Floats
) -> InvalidRun:
    here = slice(first, stop)
    start, end = triangulation.bridges[first], triangulation.bridges[stop - 1]
    twist = float(triangulation.twist[here].max())
    worst = float(defect[here][np.abs(defect[here]).argmax()])
    kind: Kind = "fan end"
    if triangulation.inflection[here].all():
        kind = "inflection"
    elif twist > TWIST_PER_DEFECT * abs(worst):
        kind = "twist"
    return InvalidRun(
        first=first,
        last=stop - 1,
        start=(int(start[0]), int(start[1])),
        end=(int(end[0]), int(end[1])),
        p_length=float(shares[0][here].sum()),
        q_length=float(shares[1][here].sum()),
        angle_defect=worst,
        twist=twist,
        kind=kind,
    )


def run_entry(run: InvalidRun) -> dict[str, Any]:
    """A run as plain values for the JSON: lengths in mm, angles in degrees."""
    return {
        "kind": run.kind,
        "first_bridge": run.first,
        "last_bridge": run.last,
        "start": list(run.start),
        "end": list(run.end),
        "p_length_mm": run.p_length,
        "q_length_mm": run.q_length,
        "angle_defect_deg": math.degrees(run.angle_defect),
        "twist_deg": math.degrees(run.twist),
    }

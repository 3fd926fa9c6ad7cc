"""The bends of a piece, for makers who fold it: where, how far, how sharply and which way.

Every ruling at which the sheet folds is a bend. A press brake makes fewer: then each run of rulings
that bend the same way gets its share of ``k`` equal bends, each in the middle of its share of the
angle. Between two bends the sheet stays flat and leaves the curve by r (1 - cos(a / 2)), with a
the angle of one bend and r the radius there: on a circular arc r (1 - cos(theta / 2k)).
"""

from __future__ import annotations

import math

import numpy as np

from wrinkle_cad import settings

from .flat import FlatStrip
from .piece import Bends, Floats, frozen


def all_bends(strip: FlatStrip) -> Bends:
    """Returns a bend for every ruling of a flat strip at which it is folded."""
    fold = np.array(strip.fold)
    if len(fold) > 2:
        # The ends of a piece are edges, and where a longer strip was cut the seam.
        fold[[0, -1]] = 0.0
    is_folded = np.abs(fold) >= settings.FLAT_FOLD
    lines = np.stack((strip.p[strip.bridges[:, 0]], strip.q[strip.bridges[:, 1]]), axis=1)
    middles = 0.5 * (lines[:, 0] + lines[:, 1])
    # From the facet before to the one after: unfolded diagonals lie inside a facet.
    stops = np.vstack((middles[:1], middles[is_folded], middles[-1:]))
    steps = np.hypot(*np.diff(stops, axis=0).T)
    spacing = 0.5 * (steps[:-1] + steps[1:])
    return Bends(
        lines=frozen(lines[is_folded]),
        fold=frozen(fold[is_folded]),
        arcs=frozen(_arcs(strip)[is_folded]),
        radius=frozen(spacing / np.abs(fold[is_folded])),
        deviation=0.0,
    )


def equal_bends(bends: Bends, count: int) -> Bends:
    """Returns ``count`` bends instead of all, or one for each run that bends one way if more.

    Args:
        bends: of every ruling, in order.
        count: of bends wanted.
    """
    if not len(bends.fold):
        return bends
    sign = np.sign(bends.fold)
    starts = np.flatnonzero(np.append(True, sign[1:] != sign[:-1]))
    stops = np.append(starts[1:], len(sign))
    runs = list(zip(starts.tolist(), stops.tolist(), strict=True))
    totals = [math.fsum(np.abs(bends.fold[start:stop]).tolist()) for start, stop in runs]
    shares = _shared_out(totals, count)
    rows = [
        row
        for (start, stop), total, share in zip(runs, totals, shares, strict=True)
        for row in _run(bends, start, stop, total, share)
    ]
    return Bends(
        lines=frozen(np.array([row[0] for row in rows])),
        fold=frozen(np.array([row[1] for row in rows])),
        arcs=frozen(np.array([row[2] for row in rows])),
        radius=frozen(np.zeros(len(rows))),
        deviation=max(row[3] for row in rows),
    )


def _arcs(strip: FlatStrip) -> Floats:
    """Returns arc lengths in mm along P and along Q at each bridge, (b, 2)."""
    p_arc = strip.p_arc[strip.p_index[strip.bridges[:, 0]]]
    q_arc = strip.q_arc[strip.q_index[strip.bridges[:, 1]]]
    return np.column_stack((p_arc, q_arc))


def _shared_out(totals: list[float], count: int) -> list[int]:
    """Returns bends for each run: at least one, the others where the angle of one is largest."""
    shares = [1] * len(totals)
    for _ in range(count - len(totals)):
        angles = [total / share for total, share in zip(totals, shares, strict=True)]
        shares[angles.index(max(angles))] += 1
    return shares


def _run(
    bends: Bends, start: int, stop: int, total: float, count: int
) -> list[tuple[Floats, float, Floats, float]]:
    """Returns (line, fold, arcs, deviation) of the bends that stand for a run of rulings."""
    folds = np.abs(bends.fold[start:stop])
    # Each ruling stands for its own angle, in the middle of it.
    reached = np.cumsum(folds) - 0.5 * folds
    angle = total / count
    targets = angle * (np.arange(count) + 0.5)

    def at(values: Floats) -> Floats:
        found: Floats = np.interp(targets, reached, values)
        return found

    lines = bends.lines[start:stop]
    ends = np.stack(
        [np.stack([at(lines[:, end, axis]) for axis in (0, 1)], axis=-1) for end in (0, 1)], axis=1
    )
    arcs = np.stack([at(bends.arcs[start:stop, side]) for side in (0, 1)], axis=-1)
    radii = at(bends.radius[start:stop])
    sign = math.copysign(1.0, float(bends.fold[start]))
    is_crease = stop - start == 1
    return [
        (
            ends[i],
            sign * angle,
            arcs[i],
            0.0 if is_crease else float(radii[i]) * (1.0 - math.cos(0.5 * angle)),
        )
        for i in range(count)
    ]

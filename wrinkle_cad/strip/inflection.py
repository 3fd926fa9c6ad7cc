"""What invalid bridges mean: a change of bending, which is harmless, or twist, which is not."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import (
    DOUBLE_INFLECTION_SAGITTAS,
    INFLECTION_SAGITTAS,
    INFLECTION_SAMPLES,
)

from .path import Path

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


def plane_misfit(view: Floats) -> Floats:
    """Returns how far the neighbours of each bridge lie from a common plane through it.

    Args:
        view: (9, k) float64, mm; bridges as look_along fills them in.

    Returns:
        (k,) float64, mm; the largest distance of a neighbour from the plane through the bridge for
        which that is smallest.
    """
    offsets = view[1:].reshape(4, 2, -1)
    misfit = np.full(view.shape[1], np.inf)
    # The best plane has two neighbours at the same distance, so it holds their sum or difference.
    for a, b in combinations(range(4), 2):
        for direction in (offsets[a] + offsets[b], offsets[a] - offsets[b]):
            size = np.hypot(*direction)
            side = np.abs(offsets[:, 0] * direction[1] - offsets[:, 1] * direction[0])
            distance = np.divide(
                side.max(axis=0), size, where=size > 0.0, out=np.full_like(size, np.inf)
            )
            misfit = np.minimum(misfit, distance)
    misfit[np.isinf(misfit)] = 0.0
    return misfit


def inflection_bridges(path: Path, sagitta: float) -> Bools:
    """Returns which invalid interior bridges stand at a change of bending and are no defect.

    Such a bridge has a valid one bent up before it and a valid one bent down behind it (or the
    reverse), both at most two samples away, counted on the rail where that is less; and its
    neighbours share a tangent plane to within what the sampling can tell. Where two changes of
    bending fall between samples it is a single bridge, bent against its valid neighbours.

    Args:
        path: the bridges, in order.
        sagitta: mm; typical sagitta of the rail that is sampled more coarsely.

    Returns:
        (k,) bool; a subset of the invalid interior bridges.
    """
    invalid = ~path.valid
    invalid[[0, -1]] = False
    misfit = np.zeros(invalid.size)
    misfit[invalid] = plane_misfit(path.view[:, invalid])
    fold = np.concatenate(([0.0], path.fold, [0.0]))
    is_change = _changes(path.bridges, path.valid, fold) & (misfit <= INFLECTION_SAGITTAS * sagitta)
    # The first and the last bridge have no fold, so they contradict no interior one.
    opposed = (fold[:-1] * fold[1:] < 0.0) & ~(invalid[:-1] & invalid[1:])
    opposed[[0, -1]] = True
    against = np.append(False, opposed) & np.append(opposed, False)
    is_double = against & (misfit <= DOUBLE_INFLECTION_SAGITTAS * sagitta)
    result: Bools = invalid & (is_change | is_double)
    return result


def _changes(bridges: npt.NDArray[np.int64], valid: Bools, fold: Floats) -> Bools:
    """Bridges with valid ones bent opposite ways before and behind them, close enough."""
    reach = INFLECTION_SAMPLES
    first = np.minimum(*(np.searchsorted(side, side - reach, "left") for side in bridges.T))
    stop = np.maximum(*(np.searchsorted(side, side + reach, "right") for side in bridges.T))
    here = np.arange(bridges.shape[0])
    before, behind = [], []
    for sign in (1.0, -1.0):
        count = np.concatenate(([0], np.cumsum(valid & (sign * fold > 0.0))))
        before.append(count[here] > count[first])
        behind.append(count[stop] > count[here + 1])
    result: Bools = (before[0] & behind[1]) | (before[1] & behind[0])
    return result


def fan_aware_twist(path: Path) -> Floats:
    """Returns how much the surface's normal turns along each bridge.

    Bridges between two steps of the same kind run through one sample: a fan, which is a piece of a
    cone and has no twist of its own. Twist shows where the kind of step changes: there the plane
    that follows one rail meets the plane that follows the other. A turn into a fan which is undone
    by an opposite turn out of it is twist (the smaller of both angles, so that a crease on one side
    is not taken for it); a turn that stays is bending. A locally convex bridge has a plane that
    touches both rails, hence no twist.

    Returns:
        (k,) float64, rad, not negative.
    """
    twist = np.zeros(path.valid.shape[0])
    turns = np.flatnonzero(path.steps[1:] != path.steps[:-1])
    if turns.size > 1:
        angle = path.fold[turns]
        into, out = angle[:-1], angle[1:]
        undone = np.where(into * out < 0.0, np.minimum(np.abs(into), np.abs(out)), 0.0)
        # Bridge k+1 has fold k; a fan lies from one turning bridge to the next.
        run = np.repeat(undone, np.diff(turns))
        twist[turns[0] + 1 : turns[-1] + 1] = run
        twist[turns[1:] + 1] = np.maximum(undone, np.append(undone[1:], 0.0))
    twist[path.valid] = 0.0
    return twist

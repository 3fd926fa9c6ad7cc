"""What invalid bridges mean: a change of bending, which is harmless, or twist, which is not."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import DOUBLE_INFLECTION_SAGITTAS, INFLECTION_SAGITTAS, INFLECTION_SAMPLES

from .path import Path

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]


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

    Where nothing bends, both triangles in one plane or one without area, that is so. Elsewhere the
    neighbours of such a bridge share a tangent plane to within what the sampling can tell, and it
    has a valid bridge bent up before it and a valid one bent down behind it (or the reverse),
    both at most two samples away, counted on the rail where that is less. Where two changes of
    bending fall between samples, a run of invalid bridges is bent against the valid ones on both
    sides; that is told from a mere twist, which alternates from sample to sample, by a plane that
    fits more closely and there being at most one more invalid run within two samples.

    Args:
        path: the bridges, in order.
        sagitta: mm; typical sagitta of the rail that is sampled more coarsely.

    Returns:
        (k,) bool; a subset of the invalid interior bridges.
    """
    invalid = ~path.valid
    invalid[[0, -1]] = False
    if not invalid.any():
        return invalid
    near = _near(path.bridges)
    fold = np.concatenate(([0.0], path.fold, [0.0]))
    misfit = np.zeros(invalid.size)
    misfit[invalid] = plane_misfit(path.view[:, invalid])
    is_single = _single_changes(near, path.valid, fold) & (misfit <= INFLECTION_SAGITTAS * sagitta)
    is_double = _double_changes(near, invalid, fold) & (
        misfit <= DOUBLE_INFLECTION_SAGITTAS * sagitta
    )
    result: Bools = invalid & (is_single | is_double | ~path.is_bent)
    return result


def _near(bridges: npt.NDArray[np.int64]) -> tuple[Indices, Indices]:
    """First and one past the last bridge that is close enough to each bridge on either rail."""
    reach = INFLECTION_SAMPLES
    first = np.minimum(*(np.searchsorted(side, side - reach, "left") for side in bridges.T))
    stop = np.maximum(*(np.searchsorted(side, side + reach, "right") for side in bridges.T))
    return first, stop


def _single_changes(near: tuple[Indices, Indices], valid: Bools, fold: Floats) -> Bools:
    """Bridges with valid ones bent opposite ways before and behind them."""
    first, stop = near
    here = np.arange(valid.size)
    before, behind = [], []
    for sign in (1.0, -1.0):
        count = np.concatenate(([0], np.cumsum(valid & (sign * fold > 0.0))))
        before.append(count[here] > count[first])
        behind.append(count[stop] > count[here + 1])
    result: Bools = (before[0] & behind[1]) | (before[1] & behind[0])
    return result


def _double_changes(near: tuple[Indices, Indices], invalid: Bools, fold: Floats) -> Bools:
    """Invalid runs that are bent one way, against the bridges on both sides, and nearly alone."""
    edges = np.flatnonzero(np.diff(invalid)) + 1
    start, stop = edges[::2], edges[1::2]
    sign = np.sign(fold)
    total = np.concatenate(([0.0], np.cumsum(sign)))
    bent = total[stop] - total[start]
    is_against = (np.abs(bent) == stop - start) & (sign[start - 1] * bent <= 0.0)
    is_against &= sign[stop] * bent <= 0.0
    runs = np.zeros(invalid.size + 1, dtype=np.int64)
    runs[start + 1] = 1
    runs = np.cumsum(runs)
    is_alone = runs[near[1][stop - 1]] - runs[near[0][start]] <= 2
    result = np.zeros(invalid.size, dtype=np.bool_)
    result[invalid] = np.repeat(is_against & is_alone, stop - start)
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

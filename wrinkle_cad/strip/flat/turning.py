"""Where bank curves turn back as seen from their apexes, and samples there that mend it.

Over such a curve the cone would be folded by 180 degrees. Cut where the curve runs at its apex, the
parts do not turn back, and the search finds them apexes of their own; cut in its middle they may
not either, at less bending. Both are tried.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import TURNED_BACK_PER_TOLERANCE
from wrinkle_cad.strip.curve.chebyshev import FloatArray, PointAt, evaluate
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.partners import Pair, Search
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import dot
from wrinkle_cad.strip.triangulation import Triangulation
from wrinkle_cad.strip.validity_price import invalid_cost

from .unrolling import backward_sweeps

ROUNDS: Final = 12
"""A strip is cut and searched anew at most so often; one or two rounds are usual."""
LOOKS: Final = 129
"""A bank curve is looked at in so many places."""
HALVINGS: Final = 48
"""So often the stretch is halved in which it turns back."""
STEP: Final = 1e-4
"""The direction of a curve is taken over this share of its bank to either side: at 1e-6 round-off
would move the places by 1e-10 mm, which sharp folds make visible in the energy."""
NEAR_END: Final = 0.05
"""A bank that turns back nearer to its end than this share of it is cut in its middle instead: its
parts are seen nearly along their own normals, and no edge becomes tiny."""
SAME_COST: Final = 1e-9
"""Costs closer than this share of themselves are equal: round-off is not to choose the cuts."""


def without_turning_back(
    found: Triangulation,
    samples: Pair,
    curves: tuple[PointAt, PointAt],
    search: Search,
    *,
    tolerance: float,
    keeps: tuple[bool, bool] = (False, False),
) -> tuple[Triangulation, Pair]:
    """Returns a strip whose bank curves do not turn back, if samples on them can bring that about.

    Args:
        found: the best triangulation between the samples.
        samples: of P and of Q.
        curves: P and Q, from (k,) parameters to (k, 3) points in mm.
        search: how the best triangulation between two rows of points is found.
        tolerance: mm; that of the flat lines, see ``unroll_cones``.
        keeps: whether P and Q are to keep their samples if that can be: another strip has them too.

    Returns:
        The triangulation and its samples; those given if nothing turns back.

    Raises:
        InputError: a bank curve turns back however finely it is cut; the message says where.
    """
    places = turning_places(found, samples, curves, tolerance=tolerance)
    if not any(map(len, places)):
        return found, samples
    for kept in [keeps, (False, False)] if any(keeps) else [keeps]:
        tries = [
            _cut_until_none_turns(found, samples, curves, search, tolerance, kept, is_halved)
            for is_halved in (False, True)
        ]
        done = [(made, own) for made, own, left in tries if not any(map(len, left))]
        if done:
            break
    else:
        made, _, places = tries[0]
        raise InputError(_refusal(made, places, curves))
    return done[-1] if _cost(done[-1][0]) < _lowered(_cost(done[0][0])) else done[0]


def _cut_until_none_turns(
    found: Triangulation,
    samples: Pair,
    curves: tuple[PointAt, PointAt],
    search: Search,
    tolerance: float,
    keeps: tuple[bool, bool],
    is_halved: bool,
) -> tuple[Triangulation, Pair, tuple[FloatArray, FloatArray]]:
    """Cuts banks where they turn back, or in their middles: the strip, and where it still does.

    Cut where it turns back a bank has a part that is seen nearly end on, and the triangle over it
    may fold sharply; cut in its middle it may have to be cut more often. Neither is always better.
    """
    made, own = found, samples
    places: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))
    for count in range(ROUNDS + 1):
        places = turning_places(made, own, curves, tolerance=tolerance, is_halved=is_halved)
        cuts = [at[:0] if kept else at for at, kept in zip(places, keeps, strict=True)]
        if count == ROUNDS or not any(map(len, cuts)):
            break
        p, q = (_with(rail, curve, at) for rail, curve, at in zip(own, curves, cuts, strict=True))
        own = p, q
        made = search(p.points, q.points)
    return made, own, places


def _cost(made: Triangulation) -> tuple[float, float, float, float]:
    """Fold-backs, triangles without area, invalid bridges if they have no price, bending."""
    charge = 0.0
    if made.price is not None and made.least_bending is not None:
        charge = invalid_cost(made.price, made.least_bending, made.interior_count)
    counted = float(made.counted_invalid_count)
    return (
        float(made.fold_back_count),
        float(made.degenerate_count),
        counted if made.price is None else 0.0,
        made.bending + charge * counted,
    )


def _lowered(cost: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    return (*cost[:3], (1.0 - SAME_COST) * cost[3])


def _refusal(
    made: Triangulation, places: tuple[FloatArray, FloatArray], curves: tuple[PointAt, PointAt]
) -> str:
    k = 0 if len(places[0]) else 1
    (point,) = evaluate(curves[k], places[k][:1])
    size = float(np.ptp(np.vstack((made.p, made.q)), axis=0).max())
    return (
        f"Rail {'PQ'[k]} turns back at {place_text(point, size)} as seen from the other rail,"
        f" however finely it is cut ({ROUNDS} times here). A smooth surface between the rails would"
        " fold there: smooth the rail at that place, or take a finer tolerance."
    )


def turning_places(
    triangulation: Triangulation,
    samples: Pair,
    curves: tuple[PointAt, PointAt],
    *,
    tolerance: float,
    is_halved: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Returns the parameters at which P and Q turn back, as seen from the apexes of their banks.

    Args:
        triangulation: the strip.
        samples: of P and of Q.
        curves: P and Q, from (k,) parameters to (k, 3) points in mm.
        tolerance: mm; that of the flat lines, see ``unroll_cones``.
        is_halved: give the middles of these banks instead.
    """
    found = []
    sweeps = backward_sweeps(triangulation, *samples, *curves, tolerance=tolerance)
    for (sweep, apexes), rail, curve in zip(sweeps, samples, curves, strict=True):
        banks = np.flatnonzero(sweep > TURNED_BACK_PER_TOLERANCE * tolerance)
        ends = [rail.parameters[k : k + 2] for k in banks.tolist()]
        places = [
            np.array([0.5 * (own[0] + own[1])]) if is_halved else _turns(curve, own, apexes[k])
            for k, own in zip(banks.tolist(), ends, strict=True)
        ]
        found.append(np.concatenate([np.zeros(0), *places]))
    return found[0], found[1]


def _turns(curve: PointAt, ends: FloatArray, apex: FloatArray) -> FloatArray:
    """Parameters at which to cut a bank: where, seen along its mean normal, it turns back."""
    size = float(ends[1] - ends[0])
    at = ends[0] + size * np.linspace(0.0, 1.0, LOOKS)[1:-1]
    step = STEP * size

    def around(places: FloatArray) -> FloatArray:
        before, after = (evaluate(curve, places + way) for way in (-step, step))
        return np.asarray(np.cross(evaluate(curve, places) - apex, after - before))

    turns = around(at)
    mean = turns.sum(axis=0)
    facing = dot(turns, mean)
    (change,) = np.nonzero((facing[:-1] < 0.0) != (facing[1:] < 0.0))
    low, high, is_back = at[change], at[change + 1], facing[change] < 0.0
    for _ in range(HALVINGS if len(change) else 0):
        middle = 0.5 * (low + high)
        same = (dot(around(middle), mean) < 0.0) == is_back
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    places = 0.5 * (low + high)
    inner = np.minimum(places - ends[0], ends[1] - places) > NEAR_END * size
    return places[inner] if inner.any() else np.array([0.5 * (ends[0] + ends[1])])


def _with(samples: Samples, curve: PointAt, places: FloatArray) -> Samples:
    """The samples and those at new places; themselves if there are none."""
    if not len(places):
        return samples
    parameters = np.concatenate((samples.parameters, places))
    points = np.concatenate((samples.points, evaluate(curve, places)))
    order = np.argsort(parameters, kind="stable")
    return Samples(parameters[order], points[order])

"""Openings of one upper that overlap or touch, found before anything is cut."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import segment_lengths

from .opening_plan import OpeningPlan

Floats = NDArray[np.float64]


def check_openings_apart(plans: Sequence[OpeningPlan]) -> None:
    """Checks that no two openings overlap or touch; one inside another is found by ``split``.

    Raises:
        InputError: two do; it names both, the place and how far.
    """
    boxes = [(plan.points.min(axis=0), plan.points.max(axis=0)) for plan in plans]
    for (i, first), (j, second) in combinations(enumerate(plans), 2):
        gap = np.maximum(boxes[i][0] - boxes[j][1], boxes[j][0] - boxes[i][1])
        if float(gap.max()) > settings.OPENINGS_APART:
            continue
        _check_pair(first, second)


def _check_pair(first: OpeningPlan, second: OpeningPlan) -> None:
    depths = [_deepest(first, second), _deepest(second, first)]
    at, depth = max(depths, key=lambda found: found[1])
    pair = f"{first.heading} and {second.title}"
    if depth > settings.OPENINGS_APART:
        raise InputError(
            f"{pair} overlap by up to {depth:.3g} mm, deepest at {_place(at)}. Each wrinkle needs a"
            " place of its own: move their rails apart, or take a smaller margin."
        )
    at, gap = _nearest(first, second)
    if gap <= settings.OPENINGS_APART:
        raise InputError(
            f"{pair} touch at {_place(at)}: they are {gap:.2g} mm apart there, at least"
            f" {settings.OPENINGS_APART:g} mm is needed. Move their rails apart, or take a smaller"
            " margin."
        )


def _deepest(outer: OpeningPlan, inner: OpeningPlan) -> tuple[Floats, float]:
    """Returns where the outline of one opening reaches deepest into another, and how deep in mm.

    Where it enters, its distance changes its sign within a step of the samples; from there on it is
    inside as long as it stays on the inner side of what is nearest.
    """
    place, depth = inner.sides[0].points[0], 0.0
    for side in inner.sides:
        is_inner, distance, step = _signed(outer, side.points)
        step = step + segment_lengths(side.points).max()
        turns = np.flatnonzero(is_inner[1:] != is_inner[:-1])
        near = np.minimum(distance[turns], distance[turns + 1]) <= step
        for at in turns[near]:
            run = _run(is_inner, at + 1 if is_inner[at + 1] else at)
            worst = run[distance[run].argmax()]
            if distance[worst] > depth:
                place, depth = side.points[worst], float(distance[worst])
    return place, depth


def _run(flags: NDArray[np.bool_], at: int) -> NDArray[np.int64]:
    """Returns the indices of the run of true values that holds index ``at``."""
    numbers = np.cumsum(np.concatenate(([True], flags[1:] != flags[:-1])))
    return np.flatnonzero(numbers == numbers[at])


def _signed(plan: OpeningPlan, points: Floats) -> tuple[NDArray[np.bool_], Floats, float]:
    """Returns (k,) whether points lie on the inner side of an outline, (k,) mm from it, its step.

    At a corner, where two sides are equally near, both must have the point on their inner side.
    """
    distances, inward, step = [], [], 0.0
    for side in plan.sides:
        found = nearest_on_polyline(points, side.points)
        share = found.share[:, None]
        ends = side.points[found.segment], side.points[found.segment + 1]
        at = np.rint(found.segment + found.share).astype(np.int64)
        offset = points - ((1.0 - share) * ends[0] + share * ends[1])
        distances.append(found.distance)
        inward.append((offset * side.inward[at]).sum(axis=1) > 0.0)
        step = max(step, float(segment_lengths(side.points).max()))
    least = np.min(distances, axis=0)
    is_tied = np.array(distances) <= least * (1.0 + 1e-6) + settings.CONFUSION
    is_inner: NDArray[np.bool_] = (~is_tied | np.array(inward)).all(axis=0)
    return is_inner, np.asarray(least), step


def _nearest(first: OpeningPlan, second: OpeningPlan) -> tuple[Floats, float]:
    """Returns where two outlines are nearest to each other, and mm between them."""
    place, gap = first.sides[0].points[0], np.inf
    for plan, other in ((first, second), (second, first)):
        for side in plan.sides:
            _, distance, _ = _signed(other, side.points)
            if distance.min() < gap:
                place, gap = side.points[distance.argmin()], float(distance.min())
    return place, gap


def _place(at: Floats) -> str:
    return f"({at[0]:.1f}, {at[1]:.1f}, {at[2]:.1f}) mm"

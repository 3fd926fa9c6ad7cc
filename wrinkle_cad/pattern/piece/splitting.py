"""Cutting a flat strip that overlaps itself at bridges, into the fewest runs that do not."""

from __future__ import annotations

import numpy as np

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.flat.overlap import covers_twice

from .flat import FlatStrip
from .outline import sew_outline


def overlaps(strip: FlatStrip, tolerance: float) -> bool:
    """Returns whether the piece of the flat strip, as it will be sewn, covers any place twice."""
    outline = sew_outline(strip.p_line, strip.q_line, tolerance=tolerance)
    return covers_twice(outline.points)


def non_overlapping_runs(strip: FlatStrip, *, tolerance: float) -> tuple[tuple[int, int], ...]:
    """Returns (first, last) bridges of the fewest runs that each lie flat without overlap.

    Greedy: each run is as long as it can be. A part of a simple run is simple, so the longest can
    be found by bisection and no other choice needs fewer runs. Cuts are made at bridges of some
    length only.

    Raises:
        InputError: two neighbouring triangles overlap each other, which no cut can help.
    """
    ends = strip.bridges
    spans = np.linalg.norm(strip.p[ends[:, 0]] - strip.q[ends[:, 1]], axis=1)
    last = len(ends) - 1
    runs: list[tuple[int, int]] = []
    first = 0
    while first < last:
        stop = _longest(strip, first, tolerance)
        while first < stop < last and spans[stop] < tolerance:
            stop -= 1
        if stop == first:
            raise InputError(
                f"The pattern overlaps itself right after bridge {first}, and cuts need a bridge "
                f"of at least {tolerance:g} mm. Sample the strip more finely."
            )
        runs.append((first, stop))
        first = stop
    return tuple(runs)


def _longest(strip: FlatStrip, first: int, tolerance: float) -> int:
    """Returns the last bridge of the longest run from ``first``, ``first`` if there is none."""
    good, bad = first, len(strip.bridges)
    if not _run_overlaps(strip, first, bad - 1, tolerance):
        return bad - 1
    while bad - good > 1:
        middle = (good + bad) // 2
        if _run_overlaps(strip, first, middle, tolerance):
            bad = middle
        else:
            good = middle
    return good


def _run_overlaps(strip: FlatStrip, first: int, last: int, tolerance: float) -> bool:
    try:
        return overlaps(strip.run(first, last), tolerance)
    except InputError:
        # A run smaller than the tolerance has no outline of its own and covers nothing twice.
        return False

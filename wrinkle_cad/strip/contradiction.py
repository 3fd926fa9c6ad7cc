"""Constraints that no triangulation can keep: which of them fail, and what would do instead."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NoReturn, Protocol

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import ConstraintError

from .bars import Bars
from .constraints import Constraints, lean_cosines
from .curve.polyline import row_lengths
from .places import place_text

Floats = npt.NDArray[np.float64]


class FoundStrip(Protocol):
    """What a search found: a triangulation."""

    @property
    def p(self) -> Floats:
        """(m, 3) mm."""

    @property
    def q(self) -> Floats:
        """(n, 3) mm."""

    @property
    def bridges(self) -> npt.NDArray[np.int64]:
        """(k, 2) int64."""

    @property
    def fold(self) -> Floats:
        """Of each interior bridge, rad."""

    @property
    def is_closed(self) -> bool:
        """Whether the last bridge is the first one."""

    @property
    def first_samples(self) -> tuple[int, int]:
        """Of the given rails, the first ones that it has."""


Search = Callable[[Constraints], tuple[FoundStrip, bool]]


def is_kept(found: FoundStrip, constraints: Constraints, bars: Bars) -> bool:
    """Whether a triangulation keeps constraints.

    Args:
        found: the triangulation.
        constraints: what was asked for.
        bars: of its samples, for these constraints.
    """
    i, j = (found.bridges + found.first_samples).T
    i, j = (i % len(found.p), j % len(found.q)) if found.is_closed else (i, j)
    bridges = set(zip(i.tolist(), j.tolist(), strict=True))
    if not bridges.issuperset(constraints.pinned):
        return False
    if bars.bridges.size and bars.bridges[i, j].any():
        return False
    if bars.least_cosine < -1.0 or not len(found.fold):
        return True
    return math.cos(float(np.abs(found.fold).max())) >= bars.least_cosine - 1e-12


def refuse(constraints: Constraints, p: Floats, q: Floats, search: Search) -> NoReturn:
    """Refuses constraints that every triangulation breaks.

    Args:
        constraints: what was asked for.
        p: (m, 3) float64, mm; samples of directrix P.
        q: (n, 3) float64, mm; samples of directrix Q.
        search: the best triangulation under other constraints, and whether it keeps them.

    Raises:
        ConstraintError: one sentence names the fewest constraints that fail together.
    """
    free = search(Constraints())[0]
    parts = constraints.parts(p, q)
    failing = list(parts)
    for part in parts:
        rest = [other for other in failing if other is not part]
        if not search(_joined(rest))[1]:
            failing = rest
    if len(failing) > 1:
        *first, last = (words for words, _ in failing)
        raise ConstraintError(
            f"No strip between these rails keeps {'; '.join(first)} and {last}: loosen one of them"
            " or drop it."
        )
    ((words, alone),) = failing
    raise ConstraintError(_alone(words, alone, free))


def _joined(parts: list[tuple[str, Constraints]]) -> Constraints:
    joined = Constraints()
    for _, one in parts:
        joined = joined.together_with(one)
    return joined


def _alone(words: str, alone: Constraints, free: FoundStrip) -> str:
    """What a single constraint asks too much, and what the best strip without it has."""
    if alone.max_ruling is not None:
        sizes, unit, what, first = _lengths(free), "mm", "longest ruling", 0
    elif alone.max_lean is not None:
        sizes, unit, what, first = _leans(free), "degrees", "largest lean", 0
    elif alone.fold_bound is not None:
        sizes, unit, what = np.degrees(np.abs(free.fold)), "degrees", "largest fold"
        first = 0 if free.is_closed else 1
    else:
        return (
            f"No strip between these rails keeps {words}: every sample of a rail has a ruling, and"
            " the first and last of both rails have theirs together. Forbid less."
        )
    worst = int(sizes.argmax())
    return (
        f"No strip between these rails keeps {words}: the {what} of the best one without it is"
        f" {_upward(float(sizes[worst])):.4g} {unit}, at {_middle(free, worst + first)}. Allow so"
        " much, or change the rails there."
    )


def _upward(value: float) -> float:
    """A value with four digits that is not smaller."""
    step = 10.0 ** (math.floor(math.log10(value)) - 3) if value > 0.0 else 1.0
    return math.ceil(value / step) * step


def _lengths(found: FoundStrip) -> Floats:
    i, j = found.bridges.T
    return row_lengths(found.p[i % len(found.p)] - found.q[j % len(found.q)])


def _leans(found: FoundStrip) -> Floats:
    """(k,) degrees: the lean of each bridge."""
    i, j = found.bridges.T
    cosines = lean_cosines(found.p, found.q, closed=found.is_closed)
    own = cosines[i % len(found.p), j % len(found.q)]
    return np.array([math.degrees(math.acos(min(1.0, cosine))) for cosine in own.tolist()])


def _middle(found: FoundStrip, number: int) -> str:
    i, j = found.bridges[number]
    middle = 0.5 * (found.p[i % len(found.p)] + found.q[j % len(found.q)])
    extent = float(np.ptp(np.vstack((found.p, found.q)), axis=0).max())
    return place_text(middle, extent)

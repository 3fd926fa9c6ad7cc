"""The exact search where counts tell most bridges apart: in a corridor as narrow as it can be.

Where validity comes first, the best path has the fewest counts (fold-backs, invalid bridges,
triangles of zero area). Where an invalid bridge has a price, the best path may have more invalid
ones, but no more than the energy of any path that is known could pay for: bending is never below 0.
Either way it lies in the corridor of the bridges that paths with so few counts can have.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, cast

import numpy as np
import numpy.typing as npt

from .corridor import Corridor, corridor_of_rows, whole_corridor
from .count_corridor import FAR, Counts, CountStrip, count_onward, nothing_known, reach
from .count_screen import screen_of
from .diagonal_program import SHORT, decide_corridor, follow_corridor, short_weights
from .lanes import rails_of
from .objective import DEGENERATE, FOLD_BACK, INVALID, Weights

Floats = npt.NDArray[np.float64]
Steps = npt.NDArray[np.int8]

SMALL: Final = 2**18
"""So few bridges are all looked at: that takes 6 ms, and a first run need not compile how they are
counted, which takes a thousand times as long."""
FEW: Final = 8
"""So many bridges for each sample are looked at before it is known what going on costs."""
FIRST_SLACK: Final = 16
"""So many invalid bridges more are allowed at first where they have a price."""
WIDE: Final = 0.25
"""A corridor with a larger share of all bridges is no gain."""
EXACT: Final = 2**52
"""Counts below it are exact in a float64."""
ROUND_OFF: Final = 1e-11
"""More than the share of a sum that a tie or round-off can reach at one bridge."""


class _Corridors:
    """The corridors of one strip, as they become wider."""

    def __init__(self, strip: CountStrip, m: int, n: int) -> None:
        self._strip, self._m, self._n = strip, m, n
        self._onward = nothing_known()
        self.least = FAR
        """The fewest counts of any path, once known."""

    @property
    def fewest_invalid(self) -> int:
        """Invalid bridges among the fewest counts, where they are the last digit."""
        return self.least % self._strip.counts.flat

    def fewest(self) -> Corridor | None:
        """The corridor of the fewest counts; None where most bridges would be in it."""
        limit, left = 0, FEW * (self._m + self._n)
        while left > 0:
            least, low, high, seen = reach(self._strip, self._onward, limit, left)
            if least < FAR:
                self.least = least
                return corridor_of_rows(low, high)
            limit, left = 2 * limit + self._strip.counts.invalid, left - seen
        return self.within(0) if self._know_onward() else None

    def within(self, slack: int) -> Corridor | None:
        """The corridor of so many counts more; None where most bridges would be in it."""
        all_bridges = self._m * self._n
        if not self._onward.least.size:
            found = self._reached(slack, 8 * FEW * (self._m + self._n))
            if found is not None or not self._know_onward():
                return found
        return self._reached(slack, int(WIDE * all_bridges))

    def _reached(self, slack: int, most: int) -> Corridor | None:
        found, low, high, _ = reach(self._strip, self._onward, self.least + slack, most)
        return None if found == FAR else corridor_of_rows(low, high)

    def _know_onward(self) -> bool:
        least, onward = count_onward(self._strip)
        if least < 0:
            return False
        self.least, self._onward = least, onward
        return True


def narrow_steps(
    p: Floats, q: Floats, weights: Weights, *, planarity: float, nothing: float
) -> Steps | None:
    """Returns the steps of the best triangulation by the hinge energy, with nothing barred.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        weights: parts of the cost, in order of comparison (objective.weights_of).
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.

    Returns:
        (m+n-2,) int8: 0 a P-step, 1 a Q-step. None for a cost of too many parts.
    """
    m, n = len(p), len(q)
    rails = rails_of(p, q)
    short, is_exact = short_weights(weights), True
    if short is None:
        short, is_exact = merged_weights(weights, m + n), False
    if short is None:
        return None

    def best_in(corridor: Corridor) -> tuple[Steps, Floats]:
        choices, cost = decide_corridor(rails, corridor, short, planarity, nothing)
        return follow_corridor(choices, corridor), cost

    counts = counts_of(short, m + n)
    if counts is not None and m * n > SMALL and min(m, n) > 2:
        screen = screen_of(p, q, planarity=planarity, nothing=nothing)
        strip = CountStrip(*rails, screen, counts, planarity, nothing)
        found = _steps_in(_Corridors(strip, m, n), short, best_in)
        if found is not None:
            return found
    return best_in(whole_corridor(m, n))[0] if is_exact else None


def _steps_in(
    corridors: _Corridors, weights: Weights, best_in: Callable[[Corridor], tuple[Steps, Floats]]
) -> Steps | None:
    """The best steps in a corridor that is wide enough; None where that is most of the strip."""
    corridor = corridors.fewest()
    if corridor is None or corridors.least >= EXACT:
        return None
    steps, cost = best_in(corridor)
    if weights[0][INVALID] > 0.0:
        return steps
    slack, price = 0, weights[1][INVALID]
    while True:
        # Of the counts only invalid bridges can be more.
        most = float(cost[1]) * (1.0 + ROUND_OFF * (steps.size + 100)) / price
        if most - corridors.fewest_invalid < slack + 1:
            return steps
        slack = min(math.floor(most - corridors.fewest_invalid), max(2 * slack, FIRST_SLACK))
        corridor = corridors.within(slack)
        if corridor is None:
            return None
        steps, cost = best_in(corridor)


def counts_of(weights: Weights, bridge_count: int) -> Counts | None:
    """Returns what counts are worth, as digits of one integer; None if no validity comes first.

    Args:
        weights: parts of the cost (short_weights).
        bridge_count: no count is larger.

    Example:
        >>> from wrinkle_cad.strip.objective import weights_of
        >>> counts_of(weights_of(("invalid", "bending"), bridge_count=7), 7)
        Counts(back=64, invalid=8, flat=1)
        >>> counts_of(weights_of(("area",), bridge_count=7), 7) is None
        True
    """
    base = 2 ** bridge_count.bit_length()
    has_flat = weights[0][DEGENERATE] > 0.0
    if weights[0][INVALID] > 0.0:
        return Counts(base * base, base, 1 if has_flat else 0)
    if weights[1][INVALID] > 0.0 and has_flat:
        return Counts(base * base, 1, base)
    return None


def merged_weights(weights: Weights, bridge_count: int) -> Weights | None:
    """Returns weights whose first two parts, both counts, are one; None where they are not.

    Args:
        weights: parts of the cost of a long strip, whose counts are no digits of one float64.
        bridge_count: no count is larger.

    Example:
        >>> from wrinkle_cad.strip.objective import weights_of
        >>> merged_weights(weights_of(("invalid", "bending"), bridge_count=2**18), 2**18)[0][:3]
        (274877906944.0, 1.0, 524288.0)
    """
    base = 2.0 ** bridge_count.bit_length()
    counts = {FOLD_BACK, DEGENERATE, INVALID}
    if any(part[k] for part in weights[:2] for k in range(len(part)) if k not in counts):
        return None
    first = tuple(base * a + b for a, b in zip(*weights[:2], strict=True))
    used = [first, *(part for part in weights[2:] if any(part))]
    short = [*used, *[(0.0,) * len(first)] * (SHORT - len(used))]
    return short_weights(cast(Weights, tuple(short)))

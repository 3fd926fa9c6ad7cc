"""Which steps lead to the end without a barred bridge or fold: for a search that looks no further.

With these the local search never walks into a place that it cannot leave.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .bars import Bars, bar_row, is_barred
from .compiled import compiled
from .folding import StepCosts, cost_row, new_costs
from .sightlines import VIEW_ROWS, bank_lengths, look_along

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Rails = tuple[Floats, Floats, Floats, Floats]
Limits = tuple[float, float, int]


@compiled
def _ways_from(
    costs: StepCosts, j: int, is_first: bool, after: tuple[int, int], is_out: bool
) -> int:
    """Bits of the steps from bridge j that lead to the end, by the steps that arrived."""
    ways = 0
    for earlier in range(2):
        for later in range(2):
            row = 2 * earlier + later
            is_open = (after[later] >> (2 * later)) & 3 > 0
            if is_open and not is_out and (is_first or not is_barred(costs, row, j)):
                ways |= 1 << row
    return ways


@compiled
def open_ways(rails: Rails, bars: Bars, limits: Limits, first_step: int) -> Bytes:
    """Returns the steps that lead to the end from each bridge, (m, n) uint8.

    Args:
        rails: p (m, 3), its padded banks (3, m+1), the samples of Q by coordinate (3, n), their
            banks (3, n+1); mm.
        bars: of these samples.
        limits: planarity and round-off in mm, and HINGE or PAPER.
        first_step: the step that leaves the seam of a closed strip, whose last bridge is its first;
            -1 for an open one.

    Returns:
        Bit 2 * earlier + later is set if the later step may follow the earlier one. At the last
        bridge it says whether the strip may end after the earlier step.
    """
    p, p_banks, q, q_banks = rails
    planarity, nothing, energy = limits
    m, n = p.shape[0], q.shape[1]
    view, costs, banks = np.empty((VIEW_ROWS, n)), new_costs(n), np.empty((4, n))
    banks[2], banks[3] = bank_lengths(q_banks[:, :-1]), bank_lengths(q_banks[:, 1:])
    p_lengths = bank_lengths(p_banks)
    ways = np.zeros((m, n), dtype=np.uint8)
    for i in range(m - 1, -1, -1):
        banks[0], banks[1] = p_lengths[i], p_lengths[i + 1]
        look_along(p[i], p_banks[:, i : i + 2], q, q_banks, view)
        cost_row(view, banks, nothing, planarity, energy, costs)
        bar_row(view, bars, i, costs)
        for j in range(n - 1, -1, -1):
            is_out = bars.bridges.shape[0] > 0 and bars.bridges[i, j]
            if i == m - 1 and j == n - 1:
                for row in range(4):
                    is_kept = first_step < 0 or not is_barred(costs, row, j)
                    if not is_out and is_kept and (first_step < 0 or row % 2 == first_step):
                        ways[i, j] |= 1 << row
                continue
            on_p = ways[i + 1, j] if i < m - 1 else 0
            on_q = ways[i, j + 1] if j < n - 1 else 0
            is_first = i == 0 and j == 0
            ways[i, j] = _ways_from(costs, j, is_first, (int(on_p), int(on_q)), is_out)
    return ways

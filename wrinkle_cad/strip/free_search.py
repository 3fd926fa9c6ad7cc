"""The best triangulation whose ends are free: it may begin and end at any bridge near the rails'.

It is the best of all triangulations of all shortened rails. A shortened rail has no neighbour
beyond its new end, and that changes which bridges are locally convex: those that share the first
sample of a rail with the first bridge, up to the first step on that rail, and likewise at the other
end. So the dynamic program knows, beside the step that arrived, whether only steps on one rail were
taken since the beginning, and whether only such are taken until the end. A path that is reckoned
without that knowledge only costs more, so the least is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from .bars import Bars, bar_row
from .compiled import compiled
from .convexity import judge_row
from .folding import StepCosts, cost_row, new_costs
from .global_search import weighted_fold
from .objective import (
    AREA,
    DEGENERATE,
    FLAT_INVALID,
    LENGTH,
    TIE,
    Weights,
)
from .sightlines import BEFORE_P, VIEW_ROWS, bank_lengths, look_along, padded_banks

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Steps = npt.NDArray[np.int8]
Charges = tuple[float, ...]
Rails = tuple[Floats, Floats, Floats, Floats]
Limits = tuple[float, float, int]

AFTER_P, AFTER_Q, ONLY_P, ONLY_Q = range(4)
"""How a path came to a bridge: by a P-step or a Q-step, or by such steps only, from its start."""
MIXED, P_TO_END, Q_TO_END = range(3)
"""How it goes on: by steps of both kinds, or by P-steps or Q-steps only, or by none at all."""
END: Final = -1
"""No step: the path ends here."""
_NEVER: Final = 1e300


class _Row(NamedTuple):
    """What is known of the bridges from one sample of P."""

    seen: Floats
    costs: StepCosts
    valid: Bools
    """(16, n): locally convex without the neighbours whose bits are set: 1 before it on P, 2 after
    it on P, 4 and 8 on Q."""


class _Zones(NamedTuple):
    """Samples near the ends: before `first` a strip may begin, from `last` on it may end."""

    first_p: int
    last_p: int
    first_q: int
    last_q: int


@dataclass(frozen=True, slots=True, eq=False)
class FreePath:
    """The best path between two bridges near the ends."""

    start: tuple[int, int]
    """i, j of its first bridge."""
    steps: Steps
    """int8; 0 a P-step, 1 a Q-step."""


@compiled
def _fill_row(
    rails: Rails, i: int, banks: Floats, limits: Limits, bars: Bars, zones: _Zones, row: _Row
) -> None:
    p, p_banks, q, q_banks = rails
    planarity, nothing, energy = limits
    lengths = bank_lengths(p_banks[:, i : i + 2])
    banks[0], banks[1] = lengths[0], lengths[1]
    look_along(p[i], p_banks[:, i : i + 2], q, q_banks, row.seen)
    cost_row(row.seen, banks, nothing, planarity, energy, row.costs)
    bar_row(row.seen, bars, i, row.costs)
    partial = np.empty_like(row.seen)
    for missing in range(16):
        # Only near the ends of a rail has a bridge no neighbour on it.
        if (missing & 1 and i >= zones.first_p) or (missing & 2 and i < zones.last_p):
            continue
        low = zones.last_q if missing & 8 else 0
        high = zones.first_q if missing & 4 else row.seen.shape[1]
        if low >= high:
            continue
        partial[:, low:high] = row.seen[:, low:high]
        for neighbour in range(4):
            if (missing >> neighbour) & 1:
                at = BEFORE_P + 2 * neighbour
                partial[at : at + 2, low:high] = 0.0
        judge_row(partial[:, low:high], planarity, row.valid[missing, low:high])


@compiled
def _is_less(weights: Weights, first: Floats, second: Floats) -> bool:
    for number in range(len(weights)):
        a, b = first[number], second[number]
        if abs(a - b) > weights[number][TIE] * (abs(a) + abs(b)):
            return bool(a < b)
    return False


@compiled
def _missing(came: int, goes: int) -> int:
    """Bits of the neighbours that a bridge has not, by how its path came and goes on."""
    bits = 0
    if came == ONLY_Q:
        bits |= 1
    elif came == ONLY_P:
        bits |= 4
    if goes == Q_TO_END:
        bits |= 2
    elif goes == P_TO_END:
        bits |= 8
    return bits


@compiled
def _next_came(came: int, step: int) -> int:
    """How a path came to the next bridge."""
    if came == ONLY_P and step == 0:
        return ONLY_P
    if came == ONLY_Q and step == 1:
        return ONLY_Q
    return AFTER_P if step == 0 else AFTER_Q


@compiled
def _leave(
    weights: Weights,
    row: _Row,
    j: int,
    came: int,
    goes: int,
    step: int,
    ahead: Floats,
    cost: Floats,
) -> None:
    """Writes the cost from a bridge on, by one step of it and the cost from the next bridge on."""
    later = (came % 2) * 2 + step
    missing = _missing(came, goes)
    invalid = 0.0 if row.valid[missing, j] else 1.0
    for number in range(len(weights)):
        part = weights[number]
        triangle = part[DEGENERATE] * row.costs.degenerate[1 + 2 * step, j]
        triangle += part[AREA] * row.costs.area[step, j]
        own = part[LENGTH] * row.seen[0, j] + part[FLAT_INVALID] * invalid
        own += weighted_fold(part, row.costs, invalid, later, j)
        cost[number] = own + ahead[number] + triangle


@compiled
def _decide_bridge(
    weights: Weights,
    row: _Row,
    j: int,
    nexts: tuple[Floats, Floats],
    has_next: tuple[bool, bool],
    can: npt.NDArray[np.bool_],
    last: Floats,
    own: Floats,
    choice: npt.NDArray[np.int8],
    cost: Floats,
) -> None:
    """Writes the cost from bridge j to the end, and the way, however it was come to and goes on.

    Args:
        weights: parts of the cost.
        row: of the bridge.
        j: the bridge.
        nexts: (4, 3, parts) each: the same of the next bridge on P and on Q.
        has_next: whether there is one.
        can: (4 + 3,); how the bridge may be come to, and how the path may go on.
        last: (parts,); the cost if the path ends here.
        own: (4, 3, parts); written.
        choice: (4, 3) int8; written: the step, and 2 times how the path goes on; or END.
        cost: (parts,); room.
    """
    for came in range(4):
        for goes in range(3):
            choice[came, goes] = END
            for number in range(len(weights)):
                own[came, goes, number] = _NEVER if goes == MIXED else last[number]
            if not (can[came] and can[4 + goes]):
                continue
            for step in range(2):
                is_against = goes == (Q_TO_END if step == 0 else P_TO_END)
                if not has_next[step] or is_against:
                    continue
                after = nexts[step][_next_came(came, step)]
                for then in range(3):
                    if (goes not in (MIXED, then)) or after[then, 0] >= _NEVER:
                        continue
                    _leave(weights, row, j, came, goes, step, after[then], cost)
                    if _is_less(weights, cost, own[came, goes]):
                        own[came, goes] = cost
                        choice[came, goes] = step + 2 * then


@compiled
def _begin(
    weights: Weights,
    row: _Row,
    j: int,
    nexts: tuple[Floats, Floats],
    has_next: tuple[bool, bool],
    charge: Floats,
    best: Floats,
    way: npt.NDArray[np.int64],
    i: int,
) -> None:
    """Takes bridge (i, j) as the first one if a path from it costs less than the best so far."""
    cost = np.empty(len(weights))
    for step in range(2):
        if not has_next[step]:
            continue
        for then in range(3):
            after = nexts[step][ONLY_P if step == 0 else ONLY_Q, then]
            for number in range(len(weights)):
                part = weights[number]
                cost[number] = part[DEGENERATE] * row.costs.degenerate[1 + 2 * step, j]
                cost[number] += part[AREA] * row.costs.area[step, j] + charge[number]
                cost[number] += part[LENGTH] * row.seen[0, j] + after[number]
            if _is_less(weights, cost, best):
                best[:] = cost
                way[0], way[1], way[2], way[3] = i, j, step, then


@compiled
def _write_last(
    weights: Weights, charges: Charges, row: _Row, j: int, unused: float, last: Floats
) -> None:
    """Writes what it costs to end at bridge j with so many mm of rail behind it."""
    for number in range(len(weights)):
        is_end = unused < np.inf
        own = weights[number][LENGTH] * row.seen[0, j] + charges[number] * unused
        last[number] = own if is_end else _NEVER


@compiled
def _decide_free(
    rails: Rails,
    weights: Weights,
    charges: Charges,
    limits: Limits,
    bars: Bars,
    zones: _Zones,
    starts: tuple[Floats, Floats],
    ends: tuple[Floats, Floats],
) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.int64]]:
    """Every bridge's choices, (m, n, 4, 3), and the first bridge, its step and how it goes on."""
    m, n, parts = rails[0].shape[0], rails[2].shape[1], len(weights)
    row = _Row(np.empty((VIEW_ROWS, n)), new_costs(n), np.empty((16, n), np.bool_))
    banks, can = np.empty((4, n)), np.ones(7, np.bool_)
    banks[2], banks[3] = bank_lengths(rails[3][:, :-1]), bank_lengths(rails[3][:, 1:])
    choices = np.empty((m, n, 4, 3), dtype=np.int8)
    ahead, here = np.full((n, 4, 3, parts), _NEVER), np.full((n, 4, 3, parts), _NEVER)
    best, way = np.full(parts, _NEVER), np.zeros(4, dtype=np.int64)
    last, cost = np.empty(parts), np.empty(parts)
    for i in range(m - 1, -1, -1):
        _fill_row(rails, i, banks, limits, bars, zones, row)
        can[ONLY_Q], can[4 + Q_TO_END] = i < zones.first_p, i >= zones.last_p
        for j in range(n - 1, -1, -1):
            can[ONLY_P], can[4 + P_TO_END] = j < zones.first_q, j >= zones.last_q
            is_out = bars.bridges.shape[0] > 0 and bars.bridges[i, j]
            unused = np.inf if is_out else ends[0][i] + ends[1][j]
            _write_last(weights, charges, row, j, unused, last)
            nexts = (ahead[j], here[min(j + 1, n - 1)])
            has_next = (i < m - 1, j < n - 1)
            own, choice = here[j], choices[i, j]
            _decide_bridge(weights, row, j, nexts, has_next, can, last, own, choice, cost)
            unused = np.inf if is_out else starts[0][i] + starts[1][j]
            if unused < np.inf:
                for number in range(parts):
                    last[number] = charges[number] * unused
                _begin(weights, row, j, nexts, has_next, last, best, way, i)
        ahead, here = here, ahead
    return choices, way


@compiled
def _follow_free(choices: npt.NDArray[np.int8], way: npt.NDArray[np.int64]) -> Steps:
    steps = np.empty(choices.shape[0] + choices.shape[1], dtype=np.int8)
    i, j, step, goes = way[0], way[1], way[2], way[3]
    came = ONLY_P if step == 0 else ONLY_Q
    steps[0] = step
    count = 1
    i, j = i + 1 - step, j + step
    while choices[i, j, came, goes] != END:
        choice = int(choices[i, j, came, goes])
        step = choice & 1
        goes = choice >> 1
        steps[count] = step
        count += 1
        came = _next_came(came, step)
        i, j = i + 1 - step, j + step
    return steps[:count]


def free_steps(
    p: Floats,
    q: Floats,
    weights: Weights,
    charges: Charges,
    *,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars,
    unused: tuple[tuple[Floats, Floats], tuple[Floats, Floats]],
) -> FreePath:
    """Returns the triangulation of shortened rails that costs least of all.

    O(m n) time; twelve bytes per bridge.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P, m at least 2.
        q: (n, 3) float64, mm; checked samples of directrix Q, n at least 2.
        weights: parts of the cost, in order of comparison (objective.free_weights_of).
        charges: what 1 mm of unused rail costs in each part.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
        bars: bridges and folds to avoid wherever that can be.
        unused: (m,) and (n,) mm, for the beginning and for the end: how much of each rail lies
            beyond a sample; infinite where the strip must not begin or end.
    """
    rails = (p, padded_banks(p), np.ascontiguousarray(q.T), padded_banks(q))
    limits = (planarity, nothing, energy)
    (first_p, first_q), (last_p, last_q) = (
        [np.flatnonzero(beyond < np.inf) for beyond in own] for own in unused
    )
    zones = _Zones(int(first_p[-1]) + 1, int(last_p[0]), int(first_q[-1]) + 1, int(last_q[0]))
    choices, way = _decide_free(rails, weights, charges, limits, bars, zones, *unused)
    return FreePath((int(way[0]), int(way[1])), _follow_free(choices, way))

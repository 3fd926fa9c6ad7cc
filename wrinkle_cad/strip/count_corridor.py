"""Where a path with the fewest counts can go: what it costs to get there and to go on from there.

Counts (fold-backs, invalid bridges, triangles of zero area, as digits of one integer) are the first
part of most costs. A pass from the last row to the first, by signs where these are clear, tells
what going on costs at least; every STRIDE-th row of that is kept. A pass from the first row on then
finds the bridges where coming there and going on cost no more than a limit together: the fewest
counts, or so many more as a price may buy. Where hardly any bridge is invalid, the second pass
alone is enough: it looks no further than the limit lets it.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from .compiled import compiled
from .corridor import Integers
from .count_screen import INVALID, NOT_P_P, NOT_Q_Q, UNCLEAR, Screen, mark_row, sign_row
from .lanes import (
    BACK,
    BENT,
    FLAT_P,
    FLAT_Q,
    FREE,
    LANES,
    P_PART,
    P_REST,
    PART,
    Q_PART,
    Q_REST,
    REST,
    measure,
)
from .lanes import INVALID as INVALID_ROW

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

STRIDE: Final = 16
"""Every so many rows what going on costs is kept: four bytes a bridge, so 1/4 of one of each."""
FAR: Final = 2**60
"""More than any count."""
_CHUNK: Final = 4
"""So many bridges are looked at beyond those to which P-steps lead; then ever twice as many."""
_LARGEST: Final = 2**31 - 1
_TRIED: Final = 16
"""After so many rows it is known whether signs tell enough."""


class Counts(NamedTuple):
    """What a count is worth."""

    back: int
    """A fold-back."""
    invalid: int
    """An invalid bridge at which the strip bends."""
    flat: int
    """A triangle of zero area."""


class CountStrip(NamedTuple):
    """A strip as both passes read it."""

    p: Floats
    """(7, m+1) float64, mm; of lanes.Rails."""
    q: Floats
    """(7, n+1) float64, mm; of lanes.Rails."""
    screen: Screen
    """What signs are told from."""
    counts: Counts
    """What counts are worth."""
    planarity: float
    """mm; see lanes.measure."""
    nothing: float
    """mm; a distance that is round-off."""


class Onward(NamedTuple):
    """What going on costs at least from every STRIDE-th sample of P, by the P-step that came."""

    costs: npt.NDArray[np.int32]
    """(k, n) more than the row's least, as far as four bytes tell."""
    least: Integers
    """(k,)"""


def nothing_known() -> Onward:
    """Returns what is known of the way onward before anything is looked at."""
    return Onward(np.zeros((0, 0), dtype=np.int32), np.zeros(0, dtype=np.int64))


class _Room(NamedTuple):
    """Where a row is worked out."""

    signs: Bytes
    """(2, n+1) of sign_row, even rows and odd ones."""
    marks: Bytes
    """(n,) of a row's bridges."""
    block: Floats
    exact: Integers
    """(n, 6) counts at those that are UNCLEAR, in order: of folds between P P, P Q, Q P, Q Q, of
    the triangles behind a P-step and a Q-step."""


@compiled
def _new_room(n: int) -> _Room:
    return _Room(
        np.zeros((2, n + 1), dtype=np.uint8),
        np.zeros(n, dtype=np.uint8),
        np.zeros(FREE * LANES),
        np.zeros((n, 6), dtype=np.int64),
    )


@compiled
def _gather(block: Floats, lane: int, p: Floats, q: Floats, i: int, back: int) -> None:
    """Writes one bridge into a block."""
    for row in range(PART):
        block[P_PART + row * LANES + lane] = p[row, i]
        block[Q_PART + row * LANES + lane] = q[row, back]
    for row in range(REST):
        block[P_REST + row * LANES + lane] = p[PART - REST + row, i + 1]
        block[Q_REST + row * LANES + lane] = q[PART - REST + row, back + 1]


@compiled
def _count_exactly(strip: CountStrip, i: int, first: int, stop: int, room: _Room) -> int:
    """Measures the unclear bridges of a row, and returns how many there are."""
    block, counts = room.block, strip.counts
    found = lane = 0
    for j in range(first, stop + 1):
        if j < stop and room.marks[j] >= UNCLEAR:
            _gather(block, lane, strip.p, strip.q, i, strip.q.shape[1] - 2 - j)
            lane += 1
        if lane == LANES or (j == stop and lane > 0):
            measure(block, lane, strip.planarity, strip.nothing)
            for k in range(lane):
                for turn in range(4):
                    bent = block[INVALID_ROW + k] * block[BENT[0] + turn * LANES + k]
                    back = block[BACK[0] + turn * LANES + k]
                    cost = counts.back * int(back) + counts.invalid * int(bent)
                    room.exact[found + k, turn] = cost
                room.exact[found + k, 4] = counts.flat * int(block[FLAT_P + k])
                room.exact[found + k, 5] = counts.flat * int(block[FLAT_Q + k])
            found, lane = found + lane, 0
    return found


@compiled
def _mark(strip: CountStrip, i: int, first: int, stop: int, room: _Room) -> int:
    """Marks bridges of a row whose signs are known; measures the others and returns their count."""
    m, n = strip.p.shape[1] - 1, strip.q.shape[1] - 1
    low, high = max(first, 1), min(stop, n - 1)
    if 0 < i < m - 1:
        if first == 0:
            room.marks[0] = UNCLEAR
        if stop == n:
            room.marks[n - 1] = UNCLEAR
        if low < high:
            before, behind = room.signs[(i - 1) & 1], room.signs[i & 1]
            mark_row(strip.screen, i, low, high, before, behind, room.marks)
    else:
        room.marks[first:stop] = UNCLEAR
    return _count_exactly(strip, i, first, stop, room)


@compiled
def _weights(room: _Room, j: int, at: int, invalid: int) -> tuple[int, int, int, int, int, int]:
    """The counts at a bridge; `at` is where they stand if it was measured."""
    mark = room.marks[j]
    if mark >= UNCLEAR:
        own = room.exact[at]
        return own[0], own[1], own[2], own[3], own[4], own[5]
    cost = invalid * (mark & INVALID)
    return (
        0 if mark & NOT_P_P else cost,
        cost,
        cost,
        0 if mark & NOT_Q_Q else cost,
        0,
        0,
    )


@compiled
def _add_row(strip: CountStrip, room: _Room, at: int, ahead: Integers, is_last: bool) -> None:
    """Adds a row to the costs of going on, by the P-step that came; `at` bridges were measured."""
    invalid, after_q, last = strip.counts.invalid, FAR, ahead.size - 1
    for j in range(last, -1, -1):
        mark = room.marks[j]
        if mark <= INVALID:
            after_q = min(ahead[j], after_q) + (invalid if mark == INVALID else 0)
            ahead[j] = after_q
            continue
        at -= 1 if mark >= UNCLEAR else 0
        p_p, p_q, q_p, q_q, by_p, by_q = _weights(room, j, at, invalid)
        p, q = ahead[j] + by_p, after_q + by_q
        is_end = is_last and j == last
        ahead[j] = 0 if is_end else min(p + p_p, q + p_q)
        after_q = 0 if is_end else min(p + q_p, q + q_q)


@compiled
def count_onward(strip: CountStrip) -> tuple[int, Onward]:
    """Finds the least count of a path, and what going on costs.

    Returns:
        The least count; -1 where signs tell too little, and nothing more was done.
    """
    m, n = strip.p.shape[1] - 1, strip.q.shape[1] - 1
    room, unclear = _new_room(n), 0
    costs = np.empty(((m - 1) // STRIDE, n), dtype=np.int32)
    least = np.empty((m - 1) // STRIDE, dtype=np.int64)
    ahead = np.full(n, FAR)
    for i in range(m - 1, -1, -1):
        if i > 0:
            sign_row(strip.screen, i - 1, 0, n - 1, room.signs[(i - 1) & 1])
        at = _mark(strip, i, 0, n, room)
        unclear += at if i < m - 1 else 0
        if i == m - 1 - _TRIED and 4 * unclear > _TRIED * n:
            return -1, Onward(costs, least)
        _add_row(strip, room, at, ahead, i == m - 1)
        if i > 0 and i % STRIDE == 0:
            lowest = FAR
            for j in range(n):
                lowest = min(lowest, ahead[j])
            least[i // STRIDE - 1] = lowest
            for j in range(n):
                costs[i // STRIDE - 1, j] = min(ahead[j] - lowest, _LARGEST)
    return ahead[0], Onward(costs, least)


@compiled
def _bound_row(onward: Onward, i: int, low: Integers) -> None:
    """Writes what going on from row i costs at least: across the next row that was kept."""
    k = i // STRIDE
    if k >= onward.costs.shape[0]:
        low[:] = 0
        return
    least = FAR
    for j in range(low.size - 1, -1, -1):
        least = min(least, onward.costs[k, j] + onward.least[k])
        low[j] = least


@compiled
def _reach_row(
    strip: CountStrip,
    i: int,
    columns: tuple[int, int],
    limit: int,
    came: Integers,
    low: Integers,
    room: _Room,
) -> tuple[int, int, int, int]:
    """Goes on along a row as far as the limit lets it, and writes where and at what it is left.

    Returns:
        The first bridge that is within the limit, and the one behind the last; the cost of its
        last bridge; how many bridges were looked at.
    """
    m, n = strip.p.shape[1] - 1, strip.q.shape[1] - 1
    first, stop = columns
    here, total, looked = FAR, FAR, 0
    left, right, j, more = n, 0, first, max(stop - first, 0) + _CHUNK
    while j < n and (j < stop or here <= limit):
        end, more = min(n, j + more), 2 * more
        if i > 0:
            sign_row(strip.screen, i - 1, max(j - 1, 0), min(end, n - 1), room.signs[(i - 1) & 1])
        if i < m - 1:
            sign_row(strip.screen, i, max(j - 1, 0), min(end, n - 1), room.signs[i & 1])
        _mark(strip, i, j, end, room)
        at, looked = 0, looked + end - j
        for c in range(j, end):
            p_p, p_q, q_p, q_q, by_p, by_q = _weights(room, c, at, strip.counts.invalid)
            at += 1 if room.marks[c] >= UNCLEAR else 0
            p, q = came[c] if c < stop else FAR, here
            total = min(p, q)
            if total + low[c] <= limit:
                left, right = min(left, c), c + 1
                came[c], here = min(p + p_p, q + q_p) + by_p, min(p + p_q, q + q_q) + by_q
            else:
                came[c] = here = FAR
        j = end
    return left, right, total, looked


@compiled
def reach(
    strip: CountStrip, onward: Onward, limit: int, most: int
) -> tuple[int, Integers, Integers, int]:
    """Finds the bridges that a path of at most so many counts can have.

    Args:
        strip: m and n at least 2.
        onward: what is known of the way onward; may be nothing.
        limit: the largest count.
        most: so many bridges are looked at, then it is given up.

    Returns:
        The least count at the end, or FAR if the end is not reached or it was given up; (m,) and
        (m,): the first bridge of each row, and the one behind the last; how many were looked at.
    """
    m, n = strip.p.shape[1] - 1, strip.q.shape[1] - 1
    room = _new_room(n)
    came, low = np.full(n, FAR), np.zeros(n, dtype=np.int64)
    left, right = np.zeros(m, dtype=np.int64), np.zeros(m, dtype=np.int64)
    came[0] = 0
    first, stop, seen, total = 0, 1, 0, FAR
    for i in range(m):
        if i % STRIDE == 0:
            k = i // STRIDE - 1
            if 0 <= k < onward.costs.shape[0]:
                for j in range(first, stop):
                    if came[j] + onward.costs[k, j] + onward.least[k] > limit:
                        came[j] = FAR
            if onward.costs.size > 0:
                _bound_row(onward, i, low)
        left[i], right[i], total, looked = _reach_row(
            strip, i, (first, stop), limit, came, low, room
        )
        seen += looked
        first, stop = left[i], right[i]
        if first >= stop or seen > most:
            return FAR, left, right, seen
    for i in range(m - 2, -1, -1):
        right[i] = min(right[i], right[i + 1])  # no way on from further
    return (total if stop == n else FAR), left, right, seen

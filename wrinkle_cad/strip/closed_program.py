"""One dynamic program around a closed strip, over a range of starts and a window of bridges."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from .bars import Bars, bar_row
from .compiled import compiled
from .convexity import judge_row
from .folding import cost_row, new_costs
from .global_search import decide_row
from .objective import Weights
from .sightlines import VIEW_ROWS, bank_lengths, look_along

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Steps = npt.NDArray[np.int8]
Limits = tuple[float, float, int]
"""Planarity and round-off in mm, and HINGE or PAPER."""
Window = tuple[Integers, int]
"""(m+1,): from which column of the cover on samples 1 to m of P are looked at, and where the next
turn begins; and how many columns."""

NOTHING, CROSSINGS, BUT_LAST = range(3)
"""What a program writes down beside its best paths."""

NEVER: Final = 1e300
"""Cost in the first part, a count, of what is not allowed."""


def whole_window(m: int, n: int, first: int, stop: int) -> Window:
    """Returns the window of all bridges between a range of starts and its ends."""
    return np.full(m + 1, first, dtype=np.int64), n + stop - first


@compiled
def _columns_from(q: Floats, left: int, columns: Floats, q_banks: Floats) -> None:
    """Writes the samples of Q from a column of the cover on, and the bank edges between them."""
    n = q.shape[1]
    for c in range(q_banks.shape[1]):
        here, before = (left + c) % n, (left + c - 1) % n
        for axis in range(3):
            q_banks[axis, c] = q[axis, here] - q[axis, before]
            if c < columns.shape[1]:
                columns[axis, c] = q[axis, here]


@compiled
def _moved(ahead: Floats, by: int) -> Floats:
    """The costs ahead, seen from a window that begins so many columns further left."""
    count = ahead.shape[0]
    moved = np.zeros_like(ahead)
    moved[:, 0] = NEVER
    for c in range(max(0, by), min(count, count + by)):
        moved[c] = ahead[c - by]
    return moved


@compiled
def decide_range(
    p: Floats,
    q: Floats,
    starts: tuple[int, int],
    weights: Weights,
    limits: Limits,
    bars: Bars,
    window: Window,
    charge: Floats,
    recorded: int,
    grid: tuple[int, int],
) -> tuple[Floats, npt.NDArray[np.uint8], Floats]:
    """Finds the best path from every start (0, first), ... to any of the ends n further on.

    Args:
        p: (m, 3) float64, mm.
        q: (3, n) float64, mm.
        starts: the first column, and how many.
        weights: parts of the cost.
        limits: planarity, round-off, energy.
        bars: of samples 1 to m of P and columns 0 to 2 n of the cover.
        window: which bridges are looked at.
        charge: (parts,) for each step on Q that a path has fewer than 2 n from a start at 0 on.
        recorded: NOTHING; CROSSINGS: the costs of the P-steps as well; BUT_LAST: these, without
            what the bridges of sample m cost, and nothing else.
        grid: at which samples of P they are written down: the first of them, less 1, and how far
            they are apart.

    Returns:
        (starts, parts): the least cost from each start to any of the ends. (m, width) uint8: the
        step to take at samples 1 to m of P, as decide_row writes it. (samples, width, parts): from
        the P-step that comes to each sample of the grid and column on; empty if not wanted.
    """
    m, n = p.shape[0], q.shape[1]
    planarity, nothing, energy = limits
    left, count = window
    first, many = starts
    columns, q_banks = np.empty((3, count)), np.empty((3, count + 1))
    view, valid, costs = np.empty((VIEW_ROWS, count)), np.empty(count, np.bool_), new_costs(count)
    banks, p_banks = np.empty((4, count)), np.empty((3, 2))
    ahead = np.zeros((count, len(weights)))
    for c in range(count):
        column = left[m] + c
        ahead[c] = charge * (2 * n - (1 if recorded == BUT_LAST else 0) - column)
        if column < first + n or column >= first + n + many:
            ahead[c, 0] = NEVER
    choices = np.empty((m, count), dtype=np.uint8)
    offset, stride = grid
    kept = (m - 1 - offset) // stride + 1 if recorded else 0
    crossings = np.empty((kept, count, len(weights)))
    last = m - 1 if recorded == BUT_LAST else m
    if recorded == BUT_LAST and (m - 1 - offset) % stride == 0:
        crossings[kept - 1] = ahead
    for i in range(last, 0, -1):
        if i == last or left[i - 1] != left[i]:
            _columns_from(q, left[i - 1], columns, q_banks)
            banks[2], banks[3] = bank_lengths(q_banks[:, :-1]), bank_lengths(q_banks[:, 1:])
        if left[i] != left[i - 1]:
            ahead = _moved(ahead, left[i] - left[i - 1])
        for axis in range(3):
            p_banks[axis, 0] = p[i % m, axis] - p[i - 1, axis]
            p_banks[axis, 1] = p[(i + 1) % m, axis] - p[i % m, axis]
        lengths = bank_lengths(p_banks)
        banks[0], banks[1] = lengths[0], lengths[1]
        look_along(p[i % m], p_banks, columns, q_banks, view)
        judge_row(view, planarity, valid)
        cost_row(view, banks, nothing, planarity, energy, costs)
        bar_row(view, Bars(bars.bridges[:, left[i - 1] :], bars.least_cosine), i - 1, costs)
        decide_row(weights, False, view, valid, costs, ahead, choices[i - 1])
        if recorded and i > offset and (i - 1 - offset) % stride == 0:
            crossings[(i - 1 - offset) // stride] = ahead
    found = np.zeros((many, len(weights)))
    for k in range(many):
        c = first + k - left[0]
        if 0 <= c < count:
            found[k] = ahead[c] + charge * (first + k)
        else:
            found[k, 0] = NEVER
    return found, choices, crossings


@compiled
def follow_around(choices: npt.NDArray[np.uint8], left: Integers, start: int) -> tuple[Steps, int]:
    """Returns the steps from (0, start) until sample m is left, and the column where it is left.

    Args:
        choices: (m, width) uint8, of decide_range.
        left: (m+1,) where its window begins.
        start: column of the cover.
    """
    m = choices.shape[0]
    steps = np.zeros(2 * m + 4 * choices.shape[1] + left.max() + 4, dtype=np.int8)
    number, i, j, step = 1, 1, start, 0
    while i <= m:
        step = (choices[i - 1, j - left[i - 1]] >> step) & 1
        steps[number] = step
        number += 1
        i, j = i + 1 - step, j + step
    return steps[: number - 1], j

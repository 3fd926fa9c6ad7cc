"""Triangulations found by looking one step ahead: LODT+LMBT and LMBT of Wang and Tang, section 4.

What the paper leaves open is decided so:

- The nearest valid bridge of (i, j) has i' > i, j' > j and the smallest (i'-i) + (j'-j); of several
  it is the one with the largest i'. The last bridge counts as valid, since it is in every
  triangulation, so a nearest one always exists.
- Where the paper compares bending, a step that folds back by 180 degrees comes after one that does
  not, then one that makes a triangle of zero area, whatever it bends; coplanar triangles do not
  bend. Of two steps that bend equally (at the first bridge nothing bends) the one to the shorter
  bridge is taken, of equal ones the P-step.
- Where bridges or folds are barred, a step from which the end cannot be reached without one is not
  taken; a goal that is passed by then is given up.
- A closed strip begins at a given bridge and ends at it: what is chosen there sees no seam.
- A valid bridge is preferred to an invalid one as the paper says, even where the strip is flat or
  folds back: one step ahead, nothing tells whether the next bridge bends. There is no price.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .bars import Bars
from .closed_strip import closed_line
from .compiled import compiled
from .convexity import judge_row
from .folding import cost_row, new_costs
from .objective import REAL_TIE
from .open_ways import open_ways
from .sightlines import VIEW_ROWS, bank_lengths, look_along, padded_banks

Floats = npt.NDArray[np.float64]
Rails = tuple[Floats, Floats, Floats, Floats]

_NO_WAYS = np.zeros((0, 0), dtype=np.uint8)


@compiled
def _look(rails: Rails, i: int, j: int, view: Floats) -> None:
    p, p_banks, q, q_banks = rails
    look_along(p[i], p_banks[:, i : i + 2], q[:, j : j + 1], q_banks[:, j : j + 2], view)


@compiled
def _is_valid(rails: Rails, i: int, j: int, planarity: float) -> bool:
    if i == rails[0].shape[0] - 1 and j == rails[2].shape[1] - 1:
        return True
    view = np.empty((VIEW_ROWS, 1))
    valid = np.empty(1, dtype=np.bool_)
    _look(rails, i, j, view)
    judge_row(view, planarity, valid)
    return bool(valid[0])


@compiled
def _bridge_length(rails: Rails, i: int, j: int) -> float:
    p, _, q, _ = rails
    x, y, z = q[0, j] - p[i, 0], q[1, j] - p[i, 1], q[2, j] - p[i, 2]
    return float(np.sqrt(x * x + y * y + z * z))


@compiled
def _easier_step(
    rails: Rails, i: int, j: int, earlier: int, planarity: float, nothing: float, energy: int
) -> int:
    """The step that bends bridge (i, j) less, after the earlier one that arrived there."""
    view = np.empty((VIEW_ROWS, 1))
    banks = np.empty((4, 1))
    costs = new_costs(1)
    _look(rails, i, j, view)
    banks[:2, 0] = bank_lengths(rails[1][:, i : i + 2])
    banks[2:, 0] = bank_lengths(rails[3][:, j : j + 2])
    cost_row(view, banks, nothing, planarity, energy, costs)
    row = 2 * earlier
    parts = (
        (costs.fold_backs[row, 0], costs.fold_backs[row + 1, 0], 0.0),
        (costs.degenerate[1, 0], costs.degenerate[3, 0], 0.0),
        (costs.bending[row, 0], costs.bending[row + 1, 0], REAL_TIE),
        (_bridge_length(rails, i + 1, j), _bridge_length(rails, i, j + 1), REAL_TIE),
    )
    for p_cost, q_cost, tie in parts:
        if abs(p_cost - q_cost) > tie * (p_cost + q_cost):
            return 0 if p_cost < q_cost else 1
    return 0


@compiled
def _nearest_valid(rails: Rails, i: int, j: int, planarity: float) -> tuple[int, int]:
    m, n = rails[0].shape[0], rails[2].shape[1]
    for distance in range(2, m + n):
        for further in range(min(distance - 1, m - 1 - i), 0, -1):
            column = j + distance - further
            if column >= n:
                break
            if _is_valid(rails, i + further, column, planarity):
                return i + further, column
    return m - 1, n - 1


@compiled
def _walk(
    rails: Rails,
    is_developable: bool,
    planarity: float,
    nothing: float,
    energy: int,
    ways: npt.NDArray[np.uint8],
) -> npt.NDArray[np.int8]:
    m, n = rails[0].shape[0], rails[2].shape[1]
    steps = np.empty(m + n - 2, dtype=np.int8)
    goal_i, goal_j = (0, 0) if is_developable else (m - 1, n - 1)
    i = j = step = 0
    for number in range(m + n - 2):
        earlier = step
        if i == goal_i and j == goal_j:
            goal_i, goal_j = -1, -1
        if goal_i < 0 and i < m - 1 and j < n - 1:
            p_valid = _is_valid(rails, i + 1, j, planarity)
            q_valid = _is_valid(rails, i, j + 1, planarity)
            if not (p_valid or q_valid):
                goal_i, goal_j = _nearest_valid(rails, i, j, planarity)
            elif not (p_valid and q_valid):
                step = 0 if p_valid else 1
            else:
                step = _easier_step(rails, i, j, step, planarity, nothing, energy)
        elif goal_i < 0:
            step = 0 if j == n - 1 else 1
        if goal_i >= 0:
            if i == goal_i or j == goal_j:
                step = 0 if j == goal_j else 1
            else:
                step = _easier_step(rails, i, j, step, planarity, nothing, energy)
        if ways.shape[0] > 0 and not (ways[i, j] >> (2 * earlier + step)) & 1:
            step = 1 - step
            if (step == 0 and i == goal_i) or (step == 1 and j == goal_j):
                goal_i, goal_j = -1, -1
        steps[number] = step
        i, j = i + 1 - step, j + step
    return steps


def local_steps(
    p: Floats,
    q: Floats,
    *,
    is_developable: bool,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars | None = None,
) -> npt.NDArray[np.int8]:
    """Returns the steps of the locally best triangulation.

    O(m+n) time and memory but for the looks for a nearest valid bridge, each of which costs the
    square of the distance it finds; with bars O(m n).

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        is_developable: LODT, with LMBT between valid bridges, if True; LMBT all along if False.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
        bars: bridges and folds to avoid if that can be.

    Returns:
        (m+n-2,) int8: 0 a P-step, 1 a Q-step.
    """
    rails = (p, padded_banks(p), np.ascontiguousarray(q.T), padded_banks(q))
    ways = _NO_WAYS
    if bars is not None:
        ways = open_ways(rails, bars, (planarity, nothing, energy), -1)
    return _steps(rails, ways, is_developable, planarity, nothing, energy)


def closed_local_steps(
    p: Floats,
    q: Floats,
    start: tuple[int, int],
    *,
    is_developable: bool,
    planarity: float,
    nothing: float,
    energy: int,
    bars: Bars | None = None,
) -> npt.NDArray[np.int8]:
    """Returns the steps of the locally best triangulation around a closed strip from a bridge.

    Args:
        p: (m, 3) float64, mm; checked samples of closed directrix P, the first not repeated.
        q: (n, 3) float64, mm; those of closed directrix Q.
        start: i, j of the bridge where it begins and ends.
        is_developable: see local_steps.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
        bars: of the bridges from the start to itself again, (m+1, n+1).

    Returns:
        (m+n,) int8: 0 a P-step, 1 a Q-step.
    """
    lines = [
        closed_line(np.roll(rail, -at, axis=0)) for rail, at in zip((p, q), start, strict=True)
    ]
    banks = []
    for line in lines:
        own = padded_banks(line)
        own[:, 0], own[:, -1] = own[:, -2], own[:, 1]
        banks.append(own)
    rails = (lines[0], banks[0], np.ascontiguousarray(lines[1].T), banks[1])
    if bars is None:
        return _steps(rails, _NO_WAYS, is_developable, planarity, nothing, energy)
    tried = []
    for first in (0, 1):
        ways = open_ways(rails, bars, (planarity, nothing, energy), first)
        ways[0, 0] &= 1 << first
        steps = _steps(rails, ways, is_developable, planarity, nothing, energy)
        if ways[0, 0]:
            return steps
        tried.append(steps)
    return tried[0]


def _steps(
    rails: Rails,
    ways: npt.NDArray[np.uint8],
    is_developable: bool,
    planarity: float,
    nothing: float,
    energy: int,
) -> npt.NDArray[np.int8]:
    is_open = ways if ways.size and ways[0, 0] else _NO_WAYS
    steps: npt.NDArray[np.int8] = _walk(rails, is_developable, planarity, nothing, energy, is_open)
    return steps

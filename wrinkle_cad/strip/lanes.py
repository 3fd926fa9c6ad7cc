"""Many bridges side by side, each measured as by itself: what a fast search is made of.

A block holds LANES bridges, one number of each in a row. All rows stand in one array at offsets
that the compiler knows: so it sees that no two overlap, and runs whole loops on vector units. The
arithmetic, to the last bit, is that of look_along, judge_row and cost_row with the hinge energy.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from .compiled import compiled, inlined
from .convexity import is_convex
from .folding import fold_of
from .sightlines import frame_of, padded_banks

Floats = npt.NDArray[np.float64]

LANES: Final = 128
"""Bridges in a block."""


def _rows(first: int, count: int) -> tuple[int, ...]:
    """Where rows begin in a block."""
    return tuple(row * LANES for row in range(first, first + count))


# Written before a bridge is measured: its end on P, the bank edge before it on P and that one's
# length; the edge behind it and its length; the end on Q, the edge behind it, the one before it.
P_PART, P_REST, Q_PART, Q_REST = 0, 7 * LANES, 11 * LANES, 18 * LANES
PART: Final = 7
"""Rows of a rail's numbers: sample, bank edge, its length."""
REST: Final = 4
"""Rows of the other bank edge at a sample."""
_PX, _PY, _PZ, _AX, _AY, _AZ, _A, _BX, _BY, _BZ, _B = _rows(0, 11)
_QX, _QY, _QZ, _DX, _DY, _DZ, _D, _CX, _CY, _CZ, _C = _rows(11, 11)
# Measured: its length; its neighbours as it sees them, their heights over it, the sides on which
# they lie of each other; 1.0 for triangles of zero area, and if it is not locally convex.
LENGTH, _X1, _Y1, _X2, _Y2, _X3, _Y3, _X4, _Y4, _H1, _H2, _H3, _H4 = _rows(22, 13)
_FLAT_1, FLAT_P, _FLAT_3, FLAT_Q, INVALID, _S12, _S14, _S23, _S34 = _rows(35, 9)
# Areas of the triangles behind a P-step and a Q-step; the fold's energy, whether it bends and
# whether it lies on itself, by the steps before and after: P P, P Q, Q P, Q Q.
AREA_P, AREA_Q = _rows(44, 2)
BENDING: Final = _rows(46, 4)
BENT: Final = _rows(50, 4)
BACK: Final = _rows(54, 4)
_BEND_0, _BEND_1, _BEND_2, _BEND_3 = BENDING
_BENT_0, _BENT_1, _BENT_2, _BENT_3 = BENT
_BACK_0, _BACK_1, _BACK_2, _BACK_3 = BACK
FREE: Final = 58
"""The first row that the measurement does not use."""


class Rails(NamedTuple):
    """Both rails, Q from its end on, so that diagonals run along both of them."""

    p: Floats
    """(7, m+1) float64, mm; samples, the bank edges before them, their lengths (padded_banks)."""
    q: Floats
    """(7, n+1) float64, mm; the last sample first, the bank edges behind them, their lengths."""


def rails_of(p: Floats, q: Floats) -> Rails:
    """Returns the rails as blocks are filled from them.

    Args:
        p: (m, 3) float64, mm.
        q: (n, 3) float64, mm.
    """
    rows = []
    for rail, banks in ((p, padded_banks(p)), (q[::-1], padded_banks(q)[:, ::-1])):
        own = np.zeros((PART, len(rail) + 1))
        own[:3, :-1], own[3:6] = rail.T, banks
        own[6] = np.sqrt(banks[0] ** 2 + banks[1] ** 2 + banks[2] ** 2)
        rows.append(own)
    return Rails(*rows)


@compiled
def put_rows(
    block: Floats, row: int, source: Floats, first_row: int, rows: int, first: int, count: int
) -> None:
    """Copies so many columns of some rows of a source into rows of a block, from `row` on."""
    for k in range(rows):
        numbers = source[first_row + k][first : first + count]
        lanes = block[row + k * LANES : row + k * LANES + count]
        for lane in range(count):
            lanes[lane] = numbers[lane]


@compiled
def take_rows(block: Floats, row: int, target: Floats, first: int, count: int) -> None:
    """Copies k rows of a block into so many columns of a target (k, n), from the first on."""
    for k in range(target.shape[0]):
        numbers = target[k][first : first + count]
        lanes = block[row + k * LANES : row + k * LANES + count]
        for lane in range(count):
            numbers[lane] = lanes[lane]


@compiled
def _look(block: Floats, count: int) -> None:
    """Writes the bridges' lengths and their neighbours as they see them (look_along)."""
    w = block
    for k in range(count):
        size, ux, uy, uz, vx, vy, vz = frame_of(
            w[_QX + k] - w[_PX + k], w[_QY + k] - w[_PY + k], w[_QZ + k] - w[_PZ + k]
        )
        w[LENGTH + k] = size
        x, y, z = w[_AX + k], w[_AY + k], w[_AZ + k]
        w[_X1 + k], w[_Y1 + k] = -(x * ux + y * uy + z * uz), -(x * vx + y * vy + z * vz)
        x, y, z = w[_BX + k], w[_BY + k], w[_BZ + k]
        w[_X2 + k], w[_Y2 + k] = x * ux + y * uy + z * uz, x * vx + y * vy + z * vz
        x, y, z = w[_CX + k], w[_CY + k], w[_CZ + k]
        w[_X3 + k], w[_Y3 + k] = -(x * ux + y * uy + z * uz), -(x * vx + y * vy + z * vz)
        x, y, z = w[_DX + k], w[_DY + k], w[_DZ + k]
        w[_X4 + k], w[_Y4 + k] = x * ux + y * uy + z * uz, x * vx + y * vy + z * vz


@compiled
def _judge(block: Floats, count: int, planarity: float, nothing: float) -> None:
    """Writes heights, sides, areas, triangles of zero area and what is not locally convex."""
    w = block
    for k in range(count):
        x1, y1, x2, y2 = w[_X1 + k], w[_Y1 + k], w[_X2 + k], w[_Y2 + k]
        x3, y3, x4, y4 = w[_X3 + k], w[_Y3 + k], w[_X4 + k], w[_Y4 + k]
        squares = x1 * x1 + y1 * y1, x2 * x2 + y2 * y2, x3 * x3 + y3 * y3, x4 * x4 + y4 * y4
        h1, h2, h3, h4 = (
            np.sqrt(squares[0]),
            np.sqrt(squares[1]),
            np.sqrt(squares[2]),
            np.sqrt(squares[3]),
        )
        w[_H1 + k], w[_H2 + k], w[_H3 + k], w[_H4 + k] = h1, h2, h3, h4
        s12, s13, s14 = x1 * y2 - y1 * x2, x1 * y3 - y1 * x3, x1 * y4 - y1 * x4
        s23, s24, s34 = x2 * y3 - y2 * x3, x2 * y4 - y2 * x4, x3 * y4 - y3 * x4
        w[_S12 + k], w[_S14 + k], w[_S23 + k], w[_S34 + k] = s12, s14, s23, s34
        size = w[LENGTH + k]
        is_valid = is_convex(
            size, squares, (h1, h2, h3, h4), (s12, s13, s14, s23, s24, s34), planarity
        )
        w[INVALID + k] = 0.0 if is_valid else 1.0
        w[_FLAT_1 + k] = 1.0 if size * h1 <= nothing * max(size, w[_A + k]) else 0.0
        w[FLAT_P + k] = 1.0 if size * h2 <= nothing * max(size, w[_B + k]) else 0.0
        w[_FLAT_3 + k] = 1.0 if size * h3 <= nothing * max(size, w[_C + k]) else 0.0
        w[FLAT_Q + k] = 1.0 if size * h4 <= nothing * max(size, w[_D + k]) else 0.0
        w[AREA_P + k], w[AREA_Q + k] = 0.5 * size * h2, 0.5 * size * h4


@inlined
def _one_fold(
    length: float,
    side: float,
    along: float,
    first: float,
    second: float,
    flat: float,
    flatness: float,
) -> tuple[float, float, float]:
    energy, bent, back = fold_of(length, abs(side), -along, first, second, flatness)
    has_fold = flat == 0.0
    return (
        energy if has_fold else 0.0,
        bent if has_fold else 0.0,
        back if has_fold else 0.0,
    )


@compiled
def _fold(block: Floats, count: int, flatness: float) -> None:
    """Writes energies, bent folds and fold-backs, by the steps before and after the bridges."""
    w = block
    for k in range(count):
        size = w[LENGTH + k]
        x1, y1, x2, y2 = w[_X1 + k], w[_Y1 + k], w[_X2 + k], w[_Y2 + k]
        x3, y3, x4, y4 = w[_X3 + k], w[_Y3 + k], w[_X4 + k], w[_Y4 + k]
        h1, h2, h3, h4 = w[_H1 + k], w[_H2 + k], w[_H3 + k], w[_H4 + k]
        f1, f2, f3, f4 = w[_FLAT_1 + k], w[FLAT_P + k], w[_FLAT_3 + k], w[FLAT_Q + k]
        w[_BEND_0 + k], w[_BENT_0 + k], w[_BACK_0 + k] = _one_fold(
            size, w[_S12 + k], x1 * x2 + y1 * y2, h1, h2, f1 + f2, flatness
        )
        w[_BEND_1 + k], w[_BENT_1 + k], w[_BACK_1 + k] = _one_fold(
            size, w[_S14 + k], x1 * x4 + y1 * y4, h1, h4, f1 + f4, flatness
        )
        w[_BEND_2 + k], w[_BENT_2 + k], w[_BACK_2 + k] = _one_fold(
            size, w[_S23 + k], x3 * x2 + y3 * y2, h3, h2, f3 + f2, flatness
        )
        w[_BEND_3 + k], w[_BENT_3 + k], w[_BACK_3 + k] = _one_fold(
            size, w[_S34 + k], x3 * x4 + y3 * y4, h3, h4, f3 + f4, flatness
        )


@compiled
def measure(block: Floats, count: int, planarity: float, nothing: float) -> None:
    """Measures the first bridges of a block, whose first 22 rows are written.

    Args:
        block: (rows * LANES,) float64, mm; see the names of its rows.
        count: how many bridges.
        planarity: mm; see validity_matrix; also how far coplanar triangles are apart.
        nothing: mm; a distance that is round-off.
    """
    _look(block, count)
    _judge(block, count, planarity, nothing)
    _fold(block, count, max(planarity, nothing))

"""A path through the bridges, and what is measured on it bridge by bridge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .convexity import judge_row
from .folding import cost_row, fold_angles, new_costs
from .sightlines import bank_lengths, look_along_path, padded_banks

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Steps = npt.NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """The k bridges of a triangulation, in order."""

    bridges: npt.NDArray[np.int64]
    """(k, 2) int64; i, j of each bridge."""
    steps: Steps
    """(k-1,) int8; 0 a P-step, 1 a Q-step."""
    view: Floats
    """(9, k) float64, mm; each bridge seen along itself (look_along)."""
    valid: Bools
    """(k,) bool; locally convex bridges."""
    is_flat: Bools
    """(k-1,) bool; triangles of zero area."""
    is_bent: Bools
    """(k,) bool; interior bridges whose two triangles have areas and are not coplanar."""
    is_folded_back: Bools
    """(k,) bool; interior bridges at which one triangle lies on the other."""
    fold: Floats
    """(k-2,) float64, rad; signed fold angle of each interior bridge, 0 beside a flat triangle."""
    bending_at: Floats
    """(k-2,) float64; bending energy of each interior bridge."""
    area: float
    """mm2; of all triangles."""


def bridges_of(steps: Steps) -> npt.NDArray[np.int64]:
    """Returns the bridges (k, 2) that k-1 steps lead through, from (0, 0)."""
    bridges = np.zeros((steps.size + 1, 2), dtype=np.int64)
    bridges[1:, 1] = np.cumsum(steps)
    bridges[1:, 0] = np.arange(1, steps.size + 1) - bridges[1:, 1]
    return bridges


def walk(
    p: Floats, q: Floats, steps: Steps, *, planarity: float, nothing: float, energy: int
) -> Path:
    """Returns what is measured along a path.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        steps: (m+n-2,) int8; m-1 P-steps and n-1 Q-steps.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        energy: HINGE or PAPER.
    """
    bridges = bridges_of(steps)
    p_banks, q_banks = padded_banks(p), padded_banks(q)
    view = look_along_path(p, p_banks, np.ascontiguousarray(q.T), q_banks, bridges)
    valid = np.empty(bridges.shape[0], dtype=np.bool_)
    judge_row(view, planarity, valid)
    costs = new_costs(bridges.shape[0])
    cost_row(view, _bank_lengths_at(bridges, p_banks, q_banks), nothing, planarity, energy, costs)
    leaving = np.arange(steps.size)
    is_flat = costs.degenerate[2 * steps + 1, leaving] > 0.0
    turn = 2 * steps[:-1] + steps[1:], leaving[1:]
    fold = fold_angles(view[:, 1:-1], steps)
    fold[is_flat[:-1] | is_flat[1:]] = 0.0
    return Path(
        bridges=bridges,
        steps=steps,
        view=view,
        valid=valid,
        is_flat=is_flat,
        fold=fold,
        is_bent=_at_interior(costs.bent[turn]),
        is_folded_back=_at_interior(costs.fold_backs[turn]),
        bending_at=costs.bending[turn],
        area=float(costs.area[steps, leaving].sum()),
    )


def _at_interior(marks: Floats) -> Bools:
    return np.concatenate(([False], marks > 0.0, [False]))


def _bank_lengths_at(bridges: npt.NDArray[np.int64], p_banks: Floats, q_banks: Floats) -> Floats:
    """Lengths of the bank edges at each bridge: before, after it on P, before, after it on Q."""
    p_lengths, q_lengths = bank_lengths(p_banks), bank_lengths(q_banks)
    i, j = bridges.T
    return np.stack((p_lengths[i], p_lengths[i + 1], q_lengths[j], q_lengths[j + 1]))

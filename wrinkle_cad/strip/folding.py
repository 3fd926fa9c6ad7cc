"""What a fold costs: bending energies, fold angles and degenerate triangles at a bridge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import STEEPEST_HALF_FOLD

from .compiled import compiled
from .sightlines import BEFORE_P, NEXT_P

Floats = npt.NDArray[np.float64]

HINGE, PAPER = 0, 1
ENERGIES = {"hinge": HINGE, "paper": PAPER}
"""`hinge`: |e|/4 (1/L1 + 1/L2) (2 tan(fold/2))^2, with e the bridge and L1, L2 the heights of both
triangles over it; |2 tan(fold/2)| is the discrete curvature of Grinspun et al., "Discrete shells",
2003. Monotone in the fold, infinite at 180 degrees, the same from both ends of the strip.
`paper`: A sin^2(fold) / L^2 with area A and height L of the later triangle, Eq. (3) of Wang and
Tang. A fold of 180 degrees costs nothing there, and the two ends of a strip differ."""

_STEEPEST = STEEPEST_HALF_FOLD


class StepCosts(NamedTuple):
    """What leaving each of n bridges costs, by the step after it and the one before it."""

    bending: Floats
    """(4, n) float64; bending energy at the bridge; row 2 * earlier step + later step."""
    fold_backs: Floats
    """(4, n) float64; rows as in bending; 1.0 for a fold of 180 degrees, else 0.0."""
    degenerate: Floats
    """(2, n) float64; 1.0 if the later step's triangle has no area, else 0.0."""
    area: Floats
    """(2, n) float64, mm2; of the later step's triangle."""


@compiled
def is_degenerate(length: float, height: float, bank: float, nothing: float) -> bool:
    """Whether the triangle on a bridge has zero area: some vertex lies on the opposite side.

    Args:
        length: mm; of the bridge.
        height: mm; of the third vertex over the bridge.
        bank: mm; length of the triangle's bank edge.
        nothing: mm; a height that is round-off.
    """
    return bool(length * height <= nothing * max(length, bank))


@compiled
def fold_cost(
    length: float,
    ax: float,
    ay: float,
    first: float,
    bx: float,
    by: float,
    second: float,
    nothing: float,
    energy: int,
) -> tuple[float, float]:
    """The cost of the fold at a bridge between two triangles that are not degenerate.

    Args:
        length: mm; of the bridge.
        ax: mm; with ay the earlier triangle's third vertex, seen along the bridge.
        ay: mm; see ax.
        first: mm; length of (ax, ay), the earlier triangle's height.
        bx: mm; with by the later triangle's third vertex.
        by: mm; see bx.
        second: mm; length of (bx, by), the later triangle's height.
        nothing: mm; an offset from the other triangle's plane that is round-off.
        energy: HINGE or PAPER.

    Returns:
        The bending energy, and 1.0 if the later triangle folds back onto the earlier one, else 0.0;
        such a fold costs no (infinite) energy but is counted. `paper` knows no such folds.
    """
    size = first * second
    sine = abs(ay * bx - ax * by)
    cosine = -(ax * bx + ay * by)
    if sine <= nothing * max(first, second):
        sine = 0.0
    if energy == PAPER:
        return 0.5 * length * (sine / size) ** 2 / second, 0.0
    far = size - cosine
    if cosine < 0.0 and far >= _STEEPEST * sine:
        return 0.0, 1.0
    half = sine / (size + cosine) if cosine >= 0.0 else far / sine
    return length * ((first + second) / size) * half * half, 0.0


@compiled
def new_costs(count: int) -> StepCosts:
    """Returns room for the costs of leaving so many bridges."""
    return StepCosts(
        np.empty((4, count)), np.empty((4, count)), np.empty((2, count)), np.empty((2, count))
    )


@compiled
def cost_row(
    view: Floats,
    banks: Floats,
    nothing: float,
    energy: int,
    costs: StepCosts,
) -> None:
    """Writes what leaving each bridge of a view costs.

    Args:
        view: (9, n) float64, mm; bridges as look_along fills them in.
        banks: (4, n) float64, mm; lengths of the bank edges before and after on P, before and after
            on Q; zero where there is none.
        nothing: mm; round-off.
        energy: HINGE or PAPER.
        costs: written.
    """
    bending, fold_backs, degenerate, area = costs
    for j in range(view.shape[1]):
        length = view[0, j]
        for later in range(2):
            bx, by = view[NEXT_P + 4 * later, j], view[NEXT_P + 1 + 4 * later, j]
            height = np.sqrt(bx * bx + by * by)
            is_flat = is_degenerate(length, height, banks[1 + 2 * later, j], nothing)
            degenerate[later, j] = 1.0 if is_flat else 0.0
            area[later, j] = 0.5 * length * height
        for earlier in range(2):
            ax, ay = view[BEFORE_P + 4 * earlier, j], view[BEFORE_P + 1 + 4 * earlier, j]
            arm = np.sqrt(ax * ax + ay * ay)
            is_flat = is_degenerate(length, arm, banks[2 * earlier, j], nothing)
            for later in range(2):
                row = 2 * earlier + later
                bending[row, j] = fold_backs[row, j] = 0.0
                if not is_flat and degenerate[later, j] == 0.0:
                    bx, by = view[NEXT_P + 4 * later, j], view[NEXT_P + 1 + 4 * later, j]
                    height = np.sqrt(bx * bx + by * by)
                    bending[row, j], fold_backs[row, j] = fold_cost(
                        length, ax, ay, arm, bx, by, height, nothing, energy
                    )


def fold_angles(view: Floats, steps: npt.NDArray[np.int8]) -> Floats:
    """Returns the signed fold angle at interior bridges.

    Args:
        view: (9, k) float64, mm; the interior bridges of a path, as look_along fills them in.
        steps: (k+1,) int8; the kinds of step before, between and after them.

    Returns:
        (k,) float64, rad, in (-pi, pi]; the turn from the earlier triangle's plane to the later
        one's; positive for a ridge seen from the side where p[i] p[i+1] q[j] is counter-clockwise.
    """
    here = np.arange(view.shape[1])
    earlier, later = (
        BEFORE_P + 4 * steps[:-1].astype(np.intp),
        NEXT_P + 4 * steps[1:].astype(np.intp),
    )
    ax, ay = view[earlier, here], view[earlier + 1, here]
    bx, by = view[later, here], view[later + 1, here]
    return np.arctan2(ay * bx - ax * by, -(ax * bx + ay * by))

"""What a fold costs: bending energies, fold angles and degenerate triangles at a bridge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import STEEPEST_HALF_FOLD
from wrinkle_cad.strip.portable import atan2

from .compiled import compiled, inlined
from .sightlines import BEFORE_P, LENGTH, NEXT_P

Floats = npt.NDArray[np.float64]

HINGE, PAPER = 0, 1
ENERGIES = {"hinge": HINGE, "paper": PAPER}
"""`hinge`: |e|/4 (1/L1 + 1/L2) (2 tan(fold/2))^2, with e the bridge and L1, L2 the heights of both
triangles over it; |2 tan(fold/2)| is the discrete curvature of Grinspun et al., "Discrete shells",
2003. Monotone in the fold, infinite at 180 degrees, the same from both ends of the strip.
`paper`: A sin^2(fold) / L^2 with area A and height L of the later triangle, Eq. (3) of Wang and
Tang. It falls again beyond 90 degrees, and the two ends of a strip differ. Folds of 180 degrees
cost nothing by either energy and are counted instead; so do coplanar triangles, which are not."""

_STEEPEST = STEEPEST_HALF_FOLD


class StepCosts(NamedTuple):
    """What leaving each of n bridges costs, by the step after it and the one before it."""

    bending: Floats
    """(4, n) float64; bending energy at the bridge; row 2 * earlier step + later step."""
    bent: Floats
    """(4, n) float64; rows as in bending; 1.0 if the two triangles have areas and are not coplanar,
    else 0.0."""
    fold_backs: Floats
    """(4, n) float64; rows as in bending; 1.0 for a fold of 180 degrees, else 0.0."""
    heights: Floats
    """(4, n) float64, mm; over the bridge, of the triangles before and after it on P, on Q."""
    degenerate: Floats
    """(4, n) float64; rows as in heights; 1.0 if the triangle has no area, else 0.0."""
    area: Floats
    """(2, n) float64, mm2; of the later step's triangle."""


@inlined
def fold_of(
    length: float, sine: float, cosine: float, first: float, second: float, flatness: float
) -> tuple[float, float, float]:
    """The hinge energy of the fold at a bridge between two triangles that are not degenerate.

    Written without branches, so that a loop over it runs on vector units.

    Args:
        length: mm; of the bridge.
        sine: mm2; of the angle between both third vertices seen along the bridge, times both
            heights; not negative.
        cosine: mm2; minus the same angle's cosine, times both heights.
        first: mm; the earlier triangle's height.
        second: mm; the later triangle's height.
        flatness: mm; triangles are coplanar if the nearer of both third vertices to the other
            triangle's plane is no further from it and they lie on opposite sides of the bridge.

    Returns:
        The bending energy, 0.0 for coplanar triangles; 1.0 if they are not coplanar, else 0.0; and
        1.0 if the later triangle folds back onto the earlier one, else 0.0: that is, if they would
        be coplanar but lie on the same side, or the energy is too large to be added up. Such a fold
        costs no energy but is counted.
    """
    size = first * second
    is_plane = sine <= flatness * max(first, second)
    is_sharp = cosine < 0.0
    far = size + abs(cosine)
    is_back = is_sharp and (is_plane or far >= _STEEPEST * sine)
    is_bent = is_sharp or not is_plane
    # The tangent of half the angle, by whichever formula does not cancel.
    half_over = far if is_sharp else sine
    half_under = sine if is_sharp else far
    bending = length * (first + second) * half_over * half_over / (half_under * half_under * size)
    return (
        bending if is_bent and not is_back else 0.0,
        1.0 if is_bent else 0.0,
        1.0 if is_back else 0.0,
    )


@inlined
def fold_cost(
    length: float,
    ax: float,
    ay: float,
    first: float,
    bx: float,
    by: float,
    second: float,
    flatness: float,
) -> tuple[float, float, float]:
    """The same, by the triangles' third vertices as they are seen along the bridge.

    Args:
        length: mm; of the bridge.
        ax: mm; with ay the earlier triangle's third vertex.
        ay: mm; see ax.
        first: mm; length of (ax, ay), the earlier triangle's height.
        bx: mm; with by the later triangle's third vertex.
        by: mm; see bx.
        second: mm; length of (bx, by), the later triangle's height.
        flatness: mm; see fold_of.
    """
    sine = abs(ay * bx - ax * by)
    return fold_of(length, sine, -(ax * bx + ay * by), first, second, flatness)


class _Side(NamedTuple):
    """The triangles on one side of n bridges: x, y of the third vertex, height, 1.0 if flat."""

    x: Floats
    y: Floats
    height: Floats
    degenerate: Floats


class _Folds(NamedTuple):
    """What n bridges cost between two sides: rows of StepCosts."""

    bending: Floats
    bent: Floats
    fold_backs: Floats


@compiled
def _measure_triangles(length: Floats, banks: Floats, nothing: float, side: _Side) -> None:
    """Writes heights over the bridges, and which triangles have zero area.

    A triangle has none if a vertex lies on the opposite side, up to round-off.
    """
    x, y, height, degenerate = side
    for j in range(length.size):
        height[j] = np.sqrt(x[j] * x[j] + y[j] * y[j])
        is_flat = length[j] * height[j] <= nothing * max(length[j], banks[j])
        degenerate[j] = 1.0 if is_flat else 0.0


@compiled
def _cost_folds(length: Floats, a: _Side, b: _Side, flatness: float, folds: _Folds) -> None:
    """Writes hinge energies, bent pairs and fold-backs of the triangles on two sides."""
    for j in range(length.size):
        energy, bent, back = fold_cost(
            length[j], a.x[j], a.y[j], a.height[j], b.x[j], b.y[j], b.height[j], flatness
        )
        has_fold = a.degenerate[j] + b.degenerate[j] == 0.0
        folds.bending[j] = energy if has_fold else 0.0
        folds.bent[j] = bent if has_fold else 0.0
        folds.fold_backs[j] = back if has_fold else 0.0


@compiled
def _cost_by_the_paper(length: Floats, a: _Side, b: _Side, folds: _Folds) -> None:
    """Replaces hinge energies by those of Eq. (3); the same bridges cost nothing."""
    for j in range(length.size):
        sine = abs(a.y[j] * b.x[j] - a.x[j] * b.y[j]) / (a.height[j] * b.height[j])
        energy = 0.5 * length[j] * sine * sine / b.height[j]
        folds.bending[j] = energy if folds.bent[j] > folds.fold_backs[j] else 0.0


@compiled
def _side_of(view: Floats, costs: StepCosts, number: int) -> _Side:
    x = BEFORE_P + 2 * number
    return _Side(view[x], view[x + 1], costs.heights[number], costs.degenerate[number])


@compiled
def new_costs(count: int) -> StepCosts:
    """Returns room for the costs of leaving so many bridges."""
    return StepCosts(
        np.empty((4, count)),
        np.empty((4, count)),
        np.empty((4, count)),
        np.empty((4, count)),
        np.empty((4, count)),
        np.empty((2, count)),
    )


@compiled
def cost_row(
    view: Floats,
    banks: Floats,
    nothing: float,
    planarity: float,
    energy: int,
    costs: StepCosts,
) -> None:
    """Writes what leaving each bridge of a view costs.

    Args:
        view: (9, n) float64, mm; bridges as look_along fills them in.
        banks: (4, n) float64, mm; lengths of the bank edges before and after on P, before and after
            on Q; zero where there is none.
        nothing: mm; round-off.
        planarity: mm; how far from the other triangle's plane a third vertex lies in it.
        energy: HINGE or PAPER.
        costs: written.
    """
    length = view[LENGTH]
    for number in range(4):
        _measure_triangles(length, banks[number], nothing, _side_of(view, costs, number))
    for later in range(2):
        after = _side_of(view, costs, 2 * later + 1)
        costs.area[later] = 0.5 * length * after.height
        for earlier in range(2):
            before = _side_of(view, costs, 2 * earlier)
            row = 2 * earlier + later
            folds = _Folds(costs.bending[row], costs.bent[row], costs.fold_backs[row])
            _cost_folds(length, before, after, max(planarity, nothing), folds)
            if energy == PAPER:
                _cost_by_the_paper(length, before, after, folds)


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
    return atan2(ay * bx - ax * by, -(ax * bx + ay * by))

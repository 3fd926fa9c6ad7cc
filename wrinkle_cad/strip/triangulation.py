"""A boundary bridge triangulation: the path through the bridges, its triangles, its measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import CRITERIA, ENERGY, SEARCH, Criterion, Energy, Search

from .folding import ENERGIES
from .global_search import Weights, best_steps, weights_of
from .inflection import fan_aware_twist, inflection_bridges
from .local_search import local_steps
from .path import walk
from .rails import check_rails_apart, checked_planarity, checked_rails, coarser_sagitta, round_off

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Steps = npt.NDArray[np.int8]

P_STEP: Final = 0
"""One bank edge forward on P: triangle p[i] p[i+1] q[j]."""

Q_STEP: Final = 1
"""One bank edge forward on Q: triangle p[i] q[j+1] q[j]."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangulation:
    """A strip of m+n-2 triangles between two sampled rails; every array is read-only.

    Bridges are numbered along the path, 0 to m+n-2; interior ones are all but the first and the
    last. Counts are of interior bridges.
    """

    p: Floats
    """(m, 3) float64, mm; samples of directrix P."""
    q: Floats
    """(n, 3) float64, mm; samples of directrix Q."""
    bridges: npt.NDArray[np.int64]
    """(m+n-1, 2) int64; i, j of each bridge p[i] q[j], from (0, 0) to (m-1, n-1)."""
    triangles: npt.NDArray[np.int64]
    """(m+n-2, 3) int64 into vstack((p, q)); counter-clockwise as p[i] p[i+1] q[j]."""
    steps: npt.NDArray[np.int8]
    """(m+n-2,) int8; P_STEP or Q_STEP, the kind of each triangle."""
    valid: Bools
    """(m+n-1,) bool; locally convex bridges (see validity_matrix)."""
    inflection: Bools
    """(m+n-1,) bool; invalid interior bridges where the bending changes sign: no defects."""
    fold: Floats
    """(m+n-3,) float64, rad; fold angle of each interior bridge, 0 when flat, positive for a ridge
    seen from the side where the triangles are counter-clockwise; 0 beside a degenerate triangle."""
    twist: Floats
    """(m+n-1,) float64, rad, not negative; turn of the normal along each bridge, 0 in fans."""
    bending_at: Floats
    """(m+n-3,) float64; bending energy of each interior bridge."""
    bending: float
    """Bending energy of the strip: the sum over its interior bridges."""
    area: float
    """mm2; sum of the triangles' areas."""
    length: float
    """mm; sum of the bridges' lengths."""
    degenerate_count: int
    """Triangles of zero area, and folds of 180 degrees, neither of which bends at finite cost."""
    planarity: float
    """mm; how far a neighbour may lie on the wrong side of a valid bridge's plane."""
    criteria: tuple[Criterion, ...]
    """What was minimised, in this order."""
    search: Search
    """"global" or "local"."""
    energy: Energy
    """"hinge" or "paper"."""
    is_closed: bool = False
    """Whether the last bridge is the first one again."""

    @property
    def interior_count(self) -> int:
        """Bridges between the first and the last."""
        return len(self.bridges) - 2

    @property
    def invalid_count(self) -> int:
        """Interior bridges that are not locally convex, inflections included."""
        return int(np.count_nonzero(~self.valid[1:-1]))

    @property
    def inflection_count(self) -> int:
        """Interior bridges that are invalid only because the bending changes sign there."""
        return int(np.count_nonzero(self.inflection))


def triangulate(
    p: npt.ArrayLike,
    q: npt.ArrayLike,
    *,
    criteria: Criterion | Sequence[Criterion] = CRITERIA,
    search: Search = SEARCH,
    energy: Energy = ENERGY,
    planarity: float | None = None,
) -> Triangulation:
    """Returns the triangulation between two rails that is best by ordered criteria.

    `search="global"` is the lexicographic optimum over all triangulations: ("invalid", "bending")
    is GODT+GMBT of Wang and Tang, ("bending",) GMBT, ("area",) GMAT, ("length",) least total
    bridge length. A criterion after one that is not a count only breaks exact ties. Just before
    bending, triangles of zero area are counted. `search="local"` looks one step ahead: LODT+LMBT
    if the criteria start with "invalid", LMBT if with "bending". Of equal continuations the P-step
    is taken, always.

    Args:
        p: (m, 3) float, mm; samples of directrix P, m >= 2.
        q: (n, 3) float, mm; samples of directrix Q in the same direction, n >= 2.
        criteria: ordered choice of "invalid", "bending", "area", "length", each at most once.
        search: "global" or "local".
        energy: "hinge" or "paper", see folding.ENERGIES.
        planarity: mm; how far a neighbour may lie on the wrong side of a valid bridge's plane;
            by default a thousandth of the rails' median sagitta.

    Raises:
        InputError: a rail is no (k, 3) array of at least two finite points, the rails coincide over
            more than one bank edge, all triangles have zero area, or an option is unknown.
    """
    if energy not in ENERGIES:
        raise InputError(f"energy - {energy!r} - one of {', '.join(ENERGIES)} - choose one")
    weights = weights_of(criteria)
    names = (criteria,) if isinstance(criteria, str) else tuple(criteria)
    p, q = checked_rails(p, q)
    limit = checked_planarity(p, q, planarity)
    nothing = round_off(p, q)
    check_rails_apart(p, q, limit)
    steps = _search(
        p, q, names, weights, search, planarity=limit, nothing=nothing, energy=ENERGIES[energy]
    )
    return measured(p, q, steps, planarity=limit, criteria=names, search=search, energy=energy)


def _search(
    p: Floats,
    q: Floats,
    criteria: tuple[Criterion, ...],
    weights: Weights,
    search: Search,
    *,
    planarity: float,
    nothing: float,
    energy: int,
) -> Steps:
    if search == "global":
        return best_steps(p, q, weights, planarity=planarity, nothing=nothing, energy=energy)
    if search != "local":
        raise InputError(f"search - {search!r} - one of global, local - choose one")
    if criteria[0] not in ("invalid", "bending"):
        raise InputError(
            f"search - local with criteria that start with {criteria[0]}"
            " - they must start with invalid or bending - search globally"
        )
    return local_steps(
        p,
        q,
        is_developable=criteria[0] == "invalid",
        planarity=planarity,
        nothing=nothing,
        energy=energy,
    )


def measured(
    p: Floats,
    q: Floats,
    steps: Steps,
    *,
    planarity: float,
    criteria: tuple[Criterion, ...],
    search: Search,
    energy: Energy,
) -> Triangulation:
    """Returns the triangulation that given steps make, with all its measures.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        steps: (m+n-2,) int8; m-1 P-steps and n-1 Q-steps.
        planarity: mm; see validity_matrix.
        criteria: what the steps were chosen by.
        search: how they were searched.
        energy: "hinge" or "paper".

    Raises:
        InputError: all triangles have zero area.
    """
    path = walk(p, q, steps, planarity=planarity, nothing=round_off(p, q), energy=ENERGIES[energy])
    if path.is_flat.all():
        raise InputError(
            "strip - every triangle has zero area - at least one must have some"
            " - choose two curves that are apart"
        )
    arrays: dict[str, Any] = {
        "p": p,
        "q": q,
        "bridges": path.bridges,
        "triangles": _triangles(path.bridges, steps, p.shape[0]),
        "steps": steps,
        "valid": path.valid,
        "inflection": inflection_bridges(path, coarser_sagitta(p, q)),
        "fold": path.fold,
        "twist": fan_aware_twist(path),
        "bending_at": path.bending_at,
    }
    for array in arrays.values():
        array.flags.writeable = False
    return Triangulation(
        **arrays,
        bending=float(path.bending_at.sum()),
        area=path.area,
        length=float(path.view[0].sum()),
        degenerate_count=path.degenerate_count,
        planarity=planarity,
        criteria=criteria,
        search=search,
        energy=energy,
    )


def _triangles(bridges: npt.NDArray[np.int64], steps: Steps, m: int) -> npt.NDArray[np.int64]:
    i, j = bridges[:-1].T
    middle = np.where(steps == P_STEP, i + 1, m + j + 1)
    return np.stack((i, middle, m + j), axis=1)

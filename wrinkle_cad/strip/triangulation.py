"""A boundary bridge triangulation: the path through the bridges, its triangles, its measures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import (
    CRITERIA,
    ENERGY,
    PRICE,
    SEARCH,
    Criterion,
    Ends,
    Energy,
    Search,
)

from .closed_strip import check_closed, closed_line, middle_turn, three_turns
from .constraints import Constraints, bars_of, check_constraints
from .contradiction import is_kept, refuse
from .folding import ENERGIES
from .inflection import fan_aware_twist, inflection_bridges
from .objective import checked_criteria, is_priced
from .path import walk
from .rails import check_rails_apart, checked_planarity, checked_rails, coarser_sagitta, round_off
from .validity_price import checked_price, invalid_cost, least_bending, unused_cost
from .ways import Task, Way, check_ends, check_search, checked_give_up, unused_lengths, way_of

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
    last. Counts are of interior bridges. A closed strip has m+n triangles and m+n+1 bridges, of
    which the last is the first again, (m, n) further; all m+n are interior, so `fold` and
    `bending_at` begin with the first one, at the seam.

    Example:
        >>> triangulate([[0, 0, 0], [1, 0, 1], [2, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]])
        Triangulation(3 x 3 samples, 0 of 3 bridges not locally convex)
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
    """(m+n-1,) bool; invalid interior bridges where the bending changes sign or nothing bends: no
    defects."""
    counted: Bools
    """(m+n-1,) bool; invalid interior bridges at which the strip bends: what the objective counts.
    Where both triangles lie in one plane, or one has no area, an invalid bridge is no defect."""
    folded_back: Bools
    """(m+n-1,) bool; interior bridges at which one triangle lies on the other, on the same side of
    the bridge: a fold of 180 degrees to within the planarity."""
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
    """Triangles of zero area, beside which nothing bends."""
    planarity: float
    """mm; how far a neighbour may lie on the wrong side of a valid bridge's plane."""
    criteria: tuple[Criterion, ...]
    """What was minimised, in this order."""
    search: Search
    """"global" or "local"."""
    energy: Energy
    """"hinge" or "paper"."""
    price: float | None = None
    """What one invalid bridge more was worth, in mean bending energies of the least-bending
    triangulation; None where validity came first or no price applies."""
    least_bending: float | None = None
    """What the price was measured by: the least bending energy among all triangulations with the
    fewest fold-backs and degenerate triangles, of the strip itself or, where a side has over 250
    samples, of that side thinned to 250; None without a price."""
    is_closed: bool = False
    """Whether the last bridge is the first one again."""
    max_lean: float | None = None
    """rad; how far its bridges were allowed to lean; None where any way."""
    first_samples: tuple[int, int] = (0, 0)
    """Which samples of the given rails are the first of `p` and `q`; others than 0 where ends are
    free and rail was given up."""
    unused: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """mm of the given rails that free ends left: of P before and behind the strip, of Q."""

    def __repr__(self) -> str:
        return (
            f"Triangulation({len(self.p)} x {len(self.q)} samples, {self.invalid_count} of"
            f" {self.interior_count} bridges not locally convex)"
        )

    @property
    def _interior(self) -> slice:
        return slice(0 if self.is_closed else 1, -1)

    @property
    def interior_count(self) -> int:
        """Bridges between the first and the last; all of a closed strip."""
        return len(self.fold)

    @property
    def invalid_count(self) -> int:
        """Interior bridges that are not locally convex, inflections included."""
        return int(np.count_nonzero(~self.valid[self._interior]))

    @property
    def counted_invalid_count(self) -> int:
        """Invalid interior bridges at which the strip bends: those that the objective counted."""
        return int(np.count_nonzero(self.counted[self._interior]))

    @property
    def fold_back_count(self) -> int:
        """Interior bridges at which the strip lies on itself: folds of 180 degrees."""
        return int(np.count_nonzero(self.folded_back[self._interior]))

    @property
    def inflection_count(self) -> int:
        """Interior bridges that are invalid only because the bending changes sign or is 0."""
        return int(np.count_nonzero(self.inflection[self._interior]))


def triangulate(
    p: npt.ArrayLike,
    q: npt.ArrayLike,
    *,
    criteria: Criterion | Sequence[Criterion] = CRITERIA,
    search: Search = SEARCH,
    energy: Energy = ENERGY,
    planarity: float | None = None,
    price: float | None = PRICE,
    closed: bool = False,
    pinned: Sequence[tuple[int, int]] = (),
    forbidden: Sequence[tuple[int, int, int, int]] = (),
    max_lean: float | None = None,
    max_ruling: float | None = None,
    fold_bound: float | None = None,
    ends: Ends = "fixed",
    give_up: float | None = None,
) -> Triangulation:
    """Returns the triangulation between two rails that is best by ordered criteria.

    `search="global"` is the optimum over all triangulations, compared in this order: the fewest
    fold-backs; the criteria, one after the other, where "invalid" counts the bridges that are not
    locally convex and at which the strip bends, and triangles of zero area are counted just before
    "bending"; the least total length of the bridges; the fewest invalid ones, bent or not. A
    criterion after one that is not a count only breaks ties. ("bending",) is GMBT of Wang and
    Tang, ("area",) GMAT.

    With a price, criteria that begin with "invalid", "bending", and the hinge energy, one invalid
    bridge is worth so many mean bending energies: the order is fold-backs, triangles of zero area,
    `bending + price * least_bending / interior_count * counted invalid bridges`, later criteria,
    length. With `price=None` it is GODT+GMBT: no energy buys an invalid bridge.

    `search="local"` looks one step ahead: LODT+LMBT if the criteria start with "invalid", LMBT if
    with "bending". Of equal continuations the P-step is taken, always; sums of energies, areas or
    lengths are equal if they differ by no more than 1e-12 of themselves.

    Args:
        p: (m, 3) float, mm; samples of directrix P. A single one (m = 1) is the apex of a cone.
        q: (n, 3) float, mm; samples of directrix Q in the same direction; n >= 2 if m = 1.
        criteria: ordered choice of "invalid", "bending", "area", "length", each at most once.
        search: "global" or "local".
        energy: "hinge" or "paper", see folding.ENERGIES.
        planarity: mm; how far a neighbour may lie on the wrong side of a valid bridge's plane, and
            a triangle's third vertex from the plane of a coplanar one; by default a thousandth of
            the rails' median sagitta.
        price: what an invalid bridge more is worth, from 0 to 1e6, or None. Of no effect with other
            criteria, with the paper's energy and in the local search.
        closed: both rails are closed, their first points not repeated: the best triangulation over
            all starting bridges. Where a rail begins does not matter, but to the local search,
            which starts at the first pinned bridge or at the shortest one.
        pinned: bridges (i, j) that the strip has.
        forbidden: (first i, last i, first j, last j): no bridge goes from the one stretch of
            samples to the other; of closed rails a stretch may run past the last sample.
        max_lean: rad; largest angle of a bridge to the shortest crossing, from its end on P to the
            nearest point of Q or the other way round, whichever is smaller.
        max_ruling: mm; longest bridge.
        fold_bound: rad; largest fold at an interior bridge.
        ends: "fixed": the strip has the rails' ends; "free": it begins and ends wherever that is
            best, and the strip is between the rails so shortened. A length of rail is worth
            GIVE_UP_PRICE times the mean bending of so much rail, where bending has a price or is
            the first criterion; else it is given up for the leading counts only.
        give_up: mm of each rail that free ends may leave at either end.

    Raises:
        InputError: a rail is no (k, 3) array of finite points, both are single points, the rails
            coincide over more than one bank edge, all triangles have zero area, an option is
            unknown, or no triangulation keeps the constraints; the message names those that fail.

    Example:
        A square tent with a ridge along y: flat on either side of it.

        >>> front, back = [[0, 0, 0], [1, 0, 1], [2, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]]
        >>> found = triangulate(front, back)
        >>> found.fold.round(3).tolist(), found.counted_invalid_count
        ([0.0, 1.571, 0.0], 0)
    """
    if energy not in ENERGIES:
        raise InputError(f"energy cannot be {energy!r}: choose one of {', '.join(ENERGIES)}.")
    names = checked_criteria(criteria)
    check_search(search, names)
    has_price = search == "global" and energy == "hinge" and is_priced(names)
    price = checked_price(price) if has_price else None
    give_up = checked_give_up(ends, give_up)
    p, q = checked_rails(p, q)
    if closed:
        check_closed(p, q)
    constraints = Constraints(
        pinned=tuple((int(i), int(j)) for i, j in pinned),
        forbidden=tuple((int(a), int(b), int(c), int(d)) for a, b, c, d in forbidden),
        max_lean=max_lean,
        max_ruling=max_ruling,
        fold_bound=fold_bound,
    )
    check_constraints(constraints, len(p), len(q), closed=closed)
    # Every sample of a closed rail has two neighbours, the first and the last too.
    p_line, q_line = (closed_line(p, 2), closed_line(q, 2)) if closed else (p, q)
    limit = checked_planarity(p_line, q_line, planarity)
    check_rails_apart(p_line, q_line, limit)
    nothing = round_off(p, q)
    least = None
    is_charged = give_up is not None and energy == "hinge" and names[0] == "bending"
    if price is not None or is_charged:
        least = least_bending(p, q, planarity=limit, nothing=nothing, closed=closed)
    task = Task(
        p=p,
        q=q,
        criteria=names,
        search=search,
        energy=ENERGIES[energy],
        planarity=limit,
        nothing=nothing,
        invalid_cost=None if price is None or least is None else invalid_cost(price, *least),
        is_closed=closed,
        give_up=give_up,
        unused_cost=None if least is None else unused_cost(least[0], p, q),
    )
    check_ends(task)

    def best(asked: Constraints) -> tuple[Triangulation, bool]:
        bars = bars_of(asked, p, q, closed=closed)
        found = _measured_way(task, way_of(task, asked, bars), energy, price, least)
        found = replace(found, max_lean=max_lean)
        return found, is_kept(found, asked, bars)

    found, has_all = best(constraints)
    if not has_all:
        refuse(constraints, p, q, best)
    return found


def _measured_way(
    task: Task, way: Way, energy: Energy, price: float | None, least: tuple[float, int] | None
) -> Triangulation:
    """The triangulation that a way makes, of the rails as far as they are used."""
    p, q, first = task.p, task.q, way.start
    if task.give_up is not None:
        q_steps = int(np.count_nonzero(way.steps))
        p = p[first[0] : first[0] + len(way.steps) - q_steps + 1]
        q = q[first[1] : first[1] + q_steps + 1]
    found = measured(
        p,
        q,
        way.steps,
        planarity=task.planarity,
        criteria=task.criteria,
        search=task.search,
        energy=energy,
        price=price,
        least_bending=None if least is None or price is None else least[0],
        start=first if task.is_closed else None,
    )
    if task.give_up is None:
        return found
    return replace(found, first_samples=first, unused=unused_lengths(task, way))


def measured(
    p: Floats,
    q: Floats,
    steps: Steps,
    *,
    planarity: float,
    criteria: tuple[Criterion, ...],
    search: Search,
    energy: Energy,
    price: float | None = None,
    least_bending: float | None = None,
    start: tuple[int, int] | None = None,
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
        price: what an invalid bridge was worth, if it had a price.
        least_bending: what that price was measured by.
        start: i, j of the bridge where a closed strip, of m P-steps and n Q-steps, begins; None
            for an open one.

    Raises:
        InputError: all triangles have zero area.
    """
    rails, walked = (p, q), steps
    if start is not None:
        rails, walked = three_turns(p, q, start), np.tile(steps, 3)
    path = walk(
        *rails, walked, planarity=planarity, nothing=round_off(p, q), energy=ENERGIES[energy]
    )
    if path.is_flat.all():
        raise InputError(
            "Every triangle of the strip has zero area, and at least one must have some: choose two"
            " curves that are apart."
        )
    arrays: dict[str, Any] = {
        "p": p,
        "q": q,
        "bridges": path.bridges,
        "steps": walked,
        "valid": path.valid,
        "inflection": inflection_bridges(path, coarser_sagitta(*rails)),
        "counted": ~path.valid & path.is_bent,
        "folded_back": path.is_folded_back,
        "fold": path.fold,
        "twist": fan_aware_twist(path),
        "bending_at": path.bending_at,
        "lengths": path.view[0],
        "is_flat": path.is_flat,
    }
    if start is not None:
        arrays = middle_turn(arrays, len(steps))
        arrays["bridges"] += np.array(start) - arrays["bridges"][0]
    arrays["triangles"] = _triangles(arrays["bridges"], steps, len(p), len(q))
    lengths, is_flat = arrays.pop("lengths"), arrays.pop("is_flat")
    for array in arrays.values():
        array.flags.writeable = False
    return Triangulation(
        **arrays,
        bending=math.fsum(arrays["bending_at"]),
        area=path.area if start is None else path.area / 3,
        length=math.fsum(lengths if start is None else lengths[:-1]),
        degenerate_count=int(np.count_nonzero(is_flat)),
        planarity=planarity,
        criteria=criteria,
        search=search,
        energy=energy,
        price=price,
        least_bending=least_bending,
        is_closed=start is not None,
    )


def _triangles(
    bridges: npt.NDArray[np.int64], steps: Steps, m: int, n: int
) -> npt.NDArray[np.int64]:
    i, j = bridges[:-1].T
    middle = np.where(steps == P_STEP, (i + 1) % m, m + (j + 1) % n)
    return np.stack((i % m, middle, m + j % n), axis=1)

"""The way through the bridges that a search takes, whichever search it is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import Criterion, Ends, Search

from .bars import Bars
from .closed_search import closed_steps
from .constraints import Constraints
from .curve.polyline import arc_lengths, row_lengths
from .free_search import free_steps
from .global_search import best_steps
from .local_search import closed_local_steps, local_steps
from .objective import Weights, free_weights_of, weights_of

Floats = npt.NDArray[np.float64]
Steps = npt.NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Task:
    """What is searched for, all of it checked."""

    p: Floats
    """(m, 3) float64, mm."""
    q: Floats
    """(n, 3) float64, mm."""
    criteria: tuple[Criterion, ...]
    """What is minimized, the most important first."""
    search: Search
    """``global`` or ``local``."""
    energy: int
    """HINGE or PAPER."""
    planarity: float
    """mm."""
    nothing: float
    """mm; round-off."""
    invalid_cost: float | None
    """Bending energy of an invalid bridge; None without a price."""
    is_closed: bool
    """Whether the strip runs round."""
    give_up: float | None = None
    """mm of each rail that may be given up at each end; None where the ends are fixed."""
    unused_cost: float | None = None
    """Bending energy of 1 mm of unused rail; None where it has no price."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A path through the bridges."""

    start: tuple[int, int]
    """i, j of its first bridge."""
    steps: Steps
    """int8; 0 a P-step, 1 a Q-step."""


def check_search(search: Search, criteria: tuple[Criterion, ...]) -> None:
    """Refuses a search that is none, and criteria that the local one cannot have.

    Raises:
        InputError: one sentence says which.
    """
    if search not in get_args(Search):
        raise InputError(
            f"search cannot be {search!r}: choose one of {', '.join(get_args(Search))}."
        )
    if search == "local" and criteria[0] not in ("invalid", "bending"):
        raise InputError(
            f"A local search cannot start with the criterion {criteria[0]}, only with invalid or"
            " bending: search globally."
        )


def checked_give_up(ends: Ends, give_up: float | None) -> float | None:
    """Returns the mm of each rail that may be left at either end; None where the ends are fixed.

    Raises:
        InputError: one sentence says what does not fit.
    """
    if ends not in get_args(Ends):
        raise InputError(f"ends cannot be {ends!r}: give {' or '.join(get_args(Ends))}.")
    if ends == "fixed":
        if give_up is not None:
            raise InputError(
                f"give_up of {give_up:g} mm has no effect where the ends are fixed: let ends be"
                " free, or leave give_up out."
            )
        return None
    if give_up is None or not 0.0 <= give_up < math.inf:
        raise InputError(
            f"Free ends may leave some rail, and give_up says {give_up}: give the largest length in"
            " mm that each rail may lose at either end."
        )
    return float(give_up)


def check_ends(task: Task) -> None:
    """Refuses free ends where there are none, or where they would leave nothing of a rail.

    Raises:
        InputError: one sentence says why.
    """
    if task.give_up is None:
        return
    if task.is_closed:
        raise InputError("Closed rails have no ends to give up: leave the ends fixed.")
    if task.search == "local":
        raise InputError(
            "The local search goes from end to end and chooses none: search globally, or leave the"
            " ends fixed."
        )
    for name, rail in (("P", task.p), ("Q", task.q)):
        length = float(arc_lengths(rail)[-1])
        if len(rail) > 1 and 2.0 * task.give_up >= length:
            raise InputError(
                f"give_up of {task.give_up:.6g} mm at either end would leave nothing of rail"
                f" {name}, which is {length:.6g} mm long: give less than {length / 2.0:.6g} mm."
            )


def way_of(task: Task, constraints: Constraints, bars: Bars) -> Way:
    """Returns the way that the search takes, under constraints if any way keeps them.

    Args:
        task: what is searched for.
        constraints: what was asked of the rulings.
        bars: of the task's samples, for these constraints.
    """
    if task.is_closed:
        return _way_around(task, constraints, bars)
    if task.search == "local":
        return Way((0, 0), _local(task, bars))
    if task.give_up is not None:
        return _free_way(task, constraints, bars)
    steps = best_steps(
        task.p,
        task.q,
        _weights(task),
        planarity=task.planarity,
        nothing=task.nothing,
        energy=task.energy,
        bars=bars,
    )
    return Way((0, 0), steps)


def _weights(task: Task) -> Weights:
    return weights_of(
        task.criteria,
        bridge_count=task.p.shape[0] + task.q.shape[0],
        invalid_cost=task.invalid_cost,
    )


def _local(task: Task, bars: Bars) -> Steps:
    return local_steps(
        task.p,
        task.q,
        is_developable=task.criteria[0] == "invalid",
        planarity=task.planarity,
        nothing=task.nothing,
        energy=task.energy,
        bars=None if bars.is_none else bars,
    )


def _way_around(task: Task, constraints: Constraints, bars: Bars) -> Way:
    if task.search == "local":
        return _local_way_around(task, constraints, bars)
    found = closed_steps(
        task.p,
        task.q,
        _weights(task),
        planarity=task.planarity,
        nothing=task.nothing,
        energy=task.energy,
        bars=bars,
        pinned=constraints.pinned,
    )
    return Way(found.start, found.steps)


def _local_way_around(task: Task, constraints: Constraints, bars: Bars) -> Way:
    """From the first pinned bridge, or from the shortest one that may be."""
    m, n = len(task.p), len(task.q)
    start = constraints.pinned[0] if constraints.pinned else _shortest(task, bars)
    around = None
    if not bars.is_none or len(constraints.pinned) > 1:
        own = bars.bridges if bars.bridges.size else np.zeros((m, n), dtype=np.bool_)
        rows, columns = np.arange(m + 1)[:, None], np.arange(n + 1)
        cover = own[(rows + start[0]) % m, (columns + start[1]) % n]
        for i, j in constraints.pinned[1:]:
            i, j = (i - start[0]) % m, (j - start[1]) % n
            cover |= ((rows < i) & (columns > j)) | ((rows > i) & (columns < j))
        around = Bars(cover, bars.least_cosine)
    steps = closed_local_steps(
        task.p,
        task.q,
        start,
        is_developable=task.criteria[0] == "invalid",
        planarity=task.planarity,
        nothing=task.nothing,
        energy=task.energy,
        bars=around,
    )
    return Way(start, steps)


def _shortest(task: Task, bars: Bars) -> tuple[int, int]:
    best, at = np.inf, (0, 0)
    for i in range(len(task.p)):
        lengths = row_lengths(task.q - task.p[i])
        if bars.bridges.size:
            lengths = np.where(bars.bridges[i], np.inf, lengths)
        j = int(lengths.argmin())
        if lengths[j] < best:
            best, at = float(lengths[j]), (i, j)
    return at


def _free_way(task: Task, constraints: Constraints, bars: Bars) -> Way:
    give_up = task.give_up
    assert give_up is not None
    weights, charges = free_weights_of(
        task.criteria,
        bridge_count=task.p.shape[0] + task.q.shape[0],
        invalid_cost=task.invalid_cost,
        unused_cost=task.unused_cost,
    )
    unused = []
    for is_end in (False, True):
        own = []
        for k, rail in enumerate((task.p, task.q)):
            arcs = arc_lengths(rail)
            beyond = arcs[-1] - arcs if is_end else arcs
            pins = [pin[k] for pin in constraints.pinned]
            numbers = np.arange(len(rail))
            is_past = (
                numbers < max(pins, default=0)
                if is_end
                else (numbers > min(pins, default=len(rail)))
            )
            own.append(np.where((beyond > give_up) | is_past, np.inf, beyond))
        unused.append((own[0], own[1]))
    found = free_steps(
        task.p,
        task.q,
        weights,
        charges,
        planarity=task.planarity,
        nothing=task.nothing,
        energy=task.energy,
        bars=bars,
        unused=(unused[0], unused[1]),
    )
    return Way(found.start, found.steps)


def unused_lengths(task: Task, way: Way) -> tuple[float, float, float, float]:
    """Returns the mm of rail before and behind a way: on P, then on Q."""
    q_steps = int(np.count_nonzero(way.steps))
    p_arcs, q_arcs = arc_lengths(task.p), arc_lengths(task.q)
    i, j = way.start
    return (
        float(p_arcs[i]),
        float(p_arcs[-1] - p_arcs[i + len(way.steps) - q_steps]),
        float(q_arcs[j]),
        float(q_arcs[-1] - q_arcs[j + q_steps]),
    )


def unused_text(unused: tuple[float, float, float, float]) -> str:
    """Says how much of the rails free ends left, and where; nothing if they left none.

    Args:
        unused: mm of P before and behind the strip, of Q before and behind it.

    Example:
        >>> unused_text((0.0, 6.25, 0.0, 1.5))
        '6.25 mm at the end of P, 1.5 mm at the end of Q'
    """
    places = ("the start of P", "the end of P", "the start of Q", "the end of Q")
    return ", ".join(
        f"{length:.4g} mm at {place}"
        for length, place in zip(unused, places, strict=True)
        if length > 0.0
    )

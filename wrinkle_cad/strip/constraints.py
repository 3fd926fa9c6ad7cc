"""What a designer asks of the rulings: some that must be, some that must not.

The lean of a bridge is its angle to the shortest crossing of the strip: from its end on P to the
nearest point of Q, or from its end on Q to the nearest point of P, whichever makes the smaller
angle. So rulings may gather at the corner of an oblique end, where the rail goes no further.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError

from .bars import Bars, least_cosine_of, no_bars
from .closed_search import is_around
from .closed_strip import closed_line
from .curve.nearest import nearest_on_polyline
from .curve.polyline import row_lengths
from .places import place_text
from .portable import dot

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Constraints:
    """What every triangulation that is found must keep.

    Example:
        >>> p, q = np.array([[0.0, 0, 0], [4.0, 0, 0]]), np.array([[0.0, 3, 0], [4.0, 3, 0]])
        >>> [words for words, _ in Constraints(pinned=((1, 0),), max_ruling=25.0).parts(p, q)]
        ['pinned ruling 1 from (4.000, 0.000, 0.000) mm of P', 'max_ruling of 25 mm']
    """

    pinned: tuple[tuple[int, int], ...] = ()
    """i, j of bridges that it has."""
    forbidden: tuple[tuple[int, int, int, int], ...] = ()
    """First and last i, first and last j: no bridge has both its ends in such stretches."""
    max_lean: float | None = None
    """rad; largest lean of a bridge."""
    max_ruling: float | None = None
    """mm; longest bridge."""
    fold_bound: float | None = None
    """rad; largest fold at an interior bridge."""

    def parts(self, p: Floats, q: Floats) -> tuple[tuple[str, Constraints], ...]:
        """Each of them in words, and alone.

        Args:
            p: (m, 3) float64, mm; samples of directrix P.
            q: (n, 3) float64, mm; samples of directrix Q.
        """
        return tuple(self._each(p, float(np.ptp(np.concatenate((p, q)), axis=0).max())))

    def together_with(self, other: Constraints) -> Constraints:
        """These constraints and others."""
        return Constraints(
            pinned=self.pinned + other.pinned,
            forbidden=self.forbidden + other.forbidden,
            max_lean=_smaller(self.max_lean, other.max_lean),
            max_ruling=_smaller(self.max_ruling, other.max_ruling),
            fold_bound=_smaller(self.fold_bound, other.fold_bound),
        )

    def _each(self, p: Floats, size: float) -> Iterator[tuple[str, Constraints]]:
        for k, (i, j) in enumerate(self.pinned):
            words = f"pinned ruling {k + 1} from {place_text(p[i], size)} of P"
            yield words, Constraints(pinned=((i, j),))
        for i, last_i, j, last_j in self.forbidden:
            words = f"the forbidden stretch from {place_text(p[i], size)} of P on"
            yield words, Constraints(forbidden=((i, last_i, j, last_j),))
        if self.max_lean is not None:
            words = f"max_lean of {math.degrees(self.max_lean):.4g} degrees"
            yield words, Constraints(max_lean=self.max_lean)
        if self.max_ruling is not None:
            words = f"max_ruling of {self.max_ruling:.6g} mm"
            yield words, Constraints(max_ruling=self.max_ruling)
        if self.fold_bound is not None:
            words = f"fold_bound of {math.degrees(self.fold_bound):.4g} degrees"
            yield words, Constraints(fold_bound=self.fold_bound)


def _smaller(first: float | None, second: float | None) -> float | None:
    given = [value for value in (first, second) if value is not None]
    return min(given, default=None)


def check_constraints(constraints: Constraints, m: int, n: int, *, closed: bool) -> None:
    """Refuses constraints that are out of range, and pinned bridges that cross.

    Raises:
        InputError: one sentence says which.
    """
    for name, value, unit, most in (
        ("max_lean", constraints.max_lean, "rad", math.pi / 2),
        ("max_ruling", constraints.max_ruling, "mm", math.inf),
        ("fold_bound", constraints.fold_bound, "rad", math.pi),
    ):
        if value is not None and not 0.0 < value <= most:
            upper = f" and at most {most:.4g}" if most < math.inf else ""
            raise InputError(f"{name} cannot be {value:g} {unit}: give a number above 0{upper}.")
    for i, j in constraints.pinned:
        _check_samples("pinned", (i, i), (j, j), m, n)
    for first, last, low, high in constraints.forbidden:
        _check_samples("forbidden", (first, last), (low, high), m, n)
        if not closed and (first > last or low > high):
            raise InputError(
                f"A forbidden stretch cannot run from sample {first} to {last} of P and from"
                f" {low} to {high} of Q: name the smaller number first."
            )
    _check_crossing(constraints.pinned, m, n, closed=closed)


def _check_samples(name: str, at_p: tuple[int, int], at_q: tuple[int, int], m: int, n: int) -> None:
    for rail, ends, count in (("P", at_p, m), ("Q", at_q, n)):
        for number in ends:
            if not 0 <= number < count:
                raise InputError(
                    f"{name} cannot name sample {number} of {rail}: it has samples 0 to"
                    f" {count - 1}."
                )


def _check_crossing(pinned: tuple[tuple[int, int], ...], m: int, n: int, *, closed: bool) -> None:
    for second, (i, j) in enumerate(pinned):
        for first, (a, b) in enumerate(pinned[:second]):
            if not closed and (i - a) * (j - b) < 0:
                raise InputError(
                    f"Pinned rulings {first + 1} and {second + 1} cross: one runs from sample {a}"
                    f" of P to {b} of Q, the other from {i} to {j}. Change one of them."
                )
    if closed and not is_around(pinned, m, n):
        raise InputError(
            "The pinned rulings cross: no strip goes once around through all of them. Their ends"
            " must follow each other on Q as they do on P."
        )


def bars_of(constraints: Constraints, p: Floats, q: Floats, *, closed: bool) -> Bars:
    """Returns the bridges and folds that no triangulation may have.

    Pinned bridges of a closed strip bar none of its m n bridges by themselves: see closed_steps.

    Args:
        constraints: checked ones.
        p: (m, 3) float64, mm; samples of directrix P.
        q: (n, 3) float64, mm; samples of directrix Q.
        closed: both rails are closed, their first points not repeated.
    """
    least_cosine = least_cosine_of(constraints.fold_bound)
    needs_bridges = (
        constraints.max_lean is not None
        or constraints.max_ruling is not None
        or constraints.forbidden
        or (constraints.pinned and not closed)
    )
    if not needs_bridges:
        return Bars(no_bars().bridges, least_cosine)
    m, n = len(p), len(q)
    barred = np.zeros((m, n), dtype=np.bool_)
    rows, columns = np.arange(m)[:, None], np.arange(n)
    for i, j in () if closed else constraints.pinned:
        barred |= ((rows < i) & (columns > j)) | ((rows > i) & (columns < j))
    for first, last, low, high in constraints.forbidden:
        barred |= _within(rows, first, last) & _within(columns, low, high)
    if constraints.max_ruling is not None:
        for i in range(m):
            barred[i] |= row_lengths(q - p[i]) > constraints.max_ruling
    if constraints.max_lean is not None:
        cosines = lean_cosines(p, q, closed=closed)
        barred |= cosines < least_cosine_of(constraints.max_lean)
    return Bars(barred, least_cosine)


def _within(numbers: npt.NDArray[np.int64], first: int, last: int) -> Bools:
    """Which samples lie in a stretch; one that wraps around has its first number above its last."""
    after, before = numbers >= first, numbers <= last
    return np.asarray(after & before if first <= last else after | before, dtype=np.bool_)


def lean_cosines(p: Floats, q: Floats, *, closed: bool = False) -> Floats:
    """Returns the cosine of each bridge's lean, (m, n) float64; 1 for bridges without length.

    Args:
        p: (m, 3) float64, mm; samples of directrix P.
        q: (n, 3) float64, mm; samples of directrix Q.
        closed: both rails are closed, their first points not repeated.

    Example:
        >>> p, q = np.array([[0.0, 0, 0], [4.0, 0, 0]]), np.array([[0.0, 3, 0], [4.0, 3, 0]])
        >>> lean_cosines(p, q).round(3).tolist()
        [[1.0, 0.6], [0.6, 1.0]]
    """
    p_crossing, q_crossing = _crossings(p, q, closed), _crossings(q, p, closed)
    cosines = np.ones((len(p), len(q)))
    for i in range(len(p)):
        bridge = q - p[i]
        length = row_lengths(bridge)
        has_length = length > 0.0
        size = np.where(has_length, length, 1.0)
        along = np.maximum(dot(bridge, p_crossing[i]), dot(-bridge, q_crossing)) / size
        cosines[i] = np.where(has_length, along, 1.0)
    return cosines


def _crossings(rail: Floats, other: Floats, closed: bool) -> Floats:
    """(k, 3): unit vectors from a rail's samples to the nearest points of the other; 0 if there."""
    line = (
        closed_line(other) if closed else np.repeat(other, 2, axis=0) if len(other) == 1 else other
    )
    found = nearest_on_polyline(rail, line)
    start, end = line[found.segment], line[found.segment + 1]
    way = start + found.share[:, None] * (end - start) - rail
    length = row_lengths(way)
    return np.asarray(way / np.where(length > 0.0, length, 1.0)[:, None])

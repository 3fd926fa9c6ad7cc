"""Splines of degree 5, once differentiable, that follow a function to a given accuracy.

Each span takes the function's values and derivatives at both of its ends, and its values at two
places between. Spans are halved until all of them follow it, and joined where one does for two.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]
Function = Callable[[Floats], tuple[Floats, Floats]]
"""From (k,) parameters to (k, d) values and (k, d) derivatives."""
Gap = Callable[[Floats, Floats, Floats], Floats]
"""From (k,) parameters, (k, d) values of the function and of a spline to (k,) distances."""

DEGREE: Final = 5
INNER: Final = (0.3, 0.7)
"""Where a span takes values between its ends."""
CHECKED: Final = (0.08, 0.2, 0.45, 0.55, 0.8, 0.92)
"""Where a span is compared with the function: off the places that it passes through ..."""
JOINED_CHECKED: Final = tuple((k + 0.5) / 16.0 for k in range(16))
"""... and where one that stands for two is, before it is compared where these were."""


@dataclass(frozen=True, slots=True, eq=False)
class Quintic:
    """A clamped B-spline of degree 5 with knots of multiplicity 4 between its ends.

    Example:
        >>> wave = fitted(lambda t: (t[:, None] ** 3, 3 * t[:, None] ** 2), [0.0, 2.0], 1e-9)
        >>> wave.knots.tolist(), wave.at(np.array([1.5]))[:, 0].round(9).tolist()
        ([0.0, 2.0], [3.375])
    """

    knots: Floats
    """(s + 1,) float64, distinct and increasing."""
    spans: Floats
    """(s, 6, d) float64; the Bernstein coefficients of each span."""

    @property
    def poles(self) -> Floats:
        """(4 s + 2, d) float64; as a B-spline: what two spans share does not count."""
        inner = self.spans[:, :-1].copy()
        kept = [inner[0], *inner[1:, 1:]]
        return np.concatenate([*kept, self.spans[-1, -1:]])

    @property
    def multiplicities(self) -> Ints:
        """(s + 1,) int64; of the knots."""
        found = np.full(len(self.knots), DEGREE - 1, dtype=np.int64)
        found[[0, -1]] = DEGREE + 1
        return found

    def at(self, parameters: Floats) -> Floats:
        """(k, d) values at (k,) parameters."""
        span, width = self._span_of(parameters)
        share = (parameters - self.knots[span]) / width
        return _bernstein([self.spans[span, rank] for rank in range(DEGREE + 1)], share)

    def slope_at(self, parameters: Floats) -> Floats:
        """(k, d) derivatives at (k,) parameters."""
        span, width = self._span_of(parameters)
        share = (parameters - self.knots[span]) / width
        legs = np.diff(self.spans[span], axis=1) * (DEGREE / width)[:, None, None]
        return _bernstein([legs[:, rank] for rank in range(DEGREE)], share)

    def _span_of(self, parameters: Floats) -> tuple[Ints, Floats]:
        span = np.searchsorted(self.knots, parameters, side="right") - 1
        span = np.clip(span, 0, len(self.spans) - 1)
        return span, self.knots[span + 1] - self.knots[span]


def _bernstein(column: list[Floats], share: Floats) -> Floats:
    """(k, d): polynomials by their Bernstein coefficients, (k, d) of each rank, at (k,) shares."""
    t = share[:, None]
    for level in range(len(column) - 1, 0, -1):
        column = [(1.0 - t) * column[rank] + t * column[rank + 1] for rank in range(level)]
    return column[0]


def fitted(
    function: Function,
    knots: npt.ArrayLike,
    tolerance: float,
    *,
    gap: Gap | None = None,
    most_spans: int = 4096,
) -> Quintic | None:
    """Returns the spline that follows a function, None if that takes too many spans.

    Args:
        function: from (k,) parameters to values and derivatives, (k, d) each; once differentiable.
        knots: (s + 1,) increasing; the spans to begin with: at knots higher derivatives may jump.
            Those that are not needed are left out.
        tolerance: how far the spline may be off, in the unit of the values or of ``gap``.
        gap: how far a value of the spline is off; by default the distance from the function's.
        most_spans: it has at most so many.

    Example:
        >>> def turn(t):
        ...     return np.stack((np.cos(t), np.sin(t)), 1), np.stack((-np.sin(t), np.cos(t)), 1)
        >>> circle = fitted(turn, [0.0, 3.0], 1e-8)
        >>> bool(abs(np.hypot(*circle.at(np.linspace(0.0, 3.0, 99)).T) - 1.0).max() <= 1e-8)
        True
    """
    measure = gap or _distance
    edges = np.asarray(knots, dtype=np.float64)
    spans = _spans(function, edges[:-1], edges[1:])
    todo = np.ones(len(spans), dtype=np.bool_)
    while True:
        chosen = np.flatnonzero(todo)
        fits = _follow(function, edges[chosen], edges[chosen + 1], spans[chosen], measure)
        todo[chosen] = fits > tolerance
        if not todo.any():
            return _joined(function, Quintic(edges, spans), measure, tolerance)
        if len(spans) + int(np.count_nonzero(todo)) > most_spans:
            return None
        edges, spans, todo = _halved(function, edges, spans, todo)


def _halved(
    function: Function, edges: Floats, spans: Floats, todo: Bools
) -> tuple[Floats, Floats, Bools]:
    """Edges, spans and which of them are new, where those to do are halved."""
    low, high = edges[:-1], edges[1:]
    middle = (low + high) / 2.0
    repeats = np.where(todo, 2, 1)
    owner = np.repeat(np.arange(len(spans)), repeats)
    starts = np.cumsum(repeats) - repeats
    edges_new = np.append(low[owner], edges[-1])
    edges_new[starts[todo] + 1] = middle[todo]
    made, fresh = spans[owner], todo[owner]
    made[fresh] = _spans(function, edges_new[:-1][fresh], edges_new[1:][fresh])
    return edges_new, made, fresh


def _joined(function: Function, found: Quintic, gap: Gap, tolerance: float) -> Quintic:
    """The spline with as many spans joined as it follows the function without."""
    edges, spans = found.knots, found.spans.copy()
    parity, tried = 0, 0
    while tried < 2 and len(spans) > 1:
        first = np.arange(parity, len(spans) - 1, 2)
        made = _spans(function, edges[first], edges[first + 2])
        fits = _follow(function, edges[first], edges[first + 2], made, gap, JOINED_CHECKED)
        good = first[fits <= tolerance]
        tried = 0 if len(good) else tried + 1
        parity = 1 - parity
        spans[good] = made[fits <= tolerance]
        spans, edges = np.delete(spans, good + 1, axis=0), np.delete(edges, good + 1)
    joined = Quintic(edges, spans)
    at = (found.knots[:-1, None] + np.diff(found.knots)[:, None] * np.array(CHECKED)).ravel()
    is_kept = bool((gap(at, function(at)[0], joined.at(at)) <= tolerance).all())
    return joined if is_kept else found


def _spans(function: Function, low: Floats, high: Floats) -> Floats:
    """(s, 6, d): coefficients of the spans between two rows of (s,) parameters."""
    width = (high - low)[:, None]
    (start, rise), (end, fall) = function(low), function(high)
    first, second = start + rise * width / DEGREE, end - fall * width / DEGREE
    inner = [function(low + share * (high - low))[0] for share in INNER]
    rows = []
    for share, value in zip(INNER, inner, strict=True):
        t, r = share, 1.0 - share
        known = r**5 * start + 5.0 * r**4 * t * first + 5.0 * r * t**4 * second + t**5 * end
        rows.append((10.0 * r**3 * t**2, 10.0 * r**2 * t**3, value - known))
    (a, b, x), (c, d, y) = rows
    det = a * d - b * c
    third, fourth = (d * x - b * y) / det, (a * y - c * x) / det
    return np.stack((start, first, third, fourth, second, end), axis=1)


def _follow(
    function: Function,
    low: Floats,
    high: Floats,
    spans: Floats,
    gap: Gap,
    shares: tuple[float, ...] = CHECKED,
) -> Floats:
    """(s,): how far each span is off the function at most."""
    worst = np.zeros(len(low))
    column = [spans[:, rank] for rank in range(DEGREE + 1)]
    for share in shares:
        at = low + share * (high - low)
        here = _bernstein(column, np.full(len(at), share))
        worst = np.maximum(worst, gap(at, function(at)[0], here))
    return worst


def _distance(_: Floats, wanted: Floats, found: Floats) -> Floats:
    apart: Floats = np.sqrt(((found - wanted) ** 2).sum(axis=1))
    return apart

"""Points and derivatives of a B-spline curve at many parameters at once.

De Boor's algorithm on homogeneous poles, compiled. The kernel evaluates one parameter per call,
which costs a hundred times more from Python; importing a library for it costs a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.compiled import compiled

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class PoleCurve:
    """A clamped B-spline curve as numbers."""

    degree: int
    """1 to 25."""

    knots: Floats
    """(l,) distinct and increasing."""

    multiplicities: NDArray[np.int64]
    """(l,); degree + 1 at both ends, at most the degree between."""

    poles: Floats
    """(k, 3) mm."""

    weights: Floats | None
    """(k,) positive; None: not rational."""

    def point_at(self, parameters: Floats) -> Floats:
        """Returns (k, 3) mm at (k,) parameters, which must lie within the first and last knot."""
        found = _de_boor(self._sequence(), self._homogeneous(), self.degree, parameters, "right")
        return found if self.weights is None else found[:, :3] / found[:, 3:]

    def velocity_at(self, parameters: Floats, side: Literal["left", "right"] = "right") -> Floats:
        """Returns (k, 3) mm: first derivatives by the parameter; ``side`` decides at a knot."""
        sequence, poles, degree = self._sequence(), self._homogeneous(), self.degree
        spans = sequence[degree + 1 : -1] - sequence[1 : -degree - 1]
        slopes = degree * np.diff(poles, axis=0) / spans[:, None]
        slope = _de_boor(sequence[1:-1], slopes, degree - 1, parameters, side)
        if self.weights is None:
            return slope
        place = _de_boor(sequence, poles, degree, parameters, "right")
        point = place[:, :3] / place[:, 3:]
        return (slope[:, :3] - slope[:, 3:] * point) / place[:, 3:]

    def reversed(self) -> PoleCurve:
        """Returns the curve run the other way over the same interval."""
        return PoleCurve(
            self.degree,
            self.knots[0] + self.knots[-1] - self.knots[::-1],
            self.multiplicities[::-1],
            self.poles[::-1],
            None if self.weights is None else self.weights[::-1],
        )

    def stretched(self, first: float, last: float) -> PoleCurve:
        """Returns the same curve with its parameter mapped linearly onto an interval."""
        share = (self.knots - self.knots[0]) / (self.knots[-1] - self.knots[0])
        knots = (1.0 - share) * first + share * last
        return PoleCurve(self.degree, knots, self.multiplicities, self.poles, self.weights)

    def joined(self, first: Floats, last: Floats) -> PoleCurve:
        """Returns the curve with its end points moved to (3,) mm each."""
        poles = self.poles.copy()
        poles[0], poles[-1] = first, last
        return PoleCurve(self.degree, self.knots, self.multiplicities, poles, self.weights)

    def _sequence(self) -> Floats:
        return np.repeat(self.knots, self.multiplicities)

    def _homogeneous(self) -> Floats:
        if self.weights is None:
            return self.poles
        return np.column_stack((self.poles * self.weights[:, None], self.weights))


def _de_boor(
    sequence: Floats,
    poles: Floats,
    degree: int,
    parameters: Floats,
    side: Literal["left", "right"],
) -> Floats:
    """Returns (k, dim) at (k,) parameters; at a knot, the polynomial on that side of it."""
    last = len(poles) - 1
    span = np.clip(np.searchsorted(sequence, parameters, side=side) - 1, degree, last)
    # A parameter at the very end belongs to the last span that has a length.
    span = np.minimum(span, np.searchsorted(sequence, sequence[-1], side="left") - 1)
    # Knots that are NaN are in no order: what comes out is NaN, too, and told as that.
    span = np.maximum(span, degree)
    return _blended(
        sequence,
        np.ascontiguousarray(poles),
        degree,
        span.astype(np.int64),
        np.ascontiguousarray(parameters, dtype=np.float64),
    )


@compiled
def _blended(
    sequence: Floats, poles: Floats, degree: int, spans: Ints, parameters: Floats
) -> Floats:
    """The triangle of de Boor for each parameter in its span."""
    size = poles.shape[1]
    found = np.empty((parameters.size, size))
    column = np.empty((degree + 1, size))
    for k in range(parameters.size):
        span, at = spans[k], parameters[k]
        column[:] = poles[span - degree : span + 1]
        for level in range(1, degree + 1):
            for j in range(degree, level - 1, -1):
                low = sequence[span - degree + j]
                share = (at - low) / (sequence[span + 1 + j - level] - low)
                for axis in range(size):
                    column[j, axis] = (1.0 - share) * column[j - 1, axis] + share * column[j, axis]
        found[k] = column[degree]
    return found

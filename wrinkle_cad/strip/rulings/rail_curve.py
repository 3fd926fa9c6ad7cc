"""A rail as the curve itself: position and derivative, corners, arc length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError

from .vectors import lengths

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
CurveFunction = Callable[[Floats], Floats]

BESIDE_CORNER: Final = 1e-9
"""Derivatives at the end of a smooth piece are taken this share of its range inside."""
ARC_CELLS: Final = 512
"""A rail's length is integrated over so many cells, shared by its smooth pieces ..."""
ARC_CELLS_OF_PIECE: Final = 8
"""... each of which gets at least so many."""
GAUSS: Final = (
    (0.5 - 0.43056815579702629, 0.17392742256872693),
    (0.5 - 0.16999052179242813, 0.32607257743127307),
    (0.5 + 0.16999052179242813, 0.32607257743127307),
    (0.5 + 0.43056815579702629, 0.17392742256872693),
)
"""Places and weights of Gauss and Legendre's rule of four points on (0, 1)."""


@dataclass(frozen=True, slots=True, eq=False)
class RailCurve:
    """One rail of a strip, piecewise smooth; a point if its interval has no length.

    >>> rail = RailCurve(
    ...     lambda u: np.stack((u, 0 * u, 0 * u), axis=-1),
    ...     lambda u: np.stack((1 + 0 * u, 0 * u, 0 * u), axis=-1),
    ...     (0.0, 40.0),
    ... )
    >>> rail.length
    40.0
    """

    point_at: CurveFunction
    """From (k,) float64 parameters to (k, 3) mm."""
    velocity_at: CurveFunction
    """From (k,) float64 parameters to (k, 3) mm, the derivative by the parameter; at a break it is
    never asked for."""
    interval: tuple[float, float]
    """First and last parameter; equal for a rail that is a point."""
    breaks: tuple[float, ...] = ()
    """Increasing parameters inside the interval where the derivative jumps."""
    edges: Floats = field(init=False)
    """(pieces + 1,) float64; the parameters where smooth pieces begin and end."""
    cells: Floats = field(init=False)
    """(c + 1,) float64; parameters where the arc length is known."""
    arcs: Floats = field(init=False)
    """(c + 1,) float64, mm; the arc length there."""
    speeds: Floats = field(init=False)
    """(c, 2) float64; the speed at both ends of each cell."""

    def __post_init__(self) -> None:
        first, last = (float(end) for end in self.interval)
        if not (np.isfinite(first) and np.isfinite(last) and first <= last):
            raise InputError(
                f"The rail's parameter runs from {first:.9g} to {last:.9g}; it must be finite and"
                " must not fall. Give the first and the last parameter."
            )
        inner = sorted({float(at) for at in self.breaks if first < at < last})
        edges = np.array([first, *inner, last])
        cells, arcs, speeds = self._integrated(edges)
        for name, value in (("edges", edges), ("cells", cells), ("arcs", arcs), ("speeds", speeds)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    @property
    def length(self) -> float:
        """Arc length in mm."""
        return float(self.arcs[-1])

    @property
    def is_point(self) -> bool:
        """Whether the rail has no length."""
        return self.length == 0.0

    def tangents(self, u: Floats, piece: Ints) -> tuple[Floats, Floats]:
        """Unit tangents, (k, 3), and speeds, (k,), at parameters of given smooth pieces."""
        velocity = self.velocity_at(self._inside(u, piece))
        speed = lengths(velocity)
        return velocity / np.where(speed > 0.0, speed, 1.0)[:, None], speed

    def arc_at(self, u: Floats) -> Floats:
        """(k,) mm: the arc length from the rail's start, by cubic interpolation in each cell."""
        if self.is_point:
            return np.zeros_like(u)
        cell = np.clip(np.searchsorted(self.cells, u, side="right") - 1, 0, len(self.cells) - 2)
        width = self.cells[cell + 1] - self.cells[cell]
        x = (u - self.cells[cell]) / width
        low, high = self.arcs[cell], self.arcs[cell + 1]
        before, after = (self.speeds[cell, side] * width for side in (0, 1))
        rise = high - low
        bend = before + after - 2.0 * rise
        arc: Floats = low + x * (before + x * (3.0 * rise - 2.0 * before - after + x * bend))
        return arc

    def at_arc(self, arc: Floats) -> Floats:
        """(k,) parameters near which the arc length is reached: close, not exact."""
        return np.interp(arc, self.arcs, self.cells)

    def _inside(self, u: Floats, piece: Ints) -> Floats:
        low, high = self.edges[piece], self.edges[piece + 1]
        margin = BESIDE_CORNER * (high - low)
        return np.clip(u, low + margin, high - margin)

    def _integrated(self, edges: Floats) -> tuple[Floats, Floats, Floats]:
        if edges[0] == edges[-1]:
            return edges[:1], np.zeros(1), np.zeros((0, 2))
        pieces = len(edges) - 1
        each = max(ARC_CELLS_OF_PIECE, ARC_CELLS // pieces)
        share = np.arange(each) / each
        cells = np.append((edges[:-1, None] + np.diff(edges)[:, None] * share).ravel(), edges[-1])
        width = np.diff(cells)
        length = np.zeros_like(width)
        for place, weight in GAUSS:
            length += weight * width * lengths(self.velocity_at(cells[:-1] + place * width))
        margin = BESIDE_CORNER * width
        ends = [lengths(self.velocity_at(at)) for at in (cells[:-1] + margin, cells[1:] - margin)]
        arcs = np.concatenate(([0.0], np.cumsum(length)))
        if not arcs[-1] > 0.0:
            raise InputError(
                "The rail's derivative is zero everywhere; a rail has a length, or its parameter"
                " has none. Give a derivative that belongs to the curve."
            )
        return cells, arcs, np.stack(ends, axis=-1)

"""A rail by its arc length: the same curve whatever its parameter is and wherever its knots are.

Samples of a closed rail are placed by it, so that they remember nothing of how the rail was drawn:
where a parameter began, and how fast it runs.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.flat.development import NODES, WEIGHTS

from .directrix import Directrix

Floats = NDArray[np.float64]

CELLS: Final = 16
"""Each span between knots is measured in so many cells."""
STEPS: Final = 3
"""Newton's steps to the parameter at an arc length; two give all digits on smooth curves."""


class RailByArc:
    """The parameters of a directrix as a function of its arc length.

    Args:
        directrix: the rail; it must have a length.
    """

    def __init__(self, directrix: Directrix) -> None:
        self._rail = directrix
        knots = np.unique(np.concatenate([piece.knots for piece in directrix.pieces]))
        shares = np.arange(CELLS) / CELLS
        cells = (knots[:-1, None] + np.diff(knots)[:, None] * shares).ravel()
        self._u = np.append(cells, knots[-1])
        lengths = self._lengths(self._u[:-1], self._u[1:])
        self._s = np.concatenate(([0.0], np.cumsum(lengths)))

    @property
    def length(self) -> float:
        """Mm."""
        return float(self._s[-1])

    def arcs_at(self, parameters: Floats) -> Floats:
        """Returns (k,) mm from the rail's start at (k,) parameters."""
        cell = self._cell(self._u, parameters)
        return np.asarray(self._s[cell] + self._lengths(self._u[cell], parameters))

    def parameters_at(self, arcs: Floats) -> Floats:
        """Returns (k,) parameters at (k,) mm from the rail's start."""
        cell = self._cell(self._s, arcs)
        low, high = self._u[cell], self._u[cell + 1]
        share = (arcs - self._s[cell]) / (self._s[cell + 1] - self._s[cell])
        found = low + share * (high - low)
        for _ in range(STEPS):
            off = self._s[cell] + self._lengths(low, found) - arcs
            speed = row_lengths(self._rail.velocity_at(found))
            step = np.divide(off, speed, out=np.zeros_like(off), where=speed > 0.0)
            found = np.clip(found - step, low, high)
        return np.asarray(found)

    @staticmethod
    def _cell(edges: Floats, places: Floats) -> NDArray[np.int64]:
        cell = np.searchsorted(edges, places, side="right") - 1
        return np.clip(cell, 0, len(edges) - 2).astype(np.int64)

    def _lengths(self, starts: Floats, ends: Floats) -> Floats:
        """(k,) mm between parameters, each pair between two knots."""
        half = 0.5 * (ends - starts)
        at = (starts + half)[:, None] + half[:, None] * NODES
        speeds = row_lengths(self._rail.velocity_at(at.ravel())).reshape(at.shape)
        return np.asarray((speeds * WEIGHTS).sum(axis=1) * half)

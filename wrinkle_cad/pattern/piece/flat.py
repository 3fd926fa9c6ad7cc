"""FlatStrip: a strip, or a run of its bridges, laid out in the frame of a pattern piece."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.portable import dot, norm

from .options import Direction
from .piece import Floats, frozen

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.triangulation import Triangulation

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class FlatStrip:
    """A flat strip with what a piece needs to know of its shape in space."""

    p: Floats
    """(m, 2) mm, flat samples of P."""
    q: Floats
    """(n, 2) mm, flat samples of Q."""
    p_space: Floats
    """(m, 3) mm, the samples of P in space."""
    q_space: Floats
    """(n, 3) mm, the samples of Q in space."""
    p_line: Floats
    """(k, 2) mm, flat rail P through all samples."""
    q_line: Floats
    """(l, 2) mm, flat rail Q through all samples."""
    p_arc: Floats
    """(k,) mm, arc length in space at each point of ``p_line``."""
    q_arc: Floats
    """(l,) mm, likewise of ``q_line``."""
    p_index: Indices
    """(m,) where the samples stand in ``p_line``."""
    q_index: Indices
    """(n,) where the samples stand in ``q_line``."""
    bridges: Indices
    """(b, 2) pairs of sample indices, from the first to the last ruling."""
    fold: Floats
    """(b,) rad, signed; 0 at the first and the last bridge of the whole strip."""
    starts_at_cut: bool = False
    """Whether its start is where a longer strip was cut apart."""
    ends_at_cut: bool = False
    """Whether its end is."""

    def run(self, first: int, last: int) -> FlatStrip:
        """Returns the part between two bridges, ``first < last``, in the same place."""
        (i0, j0), (i1, j1) = self.bridges[first], self.bridges[last]
        p_part = slice(self.p_index[i0], self.p_index[i1] + 1)
        q_part = slice(self.q_index[j0], self.q_index[j1] + 1)
        return FlatStrip(
            p=self.p[i0 : i1 + 1],
            q=self.q[j0 : j1 + 1],
            p_space=self.p_space[i0 : i1 + 1],
            q_space=self.q_space[j0 : j1 + 1],
            p_line=self.p_line[p_part],
            q_line=self.q_line[q_part],
            p_arc=self.p_arc[p_part],
            q_arc=self.q_arc[q_part],
            p_index=self.p_index[i0 : i1 + 1] - self.p_index[i0],
            q_index=self.q_index[j0 : j1 + 1] - self.q_index[j0],
            bridges=self.bridges[first : last + 1] - self.bridges[first],
            fold=self.fold[first : last + 1],
            starts_at_cut=self.starts_at_cut or first > 0,
            ends_at_cut=self.ends_at_cut or last < len(self.bridges) - 1,
        )

    def framed(self) -> FlatStrip:
        """Returns the strip turned so that it runs along +x, its first P-point at the origin."""
        run = (self.p[-1] - self.p[0]) + (self.q[-1] - self.q[0])
        size = np.ptp(np.vstack((self.p, self.q)), axis=0).max()
        if np.hypot(*run) < 1e-6 * size:
            run = self.p[min(1, len(self.p) - 1)] - self.p[0]
        cosine, sine = run / np.hypot(*run) if np.any(run) else (1.0, 0.0)
        origin = self.p[0]

        def turned(points: Floats) -> Floats:
            x, y = (points - origin).T
            return frozen(np.column_stack((x * cosine + y * sine, y * cosine - x * sine)))

        return replace(
            self,
            p=turned(self.p),
            q=turned(self.q),
            p_line=turned(self.p_line),
            q_line=turned(self.q_line),
        )

    def flat_direction(self, direction: Direction, *, name: str) -> Floats:
        """Returns a unit vector (2,) in the plane of the piece.

        A direction in space is projected onto the triangle in the middle of the strip and turned
        into the plane with it.

        Raises:
            InputError: the direction in space is perpendicular to the strip there.
        """
        if direction == "along":
            return np.array([1.0, 0.0])
        if direction == "across":
            return np.array([0.0, 1.0])
        space, flat = self._middle_triangle()
        one, two = space[1:] - space[0]
        given = np.array(direction, dtype=np.float64)
        # Coordinates of the projection in the triangle's own (skew) base, by Gram and Schmidt.
        along = one / norm(one)
        across = two - dot(two, along) * along
        share_two = dot(given, across) / dot(across, across)
        share_one = dot(given - share_two * two, along) / norm(one)
        laid = share_one * (flat[1] - flat[0]) + share_two * (flat[2] - flat[0])
        length = norm(laid) / norm(given)
        if length < 1e-3:
            raise InputError(
                f"The {name} direction {direction} is perpendicular to the strip at its middle "
                "and must lie along the surface there. Give another direction."
            )
        unit: Floats = laid / norm(laid)
        return unit

    def middle(self) -> Floats:
        """Returns a point (2,) inside the flat strip, half-way along it."""
        point: Floats = self._middle_triangle()[1].mean(axis=0)
        return point

    def _middle_triangle(self) -> tuple[Floats, Floats]:
        first, second = self.bridges[:-1], self.bridges[1:]
        is_p_step = second[:, 0] > first[:, 0]
        corners = np.where(
            is_p_step[:, None],
            np.column_stack((first[:, 0], second[:, 0], first[:, 1] + len(self.p))),
            np.column_stack((first[:, 0], second[:, 1] + len(self.p), first[:, 1] + len(self.p))),
        )
        flat = np.vstack((self.p, self.q))[corners]
        one, two = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
        areas = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        reached = np.cumsum(areas)
        middle = int(np.searchsorted(reached, 0.5 * reached[-1]))
        return np.vstack((self.p_space, self.q_space))[corners[middle]], flat[middle]


def flat_strip(unrolling: Unrolling, triangulation: Triangulation) -> FlatStrip:
    """Returns the strip as it was unrolled, not yet in the frame of a piece."""
    fold = np.zeros(len(triangulation.bridges))
    fold[1:-1] = triangulation.fold
    return FlatStrip(
        p=unrolling.p,
        q=unrolling.q,
        p_space=triangulation.p,
        q_space=triangulation.q,
        p_line=unrolling.p_line,
        q_line=unrolling.q_line,
        p_arc=unrolling.p_arc,
        q_arc=unrolling.q_arc,
        p_index=unrolling.p_index,
        q_index=unrolling.q_index,
        bridges=triangulation.bridges,
        fold=frozen(fold),
    )

"""Which steps of a strip lie in one plane, their exact bank curves included.

There the surface is the plane between the rails, however the triangles lie in it: no curve has to
be seen from an apex, so none can turn back.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.curve.chebyshev import Cells
from wrinkle_cad.strip.triangulation import P_STEP, Triangulation

from .overlap import is_overlapping

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]
Steps = npt.NDArray[np.int8]


def planar_runs(
    triangulation: Triangulation,
    cells: tuple[Cells | None, Cells | None],
    parameters: tuple[Floats, Floats],
    gap: float,
) -> Indices:
    """Returns the plane that each step lies in.

    A run of steps lies in one plane if its rulings and bank curves do, its triangles face one way,
    and what its outline encloses covers nothing twice. Runs are as long as can be.

    Args:
        triangulation: the strip.
        cells: the curves of P and Q; None for a rail that is a point.
        parameters: (m,) and (n,) float64; of the samples of P and of Q.
        gap: mm; how far a curve may lie from its plane.

    Returns:
        (m+n-2,) int64; the number of a step's run, counted along the strip; -1 where the bank curve
        and its apex lie in no plane.
    """
    sectors = _Sectors(triangulation, cells, parameters)
    joined = sectors.are_coplanar(gap)
    firsts = np.concatenate(([0], np.flatnonzero(~joined) + 1, [sectors.count]))
    runs = np.full(sectors.count, -1, dtype=np.int64)
    number = 0
    for first, last in zip(firsts[:-1].tolist(), firsts[1:].tolist(), strict=True):
        for start, end in _planar_parts(sectors, first, last, gap):
            runs[start:end] = number
            number += 1
    return runs


def spans_of(runs: Indices) -> list[tuple[int, int]]:
    """Returns where each run begins, and where it ends (not included), along the strip."""
    firsts = np.flatnonzero(np.diff(runs, prepend=-2))
    lasts = np.append(firsts[1:], len(runs))
    spans = zip(firsts.tolist(), lasts.tolist(), strict=True)
    return [(first, last) for first, last in spans if runs[first] >= 0]


def plane_normal(triangulation: Triangulation, first: int, last: int) -> Floats:
    """Returns (3,): the unit normal of the plane of a run of steps, ``last`` not included.

    It looks to where the triangles are counter-clockwise; zero if none has an area.
    """
    corners = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles[first:last]]
    return _unit(_total(_cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])))


def _planar_parts(sectors: _Sectors, first: int, last: int, gap: float) -> list[tuple[int, int]]:
    """Returns the parts of a run that do lie in one plane each; halves of it where it does not."""
    if sectors.is_plane(first, last, gap):
        return [(first, last)]
    if last - first == 1:
        return []
    middle = (first + last) // 2
    return [
        *_planar_parts(sectors, first, middle, gap),
        *_planar_parts(sectors, middle, last, gap),
    ]


class _Sectors:
    """The steps of a strip as points: of each, its bank curve in order and then its apex."""

    def __init__(
        self,
        triangulation: Triangulation,
        cells: tuple[Cells | None, Cells | None],
        parameters: tuple[Floats, Floats],
    ) -> None:
        steps, bridges = triangulation.steps, triangulation.bridges[:-1]
        self.count = len(steps)
        corners = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles]
        self.areas = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        i, j = bridges.T
        self.apex = np.where((steps == P_STEP)[:, None], triangulation.q[j], triangulation.p[i])
        self.base = triangulation.p[i]
        self.sides = steps
        points, owners = [], []
        for side, (own, at) in enumerate(zip(cells, parameters, strict=True)):
            if own is not None:
                segment = np.searchsorted(at, own.edges[:-1], side="right") - 1
                (step_of,) = np.nonzero(steps == side)
                points.append(own.nodes.reshape(-1, 3))
                owners.append(np.repeat(step_of[segment], own.nodes.shape[1]))
        owner = np.concatenate(owners)
        order = np.argsort(owner, kind="stable")
        self.points, self.owner = np.concatenate(points)[order], owner[order]
        self.starts = np.searchsorted(self.owner, np.arange(self.count + 1))
        self.loops = self._loops()

    def _loops(self) -> Floats:
        """(k, 3) mm2: twice the vector area inside each bank curve and its apex, as a P-step's."""
        spokes = self.points - self.apex[self.owner]
        turns = np.zeros_like(spokes)
        turns[:-1] = _cross(spokes[:-1], spokes[1:])
        turns[self.starts[1:] - 1] = 0.0
        loops: Floats = np.add.reduceat(turns, self.starts[:-1], axis=0)
        return np.where((self.sides == P_STEP)[:, None], loops, -loops)

    def are_coplanar(self, gap: float) -> Bools:
        """(k-1,) bool: whether each step and the next lie in one plane and face one way."""
        larger = np.where(
            (_sizes(self.areas) >= _sizes(self.loops))[:, None], self.areas, self.loops
        )
        sizes = _sizes(larger)
        pair = np.where((sizes[:-1] >= sizes[1:])[:, None], larger[:-1], larger[1:])
        scale = np.sqrt(_sizes(pair))[:, None]
        normal = np.divide(pair, scale, out=np.zeros_like(pair), where=scale > 0.0)
        together = (scale[:, 0] > 0.0) & np.ones(self.count - 1, dtype=np.bool_)
        base = self.base[1:]
        for own in (slice(None, -1), slice(1, None)):
            reach = self._reach(own, normal, base)
            facing = _dots(self.areas[own], normal)
            together &= (reach <= gap) & (facing >= -gap * np.sqrt(np.sqrt(sizes[own])))
        return together

    def _reach(self, own: slice, normal: Floats, base: Floats) -> Floats:
        """(k-1,) mm: how far the steps chosen reach from the planes between the steps."""
        chosen = np.arange(self.count)[own]
        place = np.full(self.count, -1)
        place[chosen] = np.arange(len(chosen))
        at = place[self.owner]
        inside = at >= 0
        heights = np.abs(_dots(self.points[inside] - base[at[inside]], normal[at[inside]]))
        starts = np.searchsorted(at[inside], np.arange(len(chosen)))
        of_apex = np.abs(_dots(self.apex[own] - base, normal))
        return np.maximum(np.maximum.reduceat(heights, starts), of_apex)

    def is_plane(self, first: int, last: int, gap: float) -> bool:
        """Whether steps from ``first`` up to, not including, ``last`` are one region of a plane."""
        normal = _total(self.areas[first:last])
        size = math.sqrt(float(_sizes(normal[None])[0]))
        own = slice(int(self.starts[first]), int(self.starts[last]))
        points, side = self.points[own], self.sides[self.owner[own]]
        apexes, base = self.apex[first:last], self.base[first]
        reach = float(np.ptp(np.vstack((points, apexes)), axis=0).max())
        if size <= gap * reach:
            return False
        normal = normal / size
        everything = np.vstack((points, apexes)) - base
        if float(np.abs(_dots(everything, normal[None])).max()) > gap:
            return False
        if float(_dots(self.areas[first:last], normal[None]).min()) < -gap * reach:
            return False
        if all(_returns(points[side == rail], gap) for rail in (0, 1)):
            # The outline of a ring would run along the ruling that cuts it, there and back.
            return False
        return not _covers_itself(
            points - base, side, apexes - base, normal, self.sides[first:last]
        )


def _returns(points: Floats, gap: float) -> bool:
    """Whether a stretch of a rail ends where it starts; one without points is the apex of all."""
    return len(points) == 0 or float(_sizes(points[-1:] - points[:1])[0]) <= gap * gap


def _covers_itself(
    points: Floats, side: Steps, apexes: Floats, normal: Floats, sides: Steps
) -> bool:
    """Whether the region between two flat rails covers a place twice."""
    least = int(np.abs(normal).argmin())
    across = _unit(_cross(normal[None], np.eye(3)[[least]])[0])
    along = _cross(across[None], normal[None])[0]
    rails = []
    for number in range(2):
        own = points[side == number]
        # A rail on which no step lies is the one apex of all.
        own = own if len(own) else apexes[sides != number][:1]
        rails.append(np.column_stack((_dots(own, along[None]), _dots(own, across[None]))))
    return is_overlapping(rails[0], rails[1])


def _cross(first: Floats, second: Floats) -> Floats:
    x, y, z = first.T
    a, b, c = second.T
    return np.stack((y * c - z * b, z * a - x * c, x * b - y * a), axis=1)


def _dots(first: Floats, second: Floats) -> Floats:
    dots: Floats = (
        first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1] + first[:, 2] * second[:, 2]
    )
    return dots


def _sizes(vectors: Floats) -> Floats:
    return _dots(vectors, vectors)


def _total(vectors: Floats) -> Floats:
    return np.array([math.fsum(column) for column in vectors.T.tolist()])


def _unit(vector: Floats) -> Floats:
    size = math.sqrt(math.fsum((vector * vector).tolist()))
    return vector / size if size > 0.0 else vector

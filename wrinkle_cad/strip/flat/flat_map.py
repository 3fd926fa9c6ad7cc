"""From a strip's surface to the plane and back: every point is a place and a share of its ruling.

The surface is a row of cells, each with a ruling at every place. A point of the surface, or of the
plane, lies on the ruling from which it is not off to either side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.portable import dot
from wrinkle_cad.strip.rulings.family import RulingFamily
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.secants import bracketed_secants
from wrinkle_cad.strip.rulings.smooth_path import PatchRun
from wrinkle_cad.strip.triangulation import Triangulation

from .ruled import NO_PLACES, FlatPiece, flat_rulings, lay_flat

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
EndRows = tuple[Floats, Floats, Floats]
"""(k, d) ends of rulings on P and on Q, and the (k, d) way across them."""
Ends = Callable[[Floats], EndRows]
"""From (k,) places of rulings to that."""

ROUNDS: Final = 40
"""Steps of the bracketed secant; it mostly needs five to eight."""
SLACK_PER_SIZE: Final = 1e-9
"""Of the strip's size; a point is on a ruling that it is off by less."""
MOST_PAIRS: Final = 2_000_000
"""Points times rulings that are looked at together."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatCell:
    """A part of a strip with a ruling at every place, in space and in the plane."""

    family: RulingFamily
    """Its rulings in space."""
    flat: FlatPiece
    """The same in the plane."""
    space_nodes: EndRows = field(init=False)
    """What ``in_space`` gives at the places of ``flat``."""
    plane_nodes: EndRows = field(init=False)
    """What ``in_plane`` gives there."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "space_nodes", self.in_space(self.flat.places))
        object.__setattr__(self, "plane_nodes", self.in_plane(self.flat.places))

    def in_space(self, place: Floats) -> EndRows:
        """(k, 3) mm each: ends on P and on Q of rulings at (k,) places, and the way across."""
        p, q = self.family.points_at(place)
        way = q - p
        length2 = np.maximum(dot(way, way), np.finfo(np.float64).tiny)[:, None]
        one, other = self.family.velocities_at(place)
        moved = one + other
        return p, q, moved - way * (dot(moved, way)[:, None] / length2)

    def in_plane(self, place: Floats) -> EndRows:
        """(k, 2) mm each: the same in the plane."""
        p, q = flat_rulings(self.family, self.flat, place)
        way = q - p
        return p, q, np.stack((way[:, 1], -way[:, 0]), axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class FlatMap:
    """The way from a strip's surface to the plane, and back."""

    cells: tuple[FlatCell, ...]
    """The strip's parts, in order."""
    size: float
    """mm; of the strip."""

    def to_plane(self, points: Floats, reach: float) -> tuple[Floats, Floats]:
        """Lays points of the surface into the plane.

        Args:
            points: (k, 3) mm.
            reach: mm; how far they may be off the surface.

        Returns:
            (k, 2) mm; and (k,) mm, how far each is off the surface, inf beyond ``reach``.
        """
        nodes = [cell.space_nodes for cell in self.cells]
        return self._carried(points, nodes, FlatCell.in_space, FlatCell.in_plane, reach)

    def to_space(self, points: Floats, reach: float) -> tuple[Floats, Floats]:
        """Puts points of the plane onto the surface.

        Args:
            points: (k, 2) mm.
            reach: mm; how far they may lie beyond the flat strip's border.

        Returns:
            (k, 3) mm; and (k,) mm, how far each lies beyond the strip, inf beyond ``reach``.
        """
        nodes = [cell.plane_nodes for cell in self.cells]
        return self._carried(points, nodes, FlatCell.in_plane, FlatCell.in_space, reach)

    def _carried(
        self,
        points: Floats,
        nodes: Sequence[EndRows],
        given: Callable[[FlatCell, Floats], EndRows],
        wanted: Callable[[FlatCell, Floats], EndRows],
        reach: float,
    ) -> tuple[Floats, Floats]:
        found = np.zeros((len(points), 5 - points.shape[1]))
        off = np.full(len(points), np.inf)
        for cell, rows in zip(self.cells, nodes, strict=True):
            ends = np.vstack(rows[:2])
            near = (points >= ends.min(axis=0) - reach) & (points <= ends.max(axis=0) + reach)
            chosen = np.flatnonzero(near.all(axis=1) & (off > SLACK_PER_SIZE * self.size))
            if not len(chosen):
                continue
            for part in np.array_split(chosen, 1 + len(chosen) * len(rows[0]) // MOST_PAIRS):
                slack = SLACK_PER_SIZE * self.size
                own, place, share, gap = _placed(
                    points[part], cell.flat.places, rows, partial(given, cell), slack, reach
                )
                at = part[own]
                better = (gap <= reach) & (gap < off[at])
                at, place, share = at[better], place[better], share[better]
                start, end, _ = wanted(cell, place)
                found[at] = start + (end - start) * share[:, None]
                off[at] = gap[better]
        return found, off


def _placed(
    points: Floats, nodes: Floats, rows: EndRows, ends: Ends, slack: float, reach: float
) -> tuple[NDArray[np.int64], Floats, Floats, Floats]:
    """Which of (k, d) points lie across some ruling; its place, the share along it, the gap in mm.

    A point on several stretches of rulings is returned for the nearest of them; one that is off a
    ruling by no more than ``slack`` mm, or off the first or last by ``reach``, counts as on it.
    """
    p, _, across = rows
    side = dot(points[:, None] - p, across)
    near = np.full(len(nodes), slack)
    near[[0, -1]] = max(slack, reach)
    side[np.abs(side) <= near * np.sqrt(dot(across, across))] = 0.0
    crossing = side[:, :-1] * side[:, 1:] <= 0.0
    own, node = np.nonzero(crossing)
    place = _zero(points[own], nodes[node], nodes[node + 1], ends)
    start, end, _ = ends(place)
    way, away = end - start, points[own] - start
    length2 = dot(way, way)
    share = np.divide(dot(away, way), length2, out=np.zeros(len(own)), where=length2 > 0.0)
    share = np.clip(share, 0.0, 1.0)
    apart = away - share[:, None] * way
    gap = np.sqrt(dot(apart, apart))
    order = np.lexsort((gap, own))
    own, first = np.unique(own[order], return_index=True)
    kept = order[first]
    return own, place[kept], share[kept], gap[kept]


def _zero(points: Floats, low: Floats, high: Floats, ends: Ends) -> Floats:
    """(k,) places between two rows of places at which points are off to neither side."""

    def off(place: Floats) -> Floats:
        start, _, across = ends(place)
        return dot(points - start, across)

    at = low
    for place, _ in bracketed_secants(off, low, high, (off(low), off(high)), ROUNDS):
        before, at = at, place
        if not (np.abs(at - before) > 4.0 * np.finfo(np.float64).eps).any():
            break
    return at


def flat_map(
    rails: tuple[RailCurve, RailCurve],
    parameters: tuple[Floats, Floats],
    triangulation: Triangulation,
    flat: tuple[Floats, Floats],
    runs: tuple[PatchRun, ...] = (),
) -> FlatMap:
    """Returns the way from a strip's surface to the plane.

    Args:
        rails: P and Q.
        parameters: (m,) and (n,) float64; of the triangulation's samples.
        triangulation: the strip's path; its steps are cones.
        flat: (m, 2) and (n, 2) mm; where the samples lie in the plane.
        runs: steps that are one smooth patch each.
    """
    bridges, steps = triangulation.bridges, triangulation.steps
    cells: list[FlatCell] = []
    patches = {run.early: run for run in runs}
    step = 0
    while step < len(steps):
        if step in patches:
            run = patches[step]
            family, last, places = run.family, run.late, run.patch.jumps
        else:
            family = _fan(rails, parameters, bridges[step], int(steps[step]))
            last, places = step + 1, NO_PLACES
        i, j = bridges[step]
        start = np.stack((flat[0][i], flat[1][j]))
        cells.append(FlatCell(family, lay_flat(family, start, places)))
        step = last
    size = float(np.ptp(np.vstack((triangulation.p, triangulation.q)), axis=0).max())
    return FlatMap(tuple(cells), size)


def _fan(
    rails: tuple[RailCurve, RailCurve],
    parameters: tuple[Floats, Floats],
    bridge: NDArray[np.int64],
    side: int,
) -> RulingFamily:
    """The rulings of the cone of one step."""
    start = [float(own[at]) for own, at in zip(parameters, bridge, strict=True)]
    end = list(start)
    end[side] = float(parameters[side][bridge[side] + 1])
    pieces = [
        int(np.clip(np.searchsorted(rail.edges, (a + b) / 2.0) - 1, 0, max(len(rail.edges) - 2, 0)))
        for rail, a, b in zip(rails, start, end, strict=True)
    ]
    both, nothing = np.array([0.0, 1.0]), np.zeros(2)
    return RulingFamily(
        *rails, pieces[0], pieces[1], np.array([start, end]), both, nothing, nothing
    )

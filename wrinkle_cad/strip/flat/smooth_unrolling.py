"""A strip's smooth surface in the plane: patches ruling by ruling, cones about their apexes.

A patch's flat rails are put in as if they were cones, too: its stretch of P about the end on Q of
its first ruling, and that of Q about the end on P of its last one. So all pieces of a strip are
laid side by side in the same way.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.curve.chebyshev import PointAt
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.portable import atan2
from wrinkle_cad.strip.rulings.patch import places_of
from wrinkle_cad.strip.rulings.smooth_path import PatchRun, SmoothPath

from .development import DevelopedRail
from .ruled import PANELS, FlatPiece, lay_flat
from .unrolling import Unrolling, developed_chain

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

MOST_PANELS: Final = 64
"""A stretch between exact rulings is drawn with so many points at most."""
BULGE_SHARE: Final = 0.1
"""Of the tolerance; what a flat rail may leave the chords between these points by."""


def unroll_smooth(
    path: SmoothPath,
    samples: tuple[Samples, Samples],
    curves: tuple[PointAt, PointAt],
    *,
    tolerance: float,
) -> Unrolling:
    """Returns a strip's smooth surface in the plane.

    Args:
        path: the surface.
        samples: of P and of Q, at which the result's ``p`` and ``q`` stand.
        curves: P and Q, from (k,) parameters to (k, 3) mm.
        tolerance: mm; the flat lines follow the flat curves at least this closely.
    """
    chain = developed_chain(path.triangulation, (path.p_samples, path.q_samples), curves, tolerance)
    flat = [_Laid(run, path, tolerance) for run in path.runs]
    rails = [_with_patches(chain.rails[side], side, flat) for side in (0, 1)]
    radii = chain.radii.copy()
    for laid in flat:
        radii[laid.run.early : laid.run.late] = laid.radii()
    found = replace(chain, rails=(rails[0], rails[1]), radii=radii).in_plane(tolerance)
    at = [
        np.abs(own.parameters[:, None] - mine.parameters).argmin(axis=1)
        for own, mine in zip(samples, (path.p_samples, path.q_samples), strict=True)
    ]
    return replace(
        found,
        p=found.p[at[0]],
        q=found.q[at[1]],
        p_index=found.p_index[at[0]],
        q_index=found.q_index[at[1]],
    )


class _Laid:
    """A patch in the plane, its first ruling upwards from the origin."""

    def __init__(self, run: PatchRun, path: SmoothPath, tolerance: float) -> None:
        self.run = run
        first, last = path.triangulation.bridges[[run.early, run.late]]
        self.segments = [slice(int(first[side]), int(last[side])) for side in (0, 1)]
        family = run.family
        samples = (path.p_samples.parameters, path.q_samples.parameters)
        inner = [
            places_of(family, side, own[first[side] + 1 : last[side]])
            for side, own in enumerate(samples)
        ]
        places = np.concatenate((*inner, run.patch.jumps))
        start = np.zeros((2, 2))
        p, q = family.points_at(np.zeros(1))
        start[1, 1] = np.sqrt(((q - p) ** 2).sum())
        panels = PANELS
        self.flat = lay_flat(family, start, places, panels)
        while panels < MOST_PANELS and _bulge(self.flat) > BULGE_SHARE * tolerance:
            panels *= 2
            self.flat = lay_flat(family, start, places, panels)
        self.ends = [
            np.concatenate(([0], np.searchsorted(self.flat.places, own), [len(self.flat.p) - 1]))
            for own in inner
        ]

    def polar(self, side: int) -> tuple[Floats, Floats]:
        """Polar angles and distances of the flat points of a rail, about its apex."""
        points = (self.flat.p, self.flat.q)[side]
        apex = self.flat.q[0] if side == 0 else self.flat.p[-1]
        away = points - apex
        angle = atan2(away[:, 1], away[:, 0])
        radius = np.sqrt((away * away).sum(axis=1))
        if side == 0 and radius[0] == 0.0:
            angle[0] = -np.pi / 2.0
        return (angle if side == 0 else -angle), radius

    def radii(self) -> Floats:
        """Lengths in the plane of the bridges that end the steps."""
        rows = [self.polar(side)[1][self.ends[side][1:]] for side in (0, 1)]
        return np.concatenate(rows)

    def rail(self, side: int) -> tuple[Indices, Floats, Floats, Floats]:
        """Segment, angle from its start, distance and arc length of the points of a rail."""
        angle, radius = self.polar(side)
        arc = (self.flat.p_arc, self.flat.q_arc)[side]
        own, ends = np.arange(1, len(arc)), self.ends[side]
        segment = np.searchsorted(ends, own, side="left") - 1
        since = angle[own] - angle[ends[segment]]
        return segment + self.segments[side].start, since, radius[own], arc[own]


def _bulge(flat: FlatPiece) -> float:
    """mm; how far flat rails may leave their chords: a quarter of what two chords enclose."""
    worst = 0.0
    for points in (flat.p, flat.q):
        before, here, after = points[:-2], points[1:-1], points[2:]
        way, away = after - before, here - before
        length = np.sqrt((way * way).sum(axis=1))
        cross = np.abs(way[:, 0] * away[:, 1] - way[:, 1] * away[:, 0])
        height = np.divide(cross, length, out=np.zeros_like(cross), where=length > 0.0)
        worst = max(worst, float(height.max(initial=0.0)))
    return worst / 4.0


def _with_patches(rail: DevelopedRail, side: int, flat: list[_Laid]) -> DevelopedRail:
    """A developed rail with the segments of patches in place of cones."""
    if not flat or not len(rail.segment):
        return rail
    back, area = rail.back.copy(), rail.area.copy()
    steps = np.diff(rail.arc, prepend=0.0)
    rows = [np.stack((rail.segment, rail.angle, rail.radius, steps), axis=1)]
    for laid in flat:
        own = laid.segments[side]
        inside = (rows[0][:, 0] >= own.start) & (rows[0][:, 0] < own.stop)
        rows[0] = rows[0][~inside]
        back[own] = area[own] = 0.0
        area[own.start] = laid.flat.area if side == 0 else 0.0
        segment, angle, radius, arc = laid.rail(side)
        rows.append(np.stack((segment, angle, radius, np.diff(arc, prepend=0.0)), axis=1))
    table: Floats = np.concatenate(rows).astype(np.float64)
    table = table[np.argsort(table[:, 0], kind="stable")]
    return DevelopedRail(
        table[:, 0].astype(np.int64), table[:, 1], table[:, 2], np.cumsum(table[:, 3]), area, back
    )

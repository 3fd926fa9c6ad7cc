"""Where a curve near a face lies in the parameters of its surface, parted at seam and poles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.TopoDS import TopoDS_Face
from scipy.interpolate import BSpline

from wrinkle_cad import settings
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]
Curve = Callable[[Floats], Floats]
"""(k,) parameters -> (k, 3) mm."""

POLE_REACH: Final = 5e-6
"""mm; a curve that passes a pole nearer than this goes through it."""

POLE_DRAW: Final = 2e-3
"""mm; the kernel cannot split at so small a distance from a pole: the curve is led through it."""

POLE_DRAW_SHARE: Final = 0.1
"""Of a curve's length: it is moved over so much of it, on both sides of the pole, at most."""

LARGEST_TURN: Final = 0.1
"""Of a period: parameters may move so far between two feet that follow each other."""

NEAREST_FEET: Final = 1e-7
"""mm; feet that jump though they are nearer than this along the curve are none of one curve."""


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A stretch of a curve whose parameters do not jump."""

    at: Floats
    """(k,) parameters of the curve, rising, k at least 5."""
    uv: Floats
    """(k, 2) parameters of the surface there."""


class FaceParameters:
    """The surface of a face, asked for the parameters of curves that lie on it."""

    def __init__(self, face: TopoDS_Face) -> None:
        surface = BRep_Tool.Surface_s(face)
        self._surface = ShapeAnalysis_Surface(surface)
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        self._low, self._high = np.array([u0, v0]), np.array([u1, v1])
        bounds = surface.Bounds()
        self._period = np.array(
            [
                surface.UPeriod()
                if surface.IsUPeriodic()
                else _span(bounds[:2], surface.IsUClosed()),
                surface.VPeriod()
                if surface.IsVPeriodic()
                else _span(bounds[2:], surface.IsVClosed()),
            ]
        )
        self._has_seam = (self._period > 0.0) & (
            self._high - self._low >= self._period * (1.0 - 1e-9)
        )
        self._poles = self._find_poles()

    def points(self, uv: Floats) -> Floats:
        """Returns (k, 3) mm at (k, 2) parameters."""
        found = [self._surface.Value(u, v) for u, v in uv.tolist()]
        return np.array([(at.X(), at.Y(), at.Z()) for at in found])

    def feet_near(self, points: Floats, guesses: Floats) -> Floats:
        """Returns the (k, 2) parameters of the feet of (k, 3) points near (k, 2) guesses."""
        return np.array([self._next_foot(*pair) for pair in zip(points, guesses, strict=True)])

    def led_through_poles(self, points: Floats) -> Floats:
        """Returns (k, 3) points of a curve, those near a pole that it passes too closely moved.

        The shift, at most ``POLE_DRAW``, fades out smoothly; the ends stay where they are.
        """
        arc = arc_lengths(points)
        for pole, _ in self._poles:
            for _ in range(2):
                line = BSpline(*cubic_through(arc, points), 3)
                for place in _passes(line, arc, pole, POLE_DRAW):
                    reach = min(POLE_DRAW_SHARE * arc[-1], place, arc[-1] - place)
                    share = np.clip((arc - place) / max(reach, settings.CONFUSION), -1.0, 1.0)
                    fade = (1.0 - share**2) ** 2
                    points = points + fade[:, None] * (pole - line(np.array([place]))[0])
        return points

    def pieces(self, curve: Curve, at: Floats) -> list[Piece] | None:
        """Returns a curve in pieces whose parameters do not jump, None where it leaves the face.

        Args:
            curve: in space, on the face at ``at``.
            at: (k,) its parameters, arc lengths in mm, rising.
        """
        pieces: list[Piece] = []
        for first, last, ends in self._between_poles(curve, at):
            # Beside a pole the direction is known only at some distance from it.
            beside = 0.1 * float(np.diff(at).min())
            inner = at[(at > first + 2.0 * beside) & (at < last - 2.0 * beside)]
            places = np.concatenate(([first, first + beside], inner, [last - beside, last]))
            followed = self._followed(curve, places, ends)
            if followed is None:
                return None
            pieces += self._parted_at_seams(curve, *followed)
        return pieces

    def _between_poles(
        self, curve: Curve, at: Floats
    ) -> list[tuple[float, float, tuple[Floats | None, Floats | None]]]:
        """Returns stretches from pole to pole, and the pole's parameters where one ends in one."""
        cuts = [
            (place, uv)
            for pole, uv in self._poles
            for place in _passes(curve, at, pole, POLE_REACH)
        ]
        stops: list[tuple[float, Floats | None]] = [*sorted(cuts, key=lambda cut: cut[0])]
        slack = 1e-3 * float(np.diff(at).min())
        if not stops or stops[0][0] > at[0] + slack:
            stops.insert(0, (float(at[0]), None))
        if stops[-1][0] < at[-1] - slack:
            stops.append((float(at[-1]), None))
        return [
            (start, end, (start_uv, end_uv)) for (start, start_uv), (end, end_uv) in pairwise(stops)
        ]

    def _followed(
        self, curve: Curve, at: Floats, poles: tuple[Floats | None, Floats | None]
    ) -> tuple[Floats, Floats] | None:
        """Returns parameters of the curve and of the surface, so dense that these do not jump."""
        ends = slice(1 if poles[0] is not None else 0, -1 if poles[1] is not None else None)
        todo = at[ends].tolist()[::-1]
        found = [self._foot(curve, todo.pop(), None)]
        while todo:
            here, uv = found[-1]
            there, next_uv = self._foot(curve, todo[-1], uv)
            if self._jumps(uv, next_uv):
                if there - here <= NEAREST_FEET:
                    return None
                todo.append(0.5 * (here + there))
                continue
            todo.pop()
            found.append((there, next_uv))
        for pole, index, place in ((poles[0], 0, at[0]), (poles[1], len(found), at[-1])):
            if pole is not None:
                beside = found[min(index, len(found) - 1)][1]
                found.insert(
                    index if index == 0 else len(found),
                    (float(place), np.where(np.isnan(pole), beside, pole)),
                )
        return np.array([place for place, _ in found]), np.array([uv for _, uv in found])

    def _foot(self, curve: Curve, at: float, before: Floats | None) -> tuple[float, Floats]:
        point = curve(np.array([at]))[0]
        if before is not None:
            return at, self._next_foot(point, before)
        found = self._surface.ValueOfUV(gp_Pnt(*point.tolist()), settings.CONFUSION)
        return at, np.array([found.X(), found.Y()])

    def _next_foot(self, point: Floats, guess: Floats) -> Floats:
        near = gp_Pnt2d(*guess.tolist())
        found = self._surface.NextValueOfUV(near, gp_Pnt(*point.tolist()), settings.CONFUSION)
        return self._unwrapped(np.array([found.X(), found.Y()]), guess)

    def _unwrapped(self, uv: Floats, near: Floats) -> Floats:
        """Returns parameters moved by whole periods to be nearest to others."""
        turns = np.where(self._period > 0.0, np.rint((near - uv) / _or_one(self._period)), 0.0)
        return np.asarray(uv + turns * self._period)

    def _jumps(self, uv: Floats, other: Floats) -> bool:
        whole = np.where(self._period > 0.0, self._period, self._high - self._low)
        return bool((np.abs(other - uv) > LARGEST_TURN * whole).any())

    def _parted_at_seams(self, curve: Curve, at: Floats, uv: Floats) -> list[Piece]:
        """Returns the pieces between the crossings of the seams, within the face's own range."""
        cuts = [(float(at[0]), uv[0]), (float(at[-1]), uv[-1])]
        for axis in np.flatnonzero(self._has_seam):
            turn = (uv[:, axis] - self._low[axis]) / self._period[axis]
            lowest, highest = int(np.ceil(turn.min() + 1e-9)), int(np.floor(turn.max() - 1e-9))
            for k in range(lowest, highest + 1):
                level = self._low[axis] + k * self._period[axis]
                side = uv[:, axis] > level
                cuts += [
                    self._crossing(curve, (at[i], uv[i]), (at[i + 1], uv[i + 1]), int(axis), level)
                    for i in np.flatnonzero(side[1:] != side[:-1])
                ]
        cuts.sort(key=lambda cut: cut[0])
        return [
            self._piece(curve, cuts[i : i + 2], at, uv)
            for i in range(len(cuts) - 1)
            if cuts[i + 1][0] - cuts[i][0] > NEAREST_FEET
        ]

    def _crossing(
        self,
        curve: Curve,
        before: tuple[float, Floats],
        after: tuple[float, Floats],
        axis: int,
        level: float,
    ) -> tuple[float, Floats]:
        """Returns where a curve crosses a seam, to 1e-10 mm along it, and the parameters there."""
        low, high = before, after
        rises = after[1][axis] > level
        while high[0] - low[0] > 1e-10 * max(1.0, high[0]):
            middle = self._foot(curve, 0.5 * (low[0] + high[0]), low[1])
            if (middle[1][axis] > level) == rises:
                high = middle
            else:
                low = middle
        uv = 0.5 * (low[1] + high[1])
        uv[axis] = level
        return 0.5 * (low[0] + high[0]), uv

    def _piece(
        self, curve: Curve, ends: Sequence[tuple[float, Floats]], at: Floats, uv: Floats
    ) -> Piece:
        (first, start), (last, end) = ends
        span = last - first
        inner = (at > first + 1e-3 * span) & (at < last - 1e-3 * span)
        places = np.concatenate(([first], at[inner], [last]))
        held = np.vstack((start, uv[inner], end))
        while len(places) < 5:
            middles = 0.5 * (places[:-1] + places[1:])
            feet = [self._foot(curve, float(place), held[i])[1] for i, place in enumerate(middles)]
            order = np.argsort(np.concatenate((places, middles)), kind="stable")
            places = np.concatenate((places, middles))[order]
            held = np.vstack((held, feet))[order]
        middle = held[len(held) // 2]
        # Whole periods back into the range that the face itself uses.
        turns = np.where(
            self._period > 0.0, np.floor((middle - self._low) / _or_one(self._period)), 0.0
        )
        return Piece(places, held - turns * self._period)

    def _find_poles(self) -> list[tuple[Floats, Floats]]:
        """Returns points in which a whole side of the parameters ends; NaN for the free one."""
        poles = []
        for axis, value in (
            (1, self._low[1]),
            (1, self._high[1]),
            (0, self._low[0]),
            (0, self._high[0]),
        ):
            along = np.linspace(self._low[1 - axis], self._high[1 - axis], 5)
            uv = np.full((5, 2), value)
            uv[:, 1 - axis] = along
            points = self.points(uv)
            if float(np.abs(points - points[0]).max()) <= settings.CONFUSION:
                free = np.full(2, np.nan)
                free[axis] = value
                poles.append((points[0], free))
        return poles


def _span(bounds: Sequence[float], is_closed: bool) -> float:
    return bounds[1] - bounds[0] if is_closed else 0.0


def _or_one(period: Floats) -> Floats:
    return np.asarray(np.where(period > 0.0, period, 1.0))


def _passes(curve: Curve, at: Floats, pole: Floats, reach: float) -> list[float]:
    """Returns where a curve passes a point within a reach in mm: its own parameters."""
    distances = np.linalg.norm(curve(at) - pole, axis=1)
    step = float(np.diff(at).max())
    places = list[float]()
    for i in map(int, np.flatnonzero(distances <= 2.0 * step)):
        is_least = distances[i] <= distances[max(i - 1, 0) : i + 2].min()
        if is_least:
            low, high = float(at[max(i - 1, 0)]), float(at[min(i + 1, len(at) - 1)])
            place = _nearest(curve, low, high, pole)
            near_before = bool(places) and place - places[-1] < step
            if norm(curve(np.array([place]))[0] - pole) <= reach and not near_before:
                places.append(place)
    return places


def _nearest(curve: Curve, low: float, high: float, point: Floats) -> float:
    """Returns where on a short stretch a curve is nearest to a point, by thirds."""
    while high - low > 1e-12 * max(1.0, abs(high)):
        a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
        if a <= low or b >= high:
            break
        first, second = np.linalg.norm(curve(np.array([a, b])) - point, axis=1)
        low, high = (low, b) if first <= second else (a, high)
    return 0.5 * (low + high)

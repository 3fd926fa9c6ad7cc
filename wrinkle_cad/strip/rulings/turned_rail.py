"""A rail turned within a gap so that its tangents lie in the other rail's tangent planes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.portable import atan2, cos, sin

from .gaps import Gap
from .rail_curve import RailCurve
from .surface import RuledStrip
from .vectors import dots, lengths

Floats = npt.NDArray[np.float64]
RailName = Literal["P", "Q"]
Stays = Literal["start", "end", "both"]
"""Which side of the gap the rail stays on as it is; on the other it moves along, unturned."""

STEEPEST: Final = 1.2
"""rad; tangents are turned by no more than this."""
LEAST_CURED: Final = 0.1
"""A turn that leaves more than all but this share of a gap's twist is not worth trying."""


@dataclass(frozen=True, slots=True, eq=False)
class TurnedRail:
    """One rail of a strip, turned within a gap against the twist there.

    The tangent of P is turned by the gap's twist, or that of Q against it, about the rulings: the
    rail moves along the sheet's normal. Where both sides of the gap are to stay, the turn is less
    its mean, so that the rail comes back.
    """

    rail: RailName
    """The rail that is turned."""
    stays: Stays
    """Which side of the gap stays."""
    amount: float
    """Share of the twist that it is turned by."""
    parameters: Floats
    """(k,) float64, rising; of the rail, where its moves are known."""
    slopes: Floats
    """(k, 3) float64, mm by the parameter; how its moves change there."""
    moves: Floats = field(init=False)
    """(k, 3) float64, mm; how far it moves there."""
    turn: float
    """rad, at the place of the gap's largest strain; right-handed about the direction from P to
    Q."""

    def __post_init__(self) -> None:
        moves = self._summed()
        if self.stays == "both":
            span = self.parameters[-1] - self.parameters[0]
            object.__setattr__(self, "slopes", self.slopes - moves[-1] / span)
            moves = self._summed()
        if self.stays == "end":
            moves = moves - moves[-1]
        object.__setattr__(self, "moves", moves)

    def _summed(self) -> Floats:
        step = np.diff(self.parameters)[:, None] * (self.slopes[:-1] + self.slopes[1:]) / 2.0
        return np.vstack((np.zeros(3), np.cumsum(step, axis=0)))

    @property
    def farthest(self) -> int:
        """Number of the parameter at which the rail moves most."""
        return int(np.argmax(lengths(self.moves)))

    @property
    def distance(self) -> float:
        """mm; how far it moves there."""
        return float(lengths(self.moves).max())

    def of(self, rail: RailCurve, *, is_closed: bool) -> RailCurve:
        """Returns the curve after its turn.

        Args:
            rail: the curve before it.
            is_closed: whether it ends where it starts.
        """
        at, low, high = self.parameters, self.parameters[0], self.parameters[-1]
        period = rail.interval[1] - rail.interval[0]

        def inside(u: Floats) -> Floats:
            return low + np.mod(u - low, period) if is_closed else u

        def point_at(u: Floats) -> Floats:
            place = np.clip(inside(u), low, high)
            cell = np.clip(np.searchsorted(at, place, side="right") - 1, 0, len(at) - 2)
            width = (at[cell + 1] - at[cell])[:, None]
            x = (place - at[cell])[:, None] / width
            a, b = self.slopes[cell], self.slopes[cell + 1]
            moved: Floats = rail.point_at(u) + self.moves[cell] + width * x * (a + x * (b - a) / 2)
            return moved

        def velocity_at(u: Floats) -> Floats:
            place = inside(u)
            beyond = (place < low) | (place > high)
            slope = [np.interp(place, at, self.slopes[:, axis]) for axis in range(3)]
            change = np.where(beyond[:, None], 0.0, np.stack(slope, axis=-1))
            turned: Floats = rail.velocity_at(u) + change
            return turned

        return RailCurve(point_at, velocity_at, rail.interval, rail.breaks)


def turned_in(
    strip: RuledStrip, gap: Gap, rail: RailName, stays: Stays, amount: float
) -> TurnedRail | None:
    """Returns a rail turned within a gap; None where that would hardly lessen the twist.

    Args:
        strip: the exact surface.
        gap: one of its gaps.
        rail: the rail to turn.
        stays: which side of the gap the rail stays on.
        amount: share of the twist that it is turned by.
    """
    sheet, run = strip.sheet, slice(gap.first, gap.last)
    twist = (sheet.twist[run, 0] + sheet.twist[run, 1]) / 2.0
    sign = 1.0 if rail == "Q" else -1.0
    at, across, normals = (
        (sheet.rulings.v, sheet.q_across, sheet.q_normal)
        if rail == "Q"
        else (sheet.rulings.u, sheet.p_across, sheet.p_normal)
    )
    width = np.diff(at[gap.first : gap.last + 1])
    moving = width > 0.0
    if not moving.any():
        return None
    wanted = np.clip(amount * twist, -STEEPEST, STEEPEST)
    rise = sign * sin(wanted) / cos(wanted) * across[run]
    normal = (normals[run, 0] + normals[run, 1]) / 2.0
    step = rise[:, None] * normal
    if stays == "both":
        step = _coming_back(step, across[run])
    turn = atan2(dots(step, normal), across[run])
    if _cured(twist, twist - sign * turn, across[run]) < LEAST_CURED * amount:
        return None
    bounds = np.concatenate((at[gap.first : gap.last][moving], at[gap.last : gap.last + 1]))
    inner = step[moving] / width[moving][:, None]
    slopes = np.vstack((inner[:1], (inner[:-1] + inner[1:]) / 2.0, inner[-1:]))
    return TurnedRail(rail, stays, amount, bounds, slopes, -float(turn[gap.place - gap.first]))


def _cured(before: Floats, after: Floats, across: Floats) -> float:
    """The share of the twist that is gone, as the mean of its square along the rail.

    Where the rail runs against the strip nothing is gained by turning it.
    """
    along = np.maximum(across, 0.0)
    old, new = (math.fsum((along * twist * twist).tolist()) for twist in (before, after))
    return 1.0 - math.sqrt(new / old) if old > 0.0 else 0.0


def _coming_back(step: Floats, across: Floats) -> Floats:
    """Steps less their mean: the rail ends where it did."""
    whole = np.cumsum(step, axis=0)[-1]
    length = float(np.cumsum(across)[-1])
    return step - across[:, None] * whole / length if length > 0.0 else step

"""How far the piece that is cut is from the surface that the verdict is about.

The piece is the strip that a search found, laid flat; the verdict is about the surface of least
twist between the same rails. Both are near each other on most strips, but not on all: between
strongly twisted rails there may be several strips that hardly bend. A straight line across the
piece is a shortest way on the strip, so it is at least as long as the segment in space between the
same two points of the rails, and as long only where that segment lies in the strip. So the piece is
the verdict's surface where the rulings of that are as long on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .rail_curve import GAUSS
from .sheet import Sheet
from .vectors import cosines

Floats = npt.NDArray[np.float64]

_ROUND_OFF: Final = 1e-9
"""A place this share of a closed rail before its cut is the cut."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatRail:
    """A rail laid flat, by arc lengths of its curve from where the strip starts."""

    arc: Floats
    """(k,) float64, mm, rising."""
    point: Floats
    """(k, 2) float64, mm; the flat points there."""


@dataclass(frozen=True, slots=True)
class CutDifference:
    """What is different between the piece that is cut and a surface of rulings."""

    longer: float
    """mm; at the ruling where this is largest, how much longer it is on the piece; negative if
    shorter."""
    ruling: float
    """mm; the length of that ruling."""
    p_arc: float
    """mm along P from where the strip starts: where that ruling is."""
    larger: float
    """How much larger the piece's area is than the surface's, as a share of that."""

    @property
    def share(self) -> float:
        """How much longer that ruling is on the piece, as a share of its length."""
        return self.longer / self.ruling if self.ruling > 0.0 else 0.0

    def is_beyond(self, share: float, length: float) -> bool:
        """Whether the piece is another surface, as far as a cutter can tell.

        Args:
            share: of the ruling's length, or of the area, that counts as none.
            length: mm that count as none along a ruling.
        """
        is_longer = abs(self.share) > share and abs(self.longer) > length
        return is_longer or abs(self.larger) > share


def cut_difference(
    sheet: Sheet, rails: tuple[FlatRail, FlatRail], area: float, *, is_closed: bool
) -> CutDifference:
    """Returns how far a flat piece is from the surface of some rulings.

    Args:
        sheet: the rulings.
        rails: P and Q of the piece.
        area: mm2; of the piece.
        is_closed: whether the piece is a closed strip, cut; then the sheet may start elsewhere.
    """
    whole = ruled_area(sheet)
    larger = area / whole - 1.0 if whole > 0.0 else 0.0
    longer, p_at = _longer(sheet, rails, is_closed=is_closed)
    # A ruling across the cut of a closed strip has its ends on either side of the piece.
    known = np.flatnonzero(np.isfinite(longer))
    if not known.size:
        return CutDifference(0.0, 0.0, 0.0, larger)
    longer = longer[known]
    worst = int(np.argmax(np.abs(longer)))
    at = known[worst]
    return CutDifference(float(longer[worst]), float(sheet.reach[at]), float(p_at[at]), larger)


def ruled_area(sheet: Sheet) -> float:
    """Returns the area in mm2 of the surface of some rulings.

    Between two rulings a point at the share `t` of them moves across by
    `sqrt((1-t)^2 a^2 + t^2 b^2 + 2 t (1-t) a b cos(phi))`, where the rails move by `a` and `b` and
    the twist is `phi`.

    Args:
        sheet: the rulings.
    """
    twist = np.abs(sheet.twist[:, 0] + sheet.twist[:, 1]) / 2.0
    a, b, turned = sheet.p_across, sheet.q_across, cosines(twist)
    moved = np.zeros_like(a)
    for at, weight in GAUSS:
        near, far = (1.0 - at) * a, at * b
        square = near * near + far * far + 2.0 * near * far * turned
        moved = moved + weight * np.sqrt(np.maximum(0.0, square))
    reach = (sheet.reach[:-1] + sheet.reach[1:]) / 2.0
    return math.fsum((reach * moved).tolist())


def _longer(
    sheet: Sheet, rails: tuple[FlatRail, FlatRail], *, is_closed: bool
) -> tuple[Floats, Floats]:
    """How much longer each ruling is on the piece in mm, NaN across its cut; where it is on P.

    A ruling with an end at the cut itself lies on either side of the piece: the side where its
    other end is, and of two such sides that where its length differs less.
    """
    longer, place = np.full(len(sheet.reach), np.nan), np.zeros(len(sheet.reach))
    is_point = rails[0].arc[-1] == 0.0 or rails[1].arc[-1] == 0.0
    for p_at, p_turn in _on_piece(rails[0], sheet.p_arc, is_closed=is_closed):
        for q_at, q_turn in _on_piece(rails[1], sheet.q_arc, is_closed=is_closed):
            x, y = (_points(rails[1], q_at) - _points(rails[0], p_at)).T
            found = np.sqrt(x * x + y * y) - sheet.reach
            is_better = ~(np.abs(longer) <= np.abs(found))
            is_better &= (p_turn == q_turn) | is_point
            longer, place = np.where(is_better, found, longer), np.where(is_better, p_at, place)
    return longer, place


def _on_piece(rail: FlatRail, arc: Floats, *, is_closed: bool) -> list[tuple[Floats, Floats]]:
    """Arc lengths within the piece, and how often the rail was run round before.

    The second of a closed rail is where the first is at the cut: the other end of the piece; the
    turns of the rest are NaN there.
    """
    length = float(rail.arc[-1])
    if not is_closed or length == 0.0:
        return [(np.minimum(arc, length), np.zeros(len(arc)))]
    turn = np.floor(arc / length + _ROUND_OFF)
    at = np.clip(arc - turn * length, 0.0, length)
    is_cut = at <= _ROUND_OFF * length
    return [(at, turn), (np.full_like(at, length), np.where(is_cut, turn - 1.0, np.nan))]


def _points(rail: FlatRail, arc: Floats) -> Floats:
    return np.stack([np.interp(arc, rail.arc, rail.point[:, axis]) for axis in (0, 1)], axis=-1)

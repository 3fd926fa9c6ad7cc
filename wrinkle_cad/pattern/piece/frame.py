"""Where a pattern piece lies: the way from the flat strip to its drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError

from .options import P_SIDE, Q_SIDE
from .piece import Floats, Outline, PatternPiece

if TYPE_CHECKING:
    from wrinkle_cad.strip.flat.unrolling import Unrolling


Numbers = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False)
class PieceFrame:
    """A rigid motion of the plane, perhaps with a reflection before it."""

    turn: complex
    """Of length 1."""
    offset: complex
    """mm."""
    is_mirrored: bool
    """Whether y is turned over first."""

    def drawn(self, points: Floats) -> Floats:
        """(k, 2) mm in the drawing of (k, 2) points of the flat strip."""
        return _pairs(self.turn * _numbers(points, self.is_mirrored) + self.offset)

    def undrawn(self, points: Floats) -> Floats:
        """(k, 2) mm in the flat strip of (k, 2) points of the drawing."""
        found = _pairs((_numbers(points, False) - self.offset) / self.turn)
        return found * np.array([1.0, -1.0]) if self.is_mirrored else found


AS_UNROLLED = PieceFrame(1.0 + 0.0j, 0.0j, False)
"""The flat strip as it is."""


def frame_of(piece: PatternPiece, unrolling: Unrolling) -> PieceFrame:
    """Returns where a piece of a strip lies.

    Args:
        piece: one of the strip's pieces, whole or cut.
        unrolling: the flat strip.

    Raises:
        InputError: the piece is none of this strip, or not of its surface but of the neutral layer
            of a thick material.
    """
    given, wanted = [], []
    rails = (
        (P_SIDE, unrolling.p_arc, unrolling.p_line, piece.p_span),
        (Q_SIDE, unrolling.q_arc, unrolling.q_line, piece.q_span),
    )
    for side, arc, line, span in rails:
        ends = _ends(piece.sew, side)
        if ends is None:
            continue
        # Q runs back along the outline, and P where the piece is mirrored.
        runs_back = (side == Q_SIDE) != piece.is_mirrored
        wanted.append(ends[::-1] if runs_back else ends)
        given.append(np.column_stack([np.interp(span, arc, line[:, axis]) for axis in range(2)]))
    start = _numbers(np.concatenate(given), piece.is_mirrored)
    end = _numbers(np.concatenate(wanted), False)
    away, there = start - start.mean(), end - end.mean()
    turn = complex((away.conj() * there).sum())
    turn /= abs(turn)
    frame = PieceFrame(turn, complex(end.mean() - turn * start.mean()), piece.is_mirrored)
    gap = float(np.abs(turn * start + frame.offset - end).max())
    if gap > piece.tolerance:
        raise InputError(
            f"The ends of the rails on piece {piece.name} are up to {gap:.3g} mm from those of the"
            f" flat strip, at most {piece.tolerance:g} mm is allowed. Pass a piece of this strip,"
            " made for no thickness."
        )
    return frame


def _ends(outline: Outline, side: int) -> Floats | None:
    """(2, 2) mm: where a side begins and ends along an outline; None if it has no such side."""
    own = outline.sides == side
    if not own.any():
        return None
    (first,) = np.flatnonzero(own & ~np.roll(own, 1))[:1] if not own.all() else (0,)
    count = int(np.count_nonzero(own))
    return outline.points[[first, (first + count) % len(own)]]


def _numbers(points: Floats, is_mirrored: bool) -> Numbers:
    x, y = points.T
    numbers: Numbers = x + (-1j if is_mirrored else 1j) * y
    return numbers


def _pairs(numbers: Numbers) -> Floats:
    return np.column_stack((numbers.real, numbers.imag))

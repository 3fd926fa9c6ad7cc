"""Several pieces in one drawing: side by side at one scale, none on top of another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wrinkle_cad import settings

from .piece import PatternPiece, frozen


def laid_out(
    pieces: Sequence[PatternPiece], *, gap: float = settings.PIECE_GAP
) -> tuple[PatternPiece, ...]:
    """Returns the pieces shifted, never turned or scaled, one above the other.

    The lower left corner of the first cut line's box comes to the origin, so that no machine
    meets a negative coordinate; every next box starts ``gap`` mm above the one before.
    """
    placed = []
    height = 0.0
    for piece in pieces:
        low = piece.cut_line.min(axis=0)
        placed.append(piece.moved(frozen(np.array((-low[0], height - low[1])))))
        height += float(np.ptp(piece.cut_line[:, 1])) + gap
    return tuple(placed)

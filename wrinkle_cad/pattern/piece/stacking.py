"""Several pieces in one drawing: side by side at one scale, none on top of another."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from wrinkle_cad import settings

from .piece import Floats, PatternPiece, frozen

Reach = Callable[[PatternPiece], Floats]


def laid_out(
    pieces: Sequence[PatternPiece],
    *,
    reach: Reach | None = None,
) -> tuple[PatternPiece, ...]:
    """Returns the pieces shifted, never turned or scaled, one above the other.

    The lower left corner of the first cut line's box comes to the origin, so that no machine
    meets a negative coordinate; every next box starts ``settings.PIECE_GAP`` above the one before.

    Args:
        pieces: any number.
        reach: more points, (k, 2) mm, that the box of a piece must hold: its texts.
    """
    placed: list[PatternPiece] = []
    height = 0.0
    for piece in pieces:
        low = piece.cut_line.min(axis=0)
        held = piece.cut_line if reach is None else np.vstack((piece.cut_line, reach(piece)))
        bottom, top = float(held[:, 1].min()), float(held[:, 1].max())
        if not placed:
            # Texts beside the first piece may lie lower than itself.
            height = min(0.0, bottom - float(low[1]))
        placed.append(piece.moved(frozen(np.array((-low[0], height - bottom)))))
        height += top - bottom + settings.PIECE_GAP
    return tuple(placed)

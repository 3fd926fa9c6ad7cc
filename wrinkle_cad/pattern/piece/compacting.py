"""A sheet's pieces moved closer together by a longer search, only on request (spyrrow, MIT).

The search changes places and half turns. It stops by the clock, so a faster machine may find a
better layout: the one thing in this package whose result depends on the machine.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import shapely

from wrinkle_cad.errors import InputError

from .nesting import NESTING_GAP, NestedSheet
from .piece import PatternPiece, frozen

_SEED: Final = 1
_SIMPLER: Final = 0.1
"""mm; outlines are simplified by this much, and widened as much, before they are compared."""


def compacted(sheet: NestedSheet, *, seconds: int) -> NestedSheet:
    """Returns the sheet with a shorter used length if one is found, else as it is.

    Args:
        sheet: pieces that fit on it.
        seconds: that the search may take; 0 for none.

    Raises:
        InputError: there is something to search for, and spyrrow is not installed.
    """
    if seconds <= 0 or len(sheet.pieces) < 2:
        return sheet
    try:
        import spyrrow
    except ImportError as error:
        raise InputError(
            "The package spyrrow, which searches for closer layouts, is not installed. Install it "
            "(pip install wrinkle-cad[nesting]), or nest without a search (0 seconds)."
        ) from error

    outlines = [_outline(piece) for piece in sheet.pieces]
    items = [
        spyrrow.Item(str(i), list(outline.exterior.coords)[:-1], 1, [0.0, 180.0])
        for i, outline in enumerate(outlines)
    ]
    instance = spyrrow.StripPackingInstance("sheet", sheet.size[1], items)
    found = instance.solve(
        spyrrow.StripPackingConfig(total_computation_time=seconds, num_workers=1, seed=_SEED)
    )
    pieces = list(sheet.pieces)
    for placed in found.placed_items:
        i = int(placed.id)
        turned = pieces[i].turned_round() if abs(placed.rotation) > 90.0 else pieces[i]
        pieces[i] = turned.moved(frozen(placed.translation))
    made = NestedSheet(tuple(pieces), sheet.index, sheet.size)
    return made if _is_better(made, sheet) else sheet


def _outline(piece: PatternPiece) -> shapely.Polygon:
    outline = shapely.Polygon(piece.cut_line).simplify(_SIMPLER)
    widened: shapely.Polygon = outline.buffer(0.5 * NESTING_GAP + _SIMPLER, join_style="mitre")
    return shapely.Polygon(widened.exterior)


def _is_better(made: NestedSheet, before: NestedSheet) -> bool:
    """Whether a layout is shorter, on the sheet and without pieces nearer than half the gap."""
    corners = np.vstack([piece.cut_line for piece in made.pieces])
    if corners.min() < 0.0 or np.any(corners.max(axis=0) > made.size):
        return False
    regions = [shapely.Polygon(piece.cut_line) for piece in made.pieces]
    near = shapely.STRtree(regions).query(regions, predicate="dwithin", distance=0.5 * NESTING_GAP)
    return bool(np.all(near[0] == near[1])) and made.used_length < before.used_length

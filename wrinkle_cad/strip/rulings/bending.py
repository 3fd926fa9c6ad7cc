"""How sharply a strip's surface is bent: at the ends of its rulings, where they are closest."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from .creases import NEAR_PER_WIDTH, SMALLEST
from .pieces import FLAT_PER_WIDTH, Piece
from .sheet import Sheet, turns_between
from .vectors import crosses, dots

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_End = tuple[Floats, Floats, Floats, Floats, tuple[Ints, Ints]]
"""Normals, way across so far, directions across, lengths of the rulings, windows around them."""

WINDOW: Final = 2
"""On torsal pieces a radius is taken over so many intervals to either side of a ruling ..."""
GAP_WINDOW_PER_WIDTH: Final = 0.125
"""... and in gaps, whose pairing makes no exact surface, over so much to either side, in shares of
the ruling's length."""
CORE: Final = 0.1
"""Nearer its apex than this share of a ruling a cone is not judged. In a sheet of some thickness
the tip of a cone is no point but a crescent with a size of its own (Chaieb and Melo, Crescent
singularities and stress focusing in a developable cone, arXiv cond-mat/9806049; Cerda, Chaieb,
Melo and Mahadevan, Nature 401, 46, 1999); the share itself is a convention."""


def radius_along(sheet: Sheet, pieces: Sequence[Piece]) -> Floats:
    """Returns (k - 1,) mm: the smallest radius of the surface in each interval between rulings.

    On ruled pieces it is taken across the rulings, at that end where it is smaller; on a cone at
    its far end and, but for a cone about a corner of the sheet, near its apex; planes have inf. A
    cone about a corner of the sheet beside a torsal piece has inf, too: nothing holds the sheet's
    free end there, which takes the bend of its neighbour. So has a piece that is so narrow and
    turns so little that, all in one ruling, it would be no crease.

    Args:
        sheet: the strip's tangent planes.
        pieces: its pieces.
    """
    radius = np.full(len(sheet.p_across), math.inf)
    for number, piece in enumerate(pieces):
        run = slice(piece.first, piece.last)
        if piece.kind in ("torsal", "gap"):
            for end in _both_ends(sheet, piece):
                radius[run] = np.minimum(radius[run], _radius_of_ruled(end))
        elif piece.kind == "cone" and not _is_slight(sheet, piece, piece.apex == "Q"):
            radius[run] = _radius_of_cone(sheet, pieces, number)
    return radius


def bulge_along(sheet: Sheet) -> Floats:
    """Returns (k - 1,) signs of the bend in each interval between rulings.

    1 where the sheet is convex as seen along ``p' x (q - p)``, -1 where it is concave, 0 where it
    does not turn.

    Args:
        sheet: the strip's tangent planes.
    """
    turned = np.zeros(len(sheet.p_across))
    for normal in (sheet.p_normal, sheet.q_normal):
        forward = crosses(sheet.direction[:-1], normal[:, 0])
        known = normal[:, 0].any(axis=1) & normal[:, 1].any(axis=1)
        turned += np.where(known, dots(normal[:, 1] - normal[:, 0], forward), 0.0)
    return np.sign(turned)


def _both_ends(sheet: Sheet, piece: Piece) -> Iterator[_End]:
    """What bends at P's end of a piece's rulings, and at Q's."""
    first, last = piece.first, piece.last
    run = slice(first, last)
    direction, reach = sheet.direction[first : last + 1], sheet.reach[first : last + 1]
    for on_p in (True, False):
        if _is_slight(sheet, piece, on_p):
            continue
        normal, across = _at_end(sheet, on_p)
        at_rulings = np.concatenate((normal[run, 0], normal[last - 1 : last, 1]))
        moved = np.concatenate(([0.0], np.cumsum(across[run])))
        half = GAP_WINDOW_PER_WIDTH * reach if piece.kind == "gap" else np.zeros_like(reach)
        windows = _windows(moved, half)
        yield at_rulings, moved, crosses(at_rulings, direction), reach, windows


def _at_end(sheet: Sheet, on_p: bool) -> tuple[Floats, Floats]:
    """Normals, and the way across the rulings, at P's end of the rulings or at Q's."""
    return (sheet.p_normal, sheet.p_across) if on_p else (sheet.q_normal, sheet.q_across)


def _is_slight(sheet: Sheet, piece: Piece, on_p: bool) -> bool:
    """Whether a piece turns so little, and on so short a way, that as a jump it is no crease."""
    run = slice(piece.first, piece.last)
    normal, across = _at_end(sheet, on_p)
    way = math.fsum(across[run].tolist())
    if way > NEAR_PER_WIDTH * float(sheet.reach[piece.first : piece.last + 1].max()):
        return False
    return math.fsum(turns_between(normal[run, 0], normal[run, 1]).tolist()) <= SMALLEST


def _radius_of_ruled(end: _End) -> Floats:
    """(k - 1,) mm: ratio of way across to turn of the normal, over a few rulings."""
    normal, moved, across, reach, (before, after) = end
    way = moved[after] - moved[before]
    turn = np.abs(dots(normal[after] - normal[before], across))
    known = normal[before].any(axis=1) & normal[after].any(axis=1)
    known &= (way > 0.0) & (turn * FLAT_PER_WIDTH * reach > way)
    at = np.divide(way, turn, out=np.full(len(way), math.inf), where=known)
    between: Floats = np.minimum(at[:-1], at[1:])
    return between


def _windows(moved: Floats, half: Floats) -> tuple[Ints, Ints]:
    """First and last ruling of the window around each ruling."""
    at = np.arange(len(moved))
    before = np.minimum(at - WINDOW, np.searchsorted(moved, moved - half))
    after = np.maximum(at + WINDOW, np.searchsorted(moved, moved + half))
    return np.maximum(before, 0), np.minimum(after, len(moved) - 1)


def _radius_of_cone(sheet: Sheet, pieces: Sequence[Piece], number: int) -> Floats:
    cone = pieces[number]
    run = slice(cone.first, cone.last)
    normal = sheet.q_normal if cone.apex == "P" else sheet.p_normal
    across = (sheet.q_across if cone.apex == "P" else sheet.p_across)[run]
    turn = turns_between(normal[run, 0], normal[run, 1])
    far: Floats = np.divide(across, turn, out=np.full(len(turn), math.inf), where=turn > 0.0)
    is_first, is_last = number == 0, number == len(pieces) - 1
    if not (is_first or is_last):
        core: Floats = CORE * far
        return core
    beside = [pieces[at] for at in (number - 1, number + 1) if 0 <= at < len(pieces)]
    if any(piece.kind == "torsal" for piece in beside):
        return np.full(len(turn), math.inf)
    return far

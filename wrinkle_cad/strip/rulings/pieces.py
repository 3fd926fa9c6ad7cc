"""A strip's surface as ordered pieces: torsal, cone, plane, gap."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from .pairing import FAN_P, RULED
from .sheet import Sheet, turns_between

Bools = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
PieceKind = Literal["torsal", "cone", "plane", "gap"]
KINDS: Final[tuple[PieceKind, ...]] = ("torsal", "cone", "plane", "gap")
_TORSAL, _CONE, _PLANE, _GAP = range(4)

NO_TWIST: Final = 1e-3
"""rad; rulings that twist less are torsal: they strain a sheet by less than 2e-7."""
FLAT_PER_WIDTH: Final = 1e5
"""A stretch is flat where its radius is so many times the length of its rulings."""

SHORTEST_PLANE: Final = 8
"""Intervals between rulings that a plane has at least."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A run of intervals between rulings whose surface is of one kind.

    - `torsal`: every ruling has one tangent plane, which turns from ruling to ruling;
    - `cone`: all rulings pass through one point, on P or on Q;
    - `plane`: the tangent plane does not turn;
    - `gap`: the tangent planes at the two ends of a ruling differ: no developable surface.
    """

    kind: PieceKind
    """What it is."""
    first: int
    """Number of its first ruling."""
    last: int
    """Number of its last ruling."""
    apex: Literal["P", "Q"] | None
    """The rail that a cone's apex lies on."""


def kinds_of(sheet: Sheet) -> Ints:
    """(k - 1,) int64 into KINDS: the kind of each interval."""
    kind = np.where(sheet.rulings.way == RULED, _TORSAL, _CONE)
    twisted = (np.abs(sheet.twist) > NO_TWIST).any(axis=1)
    kind = np.where((kind == _TORSAL) & twisted, _GAP, kind)
    flat = _long_runs((kind != _GAP) & _is_flat(sheet))
    return np.where(flat, _PLANE, kind)


def _long_runs(flat: Bools) -> Bools:
    """Leaves out short runs: where rails meet or a bend changes sides everything looks flat."""
    bounds = np.concatenate(([0], np.flatnonzero(flat[1:] != flat[:-1]) + 1, [len(flat)]))
    length = np.diff(bounds)
    long: Bools = np.repeat(length >= SHORTEST_PLANE, length)
    return flat & long


def _is_flat(sheet: Sheet) -> Bools:
    turn = np.maximum(
        turns_between(sheet.p_normal[:, 0], sheet.p_normal[:, 1]),
        turns_between(sheet.q_normal[:, 0], sheet.q_normal[:, 1]),
    )
    width = np.maximum(sheet.reach[:-1], sheet.reach[1:])
    across = sheet.p_across + sheet.q_across
    return turn * width * FLAT_PER_WIDTH <= across


def pieces_of(sheet: Sheet, crease_at: Ints) -> tuple[Piece, ...]:
    """Returns the pieces in order; they end at creases and where the kind or an apex changes.

    Args:
        sheet: the strip's tangent planes.
        crease_at: numbers of the rulings at which the sheet is creased.
    """
    kind, way = kinds_of(sheet), sheet.rulings.way
    count = len(kind)
    changes = kind[1:] != kind[:-1]
    changes |= (kind[1:] == _CONE) & (way[1:] != way[:-1])
    for piece in (sheet.rulings.p_piece, sheet.rulings.q_piece):
        changes |= (kind[1:] != _PLANE) & (piece[1:] != piece[:-1])
    cuts = np.union1d(np.flatnonzero(changes) + 1, crease_at[(crease_at > 0) & (crease_at < count)])
    bounds = [0, *(int(cut) for cut in cuts), count]
    return tuple(
        Piece(
            kind=KINDS[kind[first]],
            first=first,
            last=last,
            apex=_apex(int(way[first])) if kind[first] == _CONE else None,
        )
        for first, last in pairwise(bounds)
    )


def _apex(way: int) -> Literal["P", "Q"]:
    return "P" if way == FAN_P else "Q"


def developable_share(sheet: Sheet) -> float:
    """Returns the share, 0 to 1, of both rails' length that pieces other than gaps cover."""
    moved = np.diff(sheet.p_arc) + np.diff(sheet.q_arc)
    whole = float(np.cumsum(moved)[-1])
    covered = np.where(kinds_of(sheet) == _GAP, 0.0, moved)
    return float(np.cumsum(covered)[-1]) / whole

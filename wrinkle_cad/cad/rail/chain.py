"""Edges of whatever a caller holds, put in a row: the raw material of a directrix.

Edges may be given in any order and direction. Ends that nearly meet are moved to their middle; ends
further apart are refused, unless their own vertices or the caller say that they meet. Edges without
length are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Edge

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import curve_arrays
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import norm

from .chain_order import chain_order
from .edges_as_drawn import edges_as_drawn

Floats = NDArray[np.float64]

LOOSE_PER_SIZE: Final = 0.05
"""The share of the smaller of two edges up to which their vertices' tolerances are believed."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """The curves of one rail."""

    curves: tuple[PoleCurve, ...]
    """In order, each starting exactly where the one before it ends."""
    findings: tuple[Finding, ...]
    """What was left out or closed."""


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    curve: PoleCurve
    slack: tuple[float, float]
    """mm; how far its ends may lie from their vertices."""
    has_one_vertex: bool
    """Whether it starts and ends in the same vertex."""

    def turned(self) -> _Piece:
        return _Piece(self.curve.reversed(), self.slack[::-1], self.has_one_vertex)


def chain_of(source: object, name: str, join: float = 0.0) -> Chain:
    """Returns the curves of a source, from the start of the rail to its end.

    Args:
        source: an edge, wire, compound of edges, or several edges and wires in any order; from
            build123d, CadQuery or the kernel itself.
        name: what messages call the rail, at the start of a sentence.
        join: mm; gaps up to this are closed, and reported.

    Raises:
        InputError: no curve in the source, a surface in it, an edge of no length, an edge that
            occurs twice, or a gap.
        CadError: the kernel cannot convert an edge.
    """
    edges = edges_as_drawn(source, name)
    pieces = [_piece_of(edge) for edge in edges if not BRep_Tool.Degenerated_s(edge)]
    whole = [piece for piece in pieces if _size(piece.curve) > settings.CONFUSION]
    dropped, pieces = len(edges) - len(whole), whole or pieces
    if not pieces:
        raise InputError(f"{name} has no curve in it. Pass at least one edge.")
    _check_finite([piece.curve for piece in pieces], name)
    _check_once([piece.curve for piece in pieces], name)
    pieces, found = _joined(_in_order(pieces, name, join), name, join)
    if dropped and whole:
        found = (_dropped_finding(name, dropped), *found)
    return Chain(tuple(piece.curve for piece in pieces), found)


def _piece_of(edge: TopoDS_Edge) -> _Piece:
    curve = edge_curve(edge)
    poles, weights, knots, multiplicities = curve_arrays(curve)
    vertices = (TopExp.FirstVertex_s(edge, True), TopExp.LastVertex_s(edge, True))
    slack = [0.0 if at.IsNull() else float(BRep_Tool.Tolerance_s(at)) for at in vertices]
    return _Piece(
        PoleCurve(curve.Degree(), knots, multiplicities, poles, weights),
        (slack[0], slack[1]),
        not vertices[0].IsNull() and bool(vertices[0].IsSame(vertices[1])),
    )


def _check_finite(curves: Sequence[PoleCurve], name: str) -> None:
    for curve in curves:
        if not np.isfinite(curve.poles).all():
            raise InputError(
                f"{name} has a curve with NaN or infinite poles. Pass finite geometry."
            )
        reach = float(np.abs(curve.poles).max())
        if reach > settings.LARGEST_COORDINATE:
            raise InputError(
                f"{name} reaches to {reach:.3g} mm, as a line without ends does, and at most"
                f" {settings.LARGEST_COORDINATE:.3g} mm is allowed. Trim it to what is needed."
            )


def _check_once(curves: Sequence[PoleCurve], name: str) -> None:
    """Checks that no edge occurs twice, as the seam does in the outer wire of a cone."""
    seen: set[bytes] = set()
    for curve in curves:
        poles = np.round(curve.poles, 9) + 0.0
        keys = {rows.tobytes() for rows in (poles, poles[::-1])}
        if keys & seen:
            size = _size(curve)
            start, end = (place_text(at, size) for at in curve.poles[[0, -1]])
            raise InputError(
                f"{name} runs twice over one edge, from {start} to {end}: an edge is given twice,"
                " or it is the seam of a closed face, which its outline passes there and back. A"
                " rail passes every place once: choose its edges one by one, or leave that edge"
                " out."
            )
        seen |= keys


def _size(curve: PoleCurve) -> float:
    return float(np.ptp(curve.poles, axis=0).max())


def _in_order(pieces: Sequence[_Piece], name: str, join: float) -> list[_Piece]:
    ends = np.array([piece.curve.poles[[0, -1]] for piece in pieces])
    slack = max((max(piece.slack) for piece in pieces), default=0.0)
    meeting = max(_limit(pieces), join, 2.0 * slack)
    _check_no_branch(ends, min(meeting, _limit(pieces)), name)
    return [
        pieces[link.edge].turned() if link.is_turned else pieces[link.edge]
        for link in chain_order(ends, meeting)
    ]


def _limit(pieces: Sequence[_Piece]) -> float:
    size = max(_size(piece.curve) for piece in pieces)
    return min(settings.RAIL_GAP, settings.RAIL_GAP_PER_SIZE * size)


def _check_no_branch(ends: Floats, meeting: float, name: str) -> None:
    """Checks that no place is the end of an odd number of edges above one."""
    points = ends.reshape(-1, 3)
    for point in points if len(points) > 4 else ():
        near = int((np.abs(points - point).max(axis=1) <= meeting).sum())
        if near > 2 and near % 2:
            size = float(np.ptp(points, axis=0).max())
            raise InputError(
                f"{name} branches: {near} edges meet at {place_text(point, size)}, and a rail is"
                " one line without branches. Choose the edges of one line."
            )


def _allowed(one: _Piece, other: _Piece, limit: float) -> float:
    """Returns mm: how far the end of one edge may be from the start of the next."""
    smaller = min(_size(one.curve), _size(other.curve))
    return max(limit, min(one.slack[1] + other.slack[0], LOOSE_PER_SIZE * smaller))


def _joined(
    pieces: Sequence[_Piece], name: str, join: float
) -> tuple[list[_Piece], tuple[Finding, ...]]:
    """Returns the pieces with nearly meeting ends moved to their middle, refusing gaps."""
    limit = _limit(pieces)
    ends = np.array([piece.curve.poles[[0, -1]] for piece in pieces])
    closed: list[tuple[float, Floats]] = []
    for i in range(1, len(pieces)):
        gap = norm(ends[i, 0] - ends[i - 1, 1])
        allowed = _allowed(pieces[i - 1], pieces[i], limit)
        if gap > max(allowed, join):
            raise _gap_error(name, gap, ends[i - 1, 1], ends[i, 0], allowed)
        middle = (ends[i, 0] + ends[i - 1, 1]) / 2.0
        if gap > allowed:
            closed.append((gap, middle))
        ends[i, 0] = ends[i - 1, 1] = middle
    gap, allowed = norm(ends[0, 0] - ends[-1, 1]), _closing(pieces, limit)
    if gap <= max(allowed, join if len(pieces) > 1 else 0.0):
        middle = (ends[0, 0] + ends[-1, 1]) / 2.0
        if gap > allowed:
            closed.append((gap, middle))
        ends[0, 0] = ends[-1, 1] = middle
    joined = [
        _Piece(piece.curve.joined(*ends[i]), piece.slack, piece.has_one_vertex)
        for i, piece in enumerate(pieces)
    ]
    return joined, tuple(_closed_finding(name, gap, at) for gap, at in closed)


def _closing(pieces: Sequence[_Piece], limit: float) -> float:
    """Returns mm: how far the ends of the whole rail may be apart for it to be closed."""
    if len(pieces) > 1:
        return _allowed(pieces[-1], pieces[0], limit)
    # The ends of one edge are where its author put them; only edges are joined to one another.
    (piece,) = pieces
    if piece.has_one_vertex:
        return max(limit, min(sum(piece.slack), LOOSE_PER_SIZE * _size(piece.curve)))
    return min(limit, settings.CONFUSION)


def _gap_error(name: str, gap: float, end: Floats, start: Floats, allowed: float) -> InputError:
    places = " and ".join(f"({x:.6g}, {y:.6g}, {z:.6g})" for x, y, z in (end + 0.0, start + 0.0))
    return InputError(
        f"{name} has a gap of {gap:.4g} mm: its edges are apart at {places} mm, and at most"
        f" {allowed:.4g} mm is allowed. Pass the edges of one line, lengthen one of the two, or"
        " close the gap with the option join."
    )


def _closed_finding(name: str, gap: float, at: Floats) -> Finding:
    x, y, z = at + 0.0
    return Finding(
        "gap-closed",
        "info",
        f"{name} had a gap of {gap:.4g} mm at ({x:.6g}, {y:.6g}, {z:.6g}) mm, which was closed"
        " in its middle as asked (join).",
    )


def _dropped_finding(name: str, count: int) -> Finding:
    edges = "An edge" if count == 1 else f"{count} edges"
    are = "is" if count == 1 else "are"
    return Finding(
        "edges-without-length",
        "info",
        f"{edges} of {name[0].lower()}{name[1:]} {are} no longer than {settings.CONFUSION:g} mm and"
        f" {'was' if count == 1 else 'were'} left out.",
    )

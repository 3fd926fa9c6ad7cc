"""Nodes along a rail, evenly spaced by arc length, every corner a node twice: once per side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .rail_curve import RailCurve

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Nodes:
    """Nodes along one rail, in order."""

    u: Floats
    """(k,) float64; parameters."""
    arc: Floats
    """(k,) float64, mm; arc lengths from the rail's start; equal for the two nodes of a corner."""
    piece: Ints
    """(k,) int64; the smooth piece that each node belongs to."""
    point: Floats
    """(k, 3) float64, mm."""
    velocity: Floats
    """(k, 3) float64, mm; derivatives by the parameter on the own piece; zero for a point."""
    tangent: Floats
    """(k, 3) float64; unit tangents likewise."""

    pieces: tuple[tuple[Floats, Floats, Floats], ...]
    """Parameters, points and derivatives of the nodes of each smooth piece."""


def place_nodes(rail: RailCurve, spacing: float) -> Nodes:
    """Returns nodes at most `spacing` mm apart, evenly spaced within each smooth piece.

    Args:
        rail: the curve.
        spacing: mm, above 0.
    """
    if rail.is_point:
        u = rail.edges[:1]
        none, still = np.zeros(1, dtype=np.int64), np.zeros((1, 3))
        return Nodes(
            u, np.zeros(1), none, rail.point_at(u), still, still, ((u, rail.point_at(u), still),)
        )
    corner = rail.arc_at(rail.edges)
    # Twice as many nodes in a piece that is run backwards are the same nodes: no rounding up twice.
    counts = np.maximum(2, np.ceil(np.diff(corner) / spacing - 1e-9).astype(np.int64))
    parts, pieces = [], []
    for piece, count in enumerate(counts):
        share = np.arange(count + 1) / count
        at = rail.at_arc(corner[piece] + (corner[piece + 1] - corner[piece]) * share)
        at[0], at[-1] = rail.edges[piece], rail.edges[piece + 1]
        parts.append(at)
        pieces.append(np.full(count + 1, piece, dtype=np.int64))
    u, piece_of = np.concatenate(parts), np.concatenate(pieces)
    tangent, speed = rail.tangents(u, piece_of)
    velocity = tangent * speed[:, None]
    point, cuts = rail.point_at(u), np.cumsum(counts + 1)[:-1]
    parts_of = zip(*(np.split(values, cuts) for values in (u, point, velocity)), strict=True)
    return Nodes(u, rail.arc_at(u), piece_of, point, velocity, tangent, tuple(parts_of))

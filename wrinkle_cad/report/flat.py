"""Where the bridges of a strip lie on its pattern pieces.

A piece may be a part of the strip, mirrored, moved, or laid out at the material's middle layer, so
its bridges are found by arc length: a bridge ends where its samples' arcs in space stand on the
piece's sew line.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.pattern.piece.options import P_SIDE, Q_SIDE
from wrinkle_cad.pattern.piece.piece import PatternPiece
from wrinkle_cad.strip.curve.polyline import arc_lengths, points_at
from wrinkle_cad.strip.flat.unrolling import Unrolling
from wrinkle_cad.strip.triangulation import Triangulation


def rail_line(piece: PatternPiece, side: int) -> NDArray[np.float64]:
    """Returns (k, 2) mm, the sew line of one rail in the rail's own direction.

    Args:
        piece: the piece.
        side: ``P_SIDE`` or ``Q_SIDE``.

    Returns:
        (k, 2) mm; (1, 2) where the piece has only a corner on that rail.
    """
    points, sides = piece.sew.points, piece.sew.sides
    at = np.flatnonzero(sides == side)
    if not len(at):
        # A piece that ends in a point on this rail: the corner between start and end.
        other = np.flatnonzero(sides == P_SIDE + Q_SIDE - side)
        return points[[(int(other[-1]) + 1) % len(points)]] if len(other) else points[:1]
    breaks = np.flatnonzero(np.diff(at) > 1)
    if len(breaks):
        at = np.roll(at, -(int(breaks[0]) + 1))
    line: NDArray[np.float64] = points[np.append(at, (at[-1] + 1) % len(points))]
    runs_backwards = (side == Q_SIDE) != piece.is_mirrored
    return line[::-1] if runs_backwards else line


def bridge_ends(
    piece: PatternPiece, strip: Triangulation, unrolling: Unrolling
) -> tuple[int, NDArray[np.float64]]:
    """Lays the bridges that a piece covers onto it.

    Args:
        piece: a piece of this strip.
        strip: the strip.
        unrolling: gives the arc lengths of the strip's samples.

    Returns:
        The index of the first bridge on the piece, and (k, 2, 2) mm: the ends on P and on Q of it
        and those that follow.
    """
    p_arc = unrolling.p_arc[unrolling.p_index]
    q_arc = unrolling.q_arc[unrolling.q_index]
    p_at, q_at = p_arc[strip.bridges[:, 0]], q_arc[strip.bridges[:, 1]]
    slack = settings.SPAN_SLACK * max(float(p_arc[-1]), float(q_arc[-1]))
    covered = _within(p_at, piece.p_span, slack) & _within(q_at, piece.q_span, slack)
    index = np.flatnonzero(covered)
    if not len(index):
        return 0, np.zeros((0, 2, 2))
    ends = np.stack(
        (
            _placed(rail_line(piece, P_SIDE), piece.p_span, p_at[index]),
            _placed(rail_line(piece, Q_SIDE), piece.q_span, q_at[index]),
        ),
        axis=1,
    )
    return int(index[0]), ends


def _within(
    arcs: NDArray[np.float64], span: tuple[float, float], slack: float
) -> NDArray[np.bool_]:
    inside: NDArray[np.bool_] = (arcs >= span[0] - slack) & (arcs <= span[1] + slack)
    return inside


def _placed(
    line: NDArray[np.float64], span: tuple[float, float], arcs: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(k, 2): where arcs in space stand on a flat line that covers ``span`` of them."""
    along = arc_lengths(line)
    reach = span[1] - span[0]
    share = (arcs - span[0]) / reach if reach > 0.0 else np.zeros_like(arcs)
    return points_at(line, along, np.clip(share, 0.0, 1.0) * along[-1])

"""The figures of a strip on matplotlib axes: drawn and returned, never shown.

Colors are the page's: blue and orange keep apart for color-blind eyes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.pattern.piece.piece import PatternPiece
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.triangulation import Triangulation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

VALID_COLOR: Final = "#2f7fc4"
INFLECTION_COLOR: Final = "#b87700"
INVALID_COLOR: Final = "#cc4a00"
_INK: Final = "#17202b"
_NO_CELL: Final = "#f6f3ee"
_OTHERS: Final = (("#8a5a9e", "--"), ("#2c8a6b", ":"), ("#7a6a2f", "-."))


def plot_validity(
    ax: Axes,
    valid: NDArray[np.bool_],
    triangulation: Triangulation | None = None,
    *,
    others: Sequence[Triangulation] = (),
) -> Axes:
    """Draws the validity matrix with paths over it (Wang and Tang, Figs. 4 and 8).

    Args:
        ax: axes to draw on.
        valid: (m, n) bool; the locally convex bridges. P runs upwards, Q to the right.
        triangulation: the chosen path; its invalid bridges are marked.
        others: further paths, dashed.

    Returns:
        The same axes.
    """
    from matplotlib.colors import ListedColormap

    ax.imshow(
        valid.astype(np.uint8),
        origin="lower",
        aspect="auto",
        interpolation="nearest" if max(valid.shape) < 600 else "antialiased",
        cmap=ListedColormap([_NO_CELL, VALID_COLOR]),
        vmin=0,
        vmax=1,
    )
    for other, (color, dash) in zip(others, _OTHERS, strict=False):
        ax.plot(other.bridges[:, 1], other.bridges[:, 0], dash, color=color, label=_label(other))
    if triangulation is not None:
        i, j = triangulation.bridges.T
        ax.plot(j, i, color=_INK, linewidth=1.6, label=_label(triangulation))
        _mark_invalid(ax, triangulation, j.astype(np.float64), i.astype(np.float64))
    ax.set_xlabel("samples of Q")
    ax.set_ylabel("samples of P")
    return ax


def plot_energy(
    ax: Axes, triangulation: Triangulation, others: Sequence[Triangulation] = ()
) -> Axes:
    """Draws the bending energy at each bridge along the strip (Wang and Tang, Fig. 10c).

    Args:
        ax: axes to draw on.
        triangulation: the strip; its invalid bridges are marked at the foot.
        others: strips between the same rails, dashed, for comparison.

    Returns:
        The same axes; x in mm along the middle of both rails, y on a logarithmic scale where the
        energies differ much.
    """
    for other, (color, dash) in zip(others, _OTHERS, strict=False):
        ax.plot(along(other)[1:-1], other.bending_at, dash, color=color, label=_label(other))
    at = along(triangulation)
    ax.plot(at[1:-1], triangulation.bending_at, color=VALID_COLOR, label=_label(triangulation))
    own = triangulation.bending_at[triangulation.bending_at > 0.0]
    highest = max(float(strip.bending_at.max(initial=0.0)) for strip in (triangulation, *others))
    if len(own) and highest > 100.0 * float(np.median(own)):
        ax.set_yscale("symlog", linthresh=float(np.median(own)))
    _mark_invalid(ax, triangulation, at, np.zeros_like(at))
    ax.set_xlabel("mm along the strip")
    ax.set_ylabel("bending energy at each bridge")
    ax.legend(loc="best", fontsize="small", framealpha=0.85)
    return ax


def plot_pattern(ax: Axes, pieces: Sequence[PatternPiece]) -> Axes:
    """Draws pattern pieces one above the other, to scale.

    Args:
        ax: axes to draw on; units are mm.
        pieces: cut line solid, sew line dashed, with bridges, notches, holes and grain line.

    Returns:
        The same axes.

    Example:
        >>> from matplotlib.figure import Figure
        >>> from wrinkle_cad import WrinkleStrip
        >>> p, q = [[0, 0, 0], [50, 0, 9], [100, 0, 0]], [[0, 30, 0], [50, 30, 9], [100, 30, 0]]
        >>> axes = Figure().add_subplot()
        >>> plot_pattern(axes, WrinkleStrip(p, q, name="tent").pattern().pieces) is axes
        True
    """
    top = 0.0
    for piece in pieces:
        low, high = piece.cut_line.min(axis=0), piece.cut_line.max(axis=0)
        shift = np.array([-low[0], top - high[1]])
        _plot_piece(ax, piece, shift)
        top -= (high[1] - low[1]) * 1.3
    ax.set_aspect("equal")
    ax.set_xlabel("mm")
    ax.set_ylabel("mm")
    return ax


def along(triangulation: Triangulation) -> NDArray[np.float64]:
    """Returns (m+n-1,) mm: where each bridge stands along the middle of both rails."""
    i, j = triangulation.bridges.T
    middle: NDArray[np.float64] = (
        arc_lengths(triangulation.p)[i] + arc_lengths(triangulation.q)[j]
    ) / 2
    return middle


def _label(triangulation: Triangulation) -> str:
    named = " + ".join(triangulation.criteria)
    return f"{triangulation.search}, least {named}: {triangulation.bending:.3g}"


def _mark_invalid(
    ax: Axes, triangulation: Triangulation, x: NDArray[np.float64], y: NDArray[np.float64]
) -> None:
    """Marks interior bridges that are not locally convex at (x, y), one of each per bridge."""
    invalid = ~triangulation.valid
    invalid[[0, -1]] = False
    for at, color, label in (
        (invalid & ~triangulation.inflection, INVALID_COLOR, "not locally convex"),
        (invalid & triangulation.inflection, INFLECTION_COLOR, "inflection"),
    ):
        if at.any():
            ax.plot(x[at], y[at], "s", color=color, markersize=3.5, label=label)


def _plot_piece(ax: Axes, piece: PatternPiece, shift: NDArray[np.float64]) -> None:
    from matplotlib.collections import LineCollection

    def closed(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.vstack((points, points[:1])) + shift

    ax.add_collection(LineCollection(list(piece.rulings + shift), colors="#9db4ca", linewidths=0.4))
    if piece.has_allowance:
        ax.plot(*closed(piece.sew_line).T, "--", color=VALID_COLOR, linewidth=1.0)
    for outline in (piece.cut_line, *piece.cut_outs):
        ax.plot(*closed(outline).T, color=_INK, linewidth=1.4)
    for notch in piece.notches:
        ends = np.vstack((notch.position, notch.position + notch.direction * notch.depth)) + shift
        ax.plot(*ends.T, color="#a3006a", linewidth=1.6)
    if len(piece.drill_holes):
        ax.plot(*(piece.drill_holes + shift).T, "o", color=_INK, markersize=4, fillstyle="none")
    tail, head = piece.grain_line + shift
    arrow: dict[str, Any] = {"arrowstyle": "->", "color": "#6b6f2a"}
    ax.annotate("", xy=tuple(head), xytext=tuple(tail), arrowprops=arrow)
    ax.annotate(
        piece.name, xy=tuple(closed(piece.cut_line).mean(axis=0)), ha="center", parse_math=False
    )

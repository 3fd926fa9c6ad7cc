"""A parametric curve becomes vertices whose chords stay within a tolerance of it."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import (
    FINEST_TOLERANCE_PER_SIZE,
    SAMPLING_MARGINS,
    SHORTEST_SEGMENT_PER_LENGTH,
    SURROGATE_PER_SIZE,
    SURROGATE_PER_TOLERANCE,
    TABLE_SAG_PER_TOLERANCE,
)

from .chebyshev import Cells, FloatArray, PointAt, evaluate, fit_cells
from .chords import IndexArray, tabulate
from .placing import place_chords

FIRST_CELLS: Final = 64
"""A curve starts with so many cells of 17 points, whatever the number of its smooth pieces ..."""
FIRST_CELLS_OF_PIECE: Final = 2
"""... and each piece with at least so many."""
TABLE_SHARE: Final = 256
"""The table has at least so many points along a curve."""
MOST_TABLE_POINTS: Final = 4_000_000
CHECKS_PER_CHORD: Final = 16
LEAST_CHECKS: Final = 512
GOLDEN: Final = 0.6180339887498949
"""Checks stand at this offset from either end of a chord, off the table's dyadic parameters."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Vertices on a curve.

    Example:
        >>> import numpy as np
        >>> circle = lambda t: np.stack((9 * np.cos(t), 9 * np.sin(t), 0 * t), axis=1)
        >>> sample_curve(circle, (0.0, 3.0), 0.1)
        Samples(12 from 0 to 3)
    """

    parameters: FloatArray
    """(k,) float64, strictly increasing, from one end of the interval to the other."""
    points: FloatArray
    """(k, 3) float64, mm: the curve at the parameters."""

    def __post_init__(self) -> None:
        self.parameters.setflags(write=False)
        self.points.setflags(write=False)

    def __repr__(self) -> str:
        return f"Samples({len(self.points)} from {self.parameters[0]:g} to {self.parameters[-1]:g})"


def sample_curve(
    point_at: PointAt,
    interval: tuple[float, float],
    tolerance: float,
    *,
    breaks: Sequence[float] | FloatArray = (),
    max_chord: float | None = None,
) -> Samples:
    """Samples a curve so that no point of it is farther than ``tolerance`` from its chord.

    Chords are as long as the tolerance allows, then evened out within each smooth piece at the same
    number. A closed curve (same point at both ends) ends with its first point, and has at least two
    chords. Where the parameter stands still for a stretch, that stretch gets no vertex of its own.

    The curve run the other way has the same vertices, to round-off.

    Breaks that follow each other within 1e-6 of the curve's length merge into the one nearest its
    middle, or into the end of the interval where that is the near one, so that no chord is shorter.
    Features that are narrower than 1e-3 of a smooth piece's parameter range can be missed.

    Args:
        point_at: the curve, from (k,) float64 parameters to (k, 3) points in mm; called some ten
            times with many parameters each.
        interval: first and last parameter.
        tolerance: mm; largest distance from a curve point to its chord (the segment, not its line).
        breaks: parameters where the curve is not C1; each is a vertex. Ends of the interval may be
            among them.
        max_chord: mm; no chord is longer.

    Returns:
        The vertices, both ends of the interval included.

    Raises:
        InputError: an argument is not finite or out of range, the curve has no length, jumps or is
            not finite, or the tolerance can only be held by chords shorter than 1e-6 of its length.

    Example:
        >>> circle = lambda t: np.stack((9 * np.cos(t), 9 * np.sin(t), 0 * t), axis=1)
        >>> samples = sample_curve(circle, (0.0, 3.0), 0.1)
        >>> samples.parameters.round(3).tolist()
        [0.0, 0.272, 0.545, 0.818, 1.091, 1.364, 1.636, 1.909, 2.182, 2.455, 2.728, 3.0]
    """
    _check_lengths(tolerance, max_chord)
    corners = _corners(interval, breaks)
    for attempt, margin in enumerate(SAMPLING_MARGINS):
        edges = _first_edges(corners, FIRST_CELLS * 4**attempt)
        cells = fit_cells(
            point_at, edges, SURROGATE_PER_TOLERANCE * tolerance, share_of_extent=SURROGATE_PER_SIZE
        )
        parameters = _place(cells, corners, tolerance, margin, max_chord)
        points = evaluate(point_at, parameters)
        if float(largest_gaps(point_at, parameters, points).max()) <= tolerance:
            return Samples(parameters, points)
    raise InputError(
        f"The curve has features too narrow to follow from parameter {interval[0]:.9g} to "
        f"{interval[1]:.9g}: chords within {tolerance:.3g} mm could not be confirmed. Pass the "
        "parameters around the feature as breaks."
    )


def _check_lengths(tolerance: float, max_chord: float | None) -> None:
    for name, length in (("tolerance", tolerance), ("max_chord", max_chord)):
        if length is not None and not (math.isfinite(length) and length > 0):
            raise InputError(f"{name} cannot be {length} mm: give a finite length above 0 mm.")


def _corners(interval: tuple[float, float], breaks: Sequence[float] | FloatArray) -> FloatArray:
    """The interval's ends and the breaks between them, increasing, without repeats."""
    start, end = (float(parameter) for parameter in interval)
    if not (math.isfinite(start) and math.isfinite(end) and math.isfinite(end - start)):
        raise InputError(
            f"The interval runs from {start} to {end}. Parameters must be finite: "
            "give the first and the last one."
        )
    if not start < end:
        raise InputError(
            f"The interval runs from {start:.9g} to {end:.9g}. Its last parameter must be above "
            "the first: swap them or widen it."
        )
    inner = np.asarray(breaks, dtype=np.float64)
    if inner.ndim != 1 or not np.isfinite(inner).all():
        raise InputError(
            f"breaks cannot be an array of shape {inner.shape} with "
            f"{np.sum(~np.isfinite(inner))} values that are not finite: give a flat list of "
            "finite parameters."
        )
    outside = inner[(inner < start) | (inner > end)]
    if len(outside):
        raise InputError(
            f"The break {outside[0]:.9g} lies outside the interval from {start:.9g} to {end:.9g}: "
            "leave out breaks that are not on the curve."
        )
    return np.unique(np.concatenate(([start, end], inner)))


def _first_edges(corners: FloatArray, count: int) -> FloatArray:
    """Splits every smooth piece evenly, into ``count`` cells or a few more in all."""
    pieces = len(corners) - 1
    each = max(FIRST_CELLS_OF_PIECE, -(-count // pieces))
    shares = np.arange(each) / each
    edges = corners[:-1, None] + np.diff(corners)[:, None] * shares
    return np.unique(np.append(edges, corners[-1]))


def _place(
    cells: Cells, corners: FloatArray, tolerance: float, margin: float, max_chord: float | None
) -> FloatArray:
    """The vertices' parameters, on the polynomials that stand for the curve."""
    arc = np.sum(np.linalg.norm(np.diff(cells.nodes, axis=1), axis=2), axis=1)
    arc = np.concatenate(([0.0], np.cumsum(arc)))
    length = float(arc[-1])
    _check_size(cells.size, length, tolerance)
    # Polynomials and round-off blur lengths; a hundredth keeps chords clear of the limit.
    shortest = 1.01 * SHORTEST_SEGMENT_PER_LENGTH * length
    longest = math.inf if max_chord is None else max_chord * (1 - 1e-9)
    # A little more than a dyadic share, so that no decision hangs on round-off.
    spacing = 1.01 * min(length / TABLE_SHARE, longest / 8)
    sag = TABLE_SAG_PER_TOLERANCE * tolerance
    t, x = tabulate(cells.edges, cells.coefficients, sag, spacing, MOST_TABLE_POINTS)
    if t[-1] < corners[-1] or longest < shortest:
        raise InputError(
            f"On a curve {length:.6g} mm long, a tolerance of {tolerance:.3g} mm"
            + (" asks" if max_chord is None else f" and chords up to {max_chord:.3g} mm ask")
            + f" for too many vertices: raise {'it' if max_chord is None else 'them'}."
        )
    kept = _merged(corners, np.interp(corners, cells.edges, arc), shortest)
    index: IndexArray = np.searchsorted(t, kept).astype(np.int64)
    limits = (margin * tolerance, longest, shortest)
    parameters: FloatArray
    parameters, failed = place_chords(t, x, cells.edges, cells.coefficients, index, limits)
    if failed >= 0:
        raise InputError(
            f"From parameter {kept[failed]:.9g} to {kept[failed + 1]:.9g} of the curve the "
            f"tolerance of {tolerance:.3g} mm takes chords shorter than {shortest:.3g} mm, 1e-6 of "
            f"the curve's {length:.6g} mm. Raise the tolerance or remove the tiny edge."
        )
    return parameters


def _check_size(size: float, length: float, tolerance: float) -> None:
    if length <= 64 * np.finfo(np.float64).eps * size:
        raise InputError(
            "All points of the curve coincide. A directrix needs a length above 0 mm: "
            "choose another curve."
        )
    finest = FINEST_TOLERANCE_PER_SIZE * size
    if tolerance < finest:
        raise InputError(
            f"tolerance cannot be {tolerance:.3g} mm: at coordinates up to {size:.6g} mm, less "
            f"than {finest:.3g} mm is round-off. Raise it or move the curve to the origin."
        )


def _merged(corners: FloatArray, arc: FloatArray, shortest: float) -> FloatArray:
    """Leaves out corners too close to an end, or to one nearer the middle of the curve."""
    last = len(corners) - 1
    kept = [0, last]
    outwards = np.argsort(np.abs(arc[1:last] - 0.5 * (arc[0] + arc[last])), kind="stable")
    for i in (outwards + 1).tolist():
        after = bisect_left(kept, i)
        if arc[i] - arc[kept[after - 1]] >= shortest and arc[kept[after]] - arc[i] >= shortest:
            kept.insert(after, i)
    return corners[kept]


def largest_gaps(point_at: PointAt, parameters: FloatArray, points: FloatArray) -> FloatArray:
    """Returns how far a curve gets from each of its chords, by checks along it.

    Args:
        point_at: the curve, from (k,) float64 parameters to (k, 3) points in mm.
        parameters: (k,) float64, increasing: the chords' ends.
        points: (k, 3) float64, mm: the curve there.

    Returns:
        (k - 1,) float64, mm.

    Example:
        >>> def parabola(t):
        ...     return np.stack((t, t * t, 0 * t), axis=1)
        >>> ends = np.array([0.0, 1.0])
        >>> largest_gaps(parabola, ends, parabola(ends)).round(4).tolist()
        [0.1768]
    """
    chords = len(parameters) - 1
    count = max(CHECKS_PER_CHORD, -(-LEAST_CHECKS // chords))
    half = (np.arange(-(-count // 2)) + GOLDEN) / count
    shares = np.concatenate((half, 1.0 - half[::-1]))
    count = len(shares)
    between = parameters[:-1, None] + np.diff(parameters)[:, None] * shares
    curve = evaluate(point_at, between.ravel()).reshape(chords, count, 3)
    chord = np.diff(points, axis=0)[:, None, :]
    offset = curve - points[:-1, None, :]
    square = np.sum(chord * chord, axis=2)
    along = np.clip(np.sum(offset * chord, axis=2) / square, 0.0, 1.0)
    gaps = np.linalg.norm(offset - along[..., None] * chord, axis=2)
    largest: FloatArray = np.max(gaps, axis=1)
    return largest

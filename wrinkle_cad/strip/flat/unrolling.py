"""A triangulated strip in the plane, every length along its surface as in space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import PLANE_GAP, TURNED_BACK_PER_TOLERANCE, UNROLLING_ACCURACY
from wrinkle_cad.strip.curve.chebyshev import Cells, FloatArray, PointAt, fit_cells
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.cut_open import cut_at
from wrinkle_cad.strip.portable import atan2, cos, dot, norm, sin
from wrinkle_cad.strip.triangulation import P_STEP, Triangulation

from .development import (
    NO_RAIL,
    THINNING_SHARE,
    DevelopedRail,
    develop_rail,
    place_chain,
    thinned,
)
from .overlap import is_overlapping
from .planes import planar_runs, plane_normal, spans_of

IndexArray = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Unrolling:
    """A strip in the plane, right side up: Q on the left of P, p[0] at the origin, q[0] above it.

    Every array is read-only.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> tent = triangulate([[0, 0, 0], [3, 0, 4], [6, 0, 0]], [[0, 9, 0], [3, 9, 4], [6, 9, 0]])
        >>> unroll(tent)
        Unrolling(3 + 3 samples, 90.0 mm2)
    """

    p: FloatArray
    """(m, 2) float64, mm: flat positions of the samples of P."""
    q: FloatArray
    """(n, 2) float64, mm: flat positions of the samples of Q."""
    p_line: FloatArray
    """(k, 2) float64, mm: flat rail P as a polyline through all its samples."""
    q_line: FloatArray
    """(l, 2) float64, mm: flat rail Q as a polyline through all its samples."""
    p_arc: FloatArray
    """(k,) float64, mm: length in space along P from its start to each point of p_line."""
    q_arc: FloatArray
    """(l,) float64, mm: length in space along Q from its start to each point of q_line."""
    p_index: IndexArray
    """(m,) int64: where the samples of P stand in p_line."""
    q_index: IndexArray
    """(n,) int64: where the samples of Q stand in q_line."""
    p_length: float
    """mm: length of the flat rail P (of the curve that p_line follows)."""
    q_length: float
    """mm: length of the flat rail Q."""
    area: float
    """mm2: of the flat strip, overlaps counted as often as they are covered."""
    overlaps: bool
    """Whether the flat strip lies over itself, to within the chords between samples."""
    turned_back_count: int
    """Cones whose curve segment turns back, seen from the apex: folded in space, unfolded here."""

    def __post_init__(self) -> None:
        for name in ("p", "q", "p_line", "q_line", "p_arc", "q_arc", "p_index", "q_index"):
            getattr(self, name).setflags(write=False)

    def __repr__(self) -> str:
        return f"Unrolling({len(self.p)} + {len(self.q)} samples, {self.area:.1f} mm2)"


def unroll(triangulation: Triangulation) -> Unrolling:
    """Lays the flat triangles of a strip into the plane.

    A triangle without area is laid out along its bridge. Where both rails start in one point, the
    first bank edge runs along -y. A closed strip is cut at its first bridge (see cut_open.cut_at
    for others), and its first samples stand at both ends.

    Args:
        triangulation: the strip.

    Returns:
        The strip in the plane, every bank edge and bridge as long as in space. Its lines are the
        samples, its arc lengths those of the chords.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> tent = triangulate([[0, 0, 0], [3, 0, 4], [6, 0, 0]], [[0, 9, 0], [3, 9, 4], [6, 9, 0]])
        >>> unroll(tent).p[:, 0].round(6).tolist()
        [0.0, 5.0, 10.0]
    """
    if triangulation.is_closed:
        triangulation = cut_at(triangulation, 0)
    strip = _Chain(triangulation)
    outward = strip.before - strip.apex
    along = strip.after - strip.before
    doubled = np.linalg.norm(np.cross(outward, along), axis=1)
    angles = atan2(doubled, dot(outward, strip.after - strip.apex))
    p, q, _, _ = place_chain(triangulation.steps, angles, strip.radii, strip.start)
    p_arc, q_arc = arc_lengths(triangulation.p), arc_lengths(triangulation.q)
    return Unrolling(
        p=p,
        q=q,
        p_line=p,
        q_line=q,
        p_arc=p_arc,
        q_arc=q_arc,
        p_index=np.arange(len(p)),
        q_index=np.arange(len(q)),
        p_length=float(p_arc[-1]),
        q_length=float(q_arc[-1]),
        area=0.5 * float(np.sum(doubled)),
        overlaps=is_overlapping(p, q),
        turned_back_count=0,
    )


def unroll_cones(
    triangulation: Triangulation,
    p_samples: Samples,
    q_samples: Samples,
    p_at: PointAt,
    q_at: PointAt,
    *,
    tolerance: float,
) -> Unrolling:
    """Lays a strip of cones into the plane: each triangle's bank edge replaced by the exact curve.

    The cone over a P-step has its apex at q[j] and ends in the curve between the samples p[i] and
    p[i+1]; a Q-step likewise. Its polar angle is the integral of sqrt(1 - r'(s)^2) / r(s) over the
    curve's arc length s, with r the distance from the apex. Derivatives come from polynomials of
    degree 16 between samples, halved where the curve needs it, so a curve with knots inside a
    segment (C1 or smoother) is followed as well. What lies in one plane (planar_runs) stays as it
    is. Elsewhere, where a segment turns back as seen from its apex, the cone is folded by 180
    degrees in space; it is unfolded here and counted. An apex may be an end of its segment (rails
    that meet). A rail that is a point has one sample and no length.

    Args:
        triangulation: the strip, its p and q the points of the samples.
        p_samples: where P was sampled; each corner of the curve (not C1) among the samples.
        q_samples: where Q was sampled, likewise.
        p_at: curve P, from (k,) parameters to (k, 3) points in mm; called some ten times.
        q_at: curve Q, likewise.
        tolerance: mm; the flat lines follow the flat curves at least this closely.

    Returns:
        The strip in the plane; seam lengths are those of the curves, area that of the cones.

    Raises:
        InputError: the tolerance is no positive length, the samples are not those of the
            triangulation, or a curve is not finite or jumps.

    Example:
        >>> from wrinkle_cad.strip import sample_curve, triangulate
        >>> p_at = lambda t: np.stack((9 * np.cos(t), 9 * np.sin(t), 0 * t), axis=1)
        >>> q_at = lambda t: np.stack((9 * np.cos(t), 9 * np.sin(t), 5 + 0 * t), axis=1)
        >>> p, q = (sample_curve(curve, (0.0, 2.0), 0.01) for curve in (p_at, q_at))
        >>> flat = unroll_cones(triangulate(p.points, q.points), p, q, p_at, q_at, tolerance=1e-3)
        >>> round(flat.p_length, 2), round(flat.area, 1)
        (18.0, 90.0)
    """
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise InputError(f"tolerance cannot be {tolerance} mm: give a finite length above 0 mm.")
    _check_samples("P", p_samples, triangulation.p)
    _check_samples("Q", q_samples, triangulation.q)
    chain = developed_chain(triangulation, (p_samples, q_samples), (p_at, q_at), tolerance)
    return chain.in_plane(tolerance)


def backward_sweeps(
    triangulation: Triangulation,
    p_samples: Samples,
    q_samples: Samples,
    p_at: PointAt,
    q_at: PointAt,
    *,
    tolerance: float,
) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Returns how far the bank curves of cones turn back, as seen from their apexes.

    The arguments are those of ``unroll_cones``.

    Returns:
        For P and for Q: (k - 1,) float64, mm, how far the closing ruling is swept backwards in all
        while the curve between two samples is run through; (k - 1, 3) float64, mm, the apexes.
    """
    strip = _Chain(triangulation)
    flat_p, flat_q = _both_developed(strip, (p_samples, q_samples), (p_at, q_at), tolerance)
    is_p = strip.is_p
    return (
        (strip.radii[is_p] * flat_p.back, strip.apex[is_p]),
        (strip.radii[~is_p] * flat_q.back, strip.apex[~is_p]),
    )


def _both_developed(
    strip: _Chain,
    samples: tuple[Samples, Samples],
    curves: tuple[PointAt, PointAt],
    tolerance: float,
) -> tuple[DevelopedRail, DevelopedRail]:
    cells = exact_rails(curves, samples)
    planes = _planes(strip.triangulation, cells, samples)
    (p_cells, q_cells), (p_samples, q_samples), is_p = cells, samples, strip.is_p
    return (
        _developed(p_cells, p_samples, strip.apex[is_p], planes[is_p], tolerance),
        _developed(q_cells, q_samples, strip.apex[~is_p], -planes[~is_p], tolerance),
    )


@dataclass(frozen=True, slots=True, eq=False)
class DevelopedChain:
    """Cones over the segments of both rails, and the order in which they follow each other."""

    steps: NDArray[np.int8]
    """(m+n-2,) int8; P_STEP or Q_STEP: the rail that the next segment lies on."""
    bridges: IndexArray
    """(m+n-2, 2) int64; the bridge before each step."""
    radii: FloatArray
    """(m+n-2,) float64, mm; length of the bridge after each step."""
    start: float
    """mm; length of the first bridge."""
    rails: tuple[DevelopedRail, DevelopedRail]
    """P and Q."""

    def in_plane(self, tolerance: float) -> Unrolling:
        """Returns the cones side by side; lines follow the rails to ``tolerance`` mm."""
        is_p, (flat_p, flat_q) = self.steps == P_STEP, self.rails
        angles = np.empty(len(is_p))
        angles[is_p] = flat_p.angle[_last_of_segments(flat_p)]
        angles[~is_p] = flat_q.angle[_last_of_segments(flat_q)]
        p, q, p_from, q_from = place_chain(self.steps, angles, self.radii, self.start)
        i, j = self.bridges.T
        p_line, p_arc, p_index = _line(p, q[j[is_p]], p_from, flat_p, tolerance)
        q_line, q_arc, q_index = _line(q, p[i[~is_p]], -q_from, flat_q, tolerance, turn=-1)
        limit = TURNED_BACK_PER_TOLERANCE * tolerance
        backs = (self.radii[is_p] * flat_p.back, self.radii[~is_p] * flat_q.back)
        return Unrolling(
            p=p,
            q=q,
            p_line=p_line,
            q_line=q_line,
            p_arc=p_arc,
            q_arc=q_arc,
            p_index=p_index,
            q_index=q_index,
            p_length=float(p_arc[-1]),
            q_length=float(q_arc[-1]),
            area=math.fsum([*flat_p.area.tolist(), *flat_q.area.tolist()]),
            overlaps=is_overlapping(p, q),
            turned_back_count=int(sum(np.sum(back > limit) for back in backs)),
        )


def developed_chain(
    triangulation: Triangulation,
    samples: tuple[Samples, Samples],
    curves: tuple[PointAt, PointAt],
    tolerance: float,
) -> DevelopedChain:
    """Returns the cones of a strip, each developed about its apex.

    Args:
        triangulation: the strip.
        samples: of P and of Q, its points.
        curves: P and Q, from (k,) parameters to (k, 3) mm.
        tolerance: mm; the flat lines will follow the flat curves at least this closely.
    """
    strip = _Chain(triangulation)
    rails = _both_developed(strip, samples, curves, tolerance)
    return DevelopedChain(triangulation.steps, strip.bridges, strip.radii, strip.start, rails)


class _Chain:
    """The triangles of a strip as apex, bank edge and closing bridge, one row per step."""

    def __init__(self, triangulation: Triangulation) -> None:
        self.triangulation = triangulation
        points_p, points_q = triangulation.p, triangulation.q
        self.is_p = triangulation.steps == P_STEP
        self.bridges = triangulation.bridges[:-1]
        i, j = self.bridges.T
        last_i, last_j = triangulation.bridges[1:].T
        choose = self.is_p[:, None]
        self.apex = np.where(choose, points_q[j], points_p[i])
        self.before = np.where(choose, points_p[i], points_q[j])
        self.after = np.where(choose, points_p[last_i], points_q[last_j])
        self.radii = np.linalg.norm(self.after - self.apex, axis=1)
        self.start = norm(points_p[0] - points_q[0])


def _check_samples(name: str, samples: Samples, points: FloatArray) -> None:
    if samples.points.shape != points.shape:
        raise InputError(
            f"{name} has {len(samples.points)} samples for {len(points)} points of the strip. They "
            "must be the same: pass the samples that were triangulated."
        )
    gap = float(np.max(np.abs(samples.points - points)))
    if gap > 1e-9 * float(np.max(np.abs(points))):
        raise InputError(
            f"The samples of {name} lie up to {gap:.3g} mm from the strip's points. They must be "
            "the same: pass the samples that were triangulated."
        )


def exact_rails(
    curves: tuple[PointAt, PointAt], samples: tuple[Samples, Samples]
) -> tuple[Cells | None, Cells | None]:
    """Returns both rails as polynomials between their samples; None for one that is a point."""
    p, q = (
        None
        if len(sampled.parameters) == 1
        else fit_cells(curve, sampled.parameters, math.inf, share_of_extent=UNROLLING_ACCURACY)
        for curve, sampled in zip(curves, samples, strict=True)
    )
    return p, q


def _planes(
    triangulation: Triangulation,
    cells: tuple[Cells | None, Cells | None],
    samples: tuple[Samples, Samples],
) -> FloatArray:
    """(m+n-2, 3): unit normals of the planes that steps lie in, zero for cones."""
    parameters = samples[0].parameters, samples[1].parameters
    runs = planar_runs(triangulation, cells, parameters, PLANE_GAP)
    planes = np.zeros((len(runs), 3))
    for first, last in spans_of(runs):
        planes[first:last] = plane_normal(triangulation, first, last)
    return planes


def _developed(
    cells: Cells | None,
    samples: Samples,
    apexes: FloatArray,
    planes: FloatArray,
    tolerance: float,
) -> DevelopedRail:
    if cells is None:
        return NO_RAIL
    return develop_rail(cells, samples.parameters, apexes, planes, tolerance)


def _last_of_segments(flat: DevelopedRail) -> IndexArray:
    """Where the segments end among the points of a developed rail."""
    ends = np.flatnonzero(np.diff(flat.segment, append=-1))
    return ends.astype(np.int64)


def _line(
    samples: FloatArray,
    apexes: FloatArray,
    outward: FloatArray,
    flat: DevelopedRail,
    tolerance: float,
    turn: int = 1,
) -> tuple[FloatArray, FloatArray, IndexArray]:
    """A flat rail as a polyline, its arc lengths, and where the samples stand in it."""
    k = flat.segment
    x, y = outward[k].T
    cosine, sine = cos(flat.angle), turn * sin(flat.angle)
    turned = np.stack((x * cosine - y * sine, x * sine + y * cosine), axis=1)
    line = np.concatenate((samples[:1], apexes[k] + flat.radius[:, None] * turned))
    ends = _last_of_segments(flat) + 1
    line[ends] = samples[1:]
    keep = thinned(line, k, THINNING_SHARE * tolerance)
    arc = np.concatenate(([0.0], flat.arc))
    index = np.concatenate(([0], (np.cumsum(keep) - 1)[ends]))
    return line[keep], arc[keep], index

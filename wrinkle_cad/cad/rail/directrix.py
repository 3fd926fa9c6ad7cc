"""A directrix: one of the two rails of a strip, whatever it was made from.

However many edges it consists of and however these are parametrised, it has one parameter: each
edge's own, mapped linearly onto a stretch as long as the edge, one edge after the other. So the
parameter runs from 0 to the length of the rail, near the arc length but not equal to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.Geom import Geom_BSplineCurve
from OCP.GeomAdaptor import GeomAdaptor_Curve
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.errors import Finding, InputError
from wrinkle_cad.strip.curve.polyline import polyline_length, segment_lengths
from wrinkle_cad.strip.portable import dot

from .apex import apex_in
from .chain import chain_of

if TYPE_CHECKING:
    from wrinkle_cad.strip.curve.sampling import Samples

Floats = NDArray[np.float64]
_Measure = Callable[[PoleCurve, Floats], Floats]


@dataclass(frozen=True, slots=True, eq=False)
class Directrix:
    """One rail: a curve of one or more B-spline edges with one parameter for all of them."""

    name: str
    """What messages call it; "" if nobody named it."""

    pieces: tuple[PoleCurve, ...]
    """The edges as numbers, in order; their knots are values of the global parameter."""

    curves: tuple[Geom_BSplineCurve, ...]
    """The same edges as curves of the kernel: world coordinates, mm, along the rail."""

    interval: tuple[float, float]
    """First and last parameter: 0 and the length in mm."""

    breaks: tuple[float, ...]
    """Parameters strictly inside where edges meet or the curve is not C1; increasing."""

    length: float
    """Length in mm."""

    is_closed: bool
    """Whether it ends where it starts."""

    is_polyline: bool
    """Whether it was given as points, which are then its samples as they are."""

    is_reversed: bool
    """Whether it runs against what it was made from."""

    findings: tuple[Finding, ...] = ()
    """What was left out of what it was made from, or closed."""

    def __repr__(self) -> str:
        count = len(self.pieces)
        return (
            f"Directrix({self.name!r}, {self.length:.6g} mm,"
            f" {count} {'edge' if count == 1 else 'edges'})"
        )

    @property
    def is_point(self) -> bool:
        """Whether it has no length: the strip to it is a cone."""
        return self.length == 0.0

    def point_at(self, parameters: Floats) -> Floats:
        """Returns (k, 3) mm at (k,) parameters; those outside the interval count as its ends."""
        return self._evaluate(parameters, PoleCurve.point_at)

    def velocity_at(self, parameters: Floats) -> Floats:
        """Returns (k, 3) mm: derivatives by the parameter at (k,) parameters.

        At a break it is the derivative of what follows.
        """
        return self._evaluate(parameters, PoleCurve.velocity_at)

    def tangent_at(self, parameters: Floats) -> Floats:
        """Returns (k, 3) unit tangents at (k,) parameters.

        At a break it is the tangent of what follows; zero where the curve stands still (a cusp).
        """
        velocity = self.velocity_at(parameters)
        speed = np.linalg.norm(velocity, axis=1, keepdims=True)
        tangent: Floats = velocity / np.where(speed > 0.0, speed, 1.0)
        return tangent

    def piece_at(self, parameters: Floats) -> NDArray[np.int64]:
        """Returns (k,) int64: the edge each of (k,) parameters lies in; the later one of two."""
        starts = np.array([piece.knots[0] for piece in self.pieces[1:]])
        return np.asarray(np.searchsorted(starts, parameters, side="right"), dtype=np.int64)

    def _evaluate(self, parameters: Floats, measure: _Measure) -> Floats:
        inside = np.clip(np.asarray(parameters, dtype=np.float64), *self.interval)
        if len(self.pieces) == 1:
            return measure(self.pieces[0], inside)
        found, owner = np.empty((len(inside), 3)), self.piece_at(inside)
        for i in np.unique(owner):
            mine = owner == i
            found[mine] = measure(self.pieces[i], inside[mine])
        return found


def make_directrix(source: object, *, name: str = "", join: float = 0.0) -> Directrix:
    """Returns the directrix that a curve or a row of points describes.

    Args:
        source: an edge, a wire, a compound of edges or a list of edges and wires (build123d,
            CadQuery or the kernel's own), in any order: the rail starts where its first edge, as
            drawn or stored, starts; or points (k, 3) in mm, joined by straight lines, which are
            then the samples; or a directrix, returned as it is. A vertex, an edge without length or
            a single row is a point, the apex of a cone.
        name: what messages call it.
        join: mm; gaps between edges up to this are closed, and reported in ``findings``.

    Raises:
        InputError: no curve; NaN or infinite coordinates; no length; edges that do not meet within
            1e-3 mm (1e-4 of their size, if that is less), their vertices' tolerances or ``join``;
            points that repeat.
        CadError: the kernel cannot make a B-spline of an edge.
    """
    if isinstance(source, Directrix):
        return source
    label = f"Rail {name}" if name else "The rail"
    points = _points_in(source)
    apex = apex_in(source if points is None else points)
    if apex is not None:
        return _point(name, apex)
    if points is not None:
        return assembled(name, label, [_polyline(points, label)], is_polyline=True)
    chain = chain_of(source, label, join)
    return replace(assembled(name, label, chain.curves), findings=chain.findings)


def _point(name: str, place: Floats) -> Directrix:
    """Returns the directrix without length at (3,) mm."""
    poles, ends = np.array([place, place]), np.array([2, 2])
    piece = PoleCurve(1, np.array([0.0, 1.0]), ends, poles, None)
    return Directrix(
        name=name,
        pieces=(piece,),
        curves=(_kernel_curve(piece),),
        interval=(0.0, 0.0),
        breaks=(),
        length=0.0,
        is_closed=False,
        is_polyline=False,
        is_reversed=False,
    )


def _points_in(source: object) -> Floats | None:
    """Returns (k, 3) if the source is an array or a list of points, else None."""
    if isinstance(source, np.ndarray):
        return np.array(source, dtype=np.float64)
    if not isinstance(source, Sequence) or isinstance(source, str) or not source:
        return None
    rows = [_coordinates(item) for item in source]
    if any(row is None for row in rows):
        return None
    try:
        return np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        return None


def _coordinates(item: object) -> tuple[object, ...] | None:
    """Returns the coordinates of a point: numbers in a row, or a vector of a CAD library."""
    if isinstance(getattr(item, "wrapped", item), TopoDS_Shape) or isinstance(item, str):
        return None
    to_tuple = getattr(item, "toTuple", None)  # CadQuery's Vector, which cannot be iterated
    if callable(to_tuple):
        item = to_tuple()
    return tuple(item) if isinstance(item, Iterable) else None


def _polyline(points: Floats, label: str) -> PoleCurve:
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        raise InputError(
            f"{label} cannot be an array of shape {points.shape}: pass one of shape (k, 3), a row"
            " of x, y, z in mm per point."
        )
    if not np.isfinite(points).all():
        raise InputError(f"{label} has points with NaN or infinite coordinates. Remove them.")
    chords = segment_lengths(points)
    if chords.min() <= settings.CONFUSION:
        i = int(chords.argmin())
        raise InputError(
            f"{label} has points {i + 1} and {i + 2} that are {chords[i]:.3g} mm apart; more than"
            f" {settings.CONFUSION:.0e} mm is needed. Remove one of them."
        )
    multiplicities = np.ones(len(points), dtype=np.int64)
    multiplicities[[0, -1]] = 2
    return PoleCurve(1, np.concatenate(([0.0], chords.cumsum())), multiplicities, points, None)


def assembled(
    name: str,
    label: str,
    pieces: Sequence[PoleCurve],
    *,
    is_polyline: bool = False,
) -> Directrix:
    """Returns the directrix of edges that follow each other.

    Args:
        name: what messages call it; "" if nobody named it.
        label: what a message calls it all the same.
        pieces: the edges, in any parameter.
        is_polyline: whether it was given as points.

    Raises:
        InputError: it has no length.
    """
    lengths = [_length(piece) for piece in pieces]
    total = float(sum(lengths))
    if not total > settings.RAIL_LENGTH_MIN:
        raise InputError(
            f"{label} is {total:.3g} mm long, more than {settings.RAIL_LENGTH_MIN:.0e} mm is"
            " needed. Pass a longer curve."
        )
    joints = np.concatenate(([0.0], np.cumsum(lengths)))
    placed = tuple(
        piece.stretched(float(joints[i]), float(joints[i + 1])) for i, piece in enumerate(pieces)
    )
    inner = [knot for piece in placed for knot in _jumps(piece)]
    breaks = sorted({*inner, *joints[1:-1].tolist()})
    return Directrix(
        name=name,
        pieces=placed,
        curves=tuple(_kernel_curve(piece) for piece in placed),
        interval=(0.0, float(joints[-1])),
        breaks=tuple(breaks),
        length=total,
        is_closed=bool(np.array_equal(placed[0].poles[0], placed[-1].poles[-1])),
        is_polyline=is_polyline,
        is_reversed=False,
    )


def _kernel_curve(piece: PoleCurve) -> Geom_BSplineCurve:
    return make_curve(piece.poles, piece.knots, piece.multiplicities, piece.degree, piece.weights)


def _length(piece: PoleCurve) -> float:
    if piece.degree == 1:
        return polyline_length(piece.poles)
    with kernel_step("measure the length of a rail"):
        # Measured over a parameter as long as the poles, where the kernel's tolerances make sense.
        size = polyline_length(piece.poles)
        adaptor = GeomAdaptor_Curve(_kernel_curve(piece.stretched(0.0, max(size, 1e-12))))
        return float(GCPnts_AbscissaPoint.Length_s(adaptor, settings.LENGTH_ERROR))


def _jumps(piece: PoleCurve) -> list[float]:
    """Returns the knots inside the piece where its derivative jumps."""
    at = piece.knots[1:-1][piece.multiplicities[1:-1] >= piece.degree]
    before, after = piece.velocity_at(at, "left"), piece.velocity_at(at, "right")
    jump = np.linalg.norm(after - before, axis=1)
    speed = np.maximum(np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1))
    return [float(knot) for knot in at[jump > settings.RAIL_JUMP * speed]]


def reversed_directrix(directrix: Directrix) -> Directrix:
    """Returns the directrix run the other way: the point at u is the given one's at length - u."""
    start, end = directrix.interval
    pieces = tuple(
        piece.reversed().stretched(
            start + end - float(piece.knots[-1]), start + end - float(piece.knots[0])
        )
        for piece in directrix.pieces[::-1]
    )
    return replace(
        directrix,
        pieces=pieces,
        curves=tuple(_kernel_curve(piece) for piece in pieces),
        breaks=tuple(start + end - at for at in directrix.breaks[::-1]),
        is_reversed=not directrix.is_reversed,
    )


def sample_directrix(
    directrix: Directrix, tolerance: float, max_chord: float | None = None
) -> Samples:
    """Returns vertices on a directrix whose chords lie within ``tolerance`` mm of it.

    A directrix given as points has these as its vertices, whatever the tolerance and ``max_chord``.

    Raises:
        InputError: a tolerance or ``max_chord`` that is not positive, or too fine.
    """
    # Compiled code is loaded when it is needed, not when a file is read.
    from wrinkle_cad.strip.curve.sampling import Samples, sample_curve

    if directrix.is_point:
        return Samples(np.zeros(1), directrix.pieces[0].poles[:1].copy())
    if directrix.is_polyline:
        (piece,) = directrix.pieces
        return Samples(piece.knots.copy(), piece.poles.copy())
    return sample_curve(
        directrix.point_at,
        directrix.interval,
        tolerance,
        breaks=directrix.breaks,
        max_chord=max_chord,
    )


def orient_alike(p: Directrix, q: Directrix) -> tuple[Directrix, Directrix, bool]:
    """Returns P, and Q turned to run the way P does, and whether it had to be turned.

    Open rails run alike if their starts and their ends are nearer together, in sum, than each start
    and the other's end. If that says nothing (a tie within 1e-9 of the lengths, as when one rail
    is closed), points at equal shares of the parameter decide, by their mean distance. Two closed
    rails run alike if the areas they enclose face the same way. A tie to the last stays as it is.
    """
    turned = reversed_directrix(q)
    if p.is_closed and q.is_closed:
        against = float(dot(_area_vector(p), _area_vector(q))) < 0.0
    else:
        tie = 1e-9 * (p.length + q.length)
        gain = _mean_distance(p, q, 2) - _mean_distance(p, turned, 2)
        if abs(gain) <= tie:
            gain = _mean_distance(p, q, 65) - _mean_distance(p, turned, 65)
        against = gain > tie
    return p, turned if against else q, against


def _mean_distance(p: Directrix, q: Directrix, count: int) -> float:
    at_p, at_q = (rail.point_at(np.linspace(*rail.interval, count)) for rail in (p, q))
    return float(np.linalg.norm(at_p - at_q, axis=1).mean())


def _area_vector(directrix: Directrix) -> Floats:
    """Returns (3,) mm^2: twice the area enclosed, along the normal it is seen counter-clockwise."""
    points = directrix.point_at(np.linspace(*directrix.interval, 257))
    points -= points[0]
    return np.asarray(np.cross(points[:-1], points[1:]).sum(axis=0), dtype=np.float64)


def check_distinct(p: Directrix, q: Directrix) -> None:
    """Checks that two rails are not one and the same curve, run either way, at any speed.

    Each is compared with the other at 257 points of its own. Rails that coincide over a stretch
    only are not refused.

    Raises:
        InputError: no point of either is further from the other than 1e-6 of its length.
    """
    apart = max(_largest_distance(p, q), _largest_distance(q, p))
    limit = settings.RAILS_APART_PER_LENGTH * min(p.length, q.length)
    if apart <= limit:
        names = " and ".join(rail.name or default for rail, default in ((p, "P"), (q, "Q")))
        raise InputError(
            f"Rails {names} are the same curve: they are at most {apart:.3g} mm apart, more than"
            f" {limit:.3g} mm is needed. Choose two different curves."
        )


def _largest_distance(p: Directrix, q: Directrix) -> float:
    """Returns mm: the largest distance of points on P from Q; too large, if at all."""
    points = p.point_at(np.linspace(*p.interval, 257))
    parameters = np.union1d(np.linspace(*q.interval, 1025), q.breaks)
    rail = q.point_at(parameters)
    nearest = np.array([((rail - point) ** 2).sum(axis=1).argmin() for point in points])
    u = parameters[nearest]
    best = np.linalg.norm(q.point_at(u) - points, axis=1)
    for _ in range(20):
        velocity = q._evaluate(u, PoleCurve.velocity_at)
        speed2 = np.maximum((velocity**2).sum(axis=1), np.finfo(np.float64).tiny)
        u = np.clip(u + ((points - q.point_at(u)) * velocity).sum(axis=1) / speed2, *q.interval)
        best = np.minimum(best, np.linalg.norm(q.point_at(u) - points, axis=1))
    return float(best.max())

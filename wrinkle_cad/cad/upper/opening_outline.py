"""The outline of an opening: two sides along the rails and two ends, as points on the upper.

A side follows its rail, moved outward (away from the other rail) by the margin. The margin fades
to nothing at both ends of the rails, so that sides and rails meet there: the opening is a lens
around the strip. An end is the nearest curve on the upper to the straight end bridge, or nothing
where the rails meet in a point or end on the upper's own border. Closed rails have no ends: the
opening is a ring, its margin the same all around.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.polyline import (
    arc_lengths,
    points_at,
    polyline_length,
    segment_lengths,
)
from wrinkle_cad.strip.portable import dot, norm, sin

from .plane_path import path_in_plane
from .projection import Feet, UpperFaces
from .smooth import is_ring

Floats = NDArray[np.float64]

FEET_PER_LENGTH: Final = 1e-3
"""A rail whose feet on the upper span less than this share of its length stands on it upright."""

JUMP: Final = 4.0
"""Feet further apart than so many steps of the curve have jumped."""

MARGIN_HELD: Final = 0.1
"""A side must leave its rail by so much of the margin."""

STANDING_PER_LENGTH: Final = 1e-8
"""Feet that follow each other within this share of their whole length are one point."""


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One line of the outline, from the start of the strip to its end, or from P to Q."""

    name: str
    """``p``, ``q``, ``start`` or ``end``."""
    points: Floats
    """(k, 3) mm, on the upper."""
    normals: Floats
    """(k, 3) unit normals of the upper."""
    inward: Floats
    """(k, 3) unit vectors along the upper, into the opening."""
    faces: NDArray[np.int64]
    """(k,) index of the face that each point lies on."""

    @property
    def is_ring(self) -> bool:
        """Whether its last point is its first one again."""
        return is_ring(self.points)


@dataclass(frozen=True, slots=True, eq=False)
class Rail:
    """A rail as it lies on the upper."""

    shares: Floats
    """(k,) arc length from its start, as a share of the whole, 0 to 1."""
    feet: Feet
    """Where its points lie on the upper."""
    tangents: Floats
    """(k, 3) unit tangents."""
    length: float
    """mm."""

    @property
    def points(self) -> Floats:
        """(k, 3) mm."""
        return self.feet.points

    @property
    def is_ring(self) -> bool:
        """Whether its last point is its first one again."""
        return is_ring(self.points)


def rail_on(upper: UpperFaces, directrix: Directrix, name: str) -> Rail:
    """Returns a directrix as it lies on the upper, at points even in its arc length.

    Raises:
        InputError: its feet, or some that follow each other, are one point.
    """
    parameters = _even_parameters(directrix, settings.RAIL_POINTS)
    given = directrix.point_at(parameters)
    feet = upper.feet(given)
    if directrix.is_closed:
        feet = _closed_up(feet)
    own = polyline_length(given)
    steps = segment_lengths(feet.points)
    length = polyline_length(feet.points)
    if not length > max(settings.RAIL_LENGTH_MIN, FEET_PER_LENGTH * own):
        raise InputError(
            f"The feet of rail {name} on the upper are one point: the rail is {own:.4g} mm long,"
            f" its feet span {length:.3g} mm. Draw it along the upper."
        )
    if steps.min() <= STANDING_PER_LENGTH * length:
        at = own * (int(steps.argmin()) + 0.5) / len(steps)
        raise InputError(
            f"Rail {name} stands upright on the upper at {at:.4g} mm of its {own:.4g} mm: its feet"
            " are one point there. Draw it along the upper."
        )
    return Rail(arc_lengths(feet.points) / length, feet, _tangents(feet.points), length)


def _closed_up(feet: Feet) -> Feet:
    """The feet of a ring, the last one the first again to the last digit."""
    points, normals = feet.points.copy(), feet.normals.copy()
    points[-1], normals[-1] = points[0], normals[0]
    return replace(feet, points=points, normals=normals)


def _tangents(points: Floats) -> Floats:
    """(k, 3) unit tangents of a row of points, or of a ring of them."""
    if not is_ring(points):
        return unit(np.gradient(points, axis=0))
    before, after = np.roll(points[:-1], 1, axis=0), np.roll(points[:-1], -1, axis=0)
    tangents = unit(after - before)
    return np.concatenate((tangents, tangents[:1]))


def _even_parameters(directrix: Directrix, count: int) -> Floats:
    fine = np.linspace(*directrix.interval, 8 * count)
    arcs = arc_lengths(directrix.point_at(fine))
    return points_at(fine[:, None], arcs, np.linspace(0.0, arcs[-1], count))[:, 0]


def across_rail(rail: Rail, other: Rail, names: tuple[str, str]) -> Floats:
    """Returns (k, 3) unit vectors along the upper, across a rail, towards the other rail.

    Raises:
        InputError: the rails cross, or enclose no area.
    """
    lateral = unit(np.cross(rail.feet.normals, rail.tangents))
    gap = np.linalg.norm(rail.points[:, None] - other.points[None], axis=2)
    nearest = gap.argmin(axis=1)
    away = other.points[nearest] - rail.points
    offset = (away * lateral).sum(axis=1)
    width = float(np.abs(offset).max())
    if width <= settings.WIDTH_PER_LENGTH_MIN * rail.length:
        # On a sharp edge the normal is that of the face beyond it: the other rail shows the way.
        lateral = unit(away - (away * rail.tangents).sum(axis=1)[:, None] * rail.tangents)
        offset = (away * lateral).sum(axis=1)
        width = float(np.abs(offset).max())
    if width <= settings.WIDTH_PER_LENGTH_MIN * rail.length:
        raise InputError(
            f"Rails {names[0]} and {names[1]} enclose no area: they are {width:.3g} mm apart at"
            f" most, more than {settings.WIDTH_PER_LENGTH_MIN * rail.length:.3g} mm is needed. Move"
            " them apart."
        )
    sign = np.sign(offset[np.abs(offset).argmax()])
    # A step of the samples is the resolution at which the nearest point is known.
    slack = rail.length / (len(rail.points) - 1)
    against = (offset * sign < -settings.WIDTH_PER_LENGTH_MIN * rail.length) & (
        np.minimum(rail.shares, 1.0 - rail.shares) * rail.length > slack
    )
    if against.any():
        at = int(np.argmin(offset * sign))
        crossings = _sign_changes(offset, settings.WIDTH_PER_LENGTH_MIN * rail.length)
        raise InputError(
            f"Rails {names[0]} and {names[1]} cross {crossings} times, by up to"
            f" {abs(offset[at]):.3g} mm at {rail.shares[at] * rail.length:.4g} mm along {names[0]}."
            " Keep one on one side of the other."
        )
    return np.asarray(lateral * sign, dtype=np.float64)


def _sign_changes(offset: Floats, nothing: float) -> int:
    signs = np.sign(offset[np.abs(offset) > nothing])
    return int((signs[1:] != signs[:-1]).sum())


def margin_along(rail: Rail, margin: float, fade: float) -> Floats:
    """Returns (k,) mm: the margin beside the points of a rail, faded at its ends if it has any."""
    if rail.is_ring:
        return np.full(len(rail.points), margin)
    return faded_margin(rail.shares, margin, fade)


def faded_margin(shares: Floats, margin: float, fade: float) -> Floats:
    """Returns (k,) mm: the margin at (k,) shares of the arc length, 0 at both ends.

    It rises as a quarter of a sine over the share ``fade`` of the length, so that side and rail
    part at an angle: where they part tangentially, the band between them begins as a needle.
    """
    near = np.minimum(shares, 1.0 - shares)
    return np.asarray(margin * sin(0.5 * np.pi * np.clip(near / fade, 0.0, 1.0)))


def side_of(upper: UpperFaces, rail: Rail, toward: Floats, margin: Floats, name: str) -> Side:
    """Returns the side of an outline along a rail, ``margin`` (k,) mm outside of it.

    Raises:
        InputError: the upper ends at the rail, or turns down there.
    """
    if not (margin > 0.0).any():
        return Side(name, rail.points, rail.feet.normals, toward, rail.feet.faces)
    feet = upper.feet(rail.points - margin[:, None] * toward)
    moved = float(np.linalg.norm(feet.points - rail.points, axis=1).max())
    if moved < MARGIN_HELD * margin.max():
        raise InputError(
            f"Rail {name.upper()} runs along an edge of the upper, so that the opening cannot reach"
            f" beyond it: of the margin of {margin.max():.3g} mm {moved:.2g} mm are left. Take no"
            " margin, or move the rail off the edge."
        )
    if rail.is_ring:
        feet = _closed_up(feet)
    points, normals = feet.points.copy(), feet.normals.copy()
    if not rail.is_ring:
        points[[0, -1]], normals[[0, -1]] = rail.points[[0, -1]], rail.feet.normals[[0, -1]]
    tangents = _tangents(points)
    inward = unit(np.cross(normals, tangents))
    inward *= np.sign((inward * toward).sum(axis=1))[:, None]
    return Side(name, points, normals, inward, feet.faces)


def end_between(upper: UpperFaces, p: Side, q: Side, at: int, name: str) -> Side | None:
    """Returns the end of an outline from P to Q at index ``at`` (0 or -1) of both, if it has one.

    It is the projection of the straight end bridge, and where that jumps, over a sharp edge, the
    way in the plane of bridge and normals; None where the rails meet.
    """
    bridge = np.array([p.points[at], q.points[at]])
    width = norm(bridge[1] - bridge[0])
    length = polyline_length(p.points)
    if width <= settings.MEETING_PER_LENGTH * length:
        return None
    shares = np.linspace(0.0, 1.0, settings.END_POINTS)[:, None]
    feet = upper.feet((1.0 - shares) * bridge[0] + shares * bridge[1])
    if segment_lengths(feet.points).max() > JUMP * width / (len(shares) - 1):
        feet = _over_edges(upper, bridge, (p.normals[at], q.normals[at])) or feet
    points, normals = feet.points.copy(), feet.normals.copy()
    points[[0, -1]] = bridge
    normals[0], normals[-1] = p.normals[at], q.normals[at]
    ahead = 1 if at == 0 else -1
    onward = 0.5 * (
        p.points[at + 3 * ahead] + q.points[at + 3 * ahead] - p.points[at] - q.points[at]
    )
    inward = unit(np.cross(normals, unit(np.gradient(points, axis=0))))
    inward *= np.sign(dot(inward, onward))[:, None]
    return Side(name, points, normals, inward, feet.faces)


def _over_edges(upper: UpperFaces, bridge: Floats, normals: tuple[Floats, Floats]) -> Feet | None:
    across = np.cross(bridge[1] - bridge[0], normals[0] + normals[1])
    if norm(across) <= settings.CONFUSION:
        return None
    near = [upper.faces[i] for i in upper.near(bridge, norm(bridge[1] - bridge[0]))]
    path = path_in_plane(near, bridge[0], bridge[1], across, 4 * settings.END_POINTS)
    return None if path is None else upper.feet(path)


def unit(vectors: Floats) -> Floats:
    """Returns (k, 3) vectors divided by their lengths; zero where there is none."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    scaled: Floats = vectors / np.where(lengths > 0.0, lengths, 1.0)
    return scaled

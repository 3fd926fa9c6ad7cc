"""Where an opening is to be cut: its rails on the upper, its outline, and what cuts it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.topology import free_edges, make_compound, make_vertex
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.polyline import polyline_length

from .opening import CarveRequest
from .opening_outline import Rail, Side, across_rail, end_between, margin_along, rail_on, side_of
from .projection import UpperFaces

Floats = NDArray[np.float64]
ENDS = ("start", "end")


@dataclass(frozen=True, slots=True, eq=False)
class OpeningPlan:
    """One opening before it is cut."""

    request: CarveRequest
    """What was asked for, its margin known."""
    rails: tuple[Rail, Rail]
    """P and Q on the upper."""
    across: tuple[Floats, Floats]
    """Per rail (k, 3) unit vectors along the upper, towards the other rail."""
    ends_on_border: tuple[bool, bool]
    """Whether the strip starts, and ends, on the upper's own border."""
    sides: tuple[Side, ...]
    """P, Q and the ends, where there are any."""
    height: float
    """mm; how far ribbons that cut it stand out on both sides of the upper."""

    @property
    def overrun(self) -> list[tuple[float, float]]:
        """Per side, mm by which its ribbon runs on beyond its start and its end."""
        start, end = (self.height * at_border for at_border in self.ends_on_border)
        return [(start, end), (start, end), (0.0, 0.0), (0.0, 0.0)][: len(self.sides)]

    @property
    def points(self) -> Floats:
        """(k, 3) mm: the whole outline, side by side."""
        return np.vstack([side.points for side in self.sides])

    @property
    def title(self) -> str:
        """What messages call it."""
        return f"the opening of {self.request.name}" if self.request.name else "the opening"

    @property
    def heading(self) -> str:
        """The same at the start of a sentence."""
        return f"T{self.title[1:]}"


def plan_opening(faces: UpperFaces, upper: TopoDS_Shape, request: CarveRequest) -> OpeningPlan:
    """Returns where an opening is to be cut.

    Raises:
        InputError: rails that cross on the upper, enclose no area or are too far from it.
    """
    _check_long(request)
    rails = (rail_on(faces, request.p, "P"), rail_on(faces, request.q, "Q"))
    for rail, name in zip(rails, "PQ", strict=True):
        _check_near(rail, name, request.limit)
    margin = request.margin
    if margin is None:
        highest = max(float(rail.feet.distances.max()) for rail in rails)
        margin = highest if highest > request.tolerance else 0.0
    across = (
        across_rail(rails[0], rails[1], ("P", "Q")),
        across_rail(rails[1], rails[0], ("Q", "P")),
    )
    on_border = _ends_on_border(upper, rails)
    sides = _sides(faces, rails, across, margin, request.fade, on_border)
    height = settings.RIBBON_PER_LENGTH * min(rail.length for rail in rails)
    return OpeningPlan(
        replace(request, margin=margin), rails, across, on_border, tuple(sides), height
    )


def _sides(
    faces: UpperFaces,
    rails: tuple[Rail, Rail],
    across: tuple[Floats, Floats],
    margin: float,
    fade: float,
    on_border: tuple[bool, bool],
) -> list[Side]:
    sides = [
        side_of(faces, rail, toward, margin_along(rail, margin, fade), name)
        for rail, toward, name in zip(rails, across, "pq", strict=True)
    ]
    if sides[0].is_ring:
        return sides
    for at, name in ((0, "start"), (-1, "end")):
        end = None if on_border[at] else end_between(faces, sides[0], sides[1], at, name)
        if end is not None:
            sides.append(end)
    return sides


def _check_long(request: CarveRequest) -> None:
    lengths = [
        polyline_length(rail.point_at(np.linspace(*rail.interval, 33)))
        for rail in (request.p, request.q)
    ]
    short, long = np.argsort(lengths, kind="stable")
    if lengths[short] <= settings.WIDTH_PER_LENGTH_MIN * lengths[long]:
        raise InputError(
            f"Rail {'PQ'[short]} is a point: it is {lengths[short]:.3g} mm long, {'PQ'[long]}"
            f" {lengths[long]:.4g} mm. An opening needs two rails along the upper: draw it as a"
            " curve."
        )


def _check_near(rail: Rail, name: str, limit: float) -> None:
    at = int(rail.feet.distances.argmax())
    distance = float(rail.feet.distances[at])
    if distance > limit:
        raise InputError(
            f"Rail {name} leaves the upper by {distance:.3g} mm at"
            f" {rail.shares[at] * rail.length:.4g} mm of its {rail.length:.4g} mm, at most"
            f" {limit:.3g} mm is allowed. Draw it nearer to the upper, or raise the limit."
        )


def _ends_on_border(shape: TopoDS_Shape, rails: tuple[Rail, Rail]) -> tuple[bool, bool]:
    border = free_edges(shape)
    if not border or rails[0].is_ring:
        return False, False
    held = make_compound(border)
    reach = [settings.BORDER_REACH_PER_LENGTH * rail.length for rail in rails]

    def reaches(at: int) -> bool:
        gaps = [
            BRepExtrema_DistShapeShape(make_vertex(rail.points[at]), held).Value() for rail in rails
        ]
        return all(gap <= limit for gap, limit in zip(gaps, reach, strict=True))

    return reaches(0), reaches(-1)

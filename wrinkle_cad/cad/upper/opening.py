"""An upper with a strip cut out, and what was asked for when it was cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad.cad.rail.directrix import Directrix

from .opening_outline import Rail
from .smooth import curve_edges, edge_row

if TYPE_CHECKING:
    from build123d import Compound, Edge, Face, Shell, Wire

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class CarveRequest:
    """What was asked for; enough to carve another body in the same way."""

    p: Directrix
    """Rail P."""
    q: Directrix
    """Rail Q."""
    margin: float | None
    """mm; how far the opening reaches beyond the rails; None: as far as they lie from the upper,
    nothing where that is within the tolerance."""
    fade: float
    """The share of the rails over which the margin grows and dies away."""
    limit: float
    """mm; how far a rail may lie from the upper."""
    join: float
    """mm; faces of the upper this near to each other are joined."""
    allow_split: bool
    """Whether the upper may fall apart."""
    tolerance: float = 0.0
    """mm; rails nearer to the upper lie on it."""
    name: str = ""
    """Of the strip, for messages."""


@dataclass(frozen=True, slots=True, eq=False)
class Opening:
    """An upper with the strip cut out.

    Example:
        >>> from wrinkle_cad import carve
        >>> from build123d import Edge, Face
        >>> upper = Face.make_rect(100, 60)
        >>> p, q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> opening = carve(upper, p, q, margin=2)
        >>> len(opening.body.faces()), opening.p.label
        (1, 'P')
    """

    body_shape: TopoDS_Shape
    """The upper without the strip: a shell, or a compound of shells that share no edge."""
    removed_shape: TopoDS_Shape
    """What was cut out, likewise."""
    p_edges: tuple[TopoDS_Edge, ...]
    """The opening's edges along P, edges of the body, in order and oriented along P."""
    q_edges: tuple[TopoDS_Edge, ...]
    """The opening's edges along Q."""
    start_edges: tuple[TopoDS_Edge, ...]
    """From P to Q at the start; edges of the body, or of the upper's border; none if they meet."""
    end_edges: tuple[TopoDS_Edge, ...]
    """From P to Q at the end."""
    rail_p_curve: Directrix
    """P as it lies on the upper."""
    rail_q_curve: Directrix
    """Q as it lies on the upper."""
    rails: tuple[Rail, Rail]
    """P and Q on the upper as points, with normals and tangents."""
    across: tuple[Floats, Floats]
    """Per rail (k, 3) unit vectors along the upper, towards the other rail."""
    ends_on_border: tuple[bool, bool]
    """Whether the strip starts, and ends, on the upper's own border."""
    face_origin: tuple[int, ...]
    """Per face of the body: which face of the upper it is, or is part of."""
    distances: tuple[float, float]
    """mm; how far P and Q were from the upper."""
    areas: tuple[float, float, float]
    """mm^2: upper, body, removed."""
    removed_beside: float
    """mm^2; what was cut out of the same body for other openings."""
    body_count: int
    """Connected parts of the body."""
    lost_border: float
    """mm; border of the upper that was cut out: slits between its faces, holes."""
    upper_shape: TopoDS_Shape
    """The upper, its faces joined where they meet."""
    given_shape: TopoDS_Shape
    """The upper as it was given."""
    request: CarveRequest
    """What was asked for."""
    source: object = None
    """The object that the upper came in, whose names and colors the body keeps."""

    def __repr__(self) -> str:
        _, body, removed = self.areas
        return f"Opening(body {body:.1f} mm2, removed {removed:.1f} mm2)"

    @property
    def area_balance(self) -> float:
        """mm^2: the body and all that was cut out together, less the upper."""
        return self.areas[1] + self.areas[2] + self.removed_beside - self.areas[0]

    @property
    def body(self) -> Face | Shell | Compound:
        """The upper without the strip, as build123d has it, its names and colors kept."""
        from wrinkle_cad.cad.exchange.likeness import body_alike

        return body_alike(self.body_shape, self.face_origin, self.given_shape, self.source)

    @property
    def removed(self) -> Face | Shell | Compound:
        """What was cut out, as build123d has it."""
        from wrinkle_cad.cad.exchange.likeness import alike

        return alike(self.removed_shape, self.source, "removed")

    @property
    def p(self) -> Edge | Wire | Compound:
        """The opening's boundary along P: an edge of the body, or a wire of several.

        Where the upper has a gap that P crosses, it is a compound.
        """
        return _curve(self.p_edges, "P")

    @property
    def q(self) -> Edge | Wire | Compound:
        """The opening's boundary along Q."""
        return _curve(self.q_edges, "Q")

    @property
    def rail_p(self) -> Edge | Wire:
        """P as it lies on the upper: a build123d edge or wire."""
        return _curve(tuple(curve_edges(self.rail_p_curve)), "P")

    @property
    def rail_q(self) -> Edge | Wire:
        """Q as it lies on the upper."""
        return _curve(tuple(curve_edges(self.rail_q_curve)), "Q")


def one_per_body(openings: Sequence[Opening]) -> list[Opening]:
    """Returns the first of the openings that were cut at once, for each body in turn."""
    kept = [openings[0]]
    for opening in openings[1:]:
        if not opening.body_shape.IsSame(kept[-1].body_shape):
            kept.append(opening)
    return kept


def _curve(edges: tuple[TopoDS_Edge, ...], label: str) -> Any:
    from wrinkle_cad.cad.build123d_objects import to_build123d

    return to_build123d(edges[0] if len(edges) == 1 else edge_row(edges), label=label)

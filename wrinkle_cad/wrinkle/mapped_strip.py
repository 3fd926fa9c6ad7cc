"""Between a strip's surface and its flat pattern: points and curves, both ways."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.piece.frame import AS_UNROLLED, PieceFrame, frame_of
from wrinkle_cad.strip.flat.flat_map import FlatMap
from wrinkle_cad.strip.places import place_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from build123d import Wire

    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.pattern.piece.piece import PatternPiece
    from wrinkle_cad.settings import Surface
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.flat.unrolling import Unrolling

Floats = NDArray[np.float64]


class MappedStrip:
    """What is drawn on a strip's pattern lands on its surface, and back."""

    p: Directrix
    """Rail P."""
    q: Directrix
    """Rail Q."""
    p_samples: Samples
    """The samples of P."""
    q_samples: Samples
    """The samples of Q."""
    tolerance: float
    """mm; of the strip."""
    surface: Surface
    """What its faces are."""

    @property
    def unrolling(self) -> Unrolling:
        """The strip laid flat."""
        raise NotImplementedError

    def _mapped(self) -> FlatMap:
        raise NotImplementedError

    @cached_property
    def _flat_map(self) -> FlatMap:
        return self._mapped()

    def to_flat(self, drawn: object, piece: PatternPiece | None = None) -> Any:
        """Lays what is drawn on the surface into the flat pattern.

        Every length along the surface is kept, across all of its faces, but in a gap, where the
        surface itself is not developable and its faces are cones.

        Args:
            drawn: points, an array (k, 3) in mm; or edges, wires, sketches or a list of them.
            piece: one of the strip's own pieces, in whose drawing the result is; when None that
                of ``unrolling``: P begins at the origin, and Q above it.

        Returns:
            (k, 2) mm for points; for curves a build123d ``Wire`` on XY for each, a polyline within
            the strip's tolerance.

        Raises:
            InputError: something is off the surface by more than the strip's tolerance, or the
                piece is none of the strip.

        Example:
            >>> from wrinkle_cad import WrinkleStrip
            >>> tent = WrinkleStrip(
            ...     [[0, 0, 0], [30, 0, 40], [60, 0, 0]], [[0, 9, 0], [30, 9, 40], [60, 9, 0]]
            ... )
            >>> tent.to_flat(np.array([[30.0, 4.0, 40.0]])).round(6).tolist()
            [[50.0, 4.0]]
        """
        frame = self._frame(piece)

        def carry(points: Floats) -> Floats:
            found, off = self._flat_map.to_plane(points, self.tolerance)
            _check_found(points, off, self.tolerance, "the surface of the strip")
            return frame.drawn(found)

        return _carried(drawn, 3, carry, self.tolerance)

    def to_space(self, drawn: object, piece: PatternPiece | None = None) -> Any:
        """Puts what is drawn on the flat pattern onto the surface.

        Where the flat pattern covers itself, the part nearer to the start is taken.

        Args:
            drawn: points, an array (k, 2) in mm; or edges, wires, sketches on XY or a list of them.
            piece: as for ``to_flat``.

        Returns:
            (k, 3) mm for points; for curves a build123d ``Wire`` for each, a polyline within the
            strip's tolerance: texts and holes as their outlines.

        Raises:
            InputError: something lies beyond the flat pattern by more than the strip's tolerance,
                or the piece is none of the strip.

        Example:
            >>> from wrinkle_cad import WrinkleStrip
            >>> tent = WrinkleStrip(
            ...     [[0, 0, 0], [30, 0, 40], [60, 0, 0]], [[0, 9, 0], [30, 9, 40], [60, 9, 0]]
            ... )
            >>> tent.to_space(np.array([[50.0, 4.0]])).round(6).tolist()
            [[30.0, 4.0, 40.0]]
        """
        frame = self._frame(piece)

        def carry(points: Floats) -> Floats:
            found, off = self._flat_map.to_space(frame.undrawn(points[:, :2]), self.tolerance)
            _check_found(points, off, self.tolerance, "the flat strip")
            return found

        return _carried(drawn, 2, carry, self.tolerance)

    def rail_points(self, rail: Literal["P", "Q"], arcs_mm: ArrayLike) -> Floats:
        """Points on the surface's edge at arc lengths from the rail's start.

        Args:
            rail: ``P`` or ``Q``.
            arcs_mm: (k,) along the edge: the curve, or its chords for facets.

        Returns:
            (k, 3) float64, mm.

        Raises:
            InputError: an arc length lies beyond the edge.
        """
        from wrinkle_cad.cad.rail.directrix import make_directrix
        from wrinkle_cad.cad.rail.rail_points import points_at_arcs

        curve, samples = (self.p, self.p_samples) if rail == "P" else (self.q, self.q_samples)
        if self.surface == "facets":
            curve = make_directrix(samples.points)
        return points_at_arcs(curve, arcs_mm)

    def _frame(self, piece: PatternPiece | None) -> PieceFrame:
        return AS_UNROLLED if piece is None else frame_of(piece, self.unrolling)


def _check_found(points: Floats, off: Floats, limit: float, where: str) -> None:
    (lost,) = np.nonzero(~np.isfinite(off))
    if len(lost):
        size = float(np.ptp(points, axis=0).max())
        raise InputError(
            f"{len(lost)} of {len(points)} points, the first at"
            f" {place_text(points[lost[0]], size)}, are more than {limit:g} mm off {where}. Draw"
            " within it."
        )


def _carried(
    drawn: object, dimensions: int, carry: Callable[[Floats], Floats], tolerance: float
) -> Any:
    points = _points_in(drawn)
    if points is None:
        return _carried_curves(drawn, carry, tolerance)
    if points.ndim != 2 or points.shape[1] != dimensions or not np.isfinite(points).all():
        raise InputError(
            f"Points cannot be an array of shape {points.shape}: pass finite (k, {dimensions}) mm."
        )
    return carry(points)


def _points_in(drawn: object) -> Floats | None:
    if isinstance(drawn, np.ndarray):
        return drawn.astype(np.float64)
    is_plain = isinstance(drawn, list | tuple) and all(
        isinstance(row, list | tuple | np.ndarray) for row in drawn
    )
    return np.array(drawn, dtype=np.float64) if is_plain and drawn else None


def _carried_curves(
    drawn: object, carry: Callable[[Floats], Floats], tolerance: float
) -> list[Wire]:
    from wrinkle_cad.cad.build123d_objects import to_build123d
    from wrinkle_cad.cad.kernel.polylines import carried, outlines_of, polyline_wire
    from wrinkle_cad.cad.rail.edges_as_drawn import shapes_in

    wires = []
    for shape in shapes_in(drawn, "What is drawn"):
        for edges in outlines_of(shape):
            line = carried(edges, carry, tolerance)
            line = np.column_stack((line, np.zeros((len(line), 3 - line.shape[1]))))
            wires.append(to_build123d(polyline_wire(line)))
    return wires

"""The way between a strip's faces and its flat pattern, whatever the faces are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wrinkle_cad.strip.flat.flat_map import FlatMap, flat_map
from wrinkle_cad.strip.flat.smooth_unrolling import unroll_smooth
from wrinkle_cad.strip.rulings.rail_curve import RailCurve

if TYPE_CHECKING:
    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.flat.unrolling import Unrolling
    from wrinkle_cad.strip.rulings.smooth_path import SmoothPath
    from wrinkle_cad.strip.triangulation import Triangulation


def map_of(
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
    triangulation: Triangulation,
    unrolling: Unrolling,
    path: SmoothPath | None,
    is_faceted: bool,
) -> FlatMap:
    """Returns the way from a strip's faces to the plane.

    Args:
        rails: P and Q.
        samples: of P and of Q, those of the triangulation.
        triangulation: the strip's own.
        unrolling: the strip in the plane.
        path: the pieces of a smooth surface; None for cones and facets.
        is_faceted: whether the faces are triangles.
    """
    if is_faceted:
        from wrinkle_cad.cad.rail.directrix import make_directrix

        rails = (make_directrix(samples[0].points), make_directrix(samples[1].points))
        parameters = (rails[0].pieces[0].knots, rails[1].pieces[0].knots)
    else:
        parameters = (samples[0].parameters, samples[1].parameters)
    curves = (_as_drawn(rails[0]), _as_drawn(rails[1]))
    if path is None:
        return flat_map(curves, parameters, triangulation, (unrolling.p, unrolling.q))
    own = (path.p_samples, path.q_samples)
    flat = unroll_smooth(path, own, (rails[0].point_at, rails[1].point_at), tolerance=1.0)
    parameters = (own[0].parameters, own[1].parameters)
    return flat_map(curves, parameters, path.triangulation, (flat.p, flat.q), path.runs)


def _as_drawn(rail: Directrix) -> RailCurve:
    """A rail as it is, with the corners of points."""
    return RailCurve(rail.point_at, rail.velocity_at, rail.interval, rail.breaks)

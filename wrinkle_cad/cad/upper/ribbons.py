"""Ribbons: narrow faces that stand on an upper along an outline, and cut it there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.Geom import Geom_BSplineSurface
from OCP.TopoDS import TopoDS_Face

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.splines import make_surface
from wrinkle_cad.cad.kernel.topology import edges_of, make_compound, make_vertex
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.portable import norm

from .opening_outline import Side, unit
from .smooth import around

Floats = NDArray[np.float64]

RING_STARTS: Final = 16
"""So many places are looked at for the start of a closed ribbon."""


def ribbon(
    side: Side, height: float, overrun: tuple[float, float], faces: Sequence[TopoDS_Face]
) -> TopoDS_Face:
    """Returns a narrow face that stands on an upper along one side of an outline.

    Args:
        side: the side.
        height: mm; how far it stands out on both sides of the upper.
        overrun: mm by which it runs on beyond the side's start and end; a ring has neither.
        faces: of the upper that it stands on.
    """
    if side.is_ring:
        return _closed_ribbon(*_started_apart(side, faces), height)
    points, normals = side.points, side.normals
    for first, extra in ((True, overrun[0]), (False, overrun[1])):
        if extra > 0.0:
            points, normals = _extended(points, normals, first, extra)
    surface = _standing(arc_lengths(points), _rows(points, normals, height), height)
    return BRepBuilderAPI_MakeFace(surface, settings.CONFUSION).Face()


def _rows(points: Floats, normals: Floats, height: float) -> Floats:
    """(k, 6) mm: where a ribbon ends on either side of the upper, for each point."""
    return np.hstack((points - height * normals, points + height * normals))


def _standing(arc: Floats, rows: Floats, height: float) -> Geom_BSplineSurface:
    """The ruled surface between the two curves through the rows."""
    spline = cubic_through(arc, rows)
    knots, counts = np.unique(spline.knots, return_counts=True)
    return make_surface(
        spline.poles.reshape(-1, 2, 3), (knots, (0.0, 2.0 * height)), (counts, (2, 2)), (3, 1)
    )


def _extended(points: Floats, normals: Floats, first: bool, extra: float) -> tuple[Floats, Floats]:
    """Runs a side on beyond one end, straight, in steps as long as its own."""
    sense = 1 if first else -1
    run, turn = points[::sense], normals[::sense]
    step = norm(run[1] - run[0])
    direction = unit((run[0] - run[2])[None])[0]
    count = max(2, int(np.ceil(extra / step)))
    beyond = run[0] + np.arange(count, 0, -1)[:, None] * (extra / count) * direction
    grown = np.vstack((beyond, run))
    turned = np.vstack((np.repeat(turn[:1], count, axis=0), turn))
    return grown[::sense], turned[::sense]


def _started_apart(side: Side, faces: Sequence[TopoDS_Face]) -> tuple[Floats, Floats]:
    """The points and normals of a ring from where it is furthest from the edges of the upper.

    A ribbon's own seam on a seam of the upper is more than the kernel can tell apart.
    """
    edges = make_compound(edges_of(make_compound(faces)))
    count = len(side.points) - 1
    tried = range(0, count, max(1, count // RING_STARTS))
    gaps = [BRepExtrema_DistShapeShape(make_vertex(side.points[k]), edges).Value() for k in tried]
    start = tried[int(np.argmax(gaps))]
    points, normals = (np.roll(rows[:-1], -start, axis=0) for rows in (side.points, side.normals))
    return np.concatenate((points, points[:1])), np.concatenate((normals, normals[:1]))


def _closed_ribbon(points: Floats, normals: Floats, height: float) -> TopoDS_Face:
    arc = arc_lengths(points)
    whole = _standing(*around(arc, _rows(points, normals, height)), height)
    whole.Segment(0.0, float(arc[-1]), 0.0, 2.0 * height)
    for row in (1, 2):
        whole.SetPole(whole.NbUPoles(), row, whole.Pole(1, row))
    return BRepBuilderAPI_MakeFace(whole, settings.CONFUSION).Face()

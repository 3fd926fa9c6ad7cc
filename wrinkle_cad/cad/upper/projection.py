"""The nearest points of an upper: feet, with the surface normal there.

An upper is any number of trimmed faces, sewn or not. A point's foot is the nearest of all its feet
on the faces; where no face has it inside its border, it is the nearest border point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.GeomLProp import GeomLProp_SLProps
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.IntTools import IntTools_FClass2d
from OCP.ShapeAnalysis import ShapeAnalysis_Surface
from OCP.TopAbs import TopAbs_OUT, TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.topology import (
    faces_of,
    kind_name,
    make_vertex,
    vertex_point,
    vertices_of,
)
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Feet:
    """The nearest points of an upper to a row of points."""

    points: Floats
    """(k, 3) mm, on the upper."""
    normals: Floats
    """(k, 3) unit normals of the faces there, turned alike along the row."""
    distances: Floats
    """(k,) mm, from the given points."""
    faces: NDArray[np.int64]
    """(k,) index of the face that each foot lies on."""


class UpperFaces:
    """The faces of an upper, ready to be asked for nearest points."""

    def __init__(self, upper: TopoDS_Shape) -> None:
        self.faces = faces_of(upper)
        if not self.faces:
            raise InputError(
                f"The upper is a {kind_name(upper)} without faces. Choose a face, a shell or a"
                " compound of faces as the upper."
            )
        self._shape = upper
        self._surfaces = [ShapeAnalysis_Surface(BRep_Tool.Surface_s(face)) for face in self.faces]
        self._inside = [IntTools_FClass2d(face, settings.CONFUSION) for face in self.faces]
        self._boxes = [_box(face) for face in self.faces]
        self._corners = np.array([vertex_point(vertex) for vertex in vertices_of(upper)])

    def feet(self, points: Floats) -> Feet:
        """Returns the feet of (k, 3) points in mm, which follow each other along a curve."""
        best = np.full(len(points), np.inf)
        owner = np.full(len(points), -1, dtype=np.int64)
        uv = np.zeros((len(points), 2))
        limit = self._nearest_corner(points)
        for i in range(len(self.faces)):
            self._try_face(i, points, limit, best, owner, uv)
        found, normals = np.empty_like(points), np.empty_like(points)
        for j, point in enumerate(points):
            if owner[j] < 0:
                owner[j], uv[j] = self._border_foot(point)
            found[j], normals[j] = self._foot(int(owner[j]), uv[j])
        distances = np.asarray(np.linalg.norm(found - points, axis=1))
        return Feet(found, _turned_alike(normals), distances, owner)

    def near(self, points: Floats, reach: float) -> list[int]:
        """Returns the faces whose boxes come within ``reach`` mm of one of (k, 3) points."""
        found = []
        for i, (low, high) in enumerate(self._boxes):
            outside = np.maximum(np.maximum(low - points, points - high), 0.0)
            if (np.linalg.norm(outside, axis=1) <= reach).any():
                found.append(i)
        return found

    def _nearest_corner(self, points: Floats) -> Floats:
        """Returns (k,) mm: the upper is no further away, and what is need not be looked at."""
        if not len(self._corners):
            return np.full(len(points), np.inf)
        apart = [np.sqrt(((self._corners - point) ** 2).sum(axis=1).min()) for point in points]
        return np.array(apart) + settings.GAP_CROSSED

    def _try_face(
        self,
        i: int,
        points: Floats,
        limit: Floats,
        best: Floats,
        owner: NDArray[np.int64],
        uv: Floats,
    ) -> None:
        surface, inside, (low, high) = self._surfaces[i], self._inside[i], self._boxes[i]
        reach = np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=1)
        previous: gp_Pnt2d | None = None
        previous_gap = 0.0
        for j in np.flatnonzero(reach <= np.minimum(best, limit)):
            at = gp_Pnt(*points[j].tolist())
            if previous is None:
                found = surface.ValueOfUV(at, settings.CONFUSION)
            else:
                found = surface.NextValueOfUV(previous, at, settings.CONFUSION)
                if surface.Gap() > 2.0 * previous_gap + settings.CONFUSION:
                    found = surface.ValueOfUV(at, settings.CONFUSION)
            previous, previous_gap = found, surface.Gap()
            # On an edge of two faces a row of points stays with the first of them.
            nearer = previous_gap < best[j] - settings.CONFUSION
            if nearer and inside.Perform(found) != TopAbs_OUT:
                best[j], owner[j] = previous_gap, i
                uv[j] = found.X(), found.Y()

    def _border_foot(self, point: Floats) -> tuple[int, Floats]:
        """Returns the face and (2,) surface parameters of the nearest border point."""
        nearest = BRepExtrema_DistShapeShape(make_vertex(point), self._shape)
        on = nearest.PointOnShape2(1)
        at = np.array([on.X(), on.Y(), on.Z()])
        gaps = []
        for i, surface in enumerate(self._surfaces):
            low, high = self._boxes[i]
            slack = 1e-3 * norm(high - low)
            if (at < low - slack).any() or (at > high + slack).any():
                gaps.append((np.inf, gp_Pnt2d()))
                continue
            foot = surface.ValueOfUV(on, settings.CONFUSION)
            gaps.append((surface.Gap(), foot))
        i = int(np.argmin([gap for gap, _ in gaps]))
        return i, np.array([gaps[i][1].X(), gaps[i][1].Y()])

    def _foot(self, i: int, uv: Floats) -> tuple[Floats, Floats]:
        surface = self._surfaces[i].Surface()
        measured = GeomLProp_SLProps(surface, float(uv[0]), float(uv[1]), 1, settings.CONFUSION)
        at = measured.Value()
        point = np.array([at.X(), at.Y(), at.Z()])
        if not measured.IsNormalDefined():
            return point, np.zeros(3)
        direction = measured.Normal()
        normal = np.array([direction.X(), direction.Y(), direction.Z()])
        return point, -normal if self.faces[i].Orientation() == TopAbs_REVERSED else normal


def _box(face: TopoDS_Face) -> tuple[Floats, Floats]:
    box = Bnd_Box()
    BRepBndLib.Add_s(face, box, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([low.X(), low.Y(), low.Z()]), np.array([high.X(), high.Y(), high.Z()])


def _turned_alike(normals: Floats) -> Floats:
    """Fills in normals that are not defined and flips those that face against the majority.

    Faces of one upper that are not sewn may face either way; along one curve they must not.
    """
    lengths = np.linalg.norm(normals, axis=1)
    defined = np.flatnonzero(lengths > 0.5)
    if len(defined) == 0:
        raise InputError(
            "The upper's surface normal is nowhere defined along the rail. Repair the upper: it"
            " needs faces with a normal."
        )
    nearest = defined[np.abs(np.arange(len(normals))[:, None] - defined).argmin(axis=1)]
    filled = normals[nearest]
    against = (filled[1:] * filled[:-1]).sum(axis=1) < 0.0
    sign = np.where(np.cumsum(np.concatenate(([False], against))) % 2, -1.0, 1.0)
    turned: Floats = filled * sign[:, None]
    return turned if sign.sum() >= 0.0 else -turned

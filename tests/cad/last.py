"""A surface like a commercial last: 39 x 17 uneven knots, closed around, poles at heel and toe."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from build123d import Edge, Spline
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.TopoDS import TopoDS_Face
from scipy.interpolate import BSpline, make_interp_spline

from wrinkle_cad.cad.kernel.splines import make_surface

AROUND, ALONG = 39, 17


@cache
def last_like_face(seed: int) -> TopoDS_Face:
    """Returns the face; u runs around, v from heel to toe, 270 mm long."""
    random = np.random.default_rng(seed)
    u, v = _uneven(random, AROUND), _uneven(random, ALONG)
    v = 0.5 - 0.5 * np.cos(np.pi * v)
    turn, along = 2.0 * np.pi * u[:, None], v[None, :]
    girth = np.sqrt(np.maximum(np.sin(np.pi * along), 0.0))
    top = np.maximum(np.sin(turn), 0.0)
    x = 270.0 * along + 0.0 * turn
    y = girth * (38.0 + 8.0 * np.sin(3.0 * along)) * np.cos(turn) + 6.0 * np.sin(2 * np.pi * along)
    z = girth * (45.0 + 25.0 * np.cos(np.pi * along)) * np.sin(turn) * (1.0 + 0.25 * top)
    z = z + 8.0 * np.cos(2.0 * np.pi * along)
    points = np.stack((x, y, z), axis=2)
    points[-1] = points[0]
    around = _clamped(make_interp_spline(u, points.reshape(AROUND, -1), 3, bc_type="periodic"))
    rows = around.c.reshape(-1, ALONG, 3).transpose(1, 0, 2)
    lengthwise = make_interp_spline(v, rows.reshape(ALONG, -1), 3)
    poles = lengthwise.c.reshape(-1, rows.shape[1], 3).transpose(1, 0, 2)
    (u_knots, u_counts), (v_knots, v_counts) = (
        np.unique(spline.t, return_counts=True) for spline in (around, lengthwise)
    )
    surface = make_surface(
        np.ascontiguousarray(poles), (u_knots, v_knots), (u_counts, v_counts), (3, 3)
    )
    return BRepBuilderAPI_MakeFace(surface, 1e-6).Face()


def rail_on_face(face: TopoDS_Face, start: tuple[float, float], end: tuple[float, float]) -> Edge:
    """Returns a curve between two places on a face, given as shares of its parameters."""
    surface = BRep_Tool.Surface_s(face)
    u0, u1, v0, v1 = surface.Bounds()
    points = []
    for t in np.linspace(0.0, 1.0, 12):
        u, v = (a + (b - a) * float(t) for a, b in zip(start, end, strict=True))
        at = surface.Value(u0 + (u1 - u0) * (u % 1.0), v0 + (v1 - v0) * v)
        points.append((at.X(), at.Y(), at.Z()))
    return Spline(*points)


def _uneven(random: np.random.Generator, count: int) -> NDArray[np.float64]:
    steps = np.cumsum(random.uniform(0.3, 1.7, count - 1))
    return np.concatenate(([0.0], steps / steps[-1]))


def _clamped(spline: Any) -> BSpline:
    """Returns a periodic spline with all knots of its ends."""
    first, last = spline.t[spline.k], spline.t[-spline.k - 1]
    full = spline
    for knot in (first, last):
        missing = spline.k + 1 - int(np.isclose(full.t, knot).sum())
        full = full.insert_knot(knot, missing) if missing > 0 else full
    low = int(np.searchsorted(full.t, first, "left"))
    high = int(np.searchsorted(full.t, last, "right"))
    knots = full.t[low:high]
    return BSpline(knots, full.c[low : low + len(knots) - spline.k - 1], spline.k)

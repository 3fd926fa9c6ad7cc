"""A stitched upper drawn from above one of its corners, as an SVG: its edges, strips on top."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GeomAbs import GeomAbs_Line
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import edges_of

Floats = NDArray[np.float64]

WIDTH: Final = 480.0
"""px"""
RIGHT: Final = (0.7071, 0.7071, 0.0)
UP: Final = (-0.4082, 0.4082, 0.8165)
"""The two directions of an isometric view."""
BODY_COLOR: Final = "#8a8f98"
STRIP_COLOR: Final = "#b3541e"
POINTS: Final = 9
"""On a curved edge."""


def upper_drawing(parts: Sequence[tuple[str, Sequence[TopoDS_Face]]], body: str) -> str:
    """Returns the edges of a shell as an ``<svg>`` element.

    Args:
        parts: the faces by what they are.
        body: the name of the part that is drawn in grey.
    """
    groups = {
        color: [
            _projected(edge)
            for edge in _edges_once(
                face for name, faces in parts if (name == body) == is_body for face in faces
            )
        ]
        for color, is_body in ((BODY_COLOR, True), (STRIP_COLOR, False))
    }
    every = np.vstack([points for lines in groups.values() for points in lines])
    low = every.min(axis=0)
    scale = WIDTH / max(float(np.ptp(every[:, 0])), 1e-9)
    height = float(np.ptp(every[:, 1])) * scale
    paths = "".join(
        f'<path fill="none" stroke="{color}" d="{_path(lines, low, scale, height)}"/>'
        for color, lines in groups.items()
        if lines
    )
    size = f'width="{WIDTH:.0f}" height="{height:.0f}" viewBox="-2 -2 {WIDTH + 4:.0f} '
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}{height + 4:.0f}">{paths}</svg>'


def _edges_once(faces: Iterator[TopoDS_Face]) -> list[TopoDS_Edge]:
    every = [edge for face in faces for edge in edges_of(face) if not BRep_Tool.Degenerated_s(edge)]
    index = ShapeIndex(every)
    return list({index.find(edge): edge for edge in every}.values())


def _projected(edge: TopoDS_Edge) -> Floats:
    """(k, 2) in the plane of the drawing, y upwards."""
    curve = BRepAdaptor_Curve(edge)
    count = 2 if curve.GetType() == GeomAbs_Line else POINTS
    places = np.linspace(curve.FirstParameter(), curve.LastParameter(), count)
    found = [curve.Value(float(at)) for at in places]
    return np.array(
        [
            [sum(a * b for a, b in zip(axis, at.Coord(), strict=True)) for axis in (RIGHT, UP)]
            for at in found
        ]
    )


def _path(lines: Sequence[Floats], low: Floats, scale: float, height: float) -> str:
    return "".join(
        "M"
        + "L".join(
            f"{(x - low[0]) * scale:.1f} {height - (y - low[1]) * scale:.1f}" for x, y in line
        )
        for line in lines
    )

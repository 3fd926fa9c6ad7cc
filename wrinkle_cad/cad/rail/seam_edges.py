"""Edges at which a closed surface begins and ends: no curve that anybody drew.

Where a cylinder's parameters begin is up to the program that made it, and such a seam has one face
on both of its sides.
"""

from __future__ import annotations

from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.kernel.topology import faces_of, vertex_point, vertices_of
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.places import place_text


def check_no_seam(edge: TopoDS_Edge, parent: TopoDS_Shape | None, name: str) -> None:
    """Checks that an edge is not the seam of a closed face.

    Args:
        edge: the edge.
        parent: what it was taken from, where that is known. Without it the curves on surfaces that
            the edge has decide: those of a seam are all on one surface, at both of its ends. The
            border of a face that was cut along the seam, and has no neighbor there, is alike.
        name: what messages call the rail, at the start of a sentence.

    Raises:
        InputError: it is one.
    """
    faces = [] if parent is None else faces_of(parent)
    uses = [count for face in faces if (count := _uses(edge, face))]
    if uses != [2] if uses else not _is_on_both_ends(edge):
        return
    places = sorted(vertex_point(vertex).tolist() for vertex in vertices_of(edge))
    size = length_of(edge)
    from_to = " to ".join(place_text(place, size) for place in (places[0], places[-1]))
    raise InputError(
        f"{name} is the seam of a closed face, from {from_to}: no edge of the design, but the line"
        " at which the program that made the face lets it begin and end. Choose another edge; if"
        " this line is meant, draw it as a curve of its own."
    )


def _uses(edge: TopoDS_Edge, face: TopoDS_Shape) -> int:
    """How often an edge bounds a face."""
    count, edges = 0, TopExp_Explorer(face, TopAbs_EDGE)
    while edges.More():
        count += edges.Current().IsSame(edge)
        edges.Next()
    return count


def _is_on_both_ends(edge: TopoDS_Edge) -> bool:
    """Whether an edge has curves on one surface only, and there at both ends of its parameters."""
    on_surfaces = [curve for curve in edge.TShape().Curves() if curve.IsCurveOnSurface()]
    return len(on_surfaces) == 1 and bool(on_surfaces[0].IsCurveOnClosedSurface())

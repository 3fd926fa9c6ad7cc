"""The edges in whatever a caller holds, in the order and direction in which they were drawn."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from OCP.TopAbs import (
    TopAbs_COMPOUND,
    TopAbs_EDGE,
    TopAbs_FORWARD,
    TopAbs_REVERSED,
    TopAbs_WIRE,
)
from OCP.TopoDS import TopoDS_Edge, TopoDS_Iterator, TopoDS_Shape, TopoDS_Wire

from wrinkle_cad.cad.kernel.topology import (
    as_edge,
    as_wire,
    edges_of,
    faces_of,
    kind_name,
    wires_of,
)
from wrinkle_cad.errors import InputError

from .seam_edges import check_no_seam


def edges_as_drawn(source: object, name: str) -> list[TopoDS_Edge]:
    """Returns the edges of a source.

    Args:
        source: an edge, wire, compound of edges, a sketch with one outline, or several of them;
            from build123d (builders too), CadQuery or the kernel itself.
        name: what messages call the rail, at the start of a sentence.

    Raises:
        InputError: there is no curve in it, or something that is none, or the seam of a face.
    """
    found: list[TopoDS_Edge] = []
    for shape, parent in _items_in(source, name):
        found += _edges_in(shape, name)
        if shape.ShapeType() == TopAbs_EDGE:
            check_no_seam(found[-1], parent, name)
    return found


def shapes_in(source: object, name: str) -> list[TopoDS_Shape]:
    """Returns the shapes that a caller holds, in the order in which they were drawn.

    Args:
        source: as for ``edges_as_drawn``.
        name: what messages call it, at the start of a sentence.

    Raises:
        InputError: something in it is no shape.
    """
    return [shape for shape, _ in _items_in(source, name)]


def _items_in(source: object, name: str) -> list[tuple[TopoDS_Shape, TopoDS_Shape | None]]:
    """Each shape with what it was taken from, as far as build123d knows that."""
    shape = source if isinstance(source, TopoDS_Shape) else getattr(source, "wrapped", None)
    if isinstance(shape, TopoDS_Shape):
        if shape.IsNull():
            raise InputError(f"{name} is an empty {type(source).__name__}. Pass one with a curve.")
        parent = getattr(getattr(source, "topo_parent", None), "wrapped", None)
        return [(shape, parent if isinstance(parent, TopoDS_Shape) else None)]
    held = _held_by(source)
    if held == () and held is not source:
        raise InputError(f"{name} is an empty {type(source).__name__}. Draw a curve in it first.")
    if isinstance(held, Iterable) and not isinstance(held, str | bytes):
        return [found for item in held for found in _items_in(item, name)]
    raise InputError(
        f"{name} cannot be of type {type(source).__name__}: pass an edge, a wire, a list of edges"
        " or a (k, 3) array."
    )


def _held_by(source: object) -> Any:
    """What a builder of build123d or a workplane of CadQuery has made; else the source itself."""
    if callable(getattr(source, "vals", None)):
        return _on_workplane(source)
    for attribute in ("line", "sketch"):  # build123d's BuildLine, BuildSketch
        made = getattr(source, attribute, None)
        if getattr(made, "wrapped", None) is not None:
            return [made]
        if type(source).__name__ in ("BuildLine", "BuildSketch") and hasattr(source, attribute):
            return ()
    return source


def _on_workplane(workplane: Any) -> list[object]:
    """The objects of CadQuery's workplane; of a line that was drawn, all its edges, in order.

    The workplane then holds the last edge only; those before it are held by its parents.
    """
    on_top = list(workplane.vals())
    drawn: list[object] = []
    held, above = on_top, workplane
    while len(held) == 1 and _is_edge(held[0]):
        if not drawn or not held[0].wrapped.IsSame(getattr(drawn[-1], "wrapped", None)):
            drawn.append(held[0])
        above = getattr(above, "parent", None)
        held = [] if above is None else list(above.vals())
    context = getattr(workplane, "ctx", None)
    pending = list(getattr(context, "pendingEdges", ()))
    if drawn and any(edge.wrapped.IsSame(on_top[0].wrapped) for edge in pending):
        return pending
    return drawn[::-1] or on_top


def _is_edge(item: Any) -> bool:
    shape = getattr(item, "wrapped", None)
    return isinstance(shape, TopoDS_Shape) and shape.ShapeType() == TopAbs_EDGE


def _edges_in(shape: TopoDS_Shape, name: str) -> list[TopoDS_Edge]:
    kind = shape.ShapeType()
    if kind == TopAbs_EDGE:
        return [as_edge(shape)]
    if kind == TopAbs_WIRE:
        return _edges_of_wire(as_wire(shape))
    if kind == TopAbs_COMPOUND:
        faces = faces_of(shape)
        if not faces:
            return _edges_of_compound(shape)
        outlines = wires_of(shape)
        if len(faces) == 1 and len(outlines) == 1:
            return _edges_of_wire(outlines[0])
        raise InputError(
            f"{name} cannot be a compound with {len(faces)} faces and {len(outlines)} outlines:"
            " pass a curve, such as one of its edges or wires."
        )
    raise InputError(
        f"{name} cannot be a {kind_name(shape)}: pass a curve, such as one of its edges or wires."
    )


def _edges_of_compound(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """The edges of a compound; its wires' edges as the wires have them."""
    found, inner = [], TopoDS_Iterator(shape)
    while inner.More():
        part = inner.Value()
        if part.ShapeType() == TopAbs_EDGE:
            found.append(as_edge(part))
        elif part.ShapeType() == TopAbs_WIRE:
            found += _edges_of_wire(as_wire(part))
        elif part.ShapeType() == TopAbs_COMPOUND:
            found += _edges_of_compound(part)
        else:
            found += edges_of(part)
        inner.Next()
    return found


def _edges_of_wire(wire: TopoDS_Wire) -> list[TopoDS_Edge]:
    """The edges as the wire stores them.

    A wire turns its edges so that they follow one another. Where it turned some and not others,
    each is given as it was drawn: that is all there is to know which way the whole was drawn.
    """
    stored, inner = [], TopoDS_Iterator(wire)
    while inner.More():
        stored.append(as_edge(inner.Value()))
        inner.Next()
    ways = {edge.Orientation() for edge in stored}
    if len(ways) == 1:
        return stored
    way = TopAbs_REVERSED if wire.Orientation() == TopAbs_REVERSED else TopAbs_FORWARD
    return [as_edge(edge.Oriented(way)) for edge in stored]

"""Edges of whatever a caller holds, put in a row: the raw material of a directrix.

A list is chained in the order given, a wire in its own, a compound (what a STEP file makes of a
wire) in the order that its ends ask for. Edges are flipped as needed. Ends that nearly meet are
moved to their middle; ends further apart are refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.TopAbs import TopAbs_COMPOUND, TopAbs_EDGE, TopAbs_FACE, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Edge, TopoDS_Iterator, TopoDS_Shape, TopoDS_Wire

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.evaluation import PoleCurve
from wrinkle_cad.cad.kernel.splines import curve_arrays
from wrinkle_cad.cad.kernel.topology import as_edge, as_wire, edges_of, kind_name
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import norm

Floats = NDArray[np.float64]


def chain_of(source: object, name: str) -> list[PoleCurve]:
    """Returns the curves of a source, each starting exactly where the one before it ends.

    Args:
        source: an edge, wire, compound of edges, or several edges and wires in order; from
            build123d, CadQuery or the kernel itself.
        name: what messages call the rail, at the start of a sentence.

    Raises:
        InputError: no curve in the source, a surface in it, an edge of no length, or a gap.
        CadError: the kernel cannot convert an edge.
    """
    shapes = _shapes_of(source, name)
    edges = [edge for shape in shapes for edge in _edges_in_order(shape, name)]
    curves = [_curve_of(edge) for edge in edges if not BRep_Tool.Degenerated_s(edge)]
    curves = [curve for curve in curves if _size(curve) > settings.CONFUSION] or curves
    if not curves:
        raise InputError(f"{name} has no curve in it. Pass at least one edge.")
    _check_once(curves, name)
    for curve in curves:
        if not np.isfinite(curve.poles).all():
            raise InputError(
                f"{name} has a curve with NaN or infinite poles. Pass finite geometry."
            )
    if len(shapes) == 1 and shapes[0].ShapeType() == TopAbs_COMPOUND:
        curves = _ordered(curves)
    return _joined(_turned(curves), name)


def _shapes_of(source: object, name: str) -> list[TopoDS_Shape]:
    shape = source if isinstance(source, TopoDS_Shape) else getattr(source, "wrapped", None)
    if isinstance(shape, TopoDS_Shape):
        if shape.IsNull():
            raise InputError(f"{name} is an empty {type(source).__name__}. Pass one with a curve.")
        return [shape]
    values = getattr(source, "vals", None)  # CadQuery's Workplane
    line = getattr(source, "line", None)  # build123d's BuildLine
    if callable(values):
        source = values()
    elif hasattr(line, "wrapped"):
        source = [line]
    if isinstance(source, Iterable) and not isinstance(source, str | bytes):
        return [shape for item in source for shape in _shapes_of(item, name)]
    raise InputError(
        f"{name} cannot be of type {type(source).__name__}: pass an edge, a wire, a list of edges"
        " or a (k, 3) array."
    )


def _edges_in_order(shape: TopoDS_Shape, name: str) -> list[TopoDS_Edge]:
    kind = shape.ShapeType()
    if kind == TopAbs_EDGE:
        return [as_edge(shape)]
    if kind == TopAbs_WIRE:
        return _edges_of_wire(as_wire(shape))
    if kind == TopAbs_COMPOUND and not TopExp_Explorer(shape, TopAbs_FACE).More():
        return edges_of(shape)
    raise InputError(
        f"{name} cannot be a {kind_name(shape)}: pass a curve, such as one of its edges or wires."
    )


def _edges_of_wire(wire: TopoDS_Wire) -> list[TopoDS_Edge]:
    explorer, followed = BRepTools_WireExplorer(wire), []
    while explorer.More():
        followed.append(explorer.Current())
        explorer.Next()
    stored, iterator = [], TopoDS_Iterator(wire)
    while iterator.More():
        stored.append(as_edge(iterator.Value()))
        iterator.Next()
    # The explorer stops where vertices are not shared; the gap, if any, is judged later.
    return followed if len(followed) == len(stored) else stored


def _curve_of(edge: TopoDS_Edge) -> PoleCurve:
    curve = edge_curve(edge)
    poles, weights, knots, multiplicities = curve_arrays(curve)
    return PoleCurve(curve.Degree(), knots, multiplicities, poles, weights)


def _check_once(curves: Sequence[PoleCurve], name: str) -> None:
    """Checks that no edge occurs twice, as the seam does in the outer wire of a cone."""
    seen: dict[bytes, int] = {}
    for i, curve in enumerate(curves):
        poles = np.round(curve.poles, 9) + 0.0
        keys = {rows.tobytes() for rows in (poles, poles[::-1])}
        if any(key in seen for key in keys):
            size = _size(curve)
            start, end = (place_text(at, size) for at in curve.poles[[0, -1]])
            raise InputError(
                f"{name} runs twice over one edge, from {start} to {end}. A rail passes every place"
                " once: choose its edges one by one, or leave that edge out."
            )
        seen |= dict.fromkeys(keys, i)


def _size(curve: PoleCurve) -> float:
    return float(np.ptp(curve.poles, axis=0).max())


def _ordered(curves: Sequence[PoleCurve]) -> list[PoleCurve]:
    """Returns the curves in the order their ends ask for, from a loose end if there is one."""
    ends = np.array([(curve.poles[0], curve.poles[-1]) for curve in curves])
    apart = np.linalg.norm(ends[:, None, :, None] - ends[None, :, None, :], axis=4)
    apart[np.arange(len(curves)), np.arange(len(curves))] = np.inf
    nearest = apart.min(axis=(1, 3), initial=np.inf)
    first, start = divmod(int(np.argmax(nearest)), 2)
    order, side = [first], 1 - start
    left = set(range(len(curves))) - {order[0]}
    while left:
        rest = sorted(left)
        choice = int(np.argmin(apart[order[-1], rest, side, :]))
        j, entry = rest[choice // 2], choice % 2
        order.append(j)
        side = 1 - entry
        left.remove(j)
    return [curves[j] for j in order]


def _turned(curves: Sequence[PoleCurve]) -> list[PoleCurve]:
    """Returns the curves each flipped so that it starts near the end of the one before.

    The first runs as given unless only its start lies near the second; on a tie nothing is flipped.
    """
    turned = list(curves)
    if len(turned) > 1:
        ends = turned[1].poles[[0, -1]]
        from_start = np.linalg.norm(turned[0].poles[0] - ends, axis=1).min()
        from_end = np.linalg.norm(turned[0].poles[-1] - ends, axis=1).min()
        if from_start < from_end and not np.isclose(
            from_start, from_end, rtol=0.0, atol=settings.RAIL_GAP
        ):
            turned[0] = turned[0].reversed()
    for i in range(1, len(turned)):
        here = turned[i - 1].poles[-1]
        start, end = np.linalg.norm(turned[i].poles[[0, -1]] - here, axis=1)
        if end < start:
            turned[i] = turned[i].reversed()
    return turned


def _joined(curves: Sequence[PoleCurve], name: str) -> list[PoleCurve]:
    """Returns the curves with nearly meeting ends moved to their middle, refusing gaps."""
    size = max(_size(curve) for curve in curves)
    limit = min(settings.RAIL_GAP, settings.RAIL_GAP_PER_SIZE * size)
    ends = np.array([(curve.poles[0], curve.poles[-1]) for curve in curves])
    for i in range(1, len(curves)):
        gap = norm(ends[i, 0] - ends[i - 1, 1])
        if gap > limit:
            x, y, z = ends[i - 1, 1]
            raise InputError(
                f"{name} has a gap of {gap:.4g} mm between edges {i} and {i + 1} at"
                f" ({x:.4g}, {y:.4g}, {z:.4g}); at most {limit:.4g} mm is allowed. Join the edges"
                " or pass them in order."
            )
        ends[i, 0] = ends[i - 1, 1] = (ends[i, 0] + ends[i - 1, 1]) / 2.0
    # The ends of one edge are where its author put them; only edges are joined to one another.
    closing = limit if len(curves) > 1 else min(limit, settings.CONFUSION)
    if norm(ends[0, 0] - ends[-1, 1]) <= closing:
        ends[0, 0] = ends[-1, 1] = (ends[0, 0] + ends[-1, 1]) / 2.0
    return [curve.joined(*ends[i]) for i, curve in enumerate(curves)]

"""Proves that the border of a stitched shell is the upper's own border and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.curves import edge_middle
from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import free_edges, make_compound, make_vertex
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.places import place_text

STEP = "compare the border with the upper's"


@dataclass(frozen=True, slots=True)
class Border:
    """The free edges of an upper before and after."""

    before: int
    """How many it had."""
    after: int
    """How many the shell has."""
    length_before: float
    """mm."""
    length_after: float
    """mm."""


def compared_border(
    upper: TopoDS_Shape, shell: TopoDS_Shape, lost: float, allowance: float
) -> Border:
    """Returns the free edges of upper and shell after checking that they are the same lines.

    Args:
        upper: before.
        shell: after.
        lost: mm; border of the upper that was carved out with the strips.
        allowance: mm; how much longer the border may be: by what strips bridge gaps of the upper.

    Raises:
        CadError: a free edge of the shell is none of the upper's, or some of these are missing.
    """
    before, after = free_edges(upper), free_edges(shell)
    lengths = [sum(length_of(edge) for edge in edges) for edges in (before, after)]
    strays = _strays(before, after, allowance)
    if strays:
        raise CadError(
            STEP,
            f"{len(strays)} of the {len(after)} free edges of the result,"
            f" {sum(length_of(edge) for edge in strays):.3g} mm in all, the first at"
            f" {place_text(edge_middle(strays[0]), lengths[0])}, are none of the upper's: the"
            " wrinkle is not watertight. Change the margin, or move the rails a little.",
        )
    off = lengths[1] - (lengths[0] - lost)
    slack = allowance + settings.SEWING * (1 + len(after))
    if not -slack <= off <= slack:
        raise CadError(
            STEP,
            f"the border is {lengths[1]:.6g} mm long, the upper's {lengths[0] - lost:.6g} mm"
            " without what was carved out. They may differ by"
            f" {slack:.3g} mm: change the margin, or move the rails a little.",
        )
    return Border(len(before), len(after), lengths[0], lengths[1])


def _strays(
    before: Sequence[TopoDS_Edge], after: Sequence[TopoDS_Edge], allowance: float
) -> list[TopoDS_Edge]:
    """Returns the free edges that do not lie on the upper's."""
    if not before:
        return list(after)
    held, strays = make_compound(before), []
    known = ShapeIndex(before)
    for edge in after:
        if known.find(edge) >= 0:
            continue
        gap = BRepExtrema_DistShapeShape(make_vertex(edge_middle(edge)), held).Value()
        if gap > settings.SEWING and length_of(edge) > allowance:
            strays.append(edge)
    return strays

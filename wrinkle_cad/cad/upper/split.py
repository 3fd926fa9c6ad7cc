"""Cuts the faces of an upper along the outlines of openings.

A side on one face is drawn onto it. Any other becomes a narrow ribbon that stands on the upper and
crosses seams, gaps and borders without being told of them. The kernel splits the faces with these
edges and ribbons.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import as_face
from wrinkle_cad.cad.kernel.versions import shape_list
from wrinkle_cad.errors import CadError

from .cut_tolerances import settle_tolerances
from .drawn_edges import drawn_edges
from .opening_outline import Side
from .opening_plan import OpeningPlan
from .pieces import Split, sorted_pieces
from .projection import UpperFaces
from .ribbons import ribbon

STEP = "split the upper"


def split_faces(faces: UpperFaces, plans: Sequence[OpeningPlan]) -> Split:
    """Splits the faces of an upper along the outlines of openings, all at once.

    Only the faces near an outline are given to the kernel: the others stay what they are.

    Args:
        faces: of the upper.
        plans: where the openings are to be cut.

    Raises:
        CadError: the kernel cannot split, or a piece lies on both sides of an outline.
        InputError: an opening lies in another.
    """
    with kernel_step(STEP):
        near, tools, drawn = set[int](), list[TopoDS_Shape](), list[TopoDS_Edge]()
        for plan in plans:
            for side, over in zip(plan.sides, plan.overrun, strict=True):
                edges = _drawn(faces.faces, side, over)
                drawn += edges or ()
                tools += edges or [ribbon(side, plan.height, over, faces.faces)]
            near.update(faces.near(plan.points, 2.0 * plan.height))
        splitter = BRepAlgoAPI_Splitter()
        splitter.SetArguments(shape_list([faces.faces[i] for i in sorted(near)]))
        splitter.SetTools(shape_list(tools))
        splitter.SetNonDestructive(True)
        splitter.SetRunParallel(False)
        splitter.Build()
        if not splitter.IsDone():
            raise CadError(STEP, "the kernel's splitter failed. Move the rails a little.")
        pieces = tuple(
            _pieces_of(splitter, face) if i in near else (face,)
            for i, face in enumerate(faces.faces)
        )
        section = ShapeIndex(splitter.SectionEdges())
        for edge in drawn:
            for part in list(splitter.Modified(edge)) or [edge]:
                section.add(part)
    split = sorted_pieces(pieces, section, plans)
    with kernel_step(STEP):
        settle_tolerances(faces.faces, split)
    return split


def _drawn(
    faces: Sequence[TopoDS_Face], side: Side, overrun: tuple[float, float]
) -> list[TopoDS_Edge] | None:
    """Returns a side as edges on the face that holds all of it, None if none does."""
    # Its ends may stand on the border of several faces.
    owners = np.unique(side.faces[1:-1])
    if len(owners) > 1 or max(overrun) > 0.0:
        return None
    return drawn_edges(faces[int(owners[0])], side)


def _pieces_of(splitter: BRepAlgoAPI_Splitter, face: TopoDS_Face) -> tuple[TopoDS_Face, ...]:
    if splitter.IsDeleted(face):
        return ()
    pieces = tuple(as_face(piece.Oriented(face.Orientation())) for piece in splitter.Modified(face))
    return pieces or (face,)

"""Cuts the faces of an upper along the outlines of openings.

An outline on one face is drawn onto it. Any other becomes narrow ribbons that stand on the upper,
one per side, which cross seams, gaps and borders without being told of them. The kernel splits the
faces with these edges or ribbons.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.splines import make_surface
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.kernel.topology import as_face
from wrinkle_cad.cad.kernel.versions import shape_list
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.curve.cubic import cubic_through
from wrinkle_cad.strip.curve.polyline import arc_lengths
from wrinkle_cad.strip.portable import norm

from .drawn_edges import drawn_edges
from .opening_outline import Side, unit
from .opening_plan import OpeningPlan
from .pieces import Split, sorted_pieces
from .projection import UpperFaces

Floats = NDArray[np.float64]


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
            edges = _drawn(faces.faces, plan)
            drawn += edges or ()
            tools += edges or [
                _ribbon(side, plan.height, over)
                for side, over in zip(plan.sides, plan.overrun, strict=True)
            ]
            points = np.vstack([side.points for side in plan.sides])
            near.update(faces.near(points, 2.0 * plan.height))
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
    return sorted_pieces(pieces, section, plans)


def _drawn(faces: Sequence[TopoDS_Face], plan: OpeningPlan) -> list[TopoDS_Edge] | None:
    """Returns an outline as edges on the face that holds all of it, None if none does."""
    owners = np.unique(np.concatenate([side.faces for side in plan.sides]))
    if len(owners) > 1 or any(plan.ends_on_border):
        return None
    return drawn_edges(faces[int(owners[0])], plan.sides)


def _pieces_of(splitter: BRepAlgoAPI_Splitter, face: TopoDS_Face) -> tuple[TopoDS_Face, ...]:
    if splitter.IsDeleted(face):
        return ()
    pieces = tuple(as_face(piece.Oriented(face.Orientation())) for piece in splitter.Modified(face))
    return pieces or (face,)


def _ribbon(side: Side, height: float, overrun: tuple[float, float]) -> TopoDS_Face:
    points, normals = side.points, side.normals
    for first, extra in ((True, overrun[0]), (False, overrun[1])):
        if extra > 0.0:
            points, normals = _extended(points, normals, first, extra)
    arc = arc_lengths(points)
    rows = np.stack((points - height * normals, points + height * normals), axis=1)
    spline = cubic_through(arc, rows.reshape(len(rows), 6))
    knots, counts = np.unique(spline.knots, return_counts=True)
    surface = make_surface(
        spline.poles.reshape(-1, 2, 3), (knots, (0.0, 2.0 * height)), (counts, (2, 2)), (3, 1)
    )
    return BRepBuilderAPI_MakeFace(surface, settings.CONFUSION).Face()


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

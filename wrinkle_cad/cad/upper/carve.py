"""Carves the strip between two rails out of an upper (Fig. 11a of the paper)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.connectivity import border_chain, connected_groups, joined_faces
from wrinkle_cad.cad.kernel.curves import edge_middle
from wrinkle_cad.cad.kernel.measures import face_areas, length_of
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges, make_compound, make_vertex, unwrap
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix, orient_alike
from wrinkle_cad.errors import CadError, InputError

from .opening import CarveRequest, Opening
from .opening_outline import Rail, Side, across_rail, end_between, faded_margin, rail_on, side_of
from .projection import UpperFaces
from .sew import joined
from .smooth import smooth_edge
from .split import Split, split_faces

Floats = NDArray[np.float64]
STEP = "carve the upper"
ENDS = ("start", "end")


def carve(
    upper: object,
    p: object,
    q: object,
    *,
    margin: float = 0.0,
    fade: float = settings.FADE,
    limit: float = settings.RAIL_OFF_UPPER,
    join: float = settings.SEWING,
    allow_split: bool = False,
) -> Opening:
    """Cuts the strip between two rails out of an upper.

    Rails that do not lie on the upper are projected onto it. Where both rails end on the upper's
    border, so does the opening; elsewhere it ends along the projection of the straight end bridge.

    Args:
        upper: a face, shell, solid or compound of faces; sewn or not. It is not written to.
        p: a rail: whatever ``make_directrix`` takes.
        q: the other rail; run either way.
        margin: mm; how far the opening reaches beyond the rails. The margin fades to 0 at the ends.
        fade: the share of the rails, 0 to 0.5, over which the margin fades.
        limit: mm; a rail further from the upper is refused.
        join: mm; faces of the upper that do not share edges are joined where their borders are
            nearer than this. Wider gaps stay open and the strip runs on across them.
        allow_split: whether the opening may cut the upper in two.

    Raises:
        InputError: rails that cross, enclose no area or are too far from the upper; an opening that
            cuts the upper in two; values out of range.
        CadError: the kernel cannot split the upper, or areas do not add up.

    Example:
        >>> from build123d import Edge, Face
        >>> upper = Face.make_rect(100, 60)
        >>> p, q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> opening = carve(upper, p, q, margin=2)
        >>> opening
        Opening(body 4469.8 mm2, removed 1530.2 mm2)
    """
    _check_numbers(margin, fade, limit, join)
    first, second, _ = orient_alike(make_directrix(p, name="P"), make_directrix(q, name="Q"))
    request = CarveRequest(first, second, margin, fade, limit, join, allow_split)
    return carve_shape(unwrap(upper), request, source=upper)


def carve_shape(shape: TopoDS_Shape, request: CarveRequest, *, source: object = None) -> Opening:
    """Cuts an opening into a shape of the kernel; see ``carve``."""
    given = shape
    shape, order = _joined_upper(given, request.join)
    faces = UpperFaces(shape)
    rails = (rail_on(faces, request.p, "P"), rail_on(faces, request.q, "Q"))
    for rail, name in zip(rails, "PQ", strict=True):
        _check_near(rail, name, request.limit)
    across = (
        across_rail(rails[0], rails[1], ("P", "Q")),
        across_rail(rails[1], rails[0], ("Q", "P")),
    )
    on_border = _ends_on_border(shape, rails)
    sides = _sides(faces, rails, across, request, on_border)
    height = settings.RIBBON_PER_LENGTH * min(rail.length for rail in rails)
    beyond = (height * on_border[0], height * on_border[1])
    overrun = [beyond, beyond, (0.0, 0.0), (0.0, 0.0)]
    split = split_faces(faces.faces, shape, sides, height, overrun[: len(sides)])
    body, removed, origin = _divided(split)
    _check_removed(removed, rails)
    count = _check_whole(faces, body, request.allow_split)
    chains, lost = _chains(split, sides, removed, on_border, rails)
    return Opening(
        body_shape=joined_faces(body),
        removed_shape=joined_faces(removed),
        p_edges=chains[0],
        q_edges=chains[1],
        start_edges=chains[2],
        end_edges=chains[3],
        rail_p_curve=_rail_curve(rails[0], request.p),
        rail_q_curve=_rail_curve(rails[1], request.q),
        rails=rails,
        across=across,
        ends_on_border=on_border,
        face_origin=tuple(order[origin[i]] for group in connected_groups(body) for i in group),
        distances=(float(rails[0].feet.distances.max()), float(rails[1].feet.distances.max())),
        areas=_checked_areas(faces.faces, split),
        body_count=count,
        lost_border=lost,
        upper_shape=shape,
        given_shape=given,
        request=request,
        source=source,
    )


def _joined_upper(shape: TopoDS_Shape, join: float) -> tuple[TopoDS_Shape, list[int]]:
    """Returns the upper with its faces joined, and for each the index of the one given."""
    faces = faces_of(shape)
    if join > 0.0 and len(connected_groups(faces)) > 1:
        return joined(faces, join)
    return shape, list(range(len(faces)))


def _sides(
    faces: UpperFaces,
    rails: tuple[Rail, Rail],
    across: tuple[Floats, Floats],
    request: CarveRequest,
    on_border: tuple[bool, bool],
) -> list[Side]:
    sides = [
        side_of(faces, rail, toward, faded_margin(rail.shares, request.margin, request.fade), name)
        for rail, toward, name in zip(rails, across, "pq", strict=True)
    ]
    for at, name in ((0, "start"), (-1, "end")):
        end = None if on_border[at] else end_between(faces, sides[0], sides[1], at, name)
        if end is not None:
            sides.append(end)
    return sides


def _check_numbers(margin: float, fade: float, limit: float, join: float) -> None:
    for name, value, low, high in (
        ("margin", margin, 0.0, np.inf),
        ("fade", fade, settings.FADE_MIN, 0.5),
        ("limit", limit, 0.0, np.inf),
        ("join", join, 0.0, np.inf),
    ):
        if not low <= value <= high or not np.isfinite(value):
            raise InputError(f"{name} is {value:g}: {low:g} to {high:g} is allowed.")


def _check_near(rail: Rail, name: str, limit: float) -> None:
    at = int(rail.feet.distances.argmax())
    distance = float(rail.feet.distances[at])
    if distance > limit:
        raise InputError(
            f"Rail {name} leaves the upper by {distance:.3g} mm at"
            f" {rail.shares[at] * rail.length:.4g} mm of its {rail.length:.4g} mm, at most"
            f" {limit:.3g} mm is allowed. Draw it nearer to the upper, or raise the limit."
        )


def _ends_on_border(shape: TopoDS_Shape, rails: tuple[Rail, Rail]) -> tuple[bool, bool]:
    border = free_edges(shape)
    if not border:
        return False, False
    held = make_compound(border)
    reach = [settings.BORDER_REACH_PER_LENGTH * rail.length for rail in rails]

    def reaches(at: int) -> bool:
        gaps = [
            BRepExtrema_DistShapeShape(make_vertex(rail.points[at]), held).Value() for rail in rails
        ]
        return all(gap <= limit for gap, limit in zip(gaps, reach, strict=True))

    return reaches(0), reaches(-1)


def _divided(split: Split) -> tuple[list[TopoDS_Face], list[TopoDS_Face], tuple[int, ...]]:
    body, removed, origin = [], [], []
    for i, (group, inside) in enumerate(zip(split.pieces, split.is_inside, strict=True)):
        for piece, is_inside in zip(group, inside, strict=True):
            if is_inside:
                removed.append(piece)
            else:
                body.append(piece)
                origin.append(i)
    return body, removed, tuple(origin)


def _check_removed(removed: Sequence[TopoDS_Face], rails: tuple[Rail, Rail]) -> None:
    if not removed:
        raise InputError(
            f"Rails P and Q of {rails[0].length:.4g} and {rails[1].length:.4g} mm cut no piece out"
            " of the upper: their ends lie inside it and do not close, or run beyond it. End both"
            " on the upper, or both on its border."
        )


def _check_whole(faces: UpperFaces, body: Sequence[TopoDS_Face], allow_split: bool) -> int:
    before, after = len(connected_groups(faces.faces)), len(connected_groups(body))
    if after > before and not allow_split:
        raise InputError(
            f"The opening cuts the upper into {after} parts, it had {before}. End the rails inside"
            " the upper, or allow the split (allow_split=True)."
        )
    return after


def _checked_areas(faces: Sequence[TopoDS_Face], split: Split) -> tuple[float, float, float]:
    """Returns mm^2: upper, body, removed; a face that was not split is measured once."""
    bound = settings.AREA_BALANCE / 4.0
    whole = kept = cut = 0.0
    for face, group, inside in zip(faces, split.pieces, split.is_inside, strict=True):
        (before,) = face_areas([face], relative_error=bound)
        is_whole = len(group) == 1 and group[0].IsPartner(face)
        after = [before] if is_whole else face_areas(group, relative_error=bound)
        whole += before
        kept += sum(area for area, is_in in zip(after, inside, strict=True) if not is_in)
        cut += sum(area for area, is_in in zip(after, inside, strict=True) if is_in)
    off = abs(kept + cut - whole) / whole
    if off > settings.AREA_BALANCE:
        raise CadError(
            STEP,
            f"body and removed part have {kept + cut:.9g} mm2, the upper {whole:.9g}: off by"
            f" {off:.1e} of it, at most {settings.AREA_BALANCE:.0e} is allowed. Move the rails.",
        )
    return whole, kept, cut


def _chains(
    split: Split,
    sides: Sequence[Side],
    removed: Sequence[TopoDS_Face],
    on_border: tuple[bool, bool],
    rails: tuple[Rail, Rail],
) -> tuple[list[tuple[TopoDS_Edge, ...]], float]:
    """Returns the edges along P and Q and across both ends, and mm of border lost besides."""
    named: dict[str, tuple[TopoDS_Edge, ...]] = {
        side.name: tuple(cut.edge for cut in split.cuts if cut.side == i)
        for i, side in enumerate(sides)
    }
    cut_edges = ShapeIndex(cut.edge for cut in split.cuts)
    border = [edge for edge in free_edges(make_compound(removed)) if cut_edges.find(edge) < 0]
    corners = np.array([[rail.points[at] for rail in rails] for at in (0, -1)])
    middles = corners.mean(axis=1)
    for at, name in enumerate(ENDS):
        if on_border[at]:
            near = [
                edge
                for edge in border
                if int(np.argmin(np.linalg.norm(middles - edge_middle(edge), axis=1))) == at
            ]
            named[name] = border_chain(near, corners[at, 0], corners[at, 1])
    kept = ShapeIndex(edge for at in (0, 1) if on_border[at] for edge in named[ENDS[at]])
    lost = sum(length_of(edge) for edge in border if kept.find(edge) < 0)
    return [named.get(name, ()) for name in ("p", "q", *ENDS)], lost


def _rail_curve(rail: Rail, given: Directrix) -> Directrix:
    """Returns the rail itself if it lies on the upper, else a smooth curve through its feet."""
    if float(rail.feet.distances.max()) <= settings.RAIL_ON_UPPER:
        return given
    return make_directrix(smooth_edge(rail.points), name=given.name)

"""Carves the strip between two rails out of an upper (Fig. 11a of the paper)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.connectivity import border_chain, connected_groups, joined_faces
from wrinkle_cad.cad.kernel.curves import edge_middle
from wrinkle_cad.cad.kernel.measures import face_areas, length_of
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges, make_compound
from wrinkle_cad.cad.rail.closed_starts import are_closed
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix, orient_alike
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.options.checking import check_numbers
from wrinkle_cad.options.signature import knows_its_options

from .given_upper import upper_object, upper_shape
from .opening import CarveRequest, Opening
from .opening_outline import Rail
from .opening_plan import ENDS, OpeningPlan, plan_opening
from .openings_apart import check_openings_apart
from .pieces import CutEdge, Split
from .projection import UpperFaces
from .sew import joined
from .smooth import smooth_edge
from .split import split_faces

Floats = NDArray[np.float64]
STEP = "carve the upper"


@knows_its_options
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
    Closed rails make an opening like a ring, which may go all around the upper: the strip alone
    joins its parts again.

    Args:
        upper: a face, shell, solid (its outer shell), part, compound or list of such, sewn or not;
            a builder of build123d or a workplane of CadQuery with one. It is not written to.
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
    request = carve_request(
        p, q, margin=margin, fade=fade, limit=limit, join=join, allow_split=allow_split
    )
    return carve_shape(upper_shape(upper), request, source=upper_object(upper))


def carve_all(
    upper: object,
    rails: Sequence[tuple[object, object]],
    *,
    margin: float = 0.0,
    fade: float = settings.FADE,
    limit: float = settings.RAIL_OFF_UPPER,
    join: float = settings.SEWING,
    allow_split: bool = False,
    names: Sequence[str] = (),
) -> list[Opening]:
    """Cuts several strips out of an upper at once: many times as fast as one after the other.

    Args:
        upper: as in ``carve``.
        rails: per strip its rails P and Q.
        margin: mm; as in ``carve``, as are the options that follow.
        fade: share of the rails.
        limit: mm.
        join: mm.
        allow_split: whether the openings may part the upper.
        names: of the strips, for messages; A, B, C and so on when left out.

    Returns:
        One opening per strip; all have the same body, the upper without any of them.

    Raises:
        InputError: as ``carve``; openings that overlap, touch or lie in each other.
        CadError: as ``carve``.

    Example:
        >>> from build123d import Edge, Face
        >>> def line(y):
        ...     return Edge.make_line((-40, y), (40, y))
        >>> carve_all(Face.make_rect(100, 60), [(line(-20), line(-10)), (line(5), line(20))])
        [Opening(body 4000.0 mm2, removed 800.0 mm2), Opening(body 4000.0 mm2, removed 1200.0 mm2)]
    """
    if not rails or len(names) not in (0, len(rails)):
        raise InputError(
            f"{len(rails)} pairs of rails and {len(names)} names are given: pass at least one pair,"
            " and one name per pair or none."
        )
    called = names or [_letters(k) for k in range(len(rails))]
    requests = [
        carve_request(
            p,
            q,
            margin=margin,
            fade=fade,
            limit=limit,
            join=join,
            allow_split=allow_split,
            name=name,
        )
        for (p, q), name in zip(rails, called, strict=True)
    ]
    return carve_shapes(upper_shape(upper), requests, source=upper_object(upper))


def _letters(k: int) -> str:
    return chr(65 + k) if k < 26 else _letters(k // 26 - 1) + chr(65 + k % 26)


def carve_request(
    p: object,
    q: object,
    *,
    margin: float | None = None,
    fade: float = settings.FADE,
    limit: float = settings.RAIL_OFF_UPPER,
    join: float = settings.SEWING,
    allow_split: bool = False,
    tolerance: float = settings.TOLERANCE,
    name: str = "",
) -> CarveRequest:
    """Returns what ``carve_shapes`` takes for one strip, its rails turned alike.

    Raises:
        InputError: what is no rail; one closed and one open rail; values out of range.
    """
    _check_numbers(0.0 if margin is None else margin, fade, limit, join)
    first, second, _ = orient_alike(make_directrix(p, name="P"), make_directrix(q, name="Q"))
    are_closed(first, second)
    return CarveRequest(first, second, margin, fade, limit, join, allow_split, tolerance, name)


def carve_shape(shape: TopoDS_Shape, request: CarveRequest, *, source: object = None) -> Opening:
    """Cuts an opening into a shape of the kernel; see ``carve``."""
    return carve_shapes(shape, [request], source=source)[0]


def carve_shapes(
    shape: TopoDS_Shape, requests: Sequence[CarveRequest], *, source: object = None
) -> list[Opening]:
    """Cuts several openings into one shape of the kernel at once; see ``carve``.

    All have one and the same body, that without any of the strips.

    Raises:
        InputError: as ``carve``; openings that overlap, touch or lie in each other.
        CadError: as ``carve``.
    """
    given = shape
    shape, order = _joined_upper(given, max(request.join for request in requests))
    faces = UpperFaces(shape)
    plans = [plan_opening(faces, shape, request) for request in requests]
    check_openings_apart(plans)
    split = split_faces(faces, plans)
    body, removed, origin = _divided(split, plans)
    for plan, cut in zip(plans, removed, strict=True):
        _check_removed(cut, plan.rails)
    # A ring has an inside and an outside: the strip joins them again.
    allowed = all(plan.request.allow_split or plan.rails[0].is_ring for plan in plans)
    count = _check_whole(faces, body, allowed)
    body_shape = joined_faces(body)
    whole, kept, cut_areas = _checked_areas(faces.faces, split, len(plans))
    groups = connected_groups(body)
    openings = []
    for k, plan in enumerate(plans):
        chains, lost = _chains(split.cuts[k], plan, removed[k])
        openings.append(
            Opening(
                body_shape=body_shape,
                removed_shape=joined_faces(removed[k]),
                p_edges=chains[0],
                q_edges=chains[1],
                start_edges=chains[2],
                end_edges=chains[3],
                rail_p_curve=_rail_curve(plan.rails[0], plan.request.p),
                rail_q_curve=_rail_curve(plan.rails[1], plan.request.q),
                rails=plan.rails,
                across=plan.across,
                ends_on_border=plan.ends_on_border,
                face_origin=tuple(order[origin[i]] for group in groups for i in group),
                distances=_distances(plan.rails),
                areas=(whole, kept, cut_areas[k]),
                removed_beside=sum(cut_areas) - cut_areas[k],
                body_count=count,
                lost_border=lost,
                upper_shape=shape,
                given_shape=given,
                request=plan.request,
                source=source,
            )
        )
    return openings


def _joined_upper(shape: TopoDS_Shape, join: float) -> tuple[TopoDS_Shape, list[int]]:
    """Returns the upper with its faces joined, and for each the index of the one given."""
    faces = faces_of(shape)
    if join > 0.0 and len(connected_groups(faces)) > 1:
        return joined(faces, join)
    return shape, list(range(len(faces)))


def _check_numbers(margin: float, fade: float, limit: float, join: float) -> None:
    check_numbers(margin=margin, fade=fade, limit=limit, join=join)
    for name, value, low, high in (
        ("margin", margin, 0.0, np.inf),
        ("fade", fade, settings.FADE_MIN, 0.5),
        ("limit", limit, 0.0, np.inf),
        ("join", join, 0.0, np.inf),
    ):
        if not low <= value <= high or not np.isfinite(value):
            raise InputError(f"{name} is {value:g}: {low:g} to {high:g} is allowed.")


def _divided(
    split: Split, plans: Sequence[OpeningPlan]
) -> tuple[list[TopoDS_Face], list[list[TopoDS_Face]], tuple[int, ...]]:
    """Returns the body's faces, those cut out per opening, and the body's faces' origin."""
    body, origin = list[TopoDS_Face](), list[int]()
    removed: list[list[TopoDS_Face]] = [[] for _ in plans]
    for i, (group, inside) in enumerate(zip(split.pieces, split.inside, strict=True)):
        for piece, of in zip(group, inside, strict=True):
            if of < 0:
                body.append(piece)
                origin.append(i)
            else:
                removed[of].append(piece)
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


def _checked_areas(
    faces: Sequence[TopoDS_Face], split: Split, count: int
) -> tuple[float, float, list[float]]:
    """Returns mm^2: upper, body, and removed per opening; what was not split is measured once."""
    bound = settings.AREA_BALANCE / 4.0
    whole = kept = 0.0
    removed = [0.0] * count
    for face, group, inside in zip(faces, split.pieces, split.inside, strict=True):
        (before,) = face_areas([face], relative_error=bound)
        is_whole = len(group) == 1 and group[0].IsPartner(face)
        after = [before] if is_whole else face_areas(group, relative_error=bound)
        whole += before
        for area, of in zip(after, inside, strict=True):
            if of < 0:
                kept += area
            else:
                removed[of] += area
    cut = sum(removed)
    off = abs(kept + cut - whole) / whole
    if off > settings.AREA_BALANCE:
        raise CadError(
            STEP,
            f"body and removed part have {kept + cut:.9g} mm2, the upper {whole:.9g}: off by"
            f" {off:.1e} of it, at most {settings.AREA_BALANCE:.0e} is allowed. Move the rails.",
        )
    return whole, kept, removed


def _chains(
    cuts: Sequence[CutEdge], plan: OpeningPlan, removed: Sequence[TopoDS_Face]
) -> tuple[list[tuple[TopoDS_Edge, ...]], float]:
    """Returns the edges along P and Q and across both ends, and mm of border lost besides."""
    rails, on_border = plan.rails, plan.ends_on_border
    named: dict[str, tuple[TopoDS_Edge, ...]] = {
        side.name: tuple(cut.edge for cut in cuts if cut.side == i)
        for i, side in enumerate(plan.sides)
    }
    cut_edges = ShapeIndex(cut.edge for cut in cuts)
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


def _distances(rails: tuple[Rail, Rail]) -> tuple[float, float]:
    return float(rails[0].feet.distances.max()), float(rails[1].feet.distances.max())


def _rail_curve(rail: Rail, given: Directrix) -> Directrix:
    """Returns the rail itself if it lies on the upper, else a smooth curve through its feet."""
    if float(rail.feet.distances.max()) <= settings.RAIL_ON_UPPER:
        return given
    return make_directrix(smooth_edge(rail.points), name=given.name)

"""Bands: the strips that close the gap between an opening's boundary and the profiles.

A band is found by the same search as the wrinkle itself, and shares the wrinkle's samples along the
profile; only where a face would be folded it has more. It has zero width at both ends of the
opening; anywhere else that would leave a slit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shell

from wrinkle_cad import settings
from wrinkle_cad.cad.faces.exact_surface import exact_surface
from wrinkle_cad.cad.faces.shell import build_shell
from wrinkle_cad.cad.faces.smooth_surface import SmoothSurface, smooth_surface
from wrinkle_cad.cad.kernel.curves import edge_ends
from wrinkle_cad.cad.rail.closed_cut import cut_open, without_end
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix, sample_directrix
from wrinkle_cad.cad.rail.joint_samples import met_at_ends, samples_against, search_between
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.crossings import self_crossings
from wrinkle_cad.strip.curve.nearest import nearest_on_polyline
from wrinkle_cad.strip.curve.polyline import row_lengths, segment_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.flat.turning import without_turning_back
from wrinkle_cad.strip.places import place_text
from wrinkle_cad.strip.portable import norm
from wrinkle_cad.strip.sampled_strip import SampledStrip
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

from .opening import Opening
from .opening_outline import Rail

Floats = NDArray[np.float64]


class StripLike(SampledStrip, Protocol):
    """What a strip must know to be stitched in; ``WrinkleStrip`` does."""

    @property
    def p(self) -> Directrix:
        """The profile along the opening's P side."""

    @property
    def q(self) -> Directrix:
        """The profile along the opening's Q side."""

    @property
    def surface(self) -> settings.Surface:
        """What its faces are."""

    def topods_shell(self) -> TopoDS_Shell:
        """Returns its surface."""


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """The strip between one side of an opening and one profile."""

    name: str
    """``P`` or ``Q``, the rail that it closes up to; in a stitched upper after its strip's name."""
    p: Directrix
    """Its rail along P: the opening's boundary or the profile."""
    q: Directrix
    """Its rail along Q, in the same direction."""
    p_samples: Samples
    """The samples of its rail along P."""
    q_samples: Samples
    """The samples of its rail along Q."""
    triangulation: Triangulation
    """The band, as triangles."""
    shell: TopoDS_Shell
    """The band, as faces."""
    width: float
    """mm; the largest distance between boundary and profile."""
    smooth: SmoothSurface | None = None
    """Its smooth surface, if that was asked for."""


def side_curve(edges: Sequence[TopoDS_Edge], name: str) -> Directrix:
    """Returns the edges of one side as one directrix; gaps of the upper are crossed straight."""
    run: list[TopoDS_Edge] = []
    for edge in edges:
        if run:
            before, after = edge_ends(run[-1])[1], edge_ends(edge)[0]
            if norm(after - before) > settings.GAP_CROSSED:
                run.append(_straight(before, after))
        run.append(edge)
    return make_directrix(run, name=name)


def _straight(start: Floats, end: Floats) -> TopoDS_Edge:
    points = (gp_Pnt(*start.tolist()), gp_Pnt(*end.tolist()))
    return BRepBuilderAPI_MakeEdge(*points).Edge()


def band_name(strip: str, rail: str) -> str:
    """Returns what the band of a strip along one of its rails is called.

    >>> band_name("vamp", "P")
    'vamp band P'
    """
    return f"{strip} band {rail}"


def bands_of(opening: Opening, strip: StripLike, tolerance: float) -> Iterator[Band]:
    """Returns the bands between an opening and a strip, under their names.

    Args:
        opening: what was carved.
        strip: between its profiles.
        tolerance: mm; chords of the bands along the opening.

    Raises:
        InputError: as ``make_band``.
    """
    for i in range(2):
        band = make_band(opening, i, strip, tolerance)
        if band is not None:
            yield band


def make_band(opening: Opening, i: int, strip: StripLike, tolerance: float) -> Band | None:
    """Returns the band between one side of an opening and a profile, None if they coincide.

    It lies between its rails as the wrinkle does between P and Q, so that all strips of one opening
    face the same way. Its price for an invalid bridge is the wrinkle's, and the default one where
    that has none: a band that folds to be more developable is of no use.

    Args:
        opening: what was carved.
        i: 0 for the side along P, 1 for that along Q.
        strip: the wrinkle, whose rail along that side is the profile.
        tolerance: mm; chords of the side.

    Raises:
        InputError: the band has no width somewhere between its ends, or folds over.
    """
    name, price = "PQ"[i], strip.triangulation.price
    profile, samples = (strip.q, strip.q_samples) if i else (strip.p, strip.p_samples)
    side = side_curve(opening.q_edges if i else opening.p_edges, f"opening along {name}")
    parameters = np.linspace(*profile.interval, settings.BAND_CHECKS)
    gaps = distances_from(profile.point_at(parameters), side)
    # The samples alone do not tell: a straight profile has them at its ends only.
    width = float(max(gaps.max(), distances_from(samples.points, side).max()))
    if width <= settings.SEWN_DIRECTLY:
        return None
    _check_open(parameters, gaps, width, name)
    # The profile's samples are the wrinkle's too: only the side is sampled with regard to them.
    rails, sampled, triangulation = _searched(
        i, profile, samples, side, tolerance, settings.PRICE if price is None else price
    )
    _check_folds(triangulation, opening, i, width)
    smooth = None
    if strip.surface == "smooth":
        ruled = exact_surface(*rails, *sampled, triangulation)
        smooth = smooth_surface(f"the band along {name}", rails, sampled, triangulation, ruled)
    if smooth is not None and smooth.made is not None:
        shell = smooth.made[0]
    else:
        shell = build_shell(triangulation, *rails, *sampled, settings.SURFACE)
    own = band_name(strip.name, name)
    return Band(own, *rails, *sampled, triangulation, shell, width, smooth)


def _searched(
    i: int,
    profile: Directrix,
    samples: Samples,
    side: Directrix,
    tolerance: float,
    price: float,
) -> tuple[tuple[Directrix, Directrix], tuple[Samples, Samples], Triangulation]:
    """The best strip between a profile, which keeps its samples, and a side of an opening."""
    side_samples = samples_against(
        side, sample_directrix(side, tolerance), samples.points, tolerance
    )
    rails = (profile, side) if i else (side, profile)
    sampled = (samples, side_samples) if i else (side_samples, samples)
    search = partial(triangulate, planarity=settings.planarity_from(tolerance), price=price)
    if profile.is_closed:
        around = search(without_end(sampled[0]), without_end(sampled[1]), closed=True)
        # Cut where the wrinkle is: the profile then begins where it does, and so do its notches.
        starts = around.bridges[:-1] % (len(around.p), len(around.q))
        own = starts[starts[:, 1 - i] == 0]
        apart = row_lengths(around.p[own[:, 0]] - around.q[own[:, 1]])
        at_p, at_q = own[int(apart.argmin())].tolist()
        found = cut_open(around, rails, sampled, (at_p, at_q))
        return found.rails, found.samples, found.triangulation
    keeps = (i == 1, i == 0)
    sampled = met_at_ends(*sampled, keeps=keeps)
    free = (None, side) if i else (side, None)
    triangulation, sampled = without_turning_back(
        *search_between(free, sampled, tolerance, search),
        (rails[0].point_at, rails[1].point_at),
        search,
        tolerance=settings.FLAT_LINE_PER_TOLERANCE * tolerance,
        keeps=keeps,
    )
    return rails, sampled, triangulation


def check_sewable(strip: StripLike) -> None:
    """Checks that the borders of a strip's faces are its rails, as they are not of facets.

    Raises:
        InputError: chords of a strip of facets leave its rails by more than what is sewn.
    """
    if strip.surface != "facets":
        return
    for rail, samples in ((strip.p, strip.p_samples), (strip.q, strip.q_samples)):
        middles = rail.point_at(0.5 * (samples.parameters[1:] + samples.parameters[:-1]))
        chords = np.diff(samples.points, axis=0)
        across = np.cross(middles - samples.points[:-1], chords)
        apart = float((row_lengths(across) / row_lengths(chords)).max(initial=0.0))
        if apart > settings.SEWING:
            raise InputError(
                f"Strip {strip.name} is made of facets, whose chords leave its rails by"
                f" {apart:.2g} mm, so that it cannot be sewn into an upper, where at most"
                f" {settings.SEWING:g} mm may be. Choose the surface cones or smooth."
            )


def check_beside(samples: Samples, edges: Sequence[TopoDS_Edge], name: str) -> None:
    """Checks that a closed profile belongs to the side of a ring-shaped opening.

    Raises:
        InputError: it is too far from it.
    """
    side = side_curve(edges, f"opening along {name}")
    gap = float(distances_from(samples.points, side).min())
    if gap > settings.RAIL_OFF_UPPER or not side.is_closed:
        raise InputError(
            f"Profile {name} is closed and at least {gap:.3g} mm from its side of the opening: at"
            f" most {settings.RAIL_OFF_UPPER:.3g} mm is allowed, and the opening must be a ring."
            " Pass the profiles of this opening."
        )


def distances_from(points: Floats, side: Directrix) -> Floats:
    """Returns (k,) mm: how far points are from a curve, exact to far below the band's width."""
    parameters = np.union1d(np.linspace(*side.interval, settings.BAND_LINE), side.breaks)
    line = side.point_at(parameters)
    nearest = nearest_on_polyline(points, line)
    steps = np.diff(parameters)[nearest.segment]
    feet = parameters[nearest.segment] + nearest.share * steps
    speeds = segment_lengths(line)[nearest.segment] / steps
    for _ in range(2):
        # A foot on the chord is off along the curve where the curve's speed varies.
        along = ((points - side.point_at(feet)) * side.tangent_at(feet)).sum(axis=1)
        feet = np.clip(feet + along / speeds, *side.interval)
    gaps: Floats = np.linalg.norm(side.point_at(feet) - points, axis=1)
    return gaps


def _check_open(parameters: Floats, gaps: Floats, width: float, name: str) -> None:
    """Checks that a band narrows to nothing at its two ends only.

    Near an end it narrows steadily; anywhere else the width has a minimum of its own.
    """
    inner = gaps[1:-1]
    is_least = (inner <= gaps[:-2]) & (inner <= gaps[2:])
    narrow = is_least & (inner < settings.BAND_NARROWEST * width)
    if narrow.any():
        at = 1 + int(np.flatnonzero(narrow)[inner[narrow].argmin()])
        raise InputError(
            f"Profile {name} touches the opening's boundary at {parameters[at]:.4g} mm along it"
            f" ({gaps[at]:.1e} mm) and leaves it by {width:.3g} mm elsewhere. A band may have no"
            " width at its two ends only: carve with a margin, or keep the profile on the"
            " boundary."
        )


def _check_folds(triangulation: Triangulation, opening: Opening, i: int, width: float) -> None:
    name, (share, place) = "PQ"[i], _overhang(triangulation, opening, i)
    if share > settings.BAND_OVERHANG_LIMIT:
        raise InputError(
            f"The band along {name} is up to {width:.3g} mm wide and {share:.0%} of it folds over:"
            f" it faces into the upper, most at {place}. At most"
            f" {settings.BAND_OVERHANG_LIMIT:.0%} may: lower the waves, take"
            " fewer of them or a wider margin."
        )
    fold = np.abs(triangulation.fold)
    worst = float(fold.max(initial=0.0))
    if worst > settings.BAND_FOLD_LIMIT:
        at, to = triangulation.bridges[int(fold.argmax()) + (not triangulation.is_closed)]
        middle = 0.5 * (
            triangulation.p[at % len(triangulation.p)] + triangulation.q[to % len(triangulation.q)]
        )
        raise InputError(
            f"The band along {name} is up to {width:.3g} mm wide and folds over by"
            f" {np.degrees(worst):.0f} degrees at {place_text(middle, 0.0)}, at most"
            f" {np.degrees(settings.BAND_FOLD_LIMIT):.0f} are allowed. Lower the waves,"
            " take fewer of them or a wider margin."
        )


def _overhang(triangulation: Triangulation, opening: Opening, i: int) -> tuple[float, str]:
    """Returns the share of a band's area that faces against the upper's normal, and where.

    Below a fold of the profile that overhangs, where it runs back along its rail, a band has to.
    """
    rail, first = opening.rails[i], opening.rails[0]
    facing_of_strip = np.cross(first.tangents, opening.across[0]) * first.feet.normals
    corners = np.vstack((triangulation.p, triangulation.q))[triangulation.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middles = corners.mean(axis=1)
    nearest = np.linalg.norm(middles[:, None] - rail.points[None], axis=2).argmin(axis=1)
    facing = (areas * rail.feet.normals[nearest]).sum(axis=1) * np.sign(facing_of_strip.sum())
    sizes = np.linalg.norm(areas, axis=1)
    is_against = facing < 0.0
    # A band that cuts itself was not meant to overhang.
    is_much = sizes[is_against].sum() > settings.BAND_OVERHANG_LIMIT * sizes.sum()
    if is_much and not self_crossings(triangulation).count:
        is_against &= ~_below_overhangs(triangulation, rail, nearest, i)
    most = middles[np.where(is_against, sizes, 0.0).argmax()]
    return float(sizes[is_against].sum() / sizes.sum()), place_text(most, 0.0)


def _below_overhangs(
    triangulation: Triangulation, rail: Rail, nearest: NDArray[np.int64], i: int
) -> NDArray[np.bool_]:
    """Returns (t,) bool: triangles on a chord of the profile that runs back along its rail.

    Not where it does so because the upper curves: beyond its centers of curvature.
    """
    is_on_q = triangulation.triangles >= len(triangulation.p)
    on_profile = np.sort(np.where(is_on_q == (i == 0), triangulation.triangles, -1), axis=1)
    corners = np.vstack((triangulation.p, triangulation.q))[on_profile[:, 1:]]
    along = ((corners[:, 1] - corners[:, 0]) * rail.tangents[nearest]).sum(axis=1)
    turning = np.gradient(rail.feet.normals, rail.shares * rail.length, axis=0)
    bend = (turning * rail.tangents).sum(axis=1)[nearest]
    raised = corners.mean(axis=1) - rail.points[nearest]
    height = (raised * rail.feet.normals[nearest]).sum(axis=1)
    return np.asarray((on_profile[:, 1] >= 0) & (along < 0.0) & (1.0 + height * bend > 0.0))

"""Fig. 11 for one job: carves the upper, designs or takes the profiles, stitches them in."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.upper.options import WaveSettings
from wrinkle_cad.errors import Finding
from wrinkle_cad.options.option import options_of
from wrinkle_cad.wrinkle.facing import faces_away
from wrinkle_cad.wrinkle.grain import Stock
from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

from .job import Job
from .parts import limits_of, material_of, rails_of, strip_name, strip_of, without_rail

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen, StripInput
    from wrinkle_cad.cad.exchange.shapes import NamedShape
    from wrinkle_cad.cad.upper.bands import Band
    from wrinkle_cad.cad.upper.opening import CarveRequest, Opening
    from wrinkle_cad.cad.upper.stitch import Stitched


Strip = TypeVar("Strip", bound=TriangulatedStrip)


@dataclass(frozen=True, slots=True, eq=False)
class WrinkledUpper:
    """An upper with its wrinkles stitched in.

    Example:
        >>> from pathlib import Path
        >>> from wrinkle_cad import Job, Part, choose_inputs, read_cad, write_step
        >>> from build123d import Edge, Face
        >>> rails = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> shapes = zip([Face.make_rect(100, 60), *rails], ["upper", "P", "Q"], strict=True)
        >>> write_step(Path("shoe.step"), [Part(shape.wrapped, name) for shape, name in shapes])
        >>> job = Job(input=Path("shoe.step"), waves=3, height=2)
        >>> wrinkle_upper(job, choose_inputs(read_cad(job.input))).stitched.report.free_edges_after
        4
    """

    given: NamedShape
    """The upper as the file has it."""
    openings: tuple[Opening, ...]
    """What was carved, in the order of the strips."""
    strips: tuple[WrinkleStrip, ...]
    """The wrinkles."""
    bands: tuple[TriangulatedStrip, ...]
    """The strips between the openings' boundaries and the wrinkles."""
    stitched: Stitched
    """The shell and its report."""
    waves: tuple[object, ...]
    """How the profiles were designed."""

    @property
    def turned_over(self) -> tuple[bool, ...]:
        """For each strip, then each band, whether its normal points to the upper's inside."""
        points, outward = _outside(self.openings)
        return tuple(
            faces_away(strip.triangulation, points, outward)
            for strip in (*self.strips, *self.bands)
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What the user should know about the carving."""
        return tuple(
            Finding(
                "rail-off-upper",
                "info",
                f"{rail} of {strip.name} lay up to {distance:.3f} mm from the upper and was"
                f" projected onto it; up to {settings.RAIL_OFF_UPPER:g} mm is allowed.",
            )
            for opening, strip in zip(self.openings, self.strips, strict=True)
            for rail, distance in zip("PQ", opening.distances, strict=True)
            if distance > strip.tolerance
        )

    def stitch_as_json(self) -> dict[str, Any]:
        """The stitching as plain values, as it stands in NAME.json."""
        report = self.stitched.report
        return {
            "faces": report.face_count,
            "free_edges_before": report.free_edges_before,
            "free_edges_after": report.free_edges_after,
            "free_length_before_mm": report.free_length_before_mm,
            "free_length_after_mm": report.free_length_after_mm,
            "max_edge_tolerance_mm": report.max_edge_tolerance_mm,
            "area_balance_mm2": report.area_balance_mm2,
            "area_mm2": report.area_mm2,
            "is_valid": report.is_valid,
            "seams": [
                {
                    "seam": seam.seam,
                    "length_mm": seam.length_mm,
                    "mean_deg": math.degrees(seam.mean),
                    "largest_deg": math.degrees(seam.largest),
                }
                for seam in report.seams
            ],
        }


def wrinkle_upper(job: Job, chosen: Chosen) -> WrinkledUpper:
    """Carves the upper along every strip's rails and stitches the wrinkles in.

    With ``job.waves`` the profiles are designed from the rails on the upper; without, P and Q of
    the file are the profiles.

    Args:
        job: the settings.
        chosen: the rails and the upper.

    Raises:
        InputError: a rail or a profile does not fit the upper.
        CadError: the parts do not become one valid shell.

    Example:
        >>> from pathlib import Path
        >>> from wrinkle_cad import Job, Part, choose_inputs, read_cad, write_step
        >>> from build123d import Edge, Face
        >>> rails = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> shapes = zip([Face.make_rect(100, 60), *rails], ["upper", "P", "Q"], strict=True)
        >>> write_step(Path("shoe.step"), [Part(shape.wrapped, name) for shape, name in shapes])
        >>> job = Job(input=Path("shoe.step"), waves=3, height=2)
        >>> wrinkled = wrinkle_upper(job, choose_inputs(read_cad(job.input)))
        >>> [strip.name for strip in (*wrinkled.strips, *wrinkled.bands)]
        ['shoe', 'shoe band P', 'shoe band Q']
    """
    from wrinkle_cad.cad.upper.carve import carve_shapes
    from wrinkle_cad.cad.upper.stitch import stitch

    assert chosen.upper is not None
    upper = chosen.upper.shape
    requests = [_request(job, given) for given in chosen.strips]
    openings = carve_shapes(upper, requests, source=upper)
    strips = [
        _wrinkle_in(job, opening, given)
        for opening, given in zip(openings, chosen.strips, strict=True)
    ]
    if job.waves is None and any(any(strip.triangulation.unused) for strip in strips):
        openings, strips = _shortened(job, chosen, strips)
    stitched = stitch(openings, strips, tolerance=job.tolerance)
    return WrinkledUpper(
        chosen.upper,
        tuple(openings),
        tuple(_facing_out(strips, openings)),
        tuple(_facing_out(_bands(job, stitched.report.bands), openings)),
        stitched,
        _waves_of(job),
    )


def _shortened(
    job: Job, chosen: Chosen, strips: Sequence[WrinkleStrip]
) -> tuple[list[Opening], list[WrinkleStrip]]:
    """Openings only as long as strips with free ends are, and the strips in them."""
    from wrinkle_cad.cad.upper.carve import carve_shapes

    assert chosen.upper is not None
    upper = chosen.upper.shape
    requests = [
        _request(job, given, (strip.p, strip.q))
        for strip, given in zip(strips, chosen.strips, strict=True)
    ]
    openings = carve_shapes(upper, requests, source=upper)
    found = []
    for opening, strip, given in zip(openings, strips, chosen.strips, strict=True):
        rails = _profiles(job, opening, given, (strip.p, strip.q))
        own = without_rail(job, strip.triangulation.unused)
        found.append(strip_of(own, *rails, given.name).as_rest_of(strip))
    return openings, found


def tried_on_upper(
    job: Job, chosen: Chosen, made: WrinkledUpper, names: Collection[str]
) -> tuple[TriangulatedStrip, ...]:
    """Makes some strips of an upper anew under other settings; nothing is sewn.

    An opening that the settings do not change is kept. Bands are made only where their rails are
    others: of every wrinkle that is asked for or whose band is, since a wave whose bands fold over
    cannot be made.

    Args:
        job: the settings.
        chosen: the rails and the upper.
        made: the upper as it was made before.
        names: of the strips and bands that are asked for.

    Raises:
        InputError: as ``wrinkle_upper``.
        CadError: a strip or a band has no valid surface.
    """
    from wrinkle_cad.cad.upper.bands import band_name, bands_of
    from wrinkle_cad.cad.upper.carve import carve_shapes

    assert chosen.upper is not None
    upper = chosen.upper.shape
    requests = [_request(job, given) for given in chosen.strips]
    before = [opening.request for opening in made.openings]
    is_kept = all(map(_opens_alike, requests, before))
    openings = made.openings if is_kept else carve_shapes(upper, requests, source=upper)
    # Where neither openings nor waves are others the bands' rails are what they were.
    has_bands = not is_kept or _waves_of(job) != made.waves
    found: list[TriangulatedStrip] = []
    for opening, given in zip(openings, chosen.strips, strict=True):
        own = {strip_name(job, given.name)}
        own |= {band_name(name, rail) for name in tuple(own) for rail in "PQ"}
        if own.isdisjoint(names):
            continue
        strip = _wrinkle_in(job, opening, given)
        found.append(strip)
        if has_bands:
            found.extend(_bands(job, bands_of(opening, strip, job.tolerance)))
    return tuple(strip for strip in _facing_out(found, openings) if strip.name in names)


def _opens_alike(request: CarveRequest, other: CarveRequest) -> bool:
    """Whether two requests for the same rails cut the same opening, to within the tolerance."""
    return (request.margin, request.fade) == (other.margin, other.fade)


def _waves_of(job: Job) -> tuple[object, ...]:
    return tuple(getattr(job, name) for name in options_of(WaveSettings))


def _wrinkle_in(job: Job, opening: Opening, given: StripInput) -> WrinkleStrip:
    return strip_of(job, *_profiles(job, opening, given), given.name)


def _facing_out(strips: Iterable[Strip], openings: Sequence[Opening]) -> Iterator[Strip]:
    """The strips, with the upper's outside as their right side."""
    points, outward = _outside(openings)
    for strip in strips:
        is_over = faces_away(strip.triangulation, points, outward)
        yield strip.turned_over() if is_over else strip


def _outside(openings: Sequence[Opening]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points of the upper beside its openings, and its outward normals there."""
    feet = [rail.feet for opening in openings for rail in opening.rails]
    return np.vstack([each.points for each in feet]), np.vstack([each.normals for each in feet])


def _request(
    job: Job, given: StripInput, rails: tuple[object, object] | None = None
) -> CarveRequest:
    """What is to be carved: between the rails of the file, or others."""
    from wrinkle_cad.cad.upper.carve import carve_request

    return carve_request(
        *(rails_of(job, given) if rails is None else rails),
        margin=job.margin_asked,
        fade=job.fade,
        allow_split=job.allow_split,
        tolerance=job.tolerance,
        name=given.name,
    )


def _profiles(
    job: Job, opening: Opening, given: StripInput, rails: tuple[object, object] | None = None
) -> tuple[object, object]:
    """What the strip is made between: of the rails of the file, or of others."""
    if job.waves is None or job.height is None:
        if opening.request.margin == 0.0 and max(opening.distances) <= job.tolerance:
            # Rails that lie on the upper within the tolerance are the opening's own boundary.
            from wrinkle_cad.cad.upper.bands import side_curve

            return side_curve(opening.p_edges, "P"), side_curve(opening.q_edges, "Q")
        return rails_of(job, given) if rails is None else rails
    from wrinkle_cad.cad.upper.profiles import profile_curves

    return profile_curves(
        opening,
        waves=job.waves,
        height=job.height,
        phase_deg=job.phase_deg,
        fade=job.fade,
        side=job.side,
        shape=job.shape,
        lean_deg=job.lean_deg,
        seed=job.seed,
        amplitude=job.amplitude,
    )


def _bands(job: Job, bands: Iterable[Band]) -> tuple[TriangulatedStrip, ...]:
    material = material_of(job, limits_of(job))
    return tuple(
        TriangulatedStrip(
            band.p,
            band.q,
            band.p_samples,
            band.q_samples,
            band.triangulation,
            tolerance=job.tolerance,
            name=band.name,
            role="band",
            color=settings.BAND_COLOR,
            surface="cones" if band.smooth is None else "smooth",
            smooth=band.smooth,
            stock=Stock(**material),
        )
        for band in bands
    )

"""The outputs of one job, written into the paths that are given."""

from __future__ import annotations

import datetime
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

from wrinkle_cad import settings
from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip

from .job import Job
from .parts import write_pattern

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.shapes import Part
    from wrinkle_cad.pattern.piece.nesting import NestedSheet
    from wrinkle_cad.report.limits import Limits
    from wrinkle_cad.report.views import MeshView
    from wrinkle_cad.wrinkle.cut_pattern import Pattern

    from .wrinkled_upper import WrinkledUpper

_RAILS: Final[tuple[Literal["P", "Q"], ...]] = ("P", "Q")
_VIEW_SAG: Final = 0.1
"""mm; how far the triangles of the page's body may lie from its faces."""
_VIEW_ANGLE: Final = 0.35
"""rad; how far the normals of its neighbouring triangles may differ."""


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """What a job has made before it writes."""

    strips: tuple[TriangulatedStrip, ...]
    """The wrinkles, then the bands."""
    pattern: Pattern
    """The pieces of all of them."""
    limits: Limits
    """What the strips are judged by."""
    upper: WrinkledUpper | None
    """The upper with the wrinkles stitched in; None when the file has no upper."""
    upper_name: str = ""
    """What the file calls the upper."""
    sheets: tuple[NestedSheet, ...] = ()
    """Of material, with the pieces nested on them, where they are asked for."""

    @property
    def sheet_kinds(self) -> tuple[str, ...]:
        """The endings of the sheets' files."""
        return tuple(f"sheet{number}.dxf" for number in range(1, len(self.sheets) + 1))


def write_shapes(job: Job, made: Made, paths: Mapping[str, Path]) -> None:
    """Writes the STEP and the STL file.

    Raises:
        ExportError: a file cannot be written.
    """
    from wrinkle_cad.cad.exchange.write import write_step, write_stl
    from wrinkle_cad.cad.kernel.topology import make_compound

    parts = _parts_of(made)
    everything = [*parts, *_notch_parts(made)]
    write_step(paths["step"], everything, schema=job.step_schema, timestamp=timestamp_of(job))
    shapes = [part.shape for part in parts]
    meshed = shapes[0] if len(shapes) == 1 else make_compound(shapes)
    # A strip is asked for to its tolerance; of the upper, which is as it was, a picture will do.
    upper_tolerance = max(job.tolerance, settings.TOLERANCE)
    write_stl(paths["stl"], meshed, tolerance=job.tolerance, curved_tolerance=upper_tolerance)


def write_flat(job: Job, made: Made, paths: Mapping[str, Path]) -> list[dict[str, str]]:
    """Writes the pattern's files and returns what had to be changed, as plain values.

    Raises:
        InputError: a profile cannot be used.
        ExportError: a file cannot be written.
    """
    from wrinkle_cad.wrinkle.cut_pattern import write_sheets

    moment = timestamp_of(job)
    changed = write_pattern(job, made.pattern, paths, moment)
    told = write_sheets(
        [paths[kind] for kind in made.sheet_kinds],
        made.sheets,
        profile=job.profile,
        version=job.dxf_version,
        curves=job.curves,
        timestamp=moment,
    )
    more = [asdict(finding) for finding in dict.fromkeys(told)]
    return changed + [finding for finding in more if finding not in changed]


def written_page(job: Job, made: Made, summary: Mapping[str, Any]) -> str:
    """The job's page."""
    from wrinkle_cad.report.page import write_page
    from wrinkle_cad.report.strip_page import strip_view

    views = [
        strip_view(strip, made.pattern.pieces_of(index)) for index, strip in enumerate(made.strips)
    ]
    return write_page(summary, views, _body_view(made), moment=timestamp_of(job))


def timestamp_of(job: Job) -> datetime.datetime:
    """The time that stands in the outputs."""
    if job.source_date_epoch is None:
        return datetime.datetime.now(datetime.UTC).replace(microsecond=0)
    return datetime.datetime.fromtimestamp(job.source_date_epoch, datetime.UTC)


def _parts_of(made: Made) -> Sequence[Part]:
    from wrinkle_cad.cad.exchange.shapes import Part

    if made.upper is None:
        return [Part(strip.topods_shell(), strip.name, strip.color) for strip in made.strips]
    from wrinkle_cad.cad.upper.stitched_part import stitched_part

    upper, colors = made.upper, {strip.name: strip.color for strip in made.strips}
    return [stitched_part(upper.stitched, upper.openings, upper.given, made.upper_name, colors)]


def _notch_parts(made: Made) -> Iterator[Part]:
    """A named point for every notch, once for two pieces that are sewn together there."""
    from wrinkle_cad.cad.exchange.shapes import Part
    from wrinkle_cad.cad.kernel.topology import make_vertex

    seen: set[int] = set()
    for index, strip in enumerate(made.strips):
        for side, rail in enumerate(_RAILS):
            own = strip.p if rail == "P" else strip.q
            if id(own) in seen:
                continue
            seen.add(id(own))
            arcs = made.pattern.notch_arcs(index, side)
            # The rail of a band that no wrinkle has is the edge of the opening.
            place = "opening" if strip.role == "band" else rail
            for number, point in enumerate(strip.rail_points(rail, arcs), start=1):
                yield Part(make_vertex(point), f"{strip.name} {place} notch {number}")


def _body_view(made: Made) -> MeshView | None:
    if made.upper is None:
        return None
    import numpy as np

    from wrinkle_cad.cad.kernel.mesh import mesh_of
    from wrinkle_cad.cad.kernel.topology import make_compound
    from wrinkle_cad.report.views import MeshView

    strips = {strip.name for strip in made.strips}
    faces = [face for name, own in made.upper.stitched.parts if name not in strips for face in own]
    points, triangles = mesh_of(
        make_compound(faces), tolerance=_VIEW_SAG, angular_tolerance=_VIEW_ANGLE
    )
    return MeshView(
        name=made.upper_name or "body",
        vertices=points.astype(np.float32),
        faces=triangles.astype(np.int32),
        color=settings.UPPER_COLOR,
    )

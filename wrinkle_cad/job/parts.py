"""What a job's flat settings mean to the parts of the package that do the work."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.loading import kernel_importable
from wrinkle_cad.errors import Finding
from wrinkle_cad.options.option import values_of
from wrinkle_cad.pattern.formats.bend_table import write_bend_table
from wrinkle_cad.pattern.formats.piece_file import write_pieces
from wrinkle_cad.pattern.piece.options import PieceOptions, PieceSettings
from wrinkle_cad.report.limits import Limits, LimitSettings
from wrinkle_cad.report.material import find_material
from wrinkle_cad.wrinkle.options import StripSettings

from .job import Job
from .outputs import check_outputs_are_ours

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen, StripInput
    from wrinkle_cad.cad.exchange.shapes import CadFile
    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.wrinkle.cut_pattern import Pattern
    from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip


def output_kinds(job: Job) -> tuple[str, ...]:
    """The endings of the files that the job writes, in the order in which they are listed."""
    extra = tuple(kind for kind in ("svg", "pdf") if getattr(job, kind))
    if job.bend_table or job.equal_bends is not None:
        extra = (*extra, "bends.csv")
    if job.pieces_file:
        extra = (*extra, "pieces")
    return ("step", "stl", "dxf", "json", "html", *extra)


def read_chosen(job: Job, kinds: tuple[str, ...]) -> tuple[CadFile, Chosen]:
    """Reads the job's file and takes its curves and upper.

    Args:
        job: the settings.
        kinds: the outputs that will be written, which are checked first.

    Raises:
        JobError: an output would replace the input or a file of somebody else.
        InputError: the file cannot be used.
        CadError: the kernel cannot be loaded.
    """
    with kernel_importable():
        from wrinkle_cad.cad.exchange.choose import choose_inputs
        from wrinkle_cad.cad.exchange.read import read_cad
    check_outputs_are_ours(job, kinds)
    file = read_cad(job.input, unit=job.unit)
    return file, choose_inputs(file, p=job.p, q=job.q, upper=job.upper, join=job.join)


def rails_of(job: Job, given: StripInput) -> tuple[Directrix, Directrix]:
    """Returns P and Q of one strip of the file, gaps closed as the job asks.

    Args:
        job: the settings.
        given: the two curves.

    Raises:
        InputError: a curve cannot be used.
        CadError: the kernel cannot convert an edge.
    """
    from wrinkle_cad.cad.rail.directrix import make_directrix

    return (
        make_directrix(given.p.shape, name="P", join=job.join),
        make_directrix(given.q.shape, name="Q", join=job.join),
    )


def strip_of(job: Job, p: object, q: object, name: str) -> WrinkleStrip:
    """Makes one strip of the job.

    Args:
        job: the settings.
        p: directrix P.
        q: directrix Q.
        name: of the strip; the job's own when the file gives none.

    Raises:
        InputError: a curve cannot be used.
        CadError: the kernel could not evaluate a curve.
    """
    from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

    return WrinkleStrip(
        p,
        q,
        name=strip_name(job, name),
        **values_of(job, StripSettings),
        **material_of(job, limits_of(job)),
    )


def without_rail(job: Job, unused: tuple[float, float, float, float]) -> Job:
    """Returns the job for a strip with fixed ends between what free ends left of its rails.

    Args:
        job: the settings.
        unused: mm of P before and behind that strip, of Q before and behind it.
    """
    p, _, q, _ = unused
    pinned = tuple((pin[0] - p, pin[1] - q) if len(pin) == 2 else pin for pin in job.pinned)
    moved = ((a - p, b - p, c - q, d - q) for a, b, c, d in job.forbidden)
    forbidden = tuple(
        (max(a, 0.0), b, max(c, 0.0), d) for a, b, c, d in moved if b > 0.0 and d > 0.0
    )
    return replace(job, ends="fixed", give_up=None, pinned=pinned, forbidden=forbidden)


def strip_name(job: Job, name: str) -> str:
    """Returns what a strip of the file is called: as the job where the file gives no name."""
    return job.name if name == settings.STRIP_NAME else name


def material_of(job: Job, limits: Limits) -> dict[str, Any]:
    """Returns what a strip is told of its material: thickness, K-factor, grain and side.

    Args:
        job: the settings.
        limits: with the material.
    """
    k_factor = limits.k_factor if job.k_factor is None else job.k_factor
    side = job.surface_side
    if job.right_side == "back" and side != "middle":
        side = "inside" if side == "outside" else "outside"
    return {
        "thickness": limits.thickness_mm if job.thickness is None else job.thickness,
        "k_factor": settings.K_FACTOR if k_factor is None else k_factor,
        "grain": job.grain,
        "surface_side": side,
    }


def limits_of(job: Job) -> Limits:
    """What the job's strips are judged by.

    Raises:
        InputError: the material's file cannot be used.
    """
    limits = Limits(**values_of(job, LimitSettings))
    return limits if job.material is None else limits.of(find_material(job.material))


def piece_settings_of(job: Job, limits: Limits) -> PieceSettings:
    """How the job's pattern pieces are made.

    Args:
        job: the settings.
        limits: with the material's name, thickness and K-factor.

    Raises:
        InputError: a setting does not fit a piece.
    """
    options = values_of(job, PieceOptions)
    if job.thickness is None:
        options["thickness"] = limits.thickness_mm
    if job.k_factor is None:
        options["k_factor"] = limits.k_factor
    return PieceSettings(**options, tolerance=job.tolerance, material=limits.material)


def write_pattern(
    job: Job, pattern: Pattern, paths: Mapping[str, Path], timestamp: datetime
) -> list[dict[str, str]]:
    """Writes the pattern in every format that the job asks for.

    Args:
        job: the settings.
        pattern: what to write.
        paths: by kind, "dxf", "svg", "pdf" and so on; those missing are not written.
        timestamp: the time in the files.

    Returns:
        What had to be changed to write them, each finding once, as plain values.
    """
    changed: dict[Finding, None] = {}
    changed.update(
        dict.fromkeys(
            pattern.export_dxf(
                paths["dxf"],
                profile=job.profile,
                version=job.dxf_version,
                curves=job.curves,
                timestamp=timestamp,
                test_square=job.test_square,
            )
        )
    )
    if "svg" in paths:
        changed.update(dict.fromkeys(pattern.export_svg(paths["svg"], profile=job.profile)))
    if "bends.csv" in paths:
        write_bend_table(paths["bends.csv"], pattern.pieces)
    if "pieces" in paths:
        write_pieces(paths["pieces"], pattern.pieces)
    if "pdf" in paths:
        changed.update(dict.fromkeys(pattern.export_pdf(paths["pdf"], profile=job.profile)))
    return [asdict(finding) for finding in changed]

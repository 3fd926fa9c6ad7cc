"""One job from its file to its outputs: reads, makes the strips, writes; never prints."""

from __future__ import annotations

import datetime
import traceback
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from .cad.loading import kernel_importable
from .errors import WrinkleError
from .findings import Finding
from .job import Job
from .job_parts import limits_of, output_kinds, piece_settings_of, strip_of, write_pattern
from .outcome import JobDone, JobFailed, Progress
from .outputs import check_outputs_are_ours, hashes_of, outputs_together
from .phases import PhaseClock
from .summary import summary_of, to_json

if TYPE_CHECKING:
    from .cad.choose import Chosen
    from .cad.shapes import CadFile
    from .cut_pattern import Pattern
    from .strip_report import StripReport
    from .wrinkle import WrinkleStrip

_PHASES: Final = ("read", "strip", "surface", "pattern", "judge", "write", "page")


def run_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Runs one job.

    Args:
        job: its settings.
        progress: called with (phase, phases done, phases in all) as the job proceeds.

    Returns:
        What was made, or why nothing was: bad input does not raise.
    """
    clock = PhaseClock(progress, len(_PHASES))
    try:
        return _run(job, clock)
    except (WrinkleError, MemoryError, OSError) as error:
        return JobFailed(
            job=job,
            phase=clock.current,
            error=type(error).__name__,
            message=_one_line_of(error, job),
            seconds=clock.seconds,
            trace=traceback.format_exc(),
        )


def _one_line_of(error: Exception, job: Job) -> str:
    if isinstance(error, MemoryError):
        return f"{job.input.name} - ran out of memory - give a larger --tolerance"
    if isinstance(error, OSError) and not isinstance(error, WrinkleError):
        return f"{job.input.name} - {error.strerror or error} - correct and run again"
    return " ".join(str(error).split())


def _run(job: Job, clock: PhaseClock) -> JobDone:
    with clock.phase("read"):
        file, chosen = _read(job)
    with clock.phase("strip"):
        from .cut_pattern import pattern_of_strips

        limits = limits_of(job)
        chosen_pieces = piece_settings_of(job, limits)
        strips = _make_strips(job, chosen)
    with clock.phase("surface"):
        for strip in strips:
            strip.topods_shell()
    with clock.phase("pattern"):
        pattern = pattern_of_strips(strips, chosen_pieces)
    with clock.phase("judge"):
        noticed = [finding for strip in strips for finding in findings_on(strip, strip.report)]
        noticed += pattern.findings
        summary = summary_of(job, file, chosen, [s.report for s in strips], noticed, limits)
    outputs = _write(job, clock, strips, pattern, summary)
    return JobDone(
        job=job,
        outputs=outputs,
        missed_limits=tuple(summary["verdict"]["missed"]),
        summary=summary,
        findings=tuple(Finding(**entry) for entry in summary["findings"]),
        seconds=clock.seconds,
    )


def _read(job: Job) -> tuple[CadFile, Chosen]:
    with kernel_importable():
        from .cad.choose import choose_inputs
        from .cad.read import read_cad
    check_outputs_are_ours(job, output_kinds(job))
    file = read_cad(job.input, unit=job.unit)
    return file, choose_inputs(file, p=job.p, q=job.q, upper=job.upper)


def _make_strips(job: Job, chosen: Chosen) -> list[WrinkleStrip]:
    return [strip_of(job, given.p.shape, given.q.shape, given.name) for given in chosen.strips]


def findings_on(strip: WrinkleStrip, report: StripReport) -> Iterator[Finding]:
    """What the user should know about a strip."""
    yield from strip.findings
    invalid = report.invalid_bridges - report.inflection_bridges
    if invalid:
        yield Finding(
            "not-developable",
            "warning",
            f"{report.name} - {invalid} of {report.interior_bridges} bridges are not locally"
            f" convex, along {report.invalid_length_p_mm:.1f} mm of P and"
            f" {report.invalid_length_q_mm:.1f} mm of Q - 0 in a developable strip - the sheet"
            " must stretch there, or change a rail",
        )


def _write(
    job: Job,
    clock: PhaseClock,
    strips: Sequence[WrinkleStrip],
    pattern: Pattern,
    summary: dict[str, Any],
) -> tuple[Path, ...]:
    kinds = output_kinds(job)
    with outputs_together(job, kinds) as paths:
        with clock.phase("write"):
            _write_shapes(job, strips, paths)
            changed = write_pattern(job, pattern, paths, timestamp_of(job))
            summary["findings"] += changed
            hashed = [kind for kind in kinds if kind not in ("json", "html")]
            summary["outputs"] = hashes_of({kind: paths[kind] for kind in hashed})
        with clock.phase("page"):
            page = _page(summary, strips, pattern)
            paths["html"].write_text(page, encoding="utf-8")
        summary["seconds"] = {phase: round(took, 3) for phase, took in clock.seconds.items()}
        paths["json"].write_text(to_json(summary), encoding="utf-8")
    return tuple(job.output_dir / f"{job.name}.{kind}" for kind in kinds)


def _write_shapes(job: Job, strips: Sequence[WrinkleStrip], paths: Mapping[str, Path]) -> None:
    from .cad.kernel import make_compound
    from .cad.shapes import Part
    from .cad.write import write_step, write_stl

    parts = [Part(strip.topods_shell(), strip.name, strip.color) for strip in strips]
    write_step(paths["step"], parts, schema=job.step_schema, timestamp=timestamp_of(job))
    meshed = make_compound([part.shape for part in parts])
    write_stl(paths["stl"], meshed, tolerance=job.tolerance)


def _page(summary: Mapping[str, Any], strips: Sequence[WrinkleStrip], pattern: Pattern) -> str:
    from .report.page import write_page
    from .report.views import StripView

    views = [
        StripView(
            name=strip.name,
            triangulation=strip.triangulation,
            unrolling=strip.unrolling,
            pieces=pattern.pieces_of(index),
            valid=strip.valid,
            local=strip.local,
            least_bending=strip.least_bending,
            gaps=strip.report.gaps,
        )
        for index, strip in enumerate(strips)
    ]
    return write_page(summary, views)


def timestamp_of(job: Job) -> datetime.datetime:
    """The time that stands in the outputs."""
    if job.source_date_epoch is None:
        return datetime.datetime.now(datetime.UTC).replace(microsecond=0)
    return datetime.datetime.fromtimestamp(job.source_date_epoch, datetime.UTC)

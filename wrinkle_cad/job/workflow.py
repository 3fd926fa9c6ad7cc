"""One job from its file to its outputs: reads, makes the strips, writes; never prints."""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from wrinkle_cad.errors import Finding, JobError, WrinkleError
from wrinkle_cad.files.names import error_words
from wrinkle_cad.wrinkle.loudness import findings_in_the_result

from .job import Job
from .outcome import JobDone, JobFailed, Progress
from .outputs import check_outputs_are_ours, hashes_of, output_paths, outputs_together
from .phases import PhaseClock
from .summary import summary_of, to_json

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen
    from wrinkle_cad.cad.exchange.shapes import CadFile
    from wrinkle_cad.wrinkle.triangulated_strip import TriangulatedStrip

    from .writing import Made

_PHASES: Final = ("read", "strip", "surface", "pattern", "judge", "try", "write", "page")
_NOT_HASHED: Final = ("json", "html")


def run_job(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Runs one job.

    Args:
        job: its settings.
        progress: called with (phase, phases done, phases in all) as the job proceeds.

    Returns:
        What was made, or why nothing was: bad input does not raise.

    Example:
        >>> from pathlib import Path
        >>> from wrinkle_cad import Job, Part, write_step
        >>> from build123d import Edge
        >>> p, q = Edge.make_line((0, 0), (90, 0)), Edge.make_line((0, 20), (90, 30))
        >>> write_step(Path("lace.step"), [Part(p.wrapped, "P"), Part(q.wrapped, "Q")])
        >>> run_job(Job(input=Path("lace.step"), output_dir=Path("out")))
        JobDone('lace': lace.step, lace.stl, lace.dxf, lace.json, lace.html)
        >>> type(run_job(Job(input=Path("gone.step")))).__name__
        'JobFailed'
    """
    from wrinkle_cad.strip.compiled import compiling_told

    clock = PhaseClock(progress, len(_PHASES))
    try:
        with findings_in_the_result(), compiling_told(clock.tell_compiling):
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
        return f"{job.input.name} needs more memory than there is: give a larger --tolerance."
    if isinstance(error, OSError) and not isinstance(error, WrinkleError):
        reason = error.strerror or error
        return f"{job.input.name} cannot be done ({reason}): correct this and run again."
    return error_words(error)


def _run(job: Job, clock: PhaseClock) -> JobDone:
    from wrinkle_cad.pattern.piece.thumbnail import thumbnail
    from wrinkle_cad.report.verdict import entries_of

    from .trials import add_trials

    with clock.phase("read"):
        file, chosen = _read(job)
    made = _make(job, chosen, clock)
    with clock.phase("judge"):
        findings = _findings_of(made)
        entries = entries_of([strip.report for strip in made.strips], made.limits)
    with clock.phase("try"):
        if not job.no_trials:
            add_trials(job, chosen, made.upper, entries, made.limits)
    summary = summary_of(job, file, chosen, entries, findings, made.limits)
    if made.upper is not None:
        summary["stitch"] = made.upper.stitch_as_json()
    summary["outline_mm"] = thumbnail(made.pattern.pieces[0]) if made.pattern.pieces else []
    outputs = _write(job, made, summary, clock)
    return JobDone(
        job=job,
        outputs=outputs,
        missed_limits=tuple(summary["verdict"]["reasons"]),
        summary=summary,
        findings=tuple(Finding(**entry) for entry in summary["findings"]),
        seconds=clock.seconds,
    )


def _read(job: Job) -> tuple[CadFile, Chosen]:
    from .parts import output_kinds, read_chosen

    return read_chosen(job, output_kinds(job))


def _make(job: Job, chosen: Chosen, clock: PhaseClock) -> Made:
    from wrinkle_cad.wrinkle.cut_pattern import pattern_of_strips

    from .parts import limits_of, piece_settings_of, rails_of, strip_of
    from .writing import Made

    with clock.phase("strip"):
        limits = limits_of(job)
        piece_settings = piece_settings_of(job, limits)
        upper = None
        if chosen.upper is not None:
            from .wrinkled_upper import wrinkle_upper

            upper = wrinkle_upper(job, chosen)
            strips: tuple[TriangulatedStrip, ...] = (*upper.strips, *upper.bands)
        else:
            _check_no_waves(job)
            strips = tuple(
                strip_of(job, *rails_of(job, given), given.name) for given in chosen.strips
            )
    with clock.phase("surface"):
        for strip in strips:
            strip.topods_shell()
    with clock.phase("pattern"):
        turned_over = () if upper is None else upper.turned_over
        pattern = pattern_of_strips(strips, piece_settings, turned_over=turned_over)
        sheets = () if job.sheet is None else pattern.nested(job.sheet, seconds=job.nest_seconds)
    name = "" if chosen.upper is None else chosen.upper.name
    return Made(strips, pattern, limits, upper, name or job.name, sheets)


def _check_no_waves(job: Job) -> None:
    if job.waves is not None:
        raise JobError(
            f"The waves have no upper to stand on: {job.input.name} has no shell or face named"
            " 'upper'. Add it, choose one with --upper, or leave --waves and --height out."
        )


def _findings_of(made: Made) -> list[Finding]:
    return [
        *(made.upper.findings if made.upper is not None else ()),
        *(finding for strip in made.strips for finding in findings_on(strip)),
        *made.pattern.findings,
        *_sheet_findings(made),
    ]


def _sheet_findings(made: Made) -> Iterator[Finding]:
    """What the user should know about the sheets."""
    for number, sheet in enumerate(made.sheets, start=1):
        yield Finding(
            "nested",
            "info",
            f"Sheet {number} of {len(made.sheets)} holds {len(sheet.pieces)} pieces on "
            f"{sheet.used_length:.0f} of {sheet.size[0]:g} mm, which they use to "
            f"{100.0 * sheet.utilisation:.1f}%.",
        )


def findings_on(strip: TriangulatedStrip) -> Iterator[Finding]:
    """What the user should know about a strip."""
    # How a pattern was split says the pattern itself, with the number of its pieces.
    yield from (finding for finding in strip.findings if finding.code != "flat-overlaps")


def _write(job: Job, made: Made, summary: dict[str, Any], clock: PhaseClock) -> tuple[Path, ...]:
    from .parts import output_kinds
    from .writing import write_flat, write_shapes, written_page

    kinds = (*output_kinds(job), *made.sheet_kinds)
    check_outputs_are_ours(job, made.sheet_kinds)
    with outputs_together(job, kinds) as paths:
        with clock.phase("write"):
            write_shapes(job, made, paths)
            summary["findings"] += write_flat(job, made, paths)
            hashed = {kind: paths[kind] for kind in kinds if kind not in _NOT_HASHED}
            summary["outputs"] = hashes_of(hashed)
        # The page shows what the JSON holds, so its own seconds are in neither.
        summary["seconds"] = {phase: round(took, 3) for phase, took in clock.seconds.items()}
        with clock.phase("page"):
            paths["html"].write_text(written_page(job, made, summary), encoding="utf-8")
        paths["json"].write_text(to_json(summary), encoding="utf-8")
    return tuple(output_paths(job, kinds).values())

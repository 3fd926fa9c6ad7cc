"""The paper's methods side by side on the strips of one file."""

from __future__ import annotations

from typing import Final

from wrinkle_cad.strip.compiled import compiling_told

from .job import Job
from .outcome import JobDone, Progress
from .outputs import outputs_together
from .parts import rails_of, read_chosen, strip_of
from .phases import PhaseClock
from .summary import to_json

_KINDS: Final = ("compare.json", "compare.html")


def compare_job(job: Job, *, progress: Progress | None = None) -> JobDone:
    """Runs LODT+LMBT, GODT+GMBT, GMBT and GMAT on every strip of a file.

    Writes NAME.compare.json and NAME.compare.html.

    Args:
        job: the input, which curves to take, tolerance, energy and planarity; the criteria and
            the search are those of the methods.
        progress: called once, as it begins.

    Returns:
        The files, and what the JSON holds.

    Raises:
        InputError: the file or a curve cannot be used.
        ExportError: the files cannot be written.
    """
    clock = PhaseClock(progress, 1)
    with compiling_told(clock.tell_compiling), clock.phase("compare"):
        return _compared(job)


def _compared(job: Job) -> JobDone:
    _, chosen = read_chosen(job, _KINDS)

    from wrinkle_cad.report.compare import compare, comparison_summary, write_comparison_page

    rows = {}
    for given in chosen.strips:
        strip = strip_of(job, *rails_of(job, given), given.name)
        rows[strip.name] = compare(
            strip.p_samples.points,
            strip.q_samples.points,
            energy=job.energy,
            planarity=strip.triangulation.planarity,
        )
    summary = comparison_summary(rows, file=job.input.name)
    with outputs_together(job, _KINDS) as paths:
        paths["compare.json"].write_text(to_json(summary), encoding="utf-8")
        paths["compare.html"].write_text(write_comparison_page(summary), encoding="utf-8")
    outputs = tuple(job.output_dir / f"{job.name}.{kind}" for kind in _KINDS)
    return JobDone(job=job, outputs=outputs, summary=summary)

"""The command line: arguments, progress, messages, exit codes; nothing else.

Exit codes: 0 done, 1 a job failed or, with --strict, a limit was missed, 2 wrong usage,
130 interrupted.
"""

from __future__ import annotations

import argparse
import errno
import json
import os
import sys
import traceback
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, get_args

from wrinkle_cad import settings
from wrinkle_cad.errors import WrinkleError
from wrinkle_cad.files.names import error_words, printable

from .batch_arguments import add_batch_arguments, add_limit_arguments
from .job_arguments import add_job_argument, add_job_arguments, job_keywords
from .signals import ended_in_order
from .streams import complain, flushed, give_up_stdout, open_streams

if TYPE_CHECKING:
    from wrinkle_cad.job.outcome import JobDone, JobFailed

DONE: Final = 0
FAILED: Final = 1
INTERRUPTED: Final = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code."""
    open_streams()
    given = _parser().parse_args(arguments)
    if not given.debug:
        sys.excepthook = _report_defect
    try:
        with ended_in_order():
            code: int = given.command(given)
        flushed()
    except KeyboardInterrupt:
        complain("Interrupted: nothing is half-written.")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of our output went away (`| head`); Python would complain once more at exit.
        give_up_stdout()
        return FAILED
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EIO, errno.EBADF) or error.filename is not None:
            raise
        # No file has a part in it: a stream is full or gone.
        give_up_stdout()
        complain(
            f"wrinkle-cad: What was to be printed cannot be written ({error.strerror})."
            " The files are written all the same: look into the output folder."
        )
        return FAILED
    except WrinkleError as error:
        if given.debug:
            traceback.print_exc()
        complain(f"wrinkle-cad: {printable(str(error))}")
        return FAILED
    return code


def _report_defect(kind: type[BaseException], error: BaseException, _: object) -> None:
    """One line for what no code foresaw; Python then exits with code 1."""
    print(
        f"wrinkle-cad: This is a defect in the program ({kind.__name__}: {error_words(error)})."
        " Run again with --debug and report what it prints.",
        file=sys.stderr,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="wrinkle-cad",
        description="Finds the most developable strip between two curves; writes STEP, STL, DXF.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the versions and stop")
    parser.set_defaults(debug=False)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_run(commands)
    _add_batch(commands)
    _add_inspect(commands)
    _add_compare(commands)
    _add_check(commands)
    _add_materials(commands)
    _add_doctor(commands)
    return parser


def _add_run(commands: Any) -> None:
    run = commands.add_parser("run", help="make the strip of one file")
    run.set_defaults(command=_run)
    add_job_arguments(run)
    run.add_argument("--job", type=Path, metavar="FILE.toml", help="settings; flags go before it")
    run.add_argument("--name", metavar="STEM", help="stem of the outputs (default: the input's)")
    run.add_argument("input", type=Path, metavar="INPUT", help="STEP, IGES or BREP file")
    run.add_argument("--quiet", action="store_true", help="print failures only")
    add_limit_arguments(run)
    _add_debug(run)


def _add_batch(commands: Any) -> None:
    batch = commands.add_parser("batch", help="make the strips of many files, unattended")
    batch.set_defaults(command=_batch)
    add_batch_arguments(batch)
    add_job_arguments(batch)
    _add_debug(batch)


def _add_inspect(commands: Any) -> None:
    inspect = commands.add_parser("inspect", help="list the shapes of a file")
    inspect.set_defaults(command=_inspect)
    inspect.add_argument("input", type=Path, metavar="INPUT", help="STEP, IGES or BREP file")
    for flag in ("--p", "--q", "--upper"):
        inspect.add_argument(flag, metavar="NAME|INDEX", help="as for run: shows what it takes")
    inspect.add_argument("--unit", choices=get_args(settings.Unit))
    add_job_argument(inspect, "join")
    inspect.add_argument("--json", action="store_true", help="print one JSON value")
    add_limit_arguments(inspect)
    _add_debug(inspect)


def _add_compare(commands: Any) -> None:
    compare = commands.add_parser("compare", help="run the paper's methods on one file")
    compare.set_defaults(command=_compare)
    add_job_arguments(compare)
    compare.add_argument("--name", metavar="STEM", help="stem of the outputs")
    compare.add_argument("input", type=Path, metavar="INPUT", help="STEP, IGES or BREP file")
    add_limit_arguments(compare)
    _add_debug(compare)


def _add_check(commands: Any) -> None:
    check = commands.add_parser("check", help="find what is wrong with a DXF pattern")
    check.set_defaults(command=_check)
    check.add_argument("input", type=Path, metavar="FILE.dxf", help="ours or another program's")
    check.add_argument(
        "--cut-layer", action="append", default=[], metavar="NAME", help="a layer that is cut"
    )
    check.add_argument("--json", action="store_true", help="print one JSON value")
    add_limit_arguments(check)
    _add_debug(check)


def _add_materials(commands: Any) -> None:
    materials = commands.add_parser("materials", help="list the materials that --material knows")
    materials.set_defaults(command=_materials)
    materials.add_argument("--json", action="store_true", help="print one JSON value")
    _add_debug(materials)


def _add_doctor(commands: Any) -> None:
    doctor = commands.add_parser("doctor", help="say what is wrong with this installation")
    doctor.set_defaults(command=_doctor)
    _add_debug(doctor)


def _add_debug(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--debug", action="store_true", help="print the traceback of a failure")


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from wrinkle_cad.report.versions import installed_versions

        for name, version in installed_versions().items():
            print(f"{name} {version}")
        parser.exit()


def _run(given: argparse.Namespace) -> int:
    from wrinkle_cad.batch.alone import run_alone
    from wrinkle_cad.job.job import make_job
    from wrinkle_cad.job.outcome import JobFailed

    from .screen import progress_on_screen

    job = make_job(given.input, job_keywords(given, os.environ), given.job)
    with progress_on_screen(is_wanted=not given.quiet) as progress:
        outcome = run_alone(job, progress=progress, timeout=given.timeout, memory=given.memory)
    if isinstance(outcome, JobFailed):
        return _failed(given, outcome)
    if not given.quiet:
        _print_done(outcome)
    return FAILED if job_misses_limits(outcome) else DONE


def _limits(given: argparse.Namespace) -> dict[str, float | None]:
    return {"timeout": given.timeout, "memory": given.memory}


def _failed(given: argparse.Namespace, outcome: JobFailed) -> int:
    if given.debug:
        print(outcome.trace, file=sys.stderr)
    complain(f"wrinkle-cad: {printable(outcome.message)}")
    return FAILED


def job_misses_limits(outcome: JobDone) -> bool:
    """Whether a limit was missed that the job was told to fail by."""
    return bool(outcome.missed_limits) and outcome.job.strict


def _print_done(outcome: JobDone) -> None:
    from wrinkle_cad.files.names import one_line

    verdict = outcome.summary["verdict"]
    for strip in verdict["strips"]:
        if strip["role"] != "band":
            print(f"{one_line(strip['name'])}: {one_line(strip['sentence'])}")
    if verdict["bands"]:
        print(one_line(verdict["bands"]))
    for finding in outcome.findings:
        print(f"{finding.severity}: {one_line(finding.message)}")
    for line in outcome.missed_limits:
        print(f"FAIL: {one_line(line)}")
    if verdict["passed"]:
        print(one_line(verdict["headline"]))
    for path in outcome.outputs:
        print(printable(str(path)))


def _batch(given: argparse.Namespace) -> int:
    from .batch_screen import run_batch_command

    return run_batch_command(given, job_keywords(given, os.environ))


def _inspect(given: argparse.Namespace) -> int:
    from wrinkle_cad.batch.alone import answer_alone
    from wrinkle_cad.job.inspection import inspect_file

    from .screen import print_inspection

    question = partial(
        inspect_file,
        unit=given.unit,
        p=given.p,
        q=given.q,
        upper=given.upper,
        join=given.join or 0.0,
    )
    inspection = answer_alone(given.input, question, **_limits(given))
    if given.json:
        print(json.dumps(inspection.as_json(), ensure_ascii=False, indent=2))
    else:
        print_inspection(inspection)
    return DONE


def _compare(given: argparse.Namespace) -> int:
    from wrinkle_cad.batch.alone import run_alone
    from wrinkle_cad.job.comparison import compare_job
    from wrinkle_cad.job.job import make_job
    from wrinkle_cad.job.outcome import JobFailed

    from .screen import print_comparison

    job = make_job(given.input, job_keywords(given, os.environ))
    outcome = run_alone(job, job_function=compare_job, timeout=given.timeout, memory=given.memory)
    if isinstance(outcome, JobFailed):
        return _failed(given, outcome)
    print_comparison(outcome.summary)
    for path in outcome.outputs:
        print(printable(str(path)))
    return DONE


def _check(given: argparse.Namespace) -> int:
    from wrinkle_cad.batch.alone import answer_alone
    from wrinkle_cad.files.names import one_line
    from wrinkle_cad.pattern.check.judging import judge_dxf

    question = partial(judge_dxf, cut_layers=tuple(given.cut_layer))
    report = answer_alone(given.input, question, **_limits(given))
    if given.json:
        print(json.dumps({**asdict(report), "is_clean": report.is_clean}, indent=2))
        return DONE if report.is_clean else FAILED
    print(
        f"{one_line(report.name)}: DXF {report.release}, {report.format},"
        f" {report.contour_count} contours on layers {one_line(', '.join(report.cut_layers))}"
    )
    for finding in report.findings:
        print(f"{finding.severity}: {finding.code}: {one_line(finding.message)}")
    print("nothing wrong" if report.is_clean else "not fit to be cut as it is")
    return DONE if report.is_clean else FAILED


def _materials(given: argparse.Namespace) -> int:
    from wrinkle_cad.report.material import packaged_materials

    from .screen import material_lines

    if given.json:
        known = [asdict(material) for material in packaged_materials()]
        print(json.dumps(known, ensure_ascii=False, indent=2))
        return DONE
    for material in packaged_materials():
        for line in material_lines(material):
            print(line)
    return DONE


def _doctor(_: argparse.Namespace) -> int:
    from wrinkle_cad.doctor import diagnose

    diagnoses = diagnose(os.environ)
    for diagnosis in diagnoses:
        print(
            f"{'ok     ' if diagnosis.is_ok else 'PROBLEM'}  {diagnosis.name}: {diagnosis.message}"
        )
    return DONE if all(diagnosis.is_ok for diagnosis in diagnoses) else FAILED

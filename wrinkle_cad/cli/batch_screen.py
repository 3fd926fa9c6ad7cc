"""The command ``batch`` as a person or a machine sees it: lines and exit codes."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final, TextIO

from wrinkle_cad.batch.executor import make_pool
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import (
    BatchEvent,
    BatchStarted,
    BatchSummary,
    FileFinished,
    FilePhase,
    FileSkipped,
    Listener,
)
from wrinkle_cad.batch.folder.failure_causes import causes_of
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.manifest import MANIFEST_NAME, Manifest
from wrinkle_cad.batch.folder.plan import PlannedJob, plan_batch
from wrinkle_cad.batch.folder.rehearsal import DONE_BEFORE, TO_DO, rehearse
from wrinkle_cad.batch.folder.summary_table import total_seconds
from wrinkle_cad.batch.workers.pool import Pool
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.names import printable
from wrinkle_cad.job.job import read_job_toml

DONE: Final = 0
FAILED: Final = 1
WRONG_USAGE: Final = 2
INTERRUPTED: Final = 130


def run_batch_command(given: argparse.Namespace, keywords: Mapping[str, Any]) -> int:
    """Runs ``wrinkle-cad batch``.

    Args:
        given: the parsed arguments.
        keywords: the settings of a job among them.

    Returns:
        The exit code: 0 done, 1 a file failed (or, with ``--strict``, misses a limit) or was not
        come to, 2 wrong usage, 130 interrupted.

    Raises:
        ExportError: the output folder cannot be written to or its disk is full.
    """
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            # Names of files may not fit the terminal's encoding.
            stream.reconfigure(errors="backslashreplace")
    settings_given = {
        name: value for name, value in keywords.items() if name not in ("name", "output_dir")
    }
    try:
        folder = _folder(given)
        if given.failed:
            return _list_failed(given, folder)
        planned = _plan(given, settings_given, folder)
        if given.dry_run:
            return _rehearse(given, planned, folder)
        return _convert(given, planned, folder)
    except InputError as error:
        _say(sys.stderr, f"wrinkle-cad: {error}")
        return WRONG_USAGE


def _folder(given: argparse.Namespace) -> Path:
    if given.output_dir is None:
        raise InputError("A batch needs a folder for its outputs: give one with -o DIR.")
    folder: Path = given.output_dir
    return folder


def _plan(
    given: argparse.Namespace, keywords: Mapping[str, Any], folder: Path
) -> tuple[PlannedJob, ...]:
    if not given.inputs:
        raise InputError("A batch needs files: give files, folders or patterns of names.")
    sources = find_sources(given.inputs, folder)
    for note in sources.notes:
        _say(sys.stderr, f"wrinkle-cad: {note}")
    if not sources.files:
        raise InputError("There is no CAD file in what was given: check the paths.")
    common = {} if given.job is None else read_job_toml(given.job)
    return plan_batch(sources.files, folder, keywords=keywords, mask=given.name, common=common)


def _list_failed(given: argparse.Namespace, folder: Path) -> int:
    """Lists the files that failed when they were last done, by cause."""
    if given.inputs:
        raise InputError("--failed lists what is in -o DIR: leave the files out.")
    if not (folder / MANIFEST_NAME).exists():
        raise InputError(
            f"There is no batch in {printable(str(folder))}: it has no {MANIFEST_NAME}."
        )
    causes = causes_of(Manifest(folder).records())
    for cause in causes:
        if given.json_lines:
            for record in cause.records:
                line = {"input": record.input, "cause": cause.title, "message": record.message}
                _say(sys.stdout, json.dumps(line))
            continue
        _say(sys.stdout, f"{cause.title}: {len(cause.records)}. {cause.hint}")
        for record in cause.records:
            _say(sys.stdout, f"  {printable(record.input)}: {printable(record.message)}")
    if not causes and not given.quiet and not given.json_lines:
        _say(sys.stdout, "No file failed.")
    return FAILED if causes else DONE


def _rehearse(given: argparse.Namespace, planned: tuple[PlannedJob, ...], folder: Path) -> int:
    is_refused = False
    for entry, verdict in rehearse(planned, folder, force=given.force):
        line = {"input": entry.source.label, "outputs": f"{entry.key}.*", "verdict": verdict}
        is_refused |= verdict not in (TO_DO, DONE_BEFORE)
        if given.json_lines:
            _say(sys.stdout, json.dumps(line))
        elif not given.quiet or verdict not in (TO_DO, DONE_BEFORE):
            _say(sys.stdout, f"{line['input']} -> {line['outputs']}: {verdict}")
    return FAILED if is_refused else DONE


def _convert(given: argparse.Namespace, planned: tuple[PlannedJob, ...], folder: Path) -> int:
    options = ConversionOptions(force=given.force, ship_bytes=given.ship_bytes)
    counter = _Counter()
    try:
        with ExitStack() as stack:
            pool = stack.enter_context(_pool(given))
            shown = stack.enter_context(_listener(given, len(planned)))

            def listen(event: BatchEvent) -> None:
                counter.count(event)
                shown(event)

            summary = convert(planned, folder, pool, listen, options)
    except KeyboardInterrupt:
        _say(
            sys.stderr,
            f"Interrupted: {counter.settled} of {len(planned)} files are settled, none is"
            " half-written. Run the same command again: it goes on where it stopped.",
        )
        return INTERRUPTED
    _show_summary(given, summary)
    is_bad = summary.failed or summary.left or summary.sheet_failures
    return FAILED if is_bad or summary.strict_misses else DONE


@contextmanager
def _pool(given: argparse.Namespace) -> Iterator[Pool]:
    files = (given.tls_ca, given.tls_cert, given.tls_key)
    if any(files) and (None in files or given.scheduler is None):
        raise InputError(
            "--tls-ca, --tls-cert and --tls-key go together, and with --scheduler tls://HOST:PORT:"
            " give all of them or none."
        )
    limits = {"workers": given.workers, "timeout": given.timeout, "memory": given.memory}
    if given.scheduler is None:
        if given.ship_bytes:
            raise InputError(
                "--ship-bytes needs --scheduler, else there is nowhere to ship to: leave it out."
            )
        yield make_pool(executor=None, **limits)
        return
    for name, value in limits.items():
        if value is not None:
            raise InputError(
                f"--{name} is {value:g} together with --scheduler, and a cluster's workers cannot"
                " be held to it: set it up there, and leave it out here."
            )
    from wrinkle_cad.batch.workers.cluster import Tls, cluster_executor

    tls = None if None in files else Tls(ca_file=files[0], cert=files[1], key=files[2])
    with cluster_executor(given.scheduler, tls) as (executor, in_flight):
        yield make_pool(executor=executor, in_flight=in_flight, **limits)


class _Counter:
    def __init__(self) -> None:
        self.settled = 0

    def count(self, event: BatchEvent) -> None:
        self.settled += isinstance(event, FileFinished | FileSkipped)


@contextmanager
def _listener(given: argparse.Namespace, total: int) -> Iterator[Listener]:
    if given.json_lines:
        yield _tell_machine
    elif given.quiet:
        yield _tell_failures
    elif sys.stderr.isatty():
        from .batch_display import live_display

        with live_display(total) as listener:
            yield listener
    else:
        yield _tell_lines


def _tell_machine(event: BatchEvent) -> None:
    if isinstance(event, BatchStarted):
        line: dict[str, Any] = {"event": "started", "files": event.total}
    elif isinstance(event, FilePhase):
        line = {"event": "phase", "input": event.label, "phase": event.phase}
    else:
        kind = "skipped" if isinstance(event, FileSkipped) else "finished"
        line = {"event": kind, **asdict(event.record)}
    _say(sys.stdout, json.dumps(line))


def _tell_failures(event: BatchEvent) -> None:
    if isinstance(event, FileFinished) and not event.record.is_done:
        _say(sys.stderr, f"wrinkle-cad: {failure_line(event)}")


def _tell_lines(event: BatchEvent) -> None:
    if isinstance(event, FileSkipped):
        _say(sys.stdout, f"{event.label}: done before")
    elif isinstance(event, FileFinished) and event.record.is_done:
        _say(sys.stdout, f"{event.label}: {done_text(event)}")
    else:
        _tell_failures(event)


def failure_line(event: FileFinished) -> str:
    """A failed file in one line."""
    return f"{event.label}: {event.record.message}"


def done_text(event: FileFinished) -> str:
    """What is worth saying about a file that was done."""
    text = f"done in {total_seconds(event.record):.2f} s"
    developability = event.record.figures.get("developability")
    if developability is not None:
        text += f", {developability:.1f}% of the rails developable"
    if event.record.missed_limits:
        text += f", FAIL: {'; '.join(event.record.missed_limits)}"
    return text


def _show_summary(given: argparse.Namespace, summary: BatchSummary) -> None:
    if given.json_lines:
        line = {"event": "ended", **asdict(summary), "folder": str(summary.folder)}
        _say(sys.stdout, json.dumps(line))
    elif not given.quiet:
        from .batch_display import print_summary

        print_summary(summary)
    for failure in summary.sheet_failures:
        _say(sys.stderr, f"wrinkle-cad: {failure}")
    if summary.stopped_by:
        _say(sys.stderr, f"wrinkle-cad: {summary.stopped_by}")


def _say(stream: TextIO, line: str) -> None:
    stream.write(f"{line}\n")
    stream.flush()

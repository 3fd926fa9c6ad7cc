"""A batch of files into one folder: resumes, records, survives; tells a listener, never prints."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from wrinkle_cad import settings
from wrinkle_cad.batch.executor import run_tasks
from wrinkle_cad.batch.workers.crew import Crew, Finished, Phase
from wrinkle_cad.batch.workers.task import JobFunction, Task, TaskResult
from wrinkle_cad.errors import ExportError
from wrinkle_cad.files.names import printable
from wrinkle_cad.files.staging import discard_staging, leftovers, move_into_place, open_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed
from wrinkle_cad.job.versions import installed_versions

from .delivery import deliver, failed_record
from .disk_space import check_disk_space
from .events import BatchStarted, BatchSummary, FileFinished, FilePhase, FileSkipped, Listener
from .fingerprint import hash_file, hash_settings
from .index_page import write_index_page
from .journal import Journal
from .lock import locked_folder
from .manifest import Manifest, Record, record_from_line
from .plan import PlannedJob
from .summary import write_summary_table


@dataclass(frozen=True, slots=True, kw_only=True)
class ConversionOptions:
    """How a batch goes about its files."""

    force: bool = False
    """Whether files that are done already are done again."""
    ship_bytes: bool = False
    """Whether inputs and outputs travel as bytes: workers share no folder with us."""
    job_function: JobFunction | None = None
    """What to run for each file; `run_job` when None."""
    least_disk_mib: int = settings.BATCH_DISK_FREE_MIB
    """MiB that the folder's disk must have left."""


def convert(
    planned: Sequence[PlannedJob],
    folder: Path,
    crew: Crew,
    listener: Listener,
    options: ConversionOptions | None = None,
) -> BatchSummary:
    """Does what a plan says, but for what an earlier batch did already.

    Args:
        planned: from `plan_batch`, with the same folder.
        folder: receives the outputs, the manifest, the log, the summary; made when missing.
        crew: who does the work; ended when this returns or raises.
        listener: is told what happens, in this thread.
        options: how to go about it.

    Raises:
        InputError: another batch holds the folder.
        ExportError: the folder cannot be written to, or its disk is full before anything began.
    """
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with locked_folder(folder):
                return _Conversion(planned, folder, crew, listener, options).run()
        except BrokenPipeError:
            # The listener's: whoever read our lines went away.
            raise
        except OSError as error:
            message = f"{error.strerror or error} - a folder that can be written, with room"
            raise ExportError(folder, "folder", f"{message} - correct it and run again") from error
    finally:
        crew.kill()


def base_record(entry: PlannedJob, versions: Mapping[str, str]) -> Record:
    """The record of a planned file before it is known what becomes of it.

    Raises:
        OSError: the input, or a file among the settings, cannot be read.
    """
    return Record(
        key=entry.key,
        input=entry.source.label,
        input_sha256=hash_file(entry.source.path),
        settings_sha256=hash_settings(entry.job, versions),
        outcome="",
        versions=dict(versions),
    )


def is_up_to_date(earlier: Record | None, base: Record, folder: Path) -> bool:
    """Whether a file was done with the same input and settings and its outputs are still there."""
    if earlier is None or not earlier.is_done:
        return False
    if earlier.input_sha256 != base.input_sha256:
        return False
    if earlier.settings_sha256 != base.settings_sha256:
        return False
    target = (folder / base.key).parent
    try:
        return all(
            (target / file.name).stat().st_size == file.bytes
            and hash_file(target / file.name) == file.sha256
            for file in earlier.outputs
        )
    except OSError:
        return False


class _Conversion:
    """The state of one batch under way."""

    def __init__(
        self,
        planned: Sequence[PlannedJob],
        folder: Path,
        crew: Crew,
        listener: Listener,
        options: ConversionOptions | None,
    ) -> None:
        self._planned = planned
        self._folder = folder
        self._crew = crew
        self._tell = listener
        self._options = options or ConversionOptions()
        self._versions = installed_versions()
        self._journal = Journal(folder)
        self._manifest = Manifest(folder)
        self._under_way: dict[int, tuple[Path, Record]] = {}
        self._counts = {"done": 0, "failed": 0, "skipped": 0, "missed": 0, "strict": 0}
        self._records: dict[int, Record] = {}
        self._stopped_by = ""

    def run(self) -> BatchSummary:
        start = time.monotonic()
        check_disk_space(self._folder, least_mib=self._options.least_disk_mib)
        self._clear_leftovers()
        self._journal.write(f"batch of {len(self._planned)} files begins; {self._versions}")
        if self._manifest.torn_lines:
            self._journal.write(f"manifest: {self._manifest.torn_lines} unreadable lines left out")
        self._tell(BatchStarted(len(self._planned)))
        try:
            self._work()
        finally:
            for staging, _ in self._under_way.values():
                discard_staging(staging)
        summary = self._summary(time.monotonic() - start)
        self._journal.write(
            f"batch ends: {summary.done} done, {summary.failed} failed, {summary.skipped} skipped,"
            f" {summary.left} left, {summary.seconds:.1f} s {summary.stopped_by}"
        )
        records = [record for _, record in sorted(self._records.items())]
        write_summary_table(self._folder, records)
        write_index_page(self._folder, records, summary)
        return summary

    def _work(self) -> None:
        for event in run_tasks(self._crew, self._tasks()):
            if isinstance(event, Phase):
                label = self._planned[event.key].source.label
                self._tell(FilePhase(label, event.name, event.done, event.total))
            elif isinstance(event, Finished):
                self._finish(event.key, event.result)
        self._crew.close()

    def _tasks(self) -> Iterator[tuple[int, Task] | None]:
        for key, entry in enumerate(self._planned):
            try:
                check_disk_space(self._folder, least_mib=self._options.least_disk_mib)
            except ExportError as error:
                self._stopped_by = str(error)
                return
            task = self._prepare(key, entry)
            yield None if task is None else (key, task)

    def _prepare(self, key: int, entry: PlannedJob) -> Task | None:
        """The task of a file, or None when it is done already or cannot be done."""
        if entry.refusal:
            self._refuse(key, "plan", "JobError", entry.refusal)
            return None
        try:
            base = base_record(entry, self._versions)
            earlier = self._manifest.latest(base.key, base.input)
            if not self._options.force and is_up_to_date(earlier, base, self._folder):
                assert earlier is not None
                self._skip(key, earlier)
                return None
            content = entry.source.path.read_bytes() if self._options.ship_bytes else None
        except OSError as error:
            culprit = printable(Path(error.filename or entry.source.path).name)
            message = f"read {culprit} - {error.strerror} - a file that can be read - correct it"
            self._refuse(key, "read", type(error).__name__, message)
            return None
        try:
            staging = open_staging(entry.job.output_dir)
        except OSError as error:
            message = (
                f"output folder of {entry.key} - {error.strerror} - a folder that can be written -"
                " correct it"
            )
            self._refuse(key, "write", type(error).__name__, message)
            return None
        self._under_way[key] = (staging, base)
        return self._task(entry.job, staging, content)

    def _task(self, job: Job, staging: Path, content: bytes | None) -> Task:
        return Task(
            job=replace(job, output_dir=staging.absolute()),
            job_function=self._options.job_function,
            input_bytes=content,
            versions=self._versions,
        )

    def _finish(self, key: int, result: TaskResult) -> None:
        entry = self._planned[key]
        staging, base = self._under_way.pop(key)
        known = self._manifest.outputs_of(entry.key)
        outcome = deliver(
            entry.job,
            staging,
            result,
            base=base,
            known_outputs=known,
            on_commit=self._manifest.append,
        )
        record = self._manifest.latest(base.key, base.input) or base
        if isinstance(outcome, JobFailed) and record.is_done:
            # Committed, but a final name could not be taken: not done after all.
            record = failed_record(base, outcome)
            self._manifest.append(record)
        if isinstance(outcome, JobDone):
            self._remove_stale(entry, known, record)
        self._count(key, record, outcome.trace if isinstance(outcome, JobFailed) else "")

    def _remove_stale(self, entry: PlannedJob, known: Iterable[str], record: Record) -> None:
        """Removes outputs of an earlier run that this one did not write again."""
        current = {file.name for file in record.outputs}
        for name in known:
            if name not in current and Path(name).name == name:
                (entry.job.output_dir / name).unlink(missing_ok=True)

    def _refuse(self, key: int, phase: str, error: str, message: str) -> None:
        entry = self._planned[key]
        blank = Record(
            key=entry.key,
            input=entry.source.label,
            input_sha256="",
            settings_sha256="",
            outcome="",
            versions=dict(self._versions),
        )
        failure = JobFailed(job=entry.job, phase=phase, error=error, message=message)
        record = failed_record(blank, failure)
        self._manifest.append(record)
        self._count(key, record, "")

    def _skip(self, key: int, record: Record) -> None:
        self._records[key] = record
        self._counts["skipped"] += 1
        self._count_missed(key, record)
        self._tell(FileSkipped(record.input, record))

    def _count(self, key: int, record: Record, trace: str) -> None:
        self._records[key] = record
        self._counts["done" if record.is_done else "failed"] += 1
        self._count_missed(key, record)
        message = f" in phase {record.phase}: {record.message}" if record.message else ""
        self._journal.write(f"{record.input}: {record.outcome}{message}")
        self._journal.write_detail(trace)
        self._tell(FileFinished(record.input, record))

    def _count_missed(self, key: int, record: Record) -> None:
        is_missed = bool(record.missed_limits)
        self._counts["missed"] += is_missed
        self._counts["strict"] += is_missed and self._planned[key].job.strict

    def _clear_leftovers(self) -> None:
        """Finishes what a killed batch had committed and removes what it had not."""
        for path, line in list(leftovers(self._folder)):
            if line is None:
                discard_staging(path)
                self._journal.write("removed what an earlier batch left unfinished")
                continue
            record = record_from_line(line)
            if record is not None and self._manifest.latest(record.key, record.input) != record:
                self._manifest.append(record)
            move_into_place(path)
            self._journal.write("put in place what an earlier batch had finished")

    def _summary(self, seconds: float) -> BatchSummary:
        counts = self._counts
        settled = counts["done"] + counts["failed"] + counts["skipped"]
        return BatchSummary(
            folder=self._folder,
            done=counts["done"],
            failed=counts["failed"],
            skipped=counts["skipped"],
            left=len(self._planned) - settled,
            missed_limits=counts["missed"],
            strict_misses=counts["strict"],
            seconds=seconds,
            stopped_by=self._stopped_by,
        )

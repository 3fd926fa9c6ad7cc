"""A batch of files into one folder: resumes, records, survives; tells a listener, never prints."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from wrinkle_cad import settings
from wrinkle_cad.batch.executor import run_tasks
from wrinkle_cad.batch.workers.pool import Finished, Phase, Pool
from wrinkle_cad.batch.workers.task import JobFunction, Task, TaskResult
from wrinkle_cad.errors import ExportError, WrinkleError
from wrinkle_cad.files.names import printable
from wrinkle_cad.files.regular import hash_regular, read_regular
from wrinkle_cad.files.staging import discard_staging, open_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed
from wrinkle_cad.report.versions import installed_versions

from .delivery import deliver, failed_record
from .disk_space import check_disk_space
from .events import BatchStarted, BatchSummary, FileFinished, FilePhase, FileSkipped, Listener
from .failure_causes import USER_ERRORS
from .fingerprint import hash_settings
from .inputs import FoundFile
from .journal import Journal
from .lock import locked_folder
from .manifest import WAITING, Manifest, Record
from .ownership import Hashes, check_own_files, is_up_to_date, remove_stale, set_outdated
from .pages import Pages
from .plan import PlannedJob
from .recovery import recover
from .sheets import LABEL, BatchSheets, SheetsMade


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
    pool: Pool,
    listener: Listener,
    options: ConversionOptions | None = None,
) -> BatchSummary:
    """Does what a plan says, but for what an earlier batch did already.

    Args:
        planned: from `plan_batch`, with the same folder.
        folder: receives the outputs, the manifest, the log, the summary; made when missing.
        pool: who does the work; ended when this returns or raises.
        listener: is told what happens, in this thread.
        options: how to go about it.

    Raises:
        InputError: another batch holds the folder, or somebody else's file has the name of one of
            the batch's own files.
        ExportError: the folder cannot be written to, or its disk is full before anything began.
    """
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with locked_folder(folder):
                set_aside = check_own_files(folder)
                return _Conversion(planned, folder, pool, listener, options).run(set_aside)
        except BrokenPipeError:
            # The listener's: whoever read our lines went away.
            raise
        except OSError as error:
            message = f"{error.strerror or error}. Give a folder that can be written, with room."
            raise ExportError(folder, "folder", message) from error
    finally:
        pool.kill()


def base_record(entry: PlannedJob, versions: Mapping[str, str]) -> Record:
    """The record of a planned file before it is known what becomes of it.

    Raises:
        OSError: the input, or a file among the settings, cannot be read.
    """
    return Record(
        key=entry.key,
        input=entry.source.label,
        input_sha256=hash_regular(entry.source.path, size_limit=settings.FILE_SIZE_LIMIT),
        settings_sha256=hash_settings(entry.job, versions),
        outcome="",
        versions=dict(versions),
    )


def trouble_of(source: FoundFile, error: Exception) -> str:
    """One sentence for an error about one file that no code foresaw."""
    said = printable(" ".join(str(error).split())[:200]) or "no message"
    return (
        f"{source.label} cannot be planned ({type(error).__name__}: {said}). Its name, its settings"
        " or its earlier outputs hold something unheard of: look at its job.toml and at NAME.json."
    )


def _blank_record(entry: PlannedJob, outcome: str, versions: Mapping[str, str]) -> Record:
    return Record(
        key=entry.key,
        input=entry.source.label,
        input_sha256="",
        settings_sha256="",
        outcome=outcome,
        versions=dict(versions),
    )


class _Conversion:
    """The state of one batch under way."""

    def __init__(
        self,
        planned: Sequence[PlannedJob],
        folder: Path,
        pool: Pool,
        listener: Listener,
        options: ConversionOptions | None,
    ) -> None:
        self._planned = planned
        self._folder = folder
        self._pool = pool
        self._tell = listener
        self._options = options or ConversionOptions()
        self._versions = installed_versions()
        self._journal = Journal(folder)
        self._manifest = Manifest(folder)
        self._under_way: dict[int, tuple[Path, Record]] = {}
        self._sheets = BatchSheets(planned, folder, self._manifest, self._versions)
        self._sheets_made = SheetsMade()
        self._pages = Pages(folder)
        self._start = time.monotonic()
        self._counts = {"done": 0, "failed": 0, "skipped": 0, "missed": 0, "strict": 0}
        self._records: dict[int, Record] = {}
        self._stopped_by = ""

    def run(self, set_aside: str) -> BatchSummary:
        check_disk_space(self._folder, least_mib=self._options.least_disk_mib)
        if set_aside:
            self._journal.write(
                f"the manifest was damaged: it is {set_aside} now, a new one begins"
            )
        recover(self._folder, self._manifest, self._journal.write)
        self._journal.write(f"batch of {len(self._planned)} files begins; {self._versions}")
        if self._manifest.torn_lines:
            self._journal.write(f"manifest: {self._manifest.torn_lines} unreadable lines left out")
        self._tell(BatchStarted(len(self._planned)))
        self._pages.write(*self._state())
        try:
            self._work()
            self._nest()
        except BaseException:
            # Ctrl-C, a listener's error or a defect: the folder is left in order all the same.
            self._give_up()
            raise
        records, summary = self._state(is_over=True)
        self._journal.write(
            f"batch ends: {summary.done} done, {summary.failed} failed, {summary.skipped} skipped,"
            f" {summary.left} left, {summary.seconds:.1f} s {summary.stopped_by}"
        )
        self._pages.write(records, summary)
        return summary

    def _give_up(self) -> None:
        """Leaves the folder in order when the batch is interrupted or cannot go on."""
        for staging, _ in self._under_way.values():
            discard_staging(staging)
        self._stopped_by = self._stopped_by or "interrupted"
        with contextlib.suppress(OSError, WrinkleError):
            self._pages.write(*self._state(is_over=True))

    def _work(self) -> None:
        for event in run_tasks(self._pool, self._tasks()):
            if isinstance(event, Phase):
                label = self._planned[event.key].source.label
                self._tell(FilePhase(label, event.name, event.done, event.total))
            elif isinstance(event, Finished):
                self._finish(event.key, event.result)
            self._pages.write_if_due(self._state)
        self._pool.close()

    def _nest(self) -> None:
        """Puts the pieces of all files on sheets, where these are wanted."""
        if self._stopped_by:
            return
        if self._sheets.is_wanted:
            self._tell(FilePhase(LABEL, "nest", 0, 1))
        made = self._sheets.make(self._records, force=self._options.force)
        for line in (made.said, *made.failures, *made.notes):
            if line:
                self._journal.write(f"{LABEL}: {line}")
        self._sheets_made = made

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
            base, done, content = self._looked_up(entry)
        except OSError as error:
            culprit = printable(Path(error.filename or entry.source.path).name)
            message = f"{culprit} cannot be read ({error.strerror}). Check the file."
            self._refuse(key, "read", type(error).__name__, message)
            return None
        except Exception as error:
            # What a stranger's name, settings or manifest can raise is not listed anywhere, and
            # it is one file's trouble.
            self._refuse(key, "plan", type(error).__name__, trouble_of(entry.source, error))
            return None
        if done is not None:
            self._skip(key, done)
            return None
        try:
            staging = open_staging(entry.job.output_dir)
        except OSError as error:
            message = (
                f"The output folder of {entry.key} cannot be written to ({error.strerror})."
                " Check its permissions."
            )
            self._refuse(key, "write", type(error).__name__, message)
            return None
        self._under_way[key] = (staging, base)
        return self._task(entry.job, staging, content)

    def _looked_up(self, entry: PlannedJob) -> tuple[Record, Record | None, bytes | None]:
        """A file's record to complete, its earlier record if that still holds, its content."""
        base = base_record(entry, self._versions)
        earlier = self._manifest.latest(base.key, base.input)
        if not self._options.force and is_up_to_date(earlier, base, self._folder):
            return base, earlier, None
        if not self._options.ship_bytes:
            return base, None, None
        return base, None, read_regular(entry.source.path, size_limit=settings.FILE_SIZE_LIMIT)

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
        earlier = self._manifest.latest(base.key, base.input)
        outcome = deliver(
            entry.job,
            staging,
            result,
            base=base,
            known=known,
            on_commit=self._manifest.append,
        )
        self._sheets.set_outdated()
        record = self._manifest.latest(base.key, base.input) or base
        if isinstance(outcome, JobFailed) and record.is_done:
            # Committed, but a final name could not be taken: not done after all.
            record = failed_record(base, outcome)
            self._manifest.append(record)
        if isinstance(outcome, JobDone):
            self._remove_stale(entry.job.output_dir, record, known)
        else:
            self._set_outdated(earlier)
        self._count(key, record, outcome.trace if isinstance(outcome, JobFailed) else "")

    def _set_outdated(self, earlier: Record | None) -> None:
        """Marks outputs of an earlier run, so that nobody cuts by them what now fails."""
        if earlier is None:
            return
        known = self._manifest.outputs_of(earlier.key)
        try:
            renamed = set_outdated((self._folder / earlier.key).parent, earlier, known)
        except OSError as error:
            # A folder of this one file that cannot be written to is no end of the batch.
            self._journal.write(
                f"{earlier.input}: fails now; its earlier outputs are NOT marked as outdated"
                f" ({error.strerror or error}): do not cut by them"
            )
            return
        for name in renamed:
            self._journal.write(f"{earlier.input}: fails now; its earlier output is {name}")

    def _remove_stale(self, folder: Path, record: Record, known: Hashes) -> None:
        try:
            kept = remove_stale(folder, record, known)
        except OSError as error:
            self._journal.write(
                f"{record.input}: outputs of an earlier run cannot be removed"
                f" ({error.strerror or error}): do not cut by them"
            )
            return
        for name in kept:
            self._journal.write(f"{record.input}: {name} is not as it was written: kept")

    def _refuse(self, key: int, phase: str, error: str, message: str) -> None:
        entry = self._planned[key]
        blank = _blank_record(entry, "", self._versions)
        failure = JobFailed(job=entry.job, phase=phase, error=error, message=message)
        record = failed_record(blank, failure)
        earlier = self._manifest.latest(record.key, record.input)
        self._manifest.append(record)
        self._sheets.set_outdated()
        self._set_outdated(earlier)
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
        if record.error not in USER_ERRORS:
            self._journal.write_detail(trace)
        self._tell(FileFinished(record.input, record))

    def _count_missed(self, key: int, record: Record) -> None:
        is_missed = bool(record.missed_limits)
        self._counts["missed"] += is_missed
        self._counts["strict"] += is_missed and self._planned[key].job.strict

    def _waiting(self, entry: PlannedJob) -> Record:
        """What is known of a file that was not come to: what an earlier batch made of it."""
        earlier = self._manifest.latest(entry.key, entry.source.label)
        if earlier is None:
            return _blank_record(entry, WAITING, self._versions)
        return replace(earlier, outcome=WAITING)

    def _state(self, *, is_over: bool = False) -> tuple[list[Record], BatchSummary]:
        """What is known of every file, and the numbers."""
        counts = self._counts
        settled = counts["done"] + counts["failed"] + counts["skipped"]
        records = [
            self._records.get(key) or self._waiting(entry)
            for key, entry in enumerate(self._planned)
        ]
        return records, BatchSummary(
            folder=self._folder,
            done=counts["done"],
            failed=counts["failed"],
            skipped=counts["skipped"],
            left=len(self._planned) - settled,
            missed_limits=counts["missed"],
            strict_misses=counts["strict"],
            seconds=time.monotonic() - self._start,
            sheets=self._sheets_made.said,
            sheet_failures=self._sheets_made.failures,
            stopped_by=self._stopped_by,
            is_over=is_over,
        )

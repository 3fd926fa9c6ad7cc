"""DIR/batch.sheets.N.dxf: the pieces of a whole batch on sheets of material.

They are made when every file is settled, from the pieces that the done ones left (NAME.pieces), so
a batch that goes on where another stopped has them all. Once a file is done anew, sheets of an
earlier batch are called ``.outdated`` until there are new ones.
"""

from __future__ import annotations

import csv
import hashlib
import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final

from wrinkle_cad.batch.workers.task import TaskResult
from wrinkle_cad.errors import InputError, WrinkleError
from wrinkle_cad.files.names import printable
from wrinkle_cad.files.regular import hash_regular
from wrinkle_cad.files.staging import discard_staging, open_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed

from .delivery import deliver
from .manifest import Manifest, OutputFile, Record
from .ownership import is_up_to_date, remove_stale, set_outdated
from .plan import SHEETS_NAME, PlannedJob
from .sheet_wish import SheetWish, text_of
from .summary_table import safe_cell

if TYPE_CHECKING:
    from wrinkle_cad.pattern.piece.nesting import NestedSheet
    from wrinkle_cad.pattern.piece.piece import PatternPiece

LABEL: Final = "sheets of the batch"
"""What the manifest and the screen call them."""
_COLUMNS: Final = (
    "sheet", "length_mm", "width_mm", "used_mm", "used_percent", "input", "piece", "copies",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class SheetsMade:
    """What became of a batch's sheets."""

    said: str = ""
    """How many there are and how full, on one line; empty when none are wanted."""
    failures: tuple[str, ...] = ()
    """What is on none of them, and why; one line each."""
    notes: tuple[str, ...] = ()
    """What was noticed while they were written."""


@dataclass(frozen=True, slots=True, eq=False)
class _Lot:
    """Pieces that come on the same sheets, and the input of each."""

    wish: SheetWish
    pieces: list[PatternPiece]
    inputs: list[str]


class BatchSheets:
    """The sheets of a batch's folder.

    Args:
        planned: the batch's files.
        folder: the batch's.
        manifest: its own record of what it wrote stands there, too.
        versions: of every package at work.
    """

    def __init__(
        self,
        planned: Sequence[PlannedJob],
        folder: Path,
        manifest: Manifest,
        versions: Mapping[str, str],
    ) -> None:
        self._planned = planned
        self._folder = folder
        self._manifest = manifest
        self._versions = versions
        self._is_outdated = False
        self._notes: list[str] = []

    @property
    def is_wanted(self) -> bool:
        """Whether any file wants its pieces on sheets."""
        return any(entry.sheet is not None for entry in self._planned)

    def set_outdated(self) -> None:
        """Renames the sheets of an earlier batch, since one of their files is done anew."""
        earlier = self._manifest.latest(SHEETS_NAME, LABEL)
        if earlier is not None and not self._is_outdated:
            set_outdated(self._folder, earlier, self._manifest.outputs_of(SHEETS_NAME))
        self._is_outdated = True

    def make(self, records: Mapping[int, Record], *, force: bool = False) -> SheetsMade:
        """Nests the pieces of all files that are done.

        Args:
            records: of every file, by its number in the plan.
            force: whether to nest again what has not changed.

        Raises:
            OSError: the folder cannot be written to.
        """
        wanted = [
            (entry, records[number])
            for number, entry in enumerate(self._planned)
            if entry.sheet is not None and number in records and records[number].is_done
        ]
        if not wanted:
            # What an earlier batch nested is on no sheet any more.
            self.set_outdated()
            return SheetsMade()
        base = self._base(wanted)
        earlier = self._manifest.latest(SHEETS_NAME, LABEL)
        if earlier is not None and not force and is_up_to_date(earlier, base, self._folder):
            return self._told(earlier, len(wanted))
        known = self._manifest.outputs_of(SHEETS_NAME)
        job = Job(input=self._manifest.path, output_dir=self._folder, name=SHEETS_NAME)
        staging = open_staging(self._folder)
        try:
            base, result = self._nested(wanted, base, replace(job, output_dir=staging))
            outcome = deliver(
                job, staging, result, base=base, known=known, on_commit=self._manifest.append
            )
        except BaseException:
            # Ctrl-C, too, must leave no hidden folder.
            discard_staging(staging)
            raise
        if isinstance(outcome, JobFailed):
            return SheetsMade(failures=(f"The sheets were not written. {outcome.message}",))
        record = self._manifest.latest(SHEETS_NAME, LABEL) or base
        remove_stale(self._folder, record, known)
        return replace(self._told(record, len(wanted)), notes=tuple(dict.fromkeys(self._notes)))

    def _told(self, record: Record, done: int) -> SheetsMade:
        wanting = sum(entry.sheet is not None or bool(entry.refusal) for entry in self._planned)
        failed = wanting - done
        lacking = f" Without the pieces of {failed} files that failed." if failed else ""
        return SheetsMade(f"{_text_of_sheets(record)}{lacking}".strip(), record.missed_limits)

    def _base(self, wanted: Sequence[tuple[PlannedJob, Record]]) -> Record:
        given = hashlib.sha256()
        for entry, record in wanted:
            assert entry.sheet is not None  # chosen by it
            hashes = [file.sha256 for file in record.outputs if file.name.endswith(".pieces")]
            line = [entry.key, record.input, hashes, text_of(entry.sheet.to_hash())]
            given.update(text_of({"file": line}).encode("ascii"))
        versions = text_of(dict(self._versions)).encode("ascii")
        return Record(
            key=SHEETS_NAME,
            input=LABEL,
            input_sha256=given.hexdigest(),
            settings_sha256=hashlib.sha256(versions).hexdigest(),
            outcome="",
            versions=dict(self._versions),
        )

    def _nested(
        self, wanted: Sequence[tuple[PlannedJob, Record]], base: Record, job: Job
    ) -> tuple[Record, TaskResult]:
        """Writes the sheets into the job's folder."""
        failures: list[str] = []
        lots = _lots(wanted, self._folder, failures)
        rows: list[tuple[Any, ...]] = []
        sheets: list[NestedSheet] = []
        paths: list[Path] = []
        try:
            for lot in lots:
                here = _nested_lot(lot, len(sheets), job, failures, self._notes)
                names = [_path(job, len(sheets) + 1 + k) for k in range(len(here))]
                rows += _rows(lot, here, names)
                sheets, paths = sheets + here, paths + names
            table = job.output_dir / f"{job.name}.csv"
            table.write_text(_table(rows), encoding="utf-8-sig", newline="")
        except (WrinkleError, MemoryError) as error:
            message = printable(str(error)) or "There is not enough memory for them."
            failed = JobFailed(job=job, phase="nest", error=type(error).__name__, message=message)
            return base, TaskResult(outcome=failed)
        outputs = (*paths, table)
        files = tuple(
            OutputFile(path.name, path.stat().st_size, hash_regular(path)) for path in outputs
        )
        done = JobDone(job=job, outputs=outputs, summary={}, missed_limits=tuple(failures))
        return replace(base, figures=_figures(sheets)), TaskResult(outcome=done, outputs=files)


def _lots(
    wanted: Sequence[tuple[PlannedJob, Record]], folder: Path, failures: list[str]
) -> tuple[_Lot, ...]:
    """Returns the pieces of the files by what they want; what fits on no sheet is left out."""
    from wrinkle_cad.pattern.formats.piece_file import read_pieces
    from wrinkle_cad.pattern.piece.nesting import check_fits

    lots: dict[SheetWish, _Lot] = {}
    for entry, record in wanted:
        assert entry.sheet is not None  # chosen by it
        lot = lots.setdefault(entry.sheet, _Lot(entry.sheet, [], []))
        stem = PurePosixPath(entry.key).name
        try:
            for piece in read_pieces((folder / entry.key).with_name(f"{stem}.pieces")):
                # Two files may each have a piece called toe.
                is_told = piece.name.startswith(stem)
                named = piece if is_told else replace(piece, name=f"{stem} {piece.name}")
                check_fits(named, entry.sheet.size)
                lot.pieces.append(named)
                lot.inputs.append(record.input)
        except InputError as error:
            failures.append(f"{record.input} is not whole on the sheets. {error}")
    return tuple(lots.values())


def _nested_lot(
    lot: _Lot, before: int, job: Job, failures: list[str], notes: list[str]
) -> list[NestedSheet]:
    """Returns the sheets of a lot, written under the names after those of earlier lots."""
    from wrinkle_cad.pattern.piece.compacting import compacted
    from wrinkle_cad.pattern.piece.nesting import nested
    from wrinkle_cad.wrinkle.cut_pattern import write_sheets

    if not lot.pieces:
        return []
    wish = lot.wish
    try:
        sheets = [
            compacted(one, seconds=wish.seconds) for one in nested(lot.pieces, sheet=wish.size)
        ]
        told = write_sheets(
            [_path(job, before + 1 + k) for k in range(len(sheets))],
            sheets,
            profile=wish.profile,
            version=wish.version,
            curves=wish.curves,
            timestamp=None if wish.epoch is None else datetime.fromtimestamp(wish.epoch, UTC),
        )
    except InputError as error:
        failures.append(f"{len(lot.pieces)} pieces are on no sheet. {error}")
        return []
    notes += [finding.message for finding in told]
    return sheets


def _path(job: Job, number: int) -> Path:
    return job.output_dir / f"{job.name}.{number}.dxf"


def _rows(
    lot: _Lot, sheets: Sequence[NestedSheet], paths: Sequence[Path]
) -> Iterator[tuple[Any, ...]]:
    for sheet, path in zip(sheets, paths, strict=True):
        used = round(100.0 * sheet.utilisation, 1)
        for index, copies in sorted(Counter(sheet.index).items()):
            names = lot.inputs[index], lot.pieces[index].name
            yield path.name, *sheet.size, round(sheet.used_length, 1), used, *names, copies


def _table(rows: Sequence[tuple[Any, ...]]) -> str:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow(_COLUMNS)
    writer.writerows([safe_cell(value) for value in row] for row in rows)
    return text.getvalue()


def _figures(sheets: Sequence[NestedSheet]) -> dict[str, Any]:
    figures: dict[str, Any] = {"sheets": len(sheets)}
    for number, sheet in enumerate(sheets, start=1):
        figures[f"sheet{number}_pieces"] = len(sheet.pieces)
        figures[f"sheet{number}_used_mm"] = sheet.used_length
        figures[f"sheet{number}_utilisation"] = sheet.utilisation
    return figures


def _text_of_sheets(record: Record) -> str:
    """What the figures of the sheets say; of many sheets the first ten."""
    count = int(record.figures.get("sheets", 0))
    parts = []
    for number in range(1, min(count, 10) + 1):
        pieces, used, share = (
            record.figures.get(f"sheet{number}_{name}", 0.0)
            for name in ("pieces", "used_mm", "utilisation")
        )
        parts.append(f"{pieces} pieces on {used:.0f} mm, used to {100.0 * share:.1f}%")
    more = "; ..." if count > len(parts) else ""
    return f"{count} sheet{'s' * (count != 1)}: {'; '.join(parts)}{more}." if count else ""

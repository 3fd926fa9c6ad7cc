"""Runs damaged STEP files through the real reader in workers, and tells what became of them.

Usage: python -m tests.fuzz.runner --count N --seed S --keep DIR [--structured] [FOLDER...]

The originals are the examples and the files of the folders; those whose damage crashed a worker,
hung it or showed a bug are copied to DIR. Exit code 1 when a bug showed.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from tests.fuzz.forked import Ended, ended_files, print_ended, warm_up
from tests.fuzz.mutations import mutate
from tests.fuzz.structure import restructure
from wrinkle_cad.batch.folder.conversion import convert
from wrinkle_cad.batch.folder.events import BatchEvent, FileFinished
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.manifest import Record
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool
from wrinkle_cad.files.names import CAD_SUFFIXES
from wrinkle_cad.files.staging import leftovers

ROOT = Path(__file__).parent.parent.parent
EXAMPLES = ROOT / "shoe_examples"
STEP_SUFFIXES = tuple(suffix for suffix in CAD_SUFFIXES if suffix.startswith((".st", ".p21")))
LARGEST_ORIGINAL = 300_000
OUTPUT_KINDS = frozenset({"step", "stl", "dxf", "json", "html", "svg", "pdf"})
BATCH_FILES = frozenset({"manifest.jsonl", "batch.log", "summary.csv", "index.html"})


@dataclass
class Figures:
    """What became of the damaged files."""

    files: int = 0
    seconds: float = 0.0
    cpu_s: float = 0.0
    """CPU time of all files together, where it is known."""
    done: int = 0
    failures: Counter[str] = field(default_factory=Counter)
    """By class of error."""
    bugs: list[str] = field(default_factory=list)
    """One line each: internal errors, lines that are none, files and processes out of place."""
    longest: float = 0.0
    """Seconds of the slowest file."""

    def __str__(self) -> str:
        kinds = ", ".join(f"{count} {name}" for name, count in self.failures.most_common())
        return (
            f"{self.files} files in {self.seconds:.0f} s ({self.cpu_s:.0f} s of CPU time):"
            f" {self.done} done, {kinds}; slowest"
            f" {self.longest:.1f} s; {len(self.bugs)} bugs"
        )


def originals(folders: Iterable[Path]) -> list[Path]:
    """The STEP files below the folders that are small enough to be read often."""
    found = (path for folder in folders for path in folder.rglob("*"))
    return sorted(
        path
        for path in found
        if path.suffix.lower() in STEP_SUFFIXES and 0 < path.stat().st_size < LARGEST_ORIGINAL
    )


def weighted(examples: Sequence[Path], others: Sequence[Path]) -> list[Path]:
    """Both, the examples repeated until they are as many as the others."""
    times = max(1, round(len(others) / max(1, len(examples))))
    return [*examples] * times + [*others]


def run(
    folder: Path,
    count: int,
    seed: int,
    sources: Sequence[Path],
    *,
    timeout_s: float = 60.0,
    workers: int = 2,
    is_structured: bool = False,
) -> tuple[Figures, list[Record]]:
    """Makes damaged files in a folder, runs them all, and judges what came of it."""
    inputs, outputs = folder / "in", folder / "out"
    make_files(inputs, count, seed, sources, is_structured=is_structured)
    figures = Figures(files=count)
    records: list[Record] = []

    def listen(event: BatchEvent) -> None:
        if isinstance(event, FileFinished):
            records.append(event.record)

    planned = plan_batch(find_sources([str(inputs)], outputs).files, outputs)
    pool = WorkerPool(workers, WorkerLimits(timeout_s=timeout_s))
    start = time.monotonic()
    convert(planned, outputs, pool, listen)
    figures.seconds = time.monotonic() - start
    for record in records:
        judge(record, figures, timeout_s)
    if len(records) != count:
        figures.bugs.append(f"{len(records)} outcomes of {count} files")
    check_surroundings(folder, records, figures)
    return figures, records


def make_files(
    inputs: Path, count: int, seed: int, sources: Sequence[Path], *, is_structured: bool
) -> list[Path]:
    """Writes damaged or changed files into a new folder."""
    inputs.mkdir()
    chance = random.Random(seed)
    contents = [path.read_bytes() for path in sources]
    made = []
    for number in range(count):
        pick = chance.randrange(len(contents))
        name = f"{number:05d}-{sources[pick].stem}.step"
        damaged = (
            restructure(contents[pick], chance.choice(contents), chance)
            if is_structured
            else mutate(contents[pick], chance)
        )
        (inputs / name).write_bytes(damaged)
        made.append(inputs / name)
        settings = sources[pick].parent / "job.toml"
        if is_structured and settings.is_file():
            # With its waves an upper is carved and stitched, too.
            shutil.copy(settings, inputs / f"{Path(name).stem}.job.toml")
    return made


def run_forked(
    folder: Path,
    count: int,
    seed: int,
    sources: Sequence[Path],
    *,
    is_structured: bool = False,
    workers: int = 2,
) -> tuple[Figures, list[Ended]]:
    """As `run`, but each file in a child of this process, with a limit of its own CPU time."""
    made = make_files(folder / "in", count, seed, sources, is_structured=is_structured)
    for source in dict.fromkeys(sources):
        if source.is_relative_to(EXAMPLES):
            warm_up(source, folder / "warm")
    start = time.monotonic()
    ended = list(ended_files(made, folder / "out", at_a_time=workers))
    figures = Figures(files=count, seconds=time.monotonic() - start)
    figures.cpu_s = sum(each.cpu_s for each in ended)
    figures.longest = max(each.cpu_s for each in ended)
    figures.done = sum(not each.error for each in ended)
    figures.failures = Counter(each.error for each in ended if each.error)
    figures.bugs = [f"{each.name}: {each.bug}" for each in ended if each.bug]
    for path, _ in leftovers(folder / "out"):
        # A child that is killed leaves what its next start would clear.
        if not any(each.bug and Path(each.name).stem in path.parts for each in ended):
            figures.bugs.append(f"left behind: {path.name}")
    return figures, ended


def judge(record: Record, figures: Figures, timeout_s: float) -> None:
    """Counts an outcome and notes what must not be."""
    seconds = sum(record.seconds.values())
    figures.longest = max(figures.longest, seconds)
    if seconds > timeout_s + 2.0:
        figures.bugs.append(f"{record.input}: {seconds:.1f} s")
    if record.is_done:
        figures.done += 1
        return
    figures.failures[record.error] += 1
    is_one_line = bool(record.message) and record.message.isprintable()
    if not is_one_line or "Traceback" in record.message:
        figures.bugs.append(f"{record.input}: no line of text: {record.message!r}")
    if record.message.startswith("An internal error"):
        figures.bugs.append(f"{record.input}: {record.message}")


def check_surroundings(folder: Path, records: Sequence[Record], figures: Figures) -> None:
    """Notes processes that live on and files that are not where they belong."""
    for child in psutil.Process().children(recursive=True):
        # The server that workers are forked from is a child of this process, they are its.
        if "forkserver" in " ".join(child.cmdline()) and child.ppid() != os.getpid():
            figures.bugs.append(f"process {child.pid} lives on")
    figures.bugs += [f"left behind: {path.name}" for path, _ in leftovers(folder / "out")]
    if {path.name for path in folder.iterdir()} != {"in", "out"}:
        figures.bugs.append("a file outside of the output folder")
    allowed = {file.name for record in records for file in record.outputs} | BATCH_FILES
    for path in (folder / "out").rglob("*"):
        if path.is_file() and path.name not in allowed and not path.name.endswith(".lock"):
            figures.bugs.append(f"a file that no record names: {path.name}")


def main() -> int:
    """Runs from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path, default=[])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=60.0)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--example", default="", help="damage this example only")
    parser.add_argument("--structured", action="store_true", help="change entities, not bytes")
    parser.add_argument("--forked", action="store_true", help="in children, CPU time limited")
    given = parser.parse_args()
    if given.forked:
        return _main_forked(given)
    with tempfile.TemporaryDirectory() as name:
        figures, records = run(
            Path(name),
            given.count,
            given.seed,
            # Files that make a strip go deepest: half of the damage is theirs.
            weighted(originals([EXAMPLES / given.example]), originals(given.folders)),
            timeout_s=given.timeout,
            workers=given.workers,
            is_structured=given.structured,
        )
        sys.stdout.write("\n".join([*figures.bugs, str(figures)]) + "\n")
        if given.keep is not None:
            given.keep.mkdir(parents=True, exist_ok=True)
            for record in records:
                is_crash = record.error in ("WorkerKilled", "TimeLimit", "MemoryLimit")
                if is_crash or record.message.startswith("An internal error"):
                    shutil.copy(Path(name, "in", record.input), given.keep)
                    sys.stdout.write(f"{record.input}: {record.message}\n")
    return 1 if figures.bugs else 0


def _main_forked(given: argparse.Namespace) -> int:
    with tempfile.TemporaryDirectory() as name:
        figures, ended = run_forked(
            Path(name),
            given.count,
            given.seed,
            weighted(originals([EXAMPLES / given.example]), originals(given.folders)),
            is_structured=given.structured,
            workers=given.workers,
        )
        print_ended(ended)
        sys.stdout.write(f"{figures}\n")
        if given.keep is not None:
            given.keep.mkdir(parents=True, exist_ok=True)
            for each in ended:
                if each.bug:
                    shutil.copy(Path(name, "in", each.name), given.keep)
    return 1 if figures.bugs else 0


if __name__ == "__main__":
    sys.exit(main())

"""300 files with bad ones among them: exact counts, memory of the parent flat."""

from __future__ import annotations

import random
from pathlib import Path

import psutil
import pytest

from tests.batch.strips import put_strips
from wrinkle_cad.batch.folder.conversion import convert
from wrinkle_cad.batch.folder.events import BatchEvent, FileFinished
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool

FILES = 300
BAD = (b"", b"not a step file", b"ISO-10303-21;\nHEADER;\n")


@pytest.mark.slow
def test_300_files_with_15_bad_ones(tmp_path: Path, record_property: pytest.RecordProperty) -> None:
    paths = put_strips(tmp_path / "in", FILES, seed=7)
    chance = random.Random(8)
    bad = {path.name for path in chance.sample(paths, FILES // 20)}
    for number, name in enumerate(sorted(bad)):
        (tmp_path / "in" / name).write_bytes(BAD[number % len(BAD)])
    parent = psutil.Process()
    memory: list[int] = []
    failed: dict[str, str] = {}

    def listen(event: BatchEvent) -> None:
        if isinstance(event, FileFinished):
            memory.append(parent.memory_info().rss)
            if not event.record.is_done:
                failed[event.record.input] = event.record.message

    out = tmp_path / "out"
    sources = find_sources([str(tmp_path / "in")], out).files
    planned = plan_batch(sources, out, keywords={"tolerance": 0.3})
    summary = convert(planned, out, WorkerPool(2, WorkerLimits()), listen)
    assert {name: text for name, text in failed.items() if name not in bad} == {}
    assert set(failed) == bad
    assert (summary.done, summary.failed, summary.left) == (FILES - len(bad), len(bad), 0)
    assert len(list(out.glob("*.step"))) == FILES - len(bad)
    first, last = sum(memory[:50]) / 50, sum(memory[-50:]) / 50
    record_property("seconds", summary.seconds)
    record_property("memory", f"{first / 2**20:.1f} MiB, then {last / 2**20:.1f} MiB")
    assert last < 1.1 * first

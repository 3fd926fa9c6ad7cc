"""Faults in the real job: every phase, a disk that fills up at the k-th byte, crashes."""

from __future__ import annotations

import pytest

from tests.batch.conftest import Bench
from tests.batch.real_faults import faulty_job
from tests.batch.strips import EXAMPLE
from wrinkle_cad.batch.folder.events import FileFinished
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.job.workflow import _PHASES as PHASES

ROOMS = (0, 1000, 15_000, 100_000, 300_000)
CRASHES = ("SIGSEGV-surface", "SIGKILL-write", "memory-write")


@pytest.mark.slow
def test_a_fault_in_any_phase_of_the_real_job_costs_one_file(bench: Bench) -> None:
    text = EXAMPLE.read_text()
    names = [f"cad-{phase}" for phase in PHASES] + [f"room-{room}" for room in ROOMS]
    bench.put(**dict.fromkeys([*names, *CRASHES, "good", "z_good"], text))
    summary = bench.run(
        workers=2, job_function=faulty_job, limits=WorkerLimits(timeout_s=300, memory_gib=3)
    )
    assert summary.done == 2
    records = {
        event.record.key: event.record for event in bench.events if isinstance(event, FileFinished)
    }
    for phase in PHASES:
        record = records[f"cad-{phase}"]
        assert (record.phase, record.message) == (phase, f"Cannot do it: {phase}")
    for room in ROOMS:
        assert records[f"room-{room}"].phase in ("write", "page")
    assert [records[name].error for name in CRASHES] == [
        "WorkerKilled",
        "WorkerKilled",
        "MemoryLimit",
    ]
    assert all(record.message.isprintable() for record in records.values())
    assert {name.split(".")[0] for name in bench.files()} == {"good", "z_good"}

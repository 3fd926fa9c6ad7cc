"""What a batch costs beyond its jobs, and what a second worker brings."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.batch.strips import put_strips
from wrinkle_cad.batch.conversion import convert
from wrinkle_cad.batch.crew import WorkerCrew
from wrinkle_cad.batch.ending import CrewLimits
from wrinkle_cad.batch.events import BatchEvent, FileFinished
from wrinkle_cad.batch.inputs import find_sources
from wrinkle_cad.batch.plan import plan_batch
from wrinkle_cad.job import Job
from wrinkle_cad.outcome import JobDone
from wrinkle_cad.workflow import run_job

FILES = 24
WARM_UP = 4


def batch(inputs: Path, folder: Path, workers: int) -> float:
    """Seconds per file of a batch from its first warm file to its end."""
    planned = plan_batch(find_sources([str(inputs)], folder).files, folder)
    moments: list[float] = []

    def listen(event: BatchEvent) -> None:
        if isinstance(event, FileFinished):
            assert event.record.is_done
            moments.append(time.perf_counter())

    convert(planned, folder, WorkerCrew(workers, CrewLimits()), listen)
    return (moments[-1] - moments[WARM_UP - 1]) / (len(moments) - WARM_UP)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    put_strips(folder, FILES)
    return folder


def test_overhead_per_file_is_at_most_50_ms(
    inputs: Path, tmp_path: Path, benchmark: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One worker against the same jobs one after the other in this process, warm."""
    paths = sorted(inputs.iterdir())

    def alone() -> float:
        moments = []
        for path in paths:
            outcome = run_job(Job(input=path, output_dir=tmp_path / "alone"))
            assert isinstance(outcome, JobDone)
            moments.append(time.perf_counter())
        return (moments[-1] - moments[WARM_UP - 1]) / (len(moments) - WARM_UP)

    per_file_alone = alone()
    per_file = benchmark.pedantic(batch, args=(inputs, tmp_path / "batch", 1), rounds=1)  # type: ignore[attr-defined]
    overhead = per_file - per_file_alone
    benchmark.extra_info["overhead_ms"] = 1000 * overhead  # type: ignore[attr-defined]
    benchmark.extra_info["job_ms"] = 1000 * per_file_alone  # type: ignore[attr-defined]
    assert overhead <= 0.050


def test_two_workers_are_at_least_1_7_times_as_fast_as_one(
    inputs: Path, tmp_path: Path, benchmark: Callable[..., Any]
) -> None:
    one = batch(inputs, tmp_path / "one", 1)
    two = benchmark.pedantic(batch, args=(inputs, tmp_path / "two", 2), rounds=1)  # type: ignore[attr-defined]
    benchmark.extra_info["speed_up"] = one / two  # type: ignore[attr-defined]
    assert one / two >= 1.7

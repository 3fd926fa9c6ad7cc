"""What a batch costs beyond its jobs, and what a second worker brings."""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.batch.strips import put_strips
from wrinkle_cad.batch.folder.conversion import convert
from wrinkle_cad.batch.folder.events import BatchEvent, FileFinished, Listener
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import Finished, WorkerPool
from wrinkle_cad.batch.workers.task import Task
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed, Progress
from wrinkle_cad.job.workflow import run_job

FILES = 60
WARM_UP = 4


def batch(inputs: Path, folder: Path, workers: int, listener: Listener) -> None:
    planned = plan_batch(find_sources([str(inputs)], folder).files, folder)
    summary = convert(planned, folder, WorkerPool(workers, WorkerLimits()), listener)
    assert summary.done == FILES


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    put_strips(folder, FILES)
    return folder


def test_overhead_per_file_is_at_most_50_ms(
    inputs: Path, tmp_path: Path, benchmark: BenchmarkFixture
) -> None:
    """One worker and this process take turns with the same files, so that both meet one load."""
    alone: list[float] = []
    in_batch: list[float] = []
    left = 0.0

    def listen(event: BatchEvent) -> None:
        nonlocal left
        if not isinstance(event, FileFinished):
            return
        begin = time.perf_counter()
        if left:
            in_batch.append(begin - left)
        job = Job(input=inputs / event.record.input, output_dir=tmp_path / "alone")
        assert isinstance(run_job(job), JobDone)
        left = time.perf_counter()
        alone.append(left - begin)

    arguments = (inputs, tmp_path / "batch", 1, listen)
    benchmark.pedantic(batch, args=arguments, rounds=1)
    job_ms = 1000 * statistics.median(alone[WARM_UP:])
    overhead_ms = 1000 * statistics.median(in_batch[WARM_UP:]) - job_ms
    benchmark.extra_info.update(job_ms=job_ms, overhead_ms=overhead_ms)
    assert overhead_ms <= 50.0


def seconds_per_file(inputs: Path, folder: Path, workers: int) -> float:
    """From the first file done by warm workers to the last."""
    moments: list[float] = []

    def listen(event: BatchEvent) -> None:
        if isinstance(event, FileFinished):
            moments.append(time.perf_counter())

    batch(inputs, folder, workers, listen)
    return (moments[-1] - moments[WARM_UP - 1]) / (len(moments) - WARM_UP)


def test_two_workers_are_at_least_1_7_times_as_fast_as_one(
    inputs: Path, tmp_path: Path, benchmark: BenchmarkFixture
) -> None:
    """Needs two cores with nothing else to do."""
    one = seconds_per_file(inputs, tmp_path / "one", 1)
    arguments = (inputs, tmp_path / "two", 2)
    two: float = benchmark.pedantic(seconds_per_file, args=arguments, rounds=1)
    benchmark.extra_info["speed_up"] = one / two
    assert one / two >= 1.7


def start_only(job: Job, *, progress: Progress | None = None) -> JobDone | JobFailed:
    """Loads nothing that its worker has not, and says when it is done."""
    assert "OCP" in sys.modules
    return JobDone(job=job, outputs=(), summary={}, seconds={})


def test_a_further_worker_starts_within_300_ms(tmp_path: Path, benchmark: BenchmarkFixture) -> None:
    pool = WorkerPool(7, WorkerLimits())
    task = Task(job=Job(input=tmp_path / "none.step"), job_function=start_only)

    def one_more() -> None:
        pool.give(0, task)
        while not any(isinstance(event, Finished) for event in pool.wait(1.0)):
            pass
        # Another one must be started, while this one lives.
        started.append(pool._idle.pop())

    started: list[object] = []
    benchmark.pedantic(one_more, rounds=5, warmup_rounds=1)
    pool._idle.extend(started)  # type: ignore[arg-type]
    pool.kill()
    assert benchmark.stats.stats.median < 0.3

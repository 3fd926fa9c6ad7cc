"""Whatever happens in a worker costs the file that it had, is named, and nothing else."""

from __future__ import annotations

import json
import os
import signal
import time
from multiprocessing.process import BaseProcess
from pathlib import Path

import psutil
import pytest

from tests.batch.conftest import Bench
from tests.batch.processes import assert_all_end
from tests.batch.stand_ins import KINDS, PHASES, job_by_content, talkative_job, worker_id_job
from wrinkle_cad.batch.folder.events import FileFinished, FilePhase
from wrinkle_cad.batch.folder.manifest import Record
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool
from wrinkle_cad.batch.workers.task import Task
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job

LIMITS = WorkerLimits(timeout_s=4.0, memory_gib=2.0)


def run(bench: Bench, **contents: str) -> dict[str, Record]:
    """Runs a batch of one bad file per keyword and a good one before and after."""
    bench.put(**contents, a_good="good", z_good="good")
    bench.run(workers=2, limits=LIMITS)
    records = {
        event.record.key: event.record for event in bench.events if isinstance(event, FileFinished)
    }
    assert records.pop("a_good").is_done
    assert records.pop("z_good").is_done
    good = {f"{name}.{kind}" for name in ("a_good", "z_good") for kind in KINDS}
    assert set(bench.files()) == good
    assert_no_workers()
    return records


def assert_no_workers() -> None:
    names = [process.name() for process in psutil.Process().children(recursive=True)]
    # The fork server itself stays for the next batch.
    servers = [
        child
        for child in psutil.Process().children(recursive=True)
        if "forkserver" in " ".join(child.cmdline())
    ]
    assert len([child.pid for child in servers if child.ppid() == os.getpid()]) == 1
    assert len(servers) == 1, names


@pytest.mark.parametrize("name", ["SIGKILL", "SIGSEGV", "SIGABRT", "SIGTERM"])
def test_a_signal_is_named_whatever_the_phase(bench: Bench, name: str) -> None:
    records = run(bench, read=f"{name}@read", write=f"{name}@write", page=f"{name}@page")
    for phase, record in records.items():
        assert record.error == "WorkerKilled"
        assert record.phase == "worker"
        assert name in record.message
        assert f"in phase {phase}" in record.message


def test_a_hang_ends_at_its_time_limit(bench: Bench) -> None:
    start = time.monotonic()
    records = run(bench, sleeping="hang@write", holding="hold@surface")
    assert time.monotonic() - start < 4 * 4.0
    for record in records.values():
        assert record.error == "TimeLimit"
        assert "the limit is 4 s" in record.message


def test_memory_beyond_the_limit_is_named(bench: Bench) -> None:
    records = run(
        bench,
        early="memory@read",
        late="memory@page",
        creeping="creep@surface",
        caught="refused@strip",
    )
    for record in records.values():
        assert record.error == "MemoryLimit", record
        assert "the limit is 2 GiB" in record.message
    assert "SIGABRT" in records["creeping"].message


def test_a_crash_far_below_the_memory_limit_is_not_put_down_to_memory(bench: Bench) -> None:
    assert run(bench, crash="SIGABRT@surface")["crash"].error == "WorkerKilled"


def test_an_exception_in_any_phase_costs_one_file(bench: Bench) -> None:
    bugs = {f"bug_{phase}": f"raise@{phase}" for phase in PHASES}
    told = {f"told_{phase}": f"fail@{phase}" for phase in PHASES}
    records = run(bench, **bugs, **told, cad="cad@surface")
    for phase in PHASES:
        bug, failure = records[f"bug_{phase}"], records[f"told_{phase}"]
        assert (bug.error, bug.phase) == ("ZeroDivisionError", phase)
        assert "one two" in bug.message
        assert (failure.error, failure.phase) == ("InputError", phase)
    assert records["cad"].message == "Cannot sew: left open"
    assert not any("\n" in record.message for record in records.values())


def test_a_worker_that_leaves_by_itself_is_noticed_at_once(bench: Bench) -> None:
    start = time.monotonic()
    records = run(bench, quietly="leave@page", loudly="quit@read")
    assert time.monotonic() - start < 4.0
    assert "exit code 0" in records["quietly"].message
    assert records["loudly"].error == "SystemExit"


def test_a_disk_that_is_full_in_the_worker_costs_one_file(bench: Bench) -> None:
    assert "No space left" in run(bench, full="full@write")["full"].message


def test_what_the_kernel_prints_reaches_no_stream_of_ours(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.put(a="good", b="SIGSEGV@page")
    bench.run(workers=1, limits=LIMITS, job_function=talkative_job)
    assert capfd.readouterr() == ("", "")
    log = (bench.outputs / "batch.log").read_text()
    assert "kernel on stderr" in log
    assert "on stdout" not in log
    assert len(log) < 20_000


def test_one_worker_does_many_files_with_one_thread_each(bench: Bench) -> None:
    bench.put(a="", b="", c="")
    bench.run(workers=1, job_function=worker_id_job)
    seen = [json.loads(content) for content in bench.files().values()]
    assert len({entry["pid"] for entry in seen}) == 1
    assert seen[0]["pid"] != os.getpid()
    assert seen[0]["threads"] == {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def test_phases_are_told(bench: Bench) -> None:
    bench.put(a="good")
    bench.run()
    phases = [event.phase for event in bench.events if isinstance(event, FilePhase)]
    assert phases == list(PHASES)


def test_a_worker_that_dies_idle_costs_nothing(tmp_path: Path) -> None:
    source = tmp_path / "a.step"
    source.write_text("good")
    task = Task(job=Job(input=source, output_dir=tmp_path), job_function=worker_id_job)
    pool = WorkerPool(1, LIMITS)
    try:
        pids = []
        for key in range(3):
            pool.give(key, task)
            events = []
            while not events:
                events = list(pool.wait(1.0))
            pids.append(json.loads((tmp_path / "a.json").read_text())["pid"])
            os.kill(pids[-1], signal.SIGKILL)
            time.sleep(0.05)
        assert len(set(pids)) == 3
    finally:
        pool.kill()


def test_an_interrupt_while_a_worker_starts_leaves_no_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "a.step"
    source.write_text("hang@read")
    task = Task(job=Job(input=source, output_dir=tmp_path), job_function=job_by_content)
    real, started = BaseProcess.start, []

    def interrupted(process: BaseProcess) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        real(process)
        started.append(psutil.Process(process.pid))
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(BaseProcess, "start", interrupted)
    pool = WorkerPool(1, LIMITS)
    with pytest.raises(KeyboardInterrupt):
        pool.give(0, task)
    assert len(started) == 1, "the start itself is not interrupted"
    pool.kill()
    assert_all_end(started)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_closing_lets_idle_workers_go(tmp_path: Path) -> None:
    source = tmp_path / "a.step"
    source.write_text("good")
    pool = WorkerPool(1, LIMITS)
    pool.give(0, Task(job=Job(input=source, output_dir=tmp_path), job_function=worker_id_job))
    while pool.is_busy():
        pool.wait(1.0)
    pool.close()
    assert_no_workers()


@pytest.mark.parametrize(
    ("timeout_s", "memory_gib", "complaint"),
    [
        (0.0, 4.0, "--timeout"),
        (float("nan"), 4.0, "--timeout"),
        (1.0, 1.9, "--memory cannot be 1.9 GiB: give 2 to"),
    ],
)
def test_limits_out_of_range_are_refused(
    timeout_s: float, memory_gib: float, complaint: str
) -> None:
    with pytest.raises(InputError, match=complaint):
        WorkerLimits(timeout_s=timeout_s, memory_gib=memory_gib)

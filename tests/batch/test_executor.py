"""run_batch: from Python, on workers of its own or on an executor of the caller's."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.batch.stand_ins import KINDS, job_by_content
from wrinkle_cad.batch.executor import run_batch
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed


def make_jobs(folder: Path, *contents: str) -> list[Job]:
    jobs = []
    for number, content in enumerate(contents):
        path = folder / f"f{number}.step"
        path.write_text(content)
        jobs.append(Job(input=path, output_dir=folder / "out" / str(number % 2)))
    return jobs


def check(outcomes: tuple[JobDone | JobFailed, ...], jobs: list[Job], bad: set[int]) -> None:
    assert [outcome.job for outcome in outcomes] == jobs
    for number, (outcome, job) in enumerate(zip(outcomes, jobs, strict=True)):
        finals = [job.output_dir / f"{job.name}.{kind}" for kind in KINDS]
        if number in bad:
            assert isinstance(outcome, JobFailed)
            assert not any(path.exists() for path in finals)
        else:
            assert isinstance(outcome, JobDone)
            assert list(outcome.outputs) == finals
            assert all(path.read_text().endswith("END\n") for path in finals)
        hidden = [path for path in job.output_dir.iterdir() if path.name.startswith(".")]
        assert not hidden


def test_workers_of_its_own_survive_crashes(tmp_path: Path) -> None:
    jobs = make_jobs(tmp_path, "good", "SIGSEGV@write", "fail@read", "good", "hang@page")
    outcomes = run_batch(jobs, workers=2, timeout=3, memory=2, job_function=job_by_content)
    check(outcomes, jobs, {1, 2, 4})
    errors = [outcome.error for outcome in outcomes if isinstance(outcome, JobFailed)]
    assert errors == ["WorkerKilled", "InputError", "TimeLimit"]


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_any_executor_will_do(tmp_path: Path, kind: str) -> None:
    jobs = make_jobs(tmp_path, *["good"] * 5, "raise@write", "fail@read")
    executor: Executor
    if kind == "threads":
        executor = ThreadPoolExecutor(2)
    else:
        executor = ProcessPoolExecutor(2, multiprocessing.get_context("spawn"))
    with executor:
        outcomes = run_batch(jobs, executor=executor, job_function=job_by_content)
        check(outcomes, jobs, {5, 6})
        assert isinstance(outcomes[5], JobFailed)
        assert outcomes[5].error == "ZeroDivisionError"
        assert executor.submit(int).result() == 0, "the executor stays the caller's"


def test_an_executor_that_breaks_fails_what_it_had_and_does_not_hang(tmp_path: Path) -> None:
    jobs = make_jobs(tmp_path, "SIGKILL@write", *["good"] * 4)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as executor:
        outcomes = run_batch(jobs, executor=executor, job_function=job_by_content)
    check(outcomes, jobs, set(range(5)))
    assert {outcome.error for outcome in outcomes if isinstance(outcome, JobFailed)} == {
        "WorkerKilled"
    }


@pytest.mark.parametrize("limit", ["timeout", "memory", "workers"])
def test_limits_that_an_executor_cannot_keep_are_refused(tmp_path: Path, limit: str) -> None:
    limits: dict[str, int] = {limit: 4}
    with ThreadPoolExecutor(1) as executor, pytest.raises(InputError, match=limit):
        run_batch(make_jobs(tmp_path, "good"), executor=executor, **limits)  # type: ignore[arg-type]


def test_two_jobs_with_the_same_outputs_are_refused(tmp_path: Path) -> None:
    (job,) = make_jobs(tmp_path, "good")
    with pytest.raises(InputError, match="Two jobs would write f0"):
        run_batch([job, job])


def test_too_few_workers_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="workers cannot be 0"):
        run_batch(make_jobs(tmp_path, "good"), workers=0)


def test_an_output_folder_that_cannot_be_made_costs_one_job(tmp_path: Path) -> None:
    good, bad = make_jobs(tmp_path, "good", "good")
    (tmp_path / "out").mkdir()
    (tmp_path / "out/1").write_text("a file")
    outcomes = run_batch([good, bad], workers=1, job_function=job_by_content)
    assert isinstance(outcomes[0], JobDone)
    assert isinstance(outcomes[1], JobFailed)
    assert "File exists" in outcomes[1].message


def test_no_jobs_make_no_outcomes() -> None:
    assert run_batch([]) == ()


def test_a_caller_gets_workers_back_when_the_loop_is_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = make_jobs(tmp_path, "good", "hang@write")

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("wrinkle_cad.batch.executor.deliver", interrupt)
    with pytest.raises(KeyboardInterrupt):
        run_batch(jobs, workers=2, job_function=job_by_content)
    assert not multiprocessing.active_children()

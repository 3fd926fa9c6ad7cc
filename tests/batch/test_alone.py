"""One job in a process of its own: whatever happens to that process is a sentence here."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.batch.stand_ins import KINDS, compiling_job, job_by_content
from wrinkle_cad.batch.alone import answer_alone, run_alone
from wrinkle_cad.cli.main import main
from wrinkle_cad.errors import InputError, JobError
from wrinkle_cad.files.staging import leftovers, open_staging, release_staging
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobDone, JobFailed

ROOT = Path(__file__).parents[2]


def job_that(action: str, folder: Path) -> Job:
    source = folder / "a.step"
    source.write_text(action)
    (folder / "out").mkdir()
    return Job(input=source, output_dir=folder / "out")


def test_a_good_job_tells_its_phases_and_its_outputs_as_asked(tmp_path: Path) -> None:
    phases: list[str] = []
    outcome = run_alone(
        job_that("good", tmp_path),
        progress=lambda phase, done, total: phases.append(phase),
        job_function=job_by_content,
    )
    assert isinstance(outcome, JobDone)
    assert outcome.outputs == tuple(tmp_path / "out" / f"a.{kind}" for kind in KINDS)
    assert phases[:2] == ["read", "strip"]


@pytest.mark.parametrize(
    ("action", "error", "word"),
    [
        ("SIGSEGV@strip", "WorkerKilled", "SIGSEGV"),
        ("leave@strip", "WorkerKilled", "exit code 0"),
        ("raise@strip", "ZeroDivisionError", "ZeroDivisionError"),
        ("hang@strip", "TimeLimit", "--timeout"),
        ("memory@strip", "MemoryLimit", "--memory"),
        ("fail@read", "InputError", "no curves"),
    ],
)
def test_a_crash_or_a_limit_is_one_sentence(
    tmp_path: Path, action: str, error: str, word: str
) -> None:
    outcome = run_alone(
        job_that(action, tmp_path), timeout=4.0, memory=2.0, job_function=job_by_content
    )
    assert isinstance(outcome, JobFailed)
    assert outcome.error == error
    assert word in outcome.message
    assert "\n" not in outcome.message


def test_what_is_compiled_is_not_the_files_time(tmp_path: Path) -> None:
    outcome = run_alone(job_that("0", tmp_path), timeout=3.0, job_function=compiling_job)
    assert isinstance(outcome, JobDone)


@pytest.mark.slow
def test_what_comes_after_compiling_is_the_files_time(tmp_path: Path) -> None:
    outcome = run_alone(job_that("60", tmp_path), timeout=3.0, job_function=compiling_job)
    assert isinstance(outcome, JobFailed)
    assert outcome.error == "TimeLimit"
    assert 3.0 < outcome.seconds["total"] < 4.0, "the time of compiling is not in it"
    assert "in phase strip" in outcome.message


def test_a_limit_out_of_its_range_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="timeout"):
        run_alone(job_that("good", tmp_path), timeout=0.0)


def test_what_a_killed_run_left_is_cleared_by_the_next(tmp_path: Path) -> None:
    job = job_that("good", tmp_path)
    left = open_staging(job.output_dir)
    (left / "half.step").write_text("x")
    release_staging(left)
    run_alone(job, job_function=job_by_content)
    assert not left.exists()


EXAMPLE = ROOT / "shoe_examples" / "vamp_strip" / "vamp_strip.step"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("moment", [0.3, 2.0])
def test_a_run_that_is_told_to_end_leaves_no_hidden_folder(
    tmp_path: Path, number: signal.Signals, moment: float
) -> None:
    command = [sys.executable, "-m", "wrinkle_cad", "run", str(EXAMPLE), "-o", str(tmp_path)]
    run = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    time.sleep(moment)
    run.send_signal(number)
    _, said = run.communicate(timeout=20)
    if moment > 1.0 and run.returncode == 130:
        assert said == "Interrupted: nothing is half-written.\n"
    assert not list(leftovers(tmp_path))
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


def size_of(path: Path) -> int:
    return path.stat().st_size


def crash(path: Path) -> int:
    os.kill(os.getpid(), signal.SIGSEGV)
    return 0


def refuse(path: Path) -> int:
    raise InputError(f"{path.name} is not to my taste. Give another one.")


def sleep(path: Path) -> int:
    time.sleep(3600)
    return 0


def test_a_question_about_a_file_is_answered_by_another_process(tmp_path: Path) -> None:
    odd = tmp_path / ("x" * 240 + "\n.step")
    odd.write_text("12345")
    assert answer_alone(odd, size_of) == 5


@pytest.mark.parametrize(
    ("question", "said"),
    [(crash, "SIGSEGV"), (refuse, "not to my taste"), (sleep, "limit is 1 s")],
)
def test_a_question_that_ends_its_process_is_one_sentence(
    tmp_path: Path, question: Callable[[Path], int], said: str
) -> None:
    with pytest.raises(JobError, match=said) as caught:
        answer_alone(tmp_path / "a.step", question, timeout=1.0 if question is sleep else None)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("command", ["check", "inspect", "compare"])
def test_every_command_that_reads_a_file_keeps_its_limits(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [command, str(EXAMPLE), "--timeout", "0.1"]
    out = ["-o", str(tmp_path / "out")] if command == "compare" else []
    assert main([*arguments, *out]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "the limit is 0.1 s" in line
    assert not list(tmp_path.iterdir())

"""The batch itself is killed: no half-written file, no worker that lives on, and it resumes."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import psutil
import pytest

from tests.batch.conftest import Bench
from tests.batch.processes import assert_all_end, is_alive
from tests.batch.stand_ins import KINDS, slow_job
from wrinkle_cad.files.staging import leftovers

ROOT = Path(__file__).parent.parent.parent
FILES = 80


def start(bench: Bench, function: str = "slow_job") -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.batch.run_stand_in"]
    return subprocess.Popen(
        [*command, str(bench.inputs), str(bench.outputs), function, "2"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Whoever started the tests in the background may have turned interrupts off for all of us.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )


def kill_after(batch: subprocess.Popen[str], finished: int, seconds: float) -> list[psutil.Process]:
    """Kills a batch some time after some of its files; returns the processes that it had."""
    assert batch.stdout is not None
    while finished and (line := batch.stdout.readline()):
        finished -= line == "FileFinished\n"
    time.sleep(seconds)
    children = []
    if batch.poll() is None:
        children = psutil.Process(batch.pid).children(recursive=True)
        batch.kill()
    batch.communicate()
    return children


def assert_all_whole(bench: Bench) -> int:
    """Whatever has a final name is whole; returns how many sets of outputs are complete."""
    files = bench.files() if bench.outputs.exists() else {}
    final = {name: content for name, content in files.items() if not name.startswith(".")}
    assert all(content.endswith(b"END\n") for content in final.values())
    return sum(
        all(f"{stem}.{kind}" in final for kind in KINDS)
        for stem in {name.split(".")[0] for name in final}
    )


def check_kill_and_resume(bench: Bench, seed: int, times: int) -> None:
    bench.put(**{f"f{number:02d}": str(number) for number in range(FILES)})
    moments = random.Random(seed)
    for number in range(times):
        # Every third time before the first file, when leftovers are put in order.
        finished = moments.randint(1, 4) if number % 3 else 0
        delay = moments.uniform(0.0, 0.04 if finished else 0.5)
        assert_all_end(kill_after(start(bench), finished, delay))
        complete = assert_all_whole(bench)
    assert 0 < complete < FILES, "the kills fell into the work"
    summary = bench.run(workers=2, job_function=slow_job)
    assert summary.failed == summary.left == 0
    assert assert_all_whole(bench) == FILES
    assert not list(leftovers(bench.outputs))
    assert bench.run(job_function=slow_job).skipped == FILES
    lines = (bench.outputs / "manifest.jsonl").read_text().splitlines()
    keys = [json.loads(line)["key"] for line in lines[1:] if line.endswith("}")]
    assert len(keys) == len(set(keys)) == FILES, "no file is done twice"


def test_a_batch_killed_at_random_moments_resumes(bench: Bench) -> None:
    check_kill_and_resume(bench, seed=1, times=5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 5))
def test_a_batch_killed_at_twenty_random_moments_resumes(bench: Bench, seed: int) -> None:
    check_kill_and_resume(bench, seed, times=20)


@pytest.mark.parametrize("action", ["hang@read", "hold@write"])
def test_no_worker_outlives_a_killed_batch(bench: Bench, action: str) -> None:
    bench.put(a=action, b=action)
    batch = start(bench, "job_by_content")
    wait_for_phases(batch, 2)
    children = psutil.Process(batch.pid).children(recursive=True)
    assert len(children) >= 2
    batch.kill()
    batch.communicate()
    assert_all_end(children)


def test_ctrl_c_ends_a_batch_at_once_and_leaves_nothing_half_done(bench: Bench) -> None:
    bench.put(a="hold@write", b="hang@read")
    batch = start(bench, "job_by_content")
    wait_for_phases(batch, 2)
    children = psutil.Process(batch.pid).children(recursive=True)
    begin = time.monotonic()
    batch.send_signal(signal.SIGINT)
    batch.communicate(timeout=5)
    assert time.monotonic() - begin < 2.0
    assert_all_end(children)
    assert not bench.files()
    assert not list(leftovers(bench.outputs))


def test_a_process_that_lives_on_is_noticed() -> None:
    sleeper = subprocess.Popen(["sleep", "60"])
    process = psutil.Process(sleeper.pid)
    with pytest.raises(AssertionError):
        assert_all_end([process], 0.1)
    sleeper.kill()
    assert_all_end([process])
    sleeper.wait()
    assert not is_alive(process)


def wait_for_phases(batch: subprocess.Popen[str], count: int) -> None:
    assert batch.stdout is not None
    for line in batch.stdout:
        count -= line == "FilePhase\n"
        if not count:
            return
    raise AssertionError("the batch ended by itself")

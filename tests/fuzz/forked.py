"""Files through the real reader, each in a child of a process that is warm: none pays for a start.

A child has limits of its own CPU time and memory, so a file that costs too much is told apart from
a machine that is busy.
"""

from __future__ import annotations

import faulthandler
import json
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from wrinkle_cad.job.job import Job, make_job, read_job_toml
from wrinkle_cad.job.outcome import JobDone
from wrinkle_cad.job.workflow import run_job

MOST_CPU_S: Final = 20.0
"""s; of one file, everything in it."""
_MOST_BYTES: Final = 4 << 30


class Ended(NamedTuple):
    """What became of a file."""

    name: str
    cpu_s: float
    error: str
    """Class of the error, "" where the file was done."""
    message: str
    bug: str
    """What must not be; empty when nothing."""


def ended_files(
    paths: Sequence[Path], outputs: Path, *, at_a_time: int = 2, trials_every: int = 25
) -> Iterator[Ended]:
    """Runs files, so many at a time, in children; this process must be one that may be forked.

    Args:
        paths: the files; settings may stand beside them, as for a batch.
        outputs: the folder of the outputs, made when missing.
        at_a_time: how many children.
        trials_every: each so manieth file has its trials, too, which take longest.
    """
    waiting, running = list(enumerate(paths)), {}
    while waiting or running:
        while waiting and len(running) < at_a_time:
            number, path = waiting.pop(0)
            job = _job_of(path, outputs / path.stem, {"no_trials": number % trials_every != 0})
            pid, pipe = _child(job)
            running[pid] = (path, pipe, b"")
        for pid, (path, pipe, told) in list(running.items()):
            with_more = told + _read(pipe)
            running[pid] = (path, pipe, with_more)
            found, status, used = os.wait4(pid, os.WNOHANG)
            if found:
                del running[pid]
                rest = with_more + _read(pipe)
                os.close(pipe)
                yield _ended(path.name, used.ru_utime + used.ru_stime, status, rest)
        time.sleep(0.005)


def warm_up(path: Path, outputs: Path) -> None:
    """Loads and compiles in this process what the children will need."""
    outcome = run_job(_job_of(path, outputs, {}))
    assert isinstance(outcome, JobDone), outcome


def _job_of(path: Path, outputs: Path, more: Mapping[str, Any]) -> Job:
    beside = path.with_name(f"{path.stem}.job.toml")
    table = read_job_toml(beside) if beside.is_file() else {}
    own = {key: table[key] for key in table if key not in ("input", "output_dir", "name")}
    return make_job(path, {**own, **more, "output_dir": outputs})


def _child(job: Job) -> tuple[int, int]:
    ours, theirs = os.pipe()
    pid = os.fork()
    if pid:
        os.close(theirs)
        os.set_blocking(ours, False)
        return pid, ours
    try:
        faulthandler.disable()
        resource.setrlimit(resource.RLIMIT_CPU, (int(MOST_CPU_S), int(MOST_CPU_S) + 1))
        resource.setrlimit(resource.RLIMIT_AS, (_MOST_BYTES, _MOST_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        outcome = run_job(job)
        told = ["", ""] if isinstance(outcome, JobDone) else [outcome.error, outcome.message]
    except BaseException:
        # Whatever it is, it is what is looked for.
        told = ["BUG", traceback.format_exc()]
    os.write(theirs, json.dumps(told).encode()[-60_000:])
    os._exit(0)


def _read(pipe: int) -> bytes:
    try:
        return os.read(pipe, 1 << 16)
    except BlockingIOError:
        return b""


def _ended(name: str, cpu_s: float, status: int, told: bytes) -> Ended:
    if os.WIFSIGNALED(status):
        number = signal.Signals(os.WTERMSIG(status))
        is_late = number == signal.SIGXCPU
        bug = f"more than {MOST_CPU_S:g} s of CPU time" if is_late else f"ended by {number.name}"
        return Ended(name, cpu_s, number.name, "", bug)
    error, message = json.loads(told)
    bug = ""
    if error == "BUG":
        bug = message
    elif error and (not message or not message.isprintable() or "Traceback" in message):
        bug = f"no line of text: {message!r}"
    return Ended(name, cpu_s, error, message, bug)


def print_ended(ended: Sequence[Ended]) -> None:
    """Tells the bugs one by one and the slowest files."""
    for each in ended:
        if each.bug:
            sys.stdout.write(f"{each.name}: {each.bug}\n")
    for each in sorted(ended, key=lambda each: -each.cpu_s)[:5]:
        sys.stdout.write(f"{each.name}: {each.cpu_s:.1f} s of CPU time\n")

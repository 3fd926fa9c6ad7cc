"""Whole jobs, each in a process of its own: python -m tests.benchmarks.whole_jobs [ROUNDS].

Prints a table of seconds, by the clock and of processors, medians of five rounds; beside it
the kernel's floor, the import that every job needs. Needs a machine with nothing else to do.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).parents[2] / "shoe_examples"
WRINKLE = EXAMPLES / "one_wrinkle"
THREE = EXAMPLES / "three_wrinkles"
BATCH_FILES = 8


def jobs(folder: Path) -> dict[str, list[str]]:
    """Arguments of Python for each row of the table."""
    run = ["-m", "wrinkle_cad", "run", "--quiet", "-o", str(folder / "out")]
    one = [str(WRINKLE / "one_wrinkle.step"), "--job", str(WRINKLE / "job.toml")]
    inputs = folder / "inputs"
    inputs.mkdir()
    for number in range(BATCH_FILES):
        shutil.copy(WRINKLE / "one_wrinkle.step", inputs / f"wrinkle_{number}.step")
    batch = ["-m", "wrinkle_cad", "batch", str(inputs), "--waves", "5", "--height", "3"]
    return {
        "import of the kernel": ["-c", "import OCP.TopExp"],
        "vamp_strip": [*run, str(EXAMPLES / "vamp_strip" / "vamp_strip.step")],
        "one_wrinkle": [*run, *one],
        "one_wrinkle at 0.003 mm": [*run, "--tolerance", "0.003", *one],
        "three_wrinkles": [
            *run, str(THREE / "three_wrinkles.step"), "--job", str(THREE / "job.toml"),
        ],
        "batch of 8 on one worker": [*batch, "-o", str(folder / "one"), "--workers", "1"],
        "batch of 8 on two workers": [*batch, "-o", str(folder / "two"), "--workers", "2"],
    }  # fmt: skip


def timed(arguments: list[str], cache: Path) -> tuple[float, float]:
    """Seconds by the clock and of processors that a command takes."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments], check=True, env=environment, stdout=subprocess.DEVNULL
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    worked = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - begin, worked


def say(line: str) -> None:
    """Prints a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(rounds: int) -> None:
    """Prints the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cache = folder / "compiled"
        listed = jobs(folder)
        say(f"the very first run: {timed(listed['vamp_strip'], cache)[0]:.1f} s")
        say("| job | s | s of processors |\n|---|---|---|")
        for job, arguments in listed.items():
            timed(arguments, cache)
            for made in ("out", "one", "two"):
                shutil.rmtree(folder / made, ignore_errors=True)
            found = []
            for _ in range(rounds):
                found.append(timed(arguments, cache))
                for made in ("out", "one", "two"):
                    shutil.rmtree(folder / made, ignore_errors=True)
            clock, worked = (statistics.median(each) for each in zip(*found, strict=True))
            say(f"| {job} | {clock:.2f} | {worked:.2f} |")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)

"""Real jobs are killed at random moments: nothing hidden stays, what is told is true."""

from __future__ import annotations

import csv
import hashlib
import json
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder.manifest import Manifest
from wrinkle_cad.job.outputs import clear_killed

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
KINDS = {"step", "stl", "dxf", "json", "html"}
SIGNALS = ["SIGTERM", "SIGHUP", "SIGKILL"]
SLOW = pytest.mark.slow
QUICK = ["--no-trials", "--tolerance", "0.5"]


def started(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "wrinkle_cad", *arguments, *QUICK]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, cwd=ROOT, text=True, **pipes)  # type: ignore[call-overload, no-any-return]


def seconds_of(*arguments: str) -> float:
    """How long a command takes that nobody kills."""
    start = time.monotonic()
    done = started(*arguments)
    _, said = done.communicate(timeout=300)
    assert done.returncode in (0, 1), said
    return time.monotonic() - start


def killed(process: subprocess.Popen[str], name: str, moment: float) -> str:
    time.sleep(moment)
    process.send_signal(signal.Signals[name])
    _, said = process.communicate(timeout=120)
    return said


def assert_nothing_hidden(folder: Path) -> None:
    hidden = [path.name for path in folder.rglob(".*") if path.name != ".wrinkle_cad.lock"]
    assert not hidden


def assert_a_whole_set_or_none(folder: Path) -> None:
    names = {path.suffix[1:] for path in folder.iterdir()}
    assert names in (set(), KINDS)
    if names:
        listed = json.loads((folder / "vamp_strip.json").read_text())["outputs"]
        for entry in listed.values():
            content = (folder / entry["file"]).read_bytes()
            assert hashlib.sha256(content).hexdigest() == entry["sha256"]


@pytest.mark.parametrize(
    ("name", "times"), [("SIGKILL", 1), *(pytest.param(name, 20, marks=SLOW) for name in SIGNALS)]
)
def test_a_run_that_is_killed_at_random_moments_leaves_a_whole_set_or_none(
    tmp_path: Path, name: str, times: int
) -> None:
    folder = tmp_path / "out"
    # One kill falls into the work of a machine that is not busy; twenty are spread over it.
    measured = ("run", str(EXAMPLE), "-o", str(tmp_path / "measured"))
    longest = 3.0 if times == 1 else seconds_of(*measured)
    moments = random.Random(SIGNALS.index(name))
    for _ in range(times):
        said = killed(
            started("run", str(EXAMPLE), "-o", str(folder)), name, moments.uniform(0.0, longest)
        )
        assert said in ("", "Interrupted: nothing is half-written.\n")
        if folder.exists():
            if name != "SIGKILL":
                assert_nothing_hidden(folder)
            # As the next start does.
            clear_killed(folder)
            assert_nothing_hidden(folder)
            assert_a_whole_set_or_none(folder)
    assert seconds_of("run", str(EXAMPLE), "-o", str(folder)) > 0.0
    assert_a_whole_set_or_none(folder)


def assert_told_is_true(folder: Path, count: int) -> None:
    """What the table and the page say of each file is what the manifest says and the files are."""
    manifest = Manifest(folder)
    rows = csv.DictReader((folder / "summary.csv").read_text(encoding="utf-8-sig").splitlines())
    told = {row["input"]: row["outcome"] for row in rows}
    assert len(told) == count
    page = (folder / "index.html").read_text()
    for label, outcome in told.items():
        record = manifest.latest(Path(label).stem, label)
        assert (outcome == "done") <= (record is not None and record.is_done)
        assert (outcome == "failed") <= (record is not None and not record.is_done)
        assert label in page
        for file in record.outputs if record is not None else ():
            content = (folder / file.name).read_bytes()
            assert hashlib.sha256(content).hexdigest() == file.sha256


@pytest.mark.parametrize(
    ("name", "times"), [("SIGTERM", 1), *(pytest.param(name, 20, marks=SLOW) for name in SIGNALS)]
)
def test_a_batch_that_is_killed_at_random_moments_tells_the_truth_and_goes_on(
    tmp_path: Path, name: str, times: int
) -> None:
    inputs, folder = tmp_path / "in", tmp_path / "out"
    inputs.mkdir()
    count = 2 if times == 1 else 12
    for number in range(count):
        shutil.copy(EXAMPLE, inputs / f"f{number}.step")
    (inputs / "bad.step").write_text("no STEP at all")
    batch = ("batch", str(inputs), "-o", str(folder), "--workers", "2")
    measured = ("batch", str(inputs), "-o", str(tmp_path / "measured"), "--workers", "2")
    longest = 3.0 if times == 1 else seconds_of(*measured)
    moments = random.Random(10 + SIGNALS.index(name))
    for _ in range(times):
        said = killed(started(*batch), name, moments.uniform(0.0, longest / (times**0.5)))
        assert "Traceback" not in said
        if name != "SIGKILL" and (folder / "summary.csv").exists():
            assert_nothing_hidden(folder)
            assert_told_is_true(folder, count + 1)
    seconds_of(*batch)
    assert_nothing_hidden(folder)
    assert_told_is_true(folder, count + 1)
    table = (folder / "summary.csv").read_text(encoding="utf-8-sig").splitlines()[1:]
    assert sorted(row.split(",")[1] for row in table) == [*["done"] * count, "failed"]
    assert f"{count + 1} files: " in (folder / "index.html").read_text()

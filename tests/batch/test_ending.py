"""run and batch, told to end or killed at random moments: the next start finds and leaves order."""

from __future__ import annotations

import csv
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.batch.strips import put_strips

ROOT = Path(__file__).parents[2]
SIGNALS = (signal.SIGTERM, signal.SIGHUP, signal.SIGKILL)
KINDS = {"step", "stl", "dxf", "json", "html"}


def start(command: str, inputs: Path, folder: Path) -> subprocess.Popen[bytes]:
    source = inputs / "strip000.step" if command == "run" else inputs
    return subprocess.Popen(
        [sys.executable, "-m", "wrinkle_cad", command, str(source), "-o", str(folder), "--quiet"],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def hidden(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".*") if path.is_dir()]


def check_order(folder: Path, stems: set[str], command: str) -> None:
    """Every file is done, nothing hidden is left, index and summary say what is there."""
    assert hidden(folder) == []
    for stem in stems:
        assert {path.name.split(".", 1)[1] for path in folder.glob(f"{stem}.*")} == KINDS
    if command == "batch":
        with (folder / "summary.csv").open(encoding="utf-8-sig", newline="") as stream:
            rows = list(csv.reader(stream))
        assert len(rows) == 1 + len(stems)
        page = (folder / "index.html").read_text(encoding="utf-8")
        assert "Under way" not in page
        assert all(f"{stem}.html" in page for stem in stems)


def check_true(folder: Path) -> None:
    """Right after an end, the page names no report that is not there."""
    page = folder / "index.html"
    if page.is_file():
        text = page.read_text(encoding="utf-8")
        for number in range(3):
            name = f"strip{number:03d}.html"
            is_whole = (folder / name).is_file() or list(folder.glob(f".*/{name}"))
            assert f'href="{name}"' not in text or is_whole


@pytest.mark.parametrize("command", ["run", "batch"])
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.slow) for seed in range(20)])
def test_an_end_at_a_random_moment_leaves_order(command: str, seed: int, tmp_path: Path) -> None:
    chance = random.Random(seed)
    inputs, folder = tmp_path / "in", tmp_path / "out"
    inputs.mkdir()
    put_strips(inputs, 3)
    number = SIGNALS[seed % len(SIGNALS)]
    for _ in range(2):
        process = start(command, inputs, folder)
        time.sleep(chance.uniform(0.1, 8.0))
        process.send_signal(number)
        process.wait(timeout=20)
        if number != signal.SIGKILL and folder.is_dir():
            assert hidden(folder) == []
        check_true(folder)
    assert start(command, inputs, folder).wait(timeout=300) == 0
    stems = {"strip000"} if command == "run" else {f"strip{n:03d}" for n in range(3)}
    check_order(folder, stems, command)

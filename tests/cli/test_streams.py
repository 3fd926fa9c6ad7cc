"""Streams that are closed or full: an exit code and at most one sentence, files all the same."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "shoe_examples" / "vamp_strip" / "vamp_strip.step"


def shell(command: str, streams: str) -> subprocess.CompletedProcess[str]:
    line = f"{sys.executable} -m wrinkle_cad {command} {streams}"
    return subprocess.run(
        ["bash", "-c", line], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")
@pytest.mark.parametrize(
    ("streams", "code", "said"),
    [
        (">&-", 0, ""),
        (">/dev/full", 1, "cannot be written (No space left on device)"),
        ("2>/dev/full", 0, ""),
        (">&- 2>&- <&-", 0, ""),
    ],
)
def test_inspect_survives_its_streams(streams: str, code: int, said: str) -> None:
    done = shell(f"inspect {EXAMPLE}", streams)
    assert done.returncode == code, done.stderr
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == bool(said)


def test_a_closed_stderr_does_not_become_a_workers_pipe(tmp_path: Path) -> None:
    done = shell(f"run {EXAMPLE} -o {tmp_path}", "2>&-")
    assert done.returncode == 0
    assert len(list(tmp_path.glob("vamp_strip.*"))) == 5


def test_a_full_stderr_leaves_the_exit_code() -> None:
    assert shell("run nowhere.step", "2>/dev/full").returncode == 1


def test_escapes_and_bidi_characters_in_names_are_shown_as_text(tmp_path: Path) -> None:
    path = tmp_path / "a\x1b[31m\u202eb.dxf"
    path.write_text("no DXF")
    command = [sys.executable, "-m", "wrinkle_cad", "check", str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, timeout=60, check=False)
    assert done.returncode == 1
    assert b"\x1b" not in done.stdout + done.stderr
    assert "\u202e".encode() not in done.stdout + done.stderr
    assert len(done.stderr.splitlines()) == 1

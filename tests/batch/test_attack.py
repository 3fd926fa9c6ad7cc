"""Hostile items beside good files: each costs itself and nothing outside changes."""

from __future__ import annotations

import gzip
import hashlib
import os
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.batch.conftest import Bench
from tests.batch.stand_ins import stranger_job
from wrinkle_cad.batch.folder.events import FileFinished

LINUX_ONLY = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="devices of Linux")


class Item(NamedTuple):
    """Something hostile in the folder of inputs."""

    put: Callable[[Path], object]
    """Puts it there."""
    failed: int
    """How many files it makes fail."""
    word: str = ""
    """What their sentences say."""


def beside(name: str, settings: str | bytes) -> Callable[[Path], object]:
    """A good input with settings of its own."""

    def put(folder: Path) -> None:
        (folder / f"{name}.step").write_text("1")
        content = settings if isinstance(settings, bytes) else settings.encode()
        (folder / f"{name}.job.toml").write_bytes(content)

    return put


def pipe_beside(folder: Path) -> None:
    (folder / "bad.step").write_text("1")
    os.mkfifo(folder / "bad.job.toml")


def device_as(setting: str) -> Callable[[Path], object]:
    def put(folder: Path) -> None:
        (folder / "zero.toml").symlink_to("/dev/zero")
        beside("bad", f'{setting} = "zero.toml"')(folder)

    return put


def huge(folder: Path) -> None:
    with (folder / "bad.step").open("wb") as stream:
        stream.truncate(300 * 2**20)


def unreadable_folder(folder: Path) -> None:
    (folder / "closed").mkdir()
    (folder / "closed" / "a.step").write_text("1")
    (folder / "closed").chmod(0)


def socket_in(folder: Path) -> None:
    here = Path.cwd()
    os.chdir(folder)
    try:
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind("s.step")
    finally:
        os.chdir(here)


BAD_SETTINGS = {
    "holes that are a number": "drill_holes = 5",
    "a number of 400 digits": "tolerance = " + "9" * 400,
    "a number of 5,000 digits": "tolerance = " + "9" * 5000,
    "deep nesting": "drill_holes = " + "[" * 50_000,
    "no number": "tolerance = nan",
    "no finite number": "height = inf\nwaves = 2",
    "a tiny number": "tolerance = 1e-300",
    "a huge number": "tolerance = 1e300",
    "a huge whole number": "quantity = 99999999999999999999",
    "a NUL in a name": 'name = "a\\u0000b"\nmaterial = "a\\u0000b.toml"',
    "a profile that is not there": 'profile = "gone.toml"',
    "a table for a text": "size = {a = 1}",
    "an unknown key": "colour = 1",
    "bytes that are no text": b"name = '\xff'",
    "megabytes of comment": "#" * 2_000_000,
}

ITEMS: dict[str, Item] = {
    **{name: Item(beside("bad", text), 1) for name, text in BAD_SETTINGS.items()},
    "a material that is a device": Item(device_as("material"), 1, "not a regular file"),
    "a profile that is a device": Item(device_as("profile"), 1, "not a regular file"),
    "a pipe for settings": Item(pipe_beside, 1, "not a regular file"),
    "a file of 300 MiB": Item(huge, 1, "the limit is"),
    # What is no regular file is no input when a folder is searched.
    "a pipe": Item(lambda folder: os.mkfifo(folder / "p.step"), 0),
    "a socket": Item(socket_in, 0),
    "a device": Item(lambda folder: (folder / "z.step").symlink_to("/dev/zero"), 0),
    "a link to itself": Item(lambda folder: (folder / "l.step").symlink_to("l.step"), 0),
    "a folder called like a file": Item(lambda folder: (folder / "d.step").mkdir(), 0),
    "a folder in a circle": Item(lambda folder: (folder / "loop").symlink_to(folder), 0),
    "a name of 255 bytes": Item(lambda folder: (folder / ("n" * 250 + ".step")).write_text("1"), 0),
    "a crash": Item(lambda folder: (folder / "c.step").write_text("SIGSEGV@strip"), 1, "SIGSEGV"),
    "a hang": Item(lambda folder: (folder / "h.step").write_text("hold@strip"), 1, "--timeout"),
    "a silent end": Item(lambda folder: (folder / "e.step").write_text("leave@strip"), 1, "exit"),
    "an error nobody foresaw": Item(
        lambda folder: (folder / "r.step").write_text("raise@strip"), 1, "ZeroDivisionError"
    ),
}


def fingerprint(folder: Path) -> dict[str, tuple[int, int, str]]:
    """What stands in a folder and below: modes, times, contents; links are not followed."""
    found = {}
    for path in sorted(folder.rglob("*")):
        about = path.lstat()
        content = ""
        if stat.S_ISREG(about.st_mode) and about.st_size < 2**24:
            content = hashlib.sha256(path.read_bytes()).hexdigest()
        found[path.relative_to(folder).as_posix()] = (about.st_mode, about.st_mtime_ns, content)
    return found


def fenced(bench: Bench, tmp_path: Path) -> dict[str, tuple[int, int, str]]:
    return {**fingerprint(tmp_path / "fence"), **fingerprint(bench.inputs)}


def check(bench: Bench, tmp_path: Path, items: list[Item], seconds: float) -> None:
    """Good files done, one line per bad one, nothing outside the output folder changed."""
    from wrinkle_cad.batch.workers.ending import WorkerLimits

    (tmp_path / "fence").mkdir()
    (tmp_path / "fence" / "victim").write_text("somebody's")
    before = fenced(bench, tmp_path)
    start = time.process_time()
    summary = bench.run(workers=2, limits=WorkerLimits(timeout_s=seconds))
    assert time.process_time() - start < 10.0
    failures = [
        event.record.message
        for event in bench.events
        if isinstance(event, FileFinished) and not event.record.is_done
    ]
    assert summary.failed == len(failures) == sum(item.failed for item in items), failures
    assert summary.left == 0
    assert {"good1.dxf", "good2.dxf"} <= set(bench.files())
    assert all(message and len(message.splitlines()) == 1 for message in failures)
    for word in {item.word for item in items if item.failed and item.word}:
        assert any(word in message for message in failures), (word, failures)
    assert fenced(bench, tmp_path) == before
    page = (bench.outputs / "index.html").read_text()
    assert f"{summary.failed} failed" in page


@LINUX_ONLY
@pytest.mark.parametrize("name", ITEMS)
def test_a_hostile_item_costs_itself(bench: Bench, tmp_path: Path, name: str) -> None:
    item = ITEMS[name]
    bench.put(good1="1", good2="2")
    item.put(bench.inputs)
    check(bench, tmp_path, [item], 5.0)


OUTPUTS_PLANTED = {
    "a link to a file outside": lambda out, victim: (out / "good1.dxf").symlink_to(victim),
    "a second name of a file outside": lambda out, victim: os.link(victim, out / "good1.dxf"),
    "a file of somebody else": lambda out, victim: (out / "good1.dxf").write_text("mine"),
    "a pipe": lambda out, victim: os.mkfifo(out / "good1.json"),
    "a foreign JSON file": lambda out, victim: (out / "good1.json").write_text('{"outputs": 5}'),
    "deep JSON": lambda out, victim: (out / "good1.json").write_text("[" * 100_000),
    "JSON of ours with nonsense": lambda out, victim: (out / "good1.json").write_text(
        '{"schema": "wrinkle_cad/job", "outputs": [[["x"]]]}'
    ),
    "a folder": lambda out, victim: (out / "good1.step").mkdir(),
}


@LINUX_ONLY
@pytest.mark.parametrize("name", OUTPUTS_PLANTED)
def test_what_has_an_outputs_name_is_kept(bench: Bench, tmp_path: Path, name: str) -> None:
    bench.put(good1="1", good2="2")
    bench.outputs.mkdir()
    victim = tmp_path / "victim"
    victim.write_text("somebody's")
    OUTPUTS_PLANTED[name](bench.outputs, victim)
    before = fingerprint(bench.outputs)
    summary = bench.run(workers=2)
    is_ours = name == "JSON of ours with nonsense"
    assert (summary.done, summary.failed) == ((2, 0) if is_ours else (1, 1))
    assert victim.read_text() == "somebody's"
    if not is_ours:
        after = fingerprint(bench.outputs)
        assert {path: after[path] for path in before} == before
    assert not list(bench.outputs.glob(".wrinkle_cad-*"))


def test_figures_of_no_known_form_cost_the_file_that_they_are_about(bench: Bench) -> None:
    words = ("number", "words", "state", "creases", "shares")
    bench.put(**{word: word for word in words})
    summary = bench.run(job_function=stranger_job)
    assert (summary.done, summary.failed) == (0, len(words))
    for event in bench.events:
        if isinstance(event, FileFinished):
            assert "figures" in event.record.message
            assert len(event.record.message.splitlines()) == 1
    assert not bench.files()


def test_a_gzip_bomb_is_one_sentence(tmp_path: Path) -> None:
    bomb = tmp_path / "a.step"
    bomb.write_bytes(gzip.compress(b"ISO-10303-21;\n" + b" " * 2**28 * 2))
    command = [sys.executable, "-m", "wrinkle_cad", "run", str(bomb), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert "MiB unpacked" in done.stderr

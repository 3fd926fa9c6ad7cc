"""The batch's own files: nothing foreign is touched, nothing damaged is fatal."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.batch.conftest import Bench
from wrinkle_cad.batch.folder.lock import LOCK_NAME
from wrinkle_cad.errors import JobError

OWN = ("index.html", "summary.csv", "batch.log", "manifest.jsonl", LOCK_NAME)


def plant(path: Path, kind: str, victim: Path) -> None:
    victim.write_text('{"mine": 1}\n')
    if kind == "link":
        path.symlink_to(victim)
    elif kind == "second name":
        os.link(victim, path)
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "directory":
        path.mkdir()
    else:
        path.write_text(victim.read_text())


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("kind", ["link", "second name", "pipe", "directory", "file"])
def test_a_batch_does_not_begin_over_somebody_elses_file(
    bench: Bench, tmp_path: Path, name: str, kind: str
) -> None:
    bench.put(a="1")
    bench.outputs.mkdir()
    victim = tmp_path / "victim"
    plant(bench.outputs / name, kind, victim)
    with pytest.raises(JobError, match=name.removeprefix(".")):
        bench.run()
    assert victim.read_text() == '{"mine": 1}\n'
    assert {path.name for path in bench.outputs.iterdir()} <= {name, LOCK_NAME}


def test_own_files_of_an_earlier_batch_are_written_again(bench: Bench) -> None:
    bench.put(a="1")
    bench.run()
    before = (bench.outputs / "index.html").stat().st_mtime_ns
    assert bench.run().skipped == 1
    assert (bench.outputs / "index.html").stat().st_mtime_ns > before


@pytest.mark.parametrize("content", [b"\0" * 500, b"not a manifest", b"[" * 100_000])
def test_a_damaged_manifest_is_set_aside_with_a_sentence(bench: Bench, content: bytes) -> None:
    bench.put(a="1")
    bench.outputs.mkdir()
    (bench.outputs / "manifest.jsonl").write_bytes(content)
    assert bench.run().done == 1
    assert (bench.outputs / "manifest.jsonl.damaged-1").read_bytes() == content
    assert "the manifest was damaged" in (bench.outputs / "batch.log").read_text()
    assert bench.run().skipped == 1


HOSTILE_LINES = (
    '{"schema": 1, "key": 5, "input": "a.step"}',
    '{"schema": 1, "key": "../../x", "input": "a.step", "input_sha256": "", '
    '"settings_sha256": "", "outcome": "done", "outputs": []}',
    '{"schema": 1, "key": "a", "input": "a.step", "input_sha256": "", "settings_sha256": "", '
    '"outcome": "done", "outputs": [{"name": "../victim", "bytes": 1, "sha256": "x"}]}',
    '{"schema": 1, "key": "a", "input": "a.step", "input_sha256": "", "settings_sha256": "", '
    '"outcome": "done", "figures": {"developability": [1]}}',
    '{"schema": 1, "key": "a", "input": "a.step", "input_sha256": "", "settings_sha256": "", '
    '"outcome": "done", "seconds": {"read": "x"}}',
    '{"schema": 1, "key": "a", "input": "a.step", "figures": ' + "9" * 400 + "}",
    '{"schema": 1, "seconds": ' + "[" * 50_000,
    '{"schema": 1, "figures": ' + "9" * 5000 + "}",
    "\\udcff",
    *(
        '{"schema": 1, "key": "a", "input": "a.step", "input_sha256": "", "settings_sha256": "", '
        f'"outcome": "done", "{name}": {value}}}'
        for name in ("versions", "seconds", "figures", "outputs", "missed_limits", "message")
        for value in ("[1]", "5", '"text"', "{}", "null", "true", "[[]]", '{"a": [1]}')
        # What is left out here is of the form of a record.
        if (name, value) not in (("message", '"text"'), ("missed_limits", '"text"'))
        and (value != "{}" or name == "message")
        and (value != '{"a": [1]}' or name != "missed_limits")
    ),
)


def test_hostile_lines_in_a_manifest_are_left_out(bench: Bench, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("somebody's")
    bench.put(a="1")
    bench.run()
    with (bench.outputs / "manifest.jsonl").open("a") as stream:
        stream.writelines(f"{line}\n" for line in HOSTILE_LINES)
    assert bench.run().skipped == 1
    bench.put(a="2")
    assert bench.run().done == 1
    assert victim.read_text() == "somebody's"
    assert "unreadable lines left out" in (bench.outputs / "batch.log").read_text()


@pytest.mark.parametrize("name", ["manifest.jsonl", "batch.log"])
def test_a_file_whose_beginning_a_power_cut_tore_is_begun_again(bench: Bench, name: str) -> None:
    bench.put(a="1", b="2")
    bench.run()
    whole = (bench.outputs / name).read_bytes()
    (bench.outputs / name).write_bytes(whole[:9])
    for output in bench.files():
        (bench.outputs / output).unlink()
    assert bench.run().left == 0
    assert (bench.outputs / name).read_bytes().startswith(whole.partition(b"\n")[0])
    assert bench.run().skipped == 2


def test_a_file_that_would_take_the_pages_name_is_told_so(bench: Bench) -> None:
    bench.put(index="1", a="2")
    summary = bench.run()
    assert (summary.done, summary.failed) == (1, 1)
    assert "wrinkle_cad batch" in (bench.outputs / "index.html").read_text()


def test_no_script_but_the_pages_own_may_run(bench: Bench) -> None:
    bench.put(a="1")
    bench.run()
    page = (bench.outputs / "index.html").read_text()
    assert "default-src 'none'" in page
    assert "script-src 'sha256-" in page
    assert page.count("<script>") == 1

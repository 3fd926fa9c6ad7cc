"""The command ``batch`` as a person or a machine sees it."""

from __future__ import annotations

import io
import json
import os
import pty
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from rich.console import Console

from tests.batch.conftest import Bench
from tests.batch.stand_ins import KINDS, PHASES, job_by_content, talkative_job
from wrinkle_cad.batch.folder.conversion import ConversionOptions
from wrinkle_cad.batch.folder.events import BatchSummary, FileFinished, FilePhase, FileSkipped
from wrinkle_cad.batch.folder.lock import locked_folder
from wrinkle_cad.batch.folder.manifest import Record
from wrinkle_cad.cli import batch_screen
from wrinkle_cad.cli.batch_display import live_display, print_summary
from wrinkle_cad.cli.main import main

ROOT = Path(__file__).parents[2]


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None, raising=False)
    monkeypatch.delattr(sys.modules["__main__"], "__file__", raising=False)
    options = partial(ConversionOptions, job_function=job_by_content)
    monkeypatch.setattr(batch_screen, "ConversionOptions", options)
    return Bench(tmp_path)


def batch(bench: Bench, *flags: str) -> int:
    return main(["batch", str(bench.inputs), "-o", str(bench.outputs), "--workers", "1", *flags])


def test_off_a_terminal_there_is_one_plain_line_per_file(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.put(a="1", b="fail@read", c="SIGKILL@write")
    assert batch(bench) == 1
    out, err = capfd.readouterr()
    assert out.splitlines()[0] == "a.step: done in 0.05 s, 100.0% of the rails developable"
    failures = err.splitlines()
    assert len(failures) == 2
    assert failures[0] == "wrinkle-cad: b.step: There are no curves. Draw two."
    assert "SIGKILL" in failures[1]
    assert str(bench.outputs / "index.html") in out
    assert "\x1b" not in out + err


def test_a_good_batch_exits_with_0_and_again_when_resumed(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.put(a="1")
    assert batch(bench) == 0
    assert batch(bench) == 0
    out, err = capfd.readouterr()
    assert "a.step: done before" in out
    assert err == ""


def test_quiet_prints_failures_only(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.put(a="1", b="fail@read")
    assert batch(bench, "--quiet") == 1
    assert capfd.readouterr() == ("", "wrinkle-cad: b.step: There are no curves. Draw two.\n")


def test_a_machine_gets_json_lines_and_nothing_else(
    bench: Bench, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    options = partial(ConversionOptions, job_function=talkative_job)
    monkeypatch.setattr(batch_screen, "ConversionOptions", options)
    bench.put(a="1", b="fail@read")
    assert batch(bench, "--json-lines") == 1
    assert batch(bench, "--json-lines") == 1
    out, err = capfd.readouterr()
    events = [json.loads(line) for line in out.splitlines()]
    kinds = [event["event"] for event in events if event["event"] != "phase"]
    first = ["started", "finished", "finished", "ended"]
    assert kinds == [*first, "started", "skipped", "finished", "ended"]
    assert {event["phase"] for event in events if event["event"] == "phase"} == set(PHASES)
    assert events[-1]["failed"] == 1
    assert err == ""


def test_a_dry_run_tells_and_writes_nothing(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.put(a="1", b="2")
    assert batch(bench, "--dry-run") == 0
    assert not bench.outputs.exists()
    batch(bench, "--quiet")
    bench.put(b="3")
    (bench.inputs / "a.stp").write_text("")
    before = bench.files()
    capfd.readouterr()
    assert batch(bench, "--dry-run", "--name", "{stem}") == 1
    out = capfd.readouterr().out.splitlines()
    assert out[0] == "a.step -> a.*: done before"
    assert out[1].startswith("a.stp -> a.*: The outputs of a.step would be called a too")
    assert out[2] == "b.step -> b.*: to do"
    assert bench.files() == before
    batch(bench, "--dry-run", "--force", "--json-lines")
    verdicts = [json.loads(line)["verdict"] for line in capfd.readouterr().out.splitlines()]
    assert verdicts[0] == verdicts[2] == "to do"


def test_a_mask_names_the_outputs(bench: Bench) -> None:
    bench.put(**{"x/a": "1"})
    assert batch(bench, "--quiet", "--name", "{folder}_{stem}_{number}") == 0
    assert "x_a_0001.step" in {Path(name).name for name in bench.files()}


@pytest.mark.parametrize(
    ("flags", "complaint"),
    [
        (("--name", "{size}"), "no field 'size'"),
        (("--memory", "1"), "give 2 to 1000000 GiB"),
        (("--timeout", "0"), "give 0.1 to 10000000 s"),
        (("--workers", "0"), "from 1 to 1000"),
        (("--ship-bytes",), "needs --scheduler"),
        (("--scheduler", "tcp://x:1", "--timeout", "5"), "cannot be held to it"),
        (("--scheduler", "tcp://x:1", "--memory", "5"), "cannot be held to it"),
    ],
)
def test_wrong_usage_exits_with_2_and_one_line(
    bench: Bench, capfd: pytest.CaptureFixture[str], flags: tuple[str, ...], complaint: str
) -> None:
    bench.put(a="1")
    command = ["batch", str(bench.inputs), "-o", str(bench.outputs), *flags]
    assert main(command) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert complaint in err
    assert not bench.outputs.exists()


def test_no_input_and_no_output_folder_are_wrong_usage(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    assert batch(bench) == 2
    assert main(["batch", str(bench.inputs)]) == 2
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == 2
    assert "no CAD file" in lines[0]
    assert "-o DIR" in lines[1]


def test_a_folder_in_use_is_wrong_usage(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.put(a="1")
    bench.outputs.mkdir()
    with locked_folder(bench.outputs):
        assert batch(bench) == 2
    assert "Another batch" in capfd.readouterr().err


def test_names_that_are_no_text_do_no_harm(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    for name in (b"\xff.step", b"a\nb.step", b"\x1b[2J.step", b"CON.step", b"=1+1.step"):
        with open(os.fsencode(bench.inputs) + b"/" + name, "wb") as stream:  # noqa: PTH123
            stream.write(b"1")
    assert batch(bench) == 1
    out, err = capfd.readouterr()
    assert len(err.splitlines()) == 1
    assert "\\udcff.step has bytes that are not UTF-8" in err
    assert len([line for line in out.splitlines() if "done in" in line]) == 4
    assert "\x1b" not in out
    stems = {name.removesuffix(".step") for name in bench.files() if name.endswith(".step")}
    assert stems == {"a_b", "_[2J", "_CON", "=1+1"}


def test_ctrl_c_exits_with_130_and_tells_how_to_resume(bench: Bench) -> None:
    bench.put(a="hang@write")
    code = (
        "import sys; from functools import partial; from wrinkle_cad.cli import batch_screen as s\n"
        "from tests.batch.stand_ins import job_by_content as job\n"
        "from wrinkle_cad.cli.main import main\n"
        "s.ConversionOptions = partial(s.ConversionOptions, job_function=job)\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "batch", str(bench.inputs), "-o", str(bench.outputs)]
    running = subprocess.Popen(
        [*command, "--json-lines"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # Whoever started the tests in the background may have turned interrupts off for all of us.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    assert running.stdout is not None
    while '"write"' not in (line := running.stdout.readline()):
        assert line, "it ended before it wrote"
    begin = time.monotonic()
    os.killpg(running.pid, signal.SIGINT)
    _, err = running.communicate(timeout=10)
    assert time.monotonic() - begin < 2.0
    assert running.returncode == 130
    assert len(err.splitlines()) == 1
    assert "0 of 1 files are settled" in err
    assert "Run the same command again" in err


def test_a_terminal_shows_a_live_display(bench: Bench) -> None:
    bench.put(a="1", b="fail@read")
    master, slave = pty.openpty()
    code = (
        "import sys; from functools import partial; from wrinkle_cad.cli import batch_screen as s\n"
        "from tests.batch.stand_ins import job_by_content as job\n"
        "from wrinkle_cad.cli.main import main\n"
        "s.ConversionOptions = partial(s.ConversionOptions, job_function=job)\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "batch", str(bench.inputs), "-o", str(bench.outputs)]
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    done = subprocess.run(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=slave, env=environment, check=False
    )
    os.close(slave)
    shown = os.read(master, 1 << 20).decode(errors="replace")
    os.close(master)
    assert done.returncode == 1
    assert "\x1b[" in shown
    assert "There are no curves. Draw two." in shown


def test_the_display_counts_and_shows_phases_as_text() -> None:
    text = io.StringIO()
    console = Console(file=text, force_terminal=True, width=120, color_system=None)
    record = Record(key="a", input="a", input_sha256="", settings_sha256="", outcome="done")
    with live_display(4, console) as listener:
        listener(FilePhase("[red]x[/red].step", "search", 1, 7))
        listener(FileFinished("a", record))
        listener(FileSkipped("b", record))
        time.sleep(0.3)
    shown = text.getvalue()
    assert "1 done, 0 failed, 2 left" in shown
    assert "search 1/7  [red]x[/red].step" in shown


def test_the_summary_tells_counts_and_where_to_look() -> None:
    text = io.StringIO()
    summary = BatchSummary(
        folder=Path("out"), done=3, failed=1, skipped=2, left=4, missed_limits=1, seconds=60.0
    )
    print_summary(summary, Console(file=text, width=80))
    shown = text.getvalue()
    for expected in ("done before", "not come to", "miss a limit", "4.0", "out/index.html"):
        assert expected in shown


def test_json_names_every_output(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    bench.put(a="1")
    batch(bench, "--json-lines")
    lines = [json.loads(line) for line in capfd.readouterr().out.splitlines()]
    (finished,) = [line for line in lines if line["event"] == "finished"]
    assert [entry["name"] for entry in finished["outputs"]] == [f"a.{kind}" for kind in KINDS]


def test_what_failed_is_listed_by_cause_and_nothing_is_done(
    bench: Bench, capfd: pytest.CaptureFixture[str]
) -> None:
    bench.put(a="1", b="fail@read", c="fail@read")
    assert batch(bench) == 1
    before = {path: path.stat().st_mtime_ns for path in bench.outputs.iterdir()}
    capfd.readouterr()
    assert main(["batch", "--failed", "-o", str(bench.outputs)]) == 1
    out, err = capfd.readouterr()
    title, *lines = out.splitlines()
    assert title.startswith("The file, or the curves in it, cannot be used: 2. ")
    assert lines == [f"  {name}.step: There are no curves. Draw two." for name in "bc"]
    assert err == ""
    assert {path: path.stat().st_mtime_ns for path in bench.outputs.iterdir()} == before
    # What failed by the user's own fault has no traceback in the log, and one line.
    log = (bench.outputs / "batch.log").read_text()
    assert "Traceback" not in log
    assert log.count("b.step") == 1

    bench.put(b="1", c="1")
    assert batch(bench, "--quiet") == 0
    assert main(["batch", "--failed", "-o", str(bench.outputs)]) == 0
    assert capfd.readouterr().out == "No file failed.\n"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--failed", "-o", "nowhere"], "no manifest.jsonl"),
        (["--failed", "x.step", "-o", "nowhere"], "leave the files out"),
        (["-o", "nowhere"], "give files, folders or patterns"),
    ],
)
def test_a_batch_of_nothing_is_wrong_usage(
    given: list[str], said: str, capfd: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["batch", *given]) == 2
    assert said in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []

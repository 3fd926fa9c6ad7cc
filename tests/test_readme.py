"""Every code block of the README runs, and its tables say what the program says.

Blocks under `<!-- command: ... -->` install things on a fresh machine; `.ci/run` runs those.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from wrinkle_cad.cli.main import main
from wrinkle_cad.report.material import read_material

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"(?P<mark><!-- command: \w+ -->\n)?```(?P<kind>\w+)\n(?P<code>.*?)```", re.S)
BLOCKS = [match for match in BLOCK.finditer(README) if match["mark"] is None]


def code_of(kind: str) -> list[str]:
    return [match["code"] for match in BLOCKS if match["kind"] == kind]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A working folder with what the README's commands name."""
    shutil.copytree(ROOT / "shoe_examples", tmp_path / "shoe_examples")
    models = tmp_path / "models"
    models.mkdir()
    example = ROOT / "shoe_examples" / "vamp_strip" / "vamp_strip.step"
    for target in (models / "a.step", tmp_path / "a.step", tmp_path / "b.step"):
        shutil.copy(example, target)
    (tmp_path / "more").mkdir()
    shutil.copy(example, tmp_path / "more" / "c.step")
    shutil.copy(example, tmp_path / "one.stp")
    return tmp_path


def run(arguments: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def test_every_kind_of_block_is_run_by_a_test_here() -> None:
    assert {match["kind"] for match in BLOCKS} == {"bash", "python", "toml"}
    assert README.count("<!-- command:") == 2


@pytest.mark.parametrize("code", code_of("python"), ids=lambda code: code.split("\n")[0][:40])
def test_a_script_of_the_readme_runs(folder: Path, code: str) -> None:
    (folder / "script.py").write_text(code, encoding="utf-8")
    done = run(["script.py"], folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


@pytest.mark.parametrize("code", code_of("bash"), ids=lambda code: code.split("\n")[0][:40])
def test_the_commands_of_the_readme_run(
    folder: Path,
    code: str,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """In this process: starting one for each command costs more than the commands do."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    for line in filter(str.strip, code.splitlines()):
        program, *arguments = shlex.split(line)
        assert program == "wrinkle-cad", line
        assert main(arguments) == 0, f"{line}: {capfd.readouterr()}"


def test_the_material_of_the_readme_can_be_read(tmp_path: Path) -> None:
    (code,) = code_of("toml")
    (tmp_path / "calf.toml").write_text(code, encoding="utf-8")
    assert read_material(tmp_path / "calf.toml").thickness_mm == 1.2


@pytest.mark.parametrize("command", ["run", "batch"])
def test_every_option_in_the_readme_exists(command: str) -> None:
    shown = run(["-m", "wrinkle_cad", command, "--help"], ROOT).stdout
    section = "### Options of `run`" if command == "run" else "## Folders of files"
    table = README.split(section)[1].split("\n## ")[0]
    rows = [line for line in table.splitlines() if line.startswith("| `--")]
    named = {flag for row in rows for flag in re.findall(r"--[a-z][a-z-]*", row.split(" | ")[0])}
    assert len(named) >= 7
    missing = {flag for flag in named if not re.search(rf"{flag}\b", shown)}
    assert not missing


def test_every_option_of_run_is_in_the_readme() -> None:
    shown = run(["-m", "wrinkle_cad", "run", "--help"], ROOT).stdout
    flags = set(re.findall(r"--[a-z][a-z-]*", shown)) - {"--help", "--debug", "--quiet"}
    missing = {flag for flag in flags if not re.search(rf"{flag}\b", README)}
    assert not missing


def test_every_link_into_the_repository_leads_somewhere() -> None:
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", README)
    assert links
    assert not [link for link in links if not (ROOT / link).exists()]

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "wrinkle_cad"

CODE = """
import numpy as np
from wrinkle_cad.strip.compiled import compiling_told
from wrinkle_cad.strip.sightlines import bank_lengths
told = []
with compiling_told(told.append):
    for _ in range(2):
        assert bank_lengths(np.array([[3.0], [4.0], [0.0]]))[0] == 5.0
print(told)
"""
COMPILED, READ = "[True, False]", "[]"


def told(folder: Path, package: Path = PACKAGE, **environment: str) -> str:
    """What a fresh process says about its compiling."""
    result = subprocess.run(
        [sys.executable, "-B", "-c", CODE],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(package.parent), **environment},
        check=True,
        capture_output=True,
        text=True,
    )
    return result.stdout.strip()


def copied_to(folder: Path) -> Path:
    ignored = shutil.ignore_patterns("__pycache__")
    return Path(shutil.copytree(PACKAGE, folder / "wrinkle_cad", ignore=ignored))


def test_compiling_is_told_and_reading_machine_code_is_not(tmp_path: Path) -> None:
    cache = str(tmp_path / "cache")
    assert told(tmp_path, WRINKLE_CAD_CACHE_DIR=cache) == COMPILED
    (kept,) = Path(cache).iterdir()
    assert told(tmp_path, WRINKLE_CAD_CACHE_DIR=cache) == READ
    content = kept.read_bytes()
    kept.write_bytes(content[: len(content) // 2])
    assert told(tmp_path, WRINKLE_CAD_CACHE_DIR=cache) == COMPILED
    assert kept.read_bytes() == content


def test_code_is_compiled_again_when_its_source_or_a_constant_in_it_has_changed(
    tmp_path: Path,
) -> None:
    copy, cache = copied_to(tmp_path), str(tmp_path / "cache")
    assert told(tmp_path, copy, WRINKLE_CAD_CACHE_DIR=cache) == COMPILED
    with (copy / "strip" / "sightlines.py").open("a") as source:
        source.write("# changed\n")
    assert told(tmp_path, copy, WRINKLE_CAD_CACHE_DIR=cache) == COMPILED
    assert told(tmp_path, copy, WRINKLE_CAD_CACHE_DIR=cache) == READ


def test_another_processor_has_files_of_its_own(tmp_path: Path) -> None:
    cache = str(tmp_path / "cache")
    other = {"WRINKLE_CAD_PROCESSOR": "generic", "WRINKLE_CAD_CACHE_DIR": cache}
    assert told(tmp_path, WRINKLE_CAD_CACHE_DIR=cache) == COMPILED
    assert told(tmp_path, **other) == COMPILED
    assert told(tmp_path, **other) == READ
    assert told(tmp_path, WRINKLE_CAD_CACHE_DIR=cache) == READ


def test_code_is_kept_in_the_users_folder_where_the_programs_cannot_be_written(
    tmp_path: Path,
) -> None:
    # A file stands where the folder would be: this stops the superuser too.
    copy = copied_to(tmp_path)
    (copy / "__pycache__").touch()
    own = {"XDG_CACHE_HOME": str(tmp_path / "home"), "WRINKLE_CAD_CACHE_DIR": ""}
    assert told(tmp_path, copy, **own) == COMPILED
    assert told(tmp_path, copy, **own) == READ
    unwritable = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "WRINKLE_CAD_CACHE_DIR": ""}
    for _ in range(2):
        assert told(tmp_path, copy, **unwritable) == COMPILED

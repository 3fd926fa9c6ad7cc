from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from wrinkle_cad.strip.compiled import compiled, inlined

PACKAGE = Path(__file__).parents[2] / "wrinkle_cad"

CODE = """
import numba, numpy as np
from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.sightlines import bank_lengths
assert bank_lengths(np.array([[3.0], [4.0], [0.0]]))[0] == 5.0
print(type(bank_lengths._cache).__name__)
"""


def cache_of(folder: Path, environment: dict[str, str]) -> str:
    """The kind of cache that compiled functions of a package in this folder have."""
    return output_of(CODE, folder, environment)


def output_of(code: str, folder: Path, environment: dict[str, str]) -> str:
    result = subprocess.run(
        [sys.executable, "-B", "-c", code],
        cwd=folder,
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    return result.stdout.strip()


def test_machine_code_is_kept_where_a_folder_can_be_written(tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(tmp_path),
        "PYTHONPATH": str(PACKAGE.parent),
    }
    assert cache_of(tmp_path, environment) == "FunctionCache"
    assert list(tmp_path.rglob("*.nbi"))


TELLING_CODE = """
import numpy as np
from wrinkle_cad.strip.compiled import compiling_told
from wrinkle_cad.strip.sightlines import bank_lengths
told = []
with compiling_told(told.append):
    for _ in range(2):
        bank_lengths(np.array([[3.0], [4.0], [0.0]]))
print(told)
"""


def test_compiling_is_told_and_reading_machine_code_is_not(tmp_path: Path) -> None:
    environment = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(tmp_path),
        "PYTHONPATH": str(PACKAGE.parent),
    }
    for told in ("[True, False]", "[]"):
        assert output_of(TELLING_CODE, tmp_path, environment) == told


def test_code_is_compiled_anew_where_no_folder_can_be_written(tmp_path: Path) -> None:
    # A file stands where the folder for machine code would be, and the home is a device: this
    # stops the superuser too.
    ignored = shutil.ignore_patterns("__pycache__")
    copy = Path(shutil.copytree(PACKAGE, tmp_path / "wrinkle_cad", ignore=ignored))
    (copy / "strip" / "__pycache__").touch()
    unwritable = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "PYTHONPATH": str(tmp_path)}
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | unwritable
    assert cache_of(tmp_path, environment) == "NullCache"


def test_a_function_that_is_put_into_its_callers_gives_the_same_as_alone() -> None:
    numbers = np.linspace(-3.0, 3.0, 41)
    assert squares_in_a_loop(numbers).tolist() == [square(number) for number in numbers.tolist()]


@inlined
def square(number: float) -> float:
    return number * number if number > 0.0 else -number * number


@compiled
def squares_in_a_loop(numbers: np.ndarray) -> np.ndarray:
    squares = np.empty(numbers.size)
    for k in range(numbers.size):
        squares[k] = square(numbers[k])
    return squares

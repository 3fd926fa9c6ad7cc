"""The same bytes whatever the processor can do.

Another processor is played by what numpy, OpenBLAS and numba are told to use of this one.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent.parent
EXAMPLES = ROOT / "shoe_examples"
EPOCH = "1767225600"
KINDS = (".step", ".stl", ".dxf", ".json")

NO_VECTORS = {
    "NPY_DISABLE_CPU_FEATURES": " ".join(np.show_config("dicts")["SIMD Extensions"]["found"])
}
KERNELS = [{}, *({"OPENBLAS_CORETYPE": name} for name in ("Haswell", "Prescott", "SkylakeX"))]
PLAIN_COMPILER = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}


def inputs() -> dict[str, list[str]]:
    """The command's arguments for each shoe example."""
    found = {}
    for path in sorted(EXAMPLES.glob("*/*.step")):
        if path.stem not in (path.parent.name, "example_1", "example_2", "example_3"):
            # What an example's script makes of its input stands beside some.
            continue
        own, common = path.with_suffix(".toml"), path.parent / "job.toml"
        job = next((["--job", str(toml)] for toml in (own, common) if toml.exists()), [])
        found[path.stem] = [str(path), *job]
    return found


def made(names: Sequence[str], folder: Path, environment: dict[str, str]) -> dict[str, bytes]:
    """What a fresh process makes of examples, JSON without its seconds."""
    for name in names:
        subprocess.run(
            [sys.executable, "-m", "wrinkle_cad", "run", *inputs()[name], "-o", str(folder)],
            cwd=ROOT,
            env={"SOURCE_DATE_EPOCH": EPOCH, "PATH": "", **environment},
            check=True,
            capture_output=True,
        )
    outputs = {}
    for path in sorted(folder.iterdir()):
        content = path.read_bytes()
        if path.suffix == ".json":
            values = json.loads(content)
            assert values.pop("seconds")
            content = json.dumps(values).encode()
        if path.suffix in KINDS:
            outputs[path.name] = content
    return outputs


def check(found: dict[str, bytes], expected: dict[str, bytes]) -> None:
    assert set(found) == set(expected)
    assert [name for name, content in expected.items() if found[name] != content] == []


def test_a_wrinkle_is_the_same_without_vector_units(tmp_path: Path) -> None:
    new = made(["one_wrinkle"], tmp_path / "new", {"OPENBLAS_CORETYPE": "Haswell"})
    old = made(["one_wrinkle"], tmp_path / "old", {"OPENBLAS_CORETYPE": "Prescott", **NO_VECTORS})
    assert len(new) == len(KINDS)
    check(old, new)


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """All examples as this processor makes them."""
    return made(list(inputs()), tmp_path_factory.mktemp("expected"), {})


@pytest.mark.slow
@pytest.mark.parametrize(("kernel", "vectors"), list(product(KERNELS, ({}, NO_VECTORS)))[1:])
def test_every_example_is_the_same_on_every_processor(
    kernel: dict[str, str], vectors: dict[str, str], expected: dict[str, bytes], tmp_path: Path
) -> None:
    check(made(list(inputs()), tmp_path, {**kernel, **vectors}), expected)


@pytest.mark.slow
def test_every_example_is_the_same_compiled_for_any_processor(
    expected: dict[str, bytes], tmp_path: Path
) -> None:
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    check(made(list(inputs()), tmp_path / "made", {**PLAIN_COMPILER, **cache}), expected)

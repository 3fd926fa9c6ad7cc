"""The same bytes, whoever makes them, in whatever order, however often it was interrupted."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import psutil
import pytest

from tests.batch.processes import assert_all_end
from tests.batch.strips import put_strips
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchSummary
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool
from wrinkle_cad.files.staging import READY_PREFIX

ROOT = Path(__file__).parent.parent.parent
EPOCH = 1767225600
KINDS = ("step", "stl", "dxf", "json")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    put_strips(folder, 2)
    return folder


@pytest.fixture(scope="module")
def reference(inputs: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What one worker makes of the inputs in their order."""
    folder = tmp_path_factory.mktemp("reference")
    run(inputs, folder, workers=1)
    return outputs_of(folder)


def run(inputs: Path, folder: Path, *, workers: int, backwards: bool = False) -> BatchSummary:
    planned = plan_batch(
        find_sources([str(inputs)], folder).files, folder, keywords={"source_date_epoch": EPOCH}
    )
    ordered = planned[::-1] if backwards else planned
    pool = WorkerPool(workers, WorkerLimits())
    return convert(ordered, folder, pool, lambda _: None, ConversionOptions())


def outputs_of(folder: Path) -> dict[str, bytes]:
    """The outputs, JSON without its seconds."""
    outputs = {}
    for kind in KINDS:
        for path in sorted(folder.glob(f"*.{kind}")):
            content = path.read_bytes()
            if kind == "json":
                values = json.loads(content)
                assert values.pop("seconds")
                content = json.dumps(values).encode()
            outputs[path.name] = content
    return outputs


def check(found: dict[str, bytes], reference: dict[str, bytes]) -> None:
    assert set(found) == set(reference)
    for name, content in reference.items():
        assert found[name] == content, name


def test_the_inputs_give_different_outputs(reference: dict[str, bytes]) -> None:
    assert len(reference) == 2 * len(KINDS)
    for kind in KINDS:
        assert reference[f"strip000.{kind}"] != reference[f"strip001.{kind}"]


def test_two_workers_make_what_one_makes(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    run(inputs, tmp_path, workers=2)
    check(outputs_of(tmp_path), reference)


def test_the_other_order_in_one_worker_makes_the_same(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    run(inputs, tmp_path, workers=1, backwards=True)
    check(outputs_of(tmp_path), reference)


def command(inputs: Sequence[Path], folder: Path) -> list[str]:
    paths = [str(path) for path in inputs]
    return [sys.executable, "-m", "wrinkle_cad", "batch", *paths, "-o", str(folder)]


def check_in_fresh_processes(
    inputs: Path, reference: dict[str, bytes], folder: Path, count: int
) -> None:
    for number in range(count):
        target = folder / str(number)
        environment = {"SOURCE_DATE_EPOCH": str(EPOCH), "PYTHONHASHSEED": str(number), "PATH": ""}
        subprocess.run(
            [*command([inputs], target), "--workers", "1", "--quiet"],
            cwd=ROOT,
            env=environment,
            check=True,
        )
        check(outputs_of(target), reference)


def test_a_fresh_process_makes_the_same(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    check_in_fresh_processes(inputs, reference, tmp_path, 1)


@pytest.mark.slow
def test_ten_fresh_processes_make_the_same(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    check_in_fresh_processes(inputs, reference, tmp_path, 10)


def check_kill_and_resume(
    inputs: Path, reference: dict[str, bytes], folder: Path, moments: Sequence[float]
) -> None:
    environment = {"SOURCE_DATE_EPOCH": str(EPOCH), "PATH": ""}
    for moment in moments:
        batch = subprocess.Popen(
            [*command([inputs], folder), "--workers", "2", "--quiet"], cwd=ROOT, env=environment
        )
        time.sleep(moment)
        if batch.poll() is None:
            children = psutil.Process(batch.pid).children(recursive=True)
            batch.kill()
            assert_all_end(children)
        batch.wait()
        # Committed outputs count as present: the next batch only moves them to their names.
        present = {path.name for path in folder.glob("strip*")}
        present |= {path.name for path in folder.glob(f"{READY_PREFIX}*/strip*")}
        for name, content in outputs_of(folder).items():
            assert content == reference[name]
        for stem in ("strip000", "strip001"):
            whole = {f"{stem}.{kind}" for kind in (*KINDS, "html")}
            assert present & whole in (set(), whole)
    summary = run(inputs, folder, workers=2)
    assert summary.failed == 0
    check(outputs_of(folder), reference)


def test_a_killed_and_resumed_batch_makes_the_same(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    # About when the first file is written; the long form takes every moment.
    check_kill_and_resume(inputs, reference, tmp_path, [4.0])


@pytest.mark.slow
def test_a_batch_killed_at_twenty_moments_makes_the_same(
    inputs: Path, reference: dict[str, bytes], tmp_path: Path
) -> None:
    moments = random.Random(6)
    check_kill_and_resume(
        inputs, reference, tmp_path, [moments.uniform(0.2, 6.0) for _ in range(20)]
    )

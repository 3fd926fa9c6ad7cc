"""What the tests of batches share."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.batch.stand_ins import job_by_content
from wrinkle_cad.batch.folder.conversion import ConversionOptions, convert
from wrinkle_cad.batch.folder.events import BatchEvent, BatchSummary
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool


class Bench:
    """A folder of inputs, a folder of outputs and a way to run a batch from one to the other."""

    def __init__(self, folder: Path) -> None:
        self.inputs = folder / "in"
        self.outputs = folder / "out"
        self.inputs.mkdir()
        self.events: list[BatchEvent] = []

    def put(self, **contents: str) -> None:
        for name, content in contents.items():
            path = self.inputs / f"{name}.step"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)

    def run(
        self,
        *,
        workers: int = 1,
        limits: WorkerLimits | None = None,
        keywords: dict[str, object] | None = None,
        **options: object,
    ) -> BatchSummary:
        self.events = []
        sources = find_sources([str(self.inputs)], self.outputs)
        planned = plan_batch(sources.files, self.outputs, keywords=keywords)
        pool = WorkerPool(workers, limits or WorkerLimits())
        chosen = ConversionOptions(**{"job_function": job_by_content, **options})  # type: ignore[arg-type]
        return convert(planned, self.outputs, pool, self.events.append, chosen)

    def files(self) -> dict[str, bytes]:
        """Everything under a final name (hidden ones are not), without the batch's own files."""
        own = {"manifest.jsonl", "batch.log", "summary.csv", "index.html"}
        return {
            path.relative_to(self.outputs).as_posix(): path.read_bytes()
            for path in sorted(self.outputs.rglob("*"))
            if path.is_file()
            and path.name not in own
            and not any(part.startswith(".") for part in path.relative_to(self.outputs).parts)
        }


@pytest.fixture(autouse=True)
def _workers_do_not_import_pytest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spawned process imports the main module, which here is pytest: 0.4 s for nothing."""
    monkeypatch.setattr(sys.modules["__main__"], "__spec__", None, raising=False)
    monkeypatch.delattr(sys.modules["__main__"], "__file__", raising=False)


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


@pytest.fixture
def make_bench(tmp_path: Path) -> Callable[[str], Bench]:
    def make(name: str) -> Bench:
        (tmp_path / name).mkdir()
        return Bench(tmp_path / name)

    return make

"""STEP files whose entities are changed, not their bytes: each ends as done or as one line."""

from __future__ import annotations

import os
import random
import signal
from pathlib import Path

import pytest

from tests.fuzz import forked
from tests.fuzz.runner import EXAMPLES, originals, run_forked
from tests.fuzz.structure import CHANGES, Change, entities_of, restructure
from wrinkle_cad.job.job import Job
from wrinkle_cad.job.outcome import JobFailed

SOURCES = originals([EXAMPLES])


@pytest.mark.slow
def test_2000_changed_files_end_as_done_or_as_one_line(
    tmp_path: Path, record_property: pytest.RecordProperty
) -> None:
    figures, _ = run_forked(tmp_path, 2000, 3, SOURCES, is_structured=True)
    record_property("figures", str(figures))
    assert not figures.bugs
    assert figures.done + figures.failures.total() == 2000


def test_a_file_without_changes_is_the_same_entities() -> None:
    content = SOURCES[0].read_bytes()
    entities = entities_of(content)
    assert len(entities) == content.count(b";\n#")


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_each_change_changes_something_and_is_seeded(change: Change) -> None:
    content, other = (path.read_bytes() for path in SOURCES[:2])

    def made(seed: int) -> dict[int, bytes]:
        own = entities_of(content)
        change(own, entities_of(other), random.Random(seed))
        return own

    results = [made(seed) for seed in range(5)]
    assert results == [made(seed) for seed in range(5)]
    assert any(result != entities_of(content) for result in results)


def test_changes_keep_header_and_end() -> None:
    content = SOURCES[0].read_bytes()
    changed = restructure(content, content, random.Random(4))
    assert changed.partition(b"DATA;")[0] == content.partition(b"DATA;")[0]
    assert changed.rstrip().endswith(b"END-ISO-10303-21;")
    assert changed == restructure(content, content, random.Random(4))


def test_a_changed_file_that_costs_too_much_or_crashes_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def job_that(job: Job) -> JobFailed:
        if job.name == "burn":
            while True:
                pass
        if job.name == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        if job.name == "raise":
            raise ZeroDivisionError
        return JobFailed(job=job, phase="read", error="InputError", message="Told well.")

    monkeypatch.setattr(forked, "run_job", job_that)
    monkeypatch.setattr(forked, "MOST_CPU_S", 1.0)
    paths = [tmp_path / f"{name}.step" for name in ("burn", "crash", "raise", "good")]
    ended = {each.name: each.bug for each in forked.ended_files(paths, tmp_path / "out")}
    assert ended["good.step"] == ""
    assert ended["burn.step"] == "more than 1 s of CPU time"
    assert ended["crash.step"] == "ended by SIGSEGV"
    assert "ZeroDivisionError" in ended["raise.step"]

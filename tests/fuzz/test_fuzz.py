"""Damaged STEP files through the real reader: each ends as done or as one line, in time."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tests.fuzz.mutations import MUTATIONS, Mutation, mutate
from tests.fuzz.runner import (
    EXAMPLES,
    Figures,
    check_surroundings,
    judge,
    originals,
    run,
    run_forked,
    weighted,
)
from wrinkle_cad.batch.folder.manifest import Record

RECORD = Record(key="a", input="a", input_sha256="", settings_sha256="", outcome="failed")


@pytest.fixture
def others(request: pytest.FixtureRequest) -> list[Path]:
    """The real files, where their folder was given."""
    given = request.config.getoption("--realdata")
    return originals([Path(given)]) if given else []


@pytest.fixture
def sources(others: list[Path]) -> list[Path]:
    """Every example, and the real files."""
    return weighted(originals([EXAMPLES]), others)


@pytest.mark.parametrize("count", [60, pytest.param(200, marks=pytest.mark.slow)])
def test_damaged_files_end_as_done_or_as_one_line(
    tmp_path: Path, others: list[Path], count: int
) -> None:
    # The example that is done fastest: uppers are carved and stitched, which takes seconds.
    quick = weighted(originals([EXAMPLES / "vamp_strip"]), others)
    figures, _ = run(tmp_path, count, 1, quick, timeout_s=20.0)
    assert not figures.bugs
    assert figures.done + figures.failures.total() == count
    assert figures.done > 0, "some damage is harmless"
    assert figures.failures["InputError"] > count / 2, "most damage is told"


@pytest.mark.slow
def test_2000_damaged_files_end_as_done_or_as_one_line(
    tmp_path: Path, sources: list[Path], record_property: pytest.RecordProperty
) -> None:
    figures, _ = run_forked(tmp_path, 2000, 2, sources)
    record_property("figures", str(figures))
    assert not figures.bugs
    assert figures.done + figures.failures.total() == 2000


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.__name__)
def test_each_mutation_damages_and_is_seeded(mutation: Mutation, sources: list[Path]) -> None:
    content = sources[0].read_bytes()
    made = [mutation(content, random.Random(seed)) for seed in range(5)]
    assert made == [mutation(content, random.Random(seed)) for seed in range(5)]
    assert any(damaged != content for damaged in made)
    assert mutation(b"", random.Random(0)) is not None


def test_mutations_together_are_seeded() -> None:
    content = b"#1=A('x',(1.,2.),#1);\n" * 20
    assert mutate(content, random.Random(3)) == mutate(content, random.Random(3))
    assert mutate(content, random.Random(3)) != mutate(content, random.Random(4))


@pytest.mark.parametrize(
    ("message", "seconds"),
    [
        ("", 0.0),
        ("a\nb", 0.0),
        ("Traceback (most recent call last)", 0.0),
        ("An internal error happened in phase read (KeyError: 1). Please report it.", 0.0),
        ("told well", 99.0),
    ],
)
def test_the_judge_notices(message: str, seconds: float) -> None:
    from dataclasses import replace

    figures = Figures()
    judge(replace(RECORD, message=message, seconds={"total": seconds}), figures, 10.0)
    assert len(figures.bugs) == 1
    judge(replace(RECORD, message="told well"), figures, 10.0)
    assert len(figures.bugs) == 1


def test_the_judge_notices_files_out_of_place(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    clean = Figures()
    check_surroundings(tmp_path, [], clean)
    assert not clean.bugs
    (tmp_path / "escaped").write_text("")
    (tmp_path / "out" / "unknown.step").write_text("")
    figures = Figures()
    check_surroundings(tmp_path, [], figures)
    assert len(figures.bugs) == 2

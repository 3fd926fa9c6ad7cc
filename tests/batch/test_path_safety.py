"""Whatever files, folders and labels are called, nothing is written outside the output folder."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.batch.conftest import Bench
from tests.batch.stand_ins import KINDS
from tests.batch.strips import EXAMPLE
from wrinkle_cad.batch.folder.conversion import convert
from wrinkle_cad.batch.folder.inputs import find_sources
from wrinkle_cad.batch.folder.plan import plan_batch
from wrinkle_cad.batch.workers.ending import WorkerLimits
from wrinkle_cad.batch.workers.pool import WorkerPool

HOSTILE_LABELS = (
    "../../x",
    "/tmp/x\\X\\0Ay",
    "CON",
    "\\X2\\9774\\X0\\" + "a" * 300,
    "<script>=cmd()</script>",
)
HOSTILE_STEMS = (
    "..",
    "...",
    "-o",
    "CON",
    "com1.x",
    "a" * 240,
    "tab\there",
    "new\nline",
    "C:\\x",
    "..\\..\\x",
    "trailing. ",
    " leading",
    "=cmd()",
    "<script>",
    "$(touch x)",
    "靴",
    "%2e%2e%2fx",
)


def everything_below(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*")}


def test_no_name_of_a_file_or_folder_leads_out(bench: Bench, tmp_path: Path) -> None:
    for number, stem in enumerate(HOSTILE_STEMS):
        folder = bench.inputs / (stem.strip("/") if stem not in ("..", "...") else "dots")
        folder.mkdir(exist_ok=True)
        (folder / f"{stem}.step").write_text(str(number))
    before = everything_below(tmp_path) - {"out"}
    # Names that start with a dot are hidden: left out like the folders of version control.
    count = sum(not stem.startswith(".") for stem in HOSTILE_STEMS)
    summary = bench.run()
    assert (summary.done, summary.failed) == (count, 0)
    outside = {name for name in everything_below(tmp_path) if not name.startswith("out")}
    assert outside == before
    assert len(bench.files()) == count * len(KINDS), "none fell onto another"
    for name in bench.files():
        for part in Path(name).parts:
            assert not set(part) & set('<>:"\\|?*\n\t')
            assert len(part.encode()) <= 255


def test_names_that_become_the_same_are_told_and_not_mixed(bench: Bench) -> None:
    for name in ("a:b", "a|b", "a?b", "a_b"):
        (bench.inputs / f"{name}.step").write_text(name)
    summary = bench.run()
    assert (summary.done, summary.failed) == (1, 3)
    assert len(bench.files()) == len(KINDS)
    content = bench.files()["a_b.step"].decode()
    assert content.count("a:b END") == content.count("END")


@pytest.mark.parametrize("shape", ["absolute", "dots"])
def test_settings_beside_a_file_cannot_lead_out(bench: Bench, tmp_path: Path, shape: str) -> None:
    bench.put(a="1")
    target = str(tmp_path / "evil") if shape == "absolute" else "../../evil"
    (bench.inputs / "job.toml").write_text(f"output_dir = {target!r}\nname = {target + '/x'!r}\n")
    summary = bench.run()
    assert summary.done == 1
    assert not list(tmp_path.parent.rglob("evil*"))
    assert all(name.count("/") == 0 for name in bench.files())


@pytest.mark.slow
def test_labels_in_real_files_never_become_paths(
    make_bench: Callable[[str], Bench], tmp_path: Path
) -> None:
    bench = make_bench("labels")
    text = EXAMPLE.read_text()
    for number, label in enumerate(HOSTILE_LABELS):
        renamed = text
        for rail in ("P", "Q"):
            renamed = renamed.replace(f"PRODUCT('{rail}','{rail}'", f"PRODUCT('{label}:{rail}','x'")
            renamed = renamed.replace(
                f"OCCURRENCE('{'1' if rail == 'P' else '2'}','{rail}'",
                f"OCCURRENCE('{'1' if rail == 'P' else '2'}','{label}:{rail}'",
            )
        assert renamed != text
        (bench.inputs / f"strip{number:02d}.step").write_text(renamed)
    before = everything_below(tmp_path)
    planned = plan_batch(find_sources([str(bench.inputs)], bench.outputs).files, bench.outputs)
    summary = convert(planned, bench.outputs, WorkerPool(2, WorkerLimits()), lambda _: None)
    lines = (bench.outputs / "manifest.jsonl").read_text().splitlines()
    messages = [json.loads(line)["message"] for line in lines[1:]]
    assert summary.done == len(HOSTILE_LABELS), messages
    stems = {f"strip{number:02d}" for number in range(len(HOSTILE_LABELS))}
    assert set(bench.files()) == {
        f"{stem}.{kind}" for stem in stems for kind in ("step", "stl", "dxf", "json", "html")
    }
    outside = {name for name in everything_below(tmp_path) if not name.startswith("labels/out")}
    assert outside == before

"""More hostile items than can each have a batch of their own: all of them in one."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.batch.conftest import Bench
from tests.batch.test_attack import Item, beside, check, fingerprint
from wrinkle_cad.files.staging import MARK, MARK_NAME, PART_PREFIX, READY_PREFIX, RECORD_NAME

LINUX_ONLY = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="names of Linux")

SETTINGS_THAT_FAIL = (
    *('name = "index"', 'name = "good1"', "name = 5", 'name = ["a"]', 'name = "batch.sheets"'),
    *("input = 5", 'input = "a\\u0000b"', "p = []", "p = true", "tolerance = true"),
    *("tolerance = 2020-01-01", "tolerance = 10:00:00", 'waves = "3"\nheight = 1', "unit = 5"),
    *('p = "a"\np = "b"', '"" = 1', '"\\u202E\\u001b[31m" = 1', 'job.p = "x"'),
    *("source_date_epoch = -1", "source_date_epoch = 99999999999999999", "tolerance = 0.05\rp = 1"),
)
SETTINGS_THAT_DO = (
    *("", 'name = ".."', 'name = "../x"', 'name = "a/c"', 'name = "NUL"'),
    *(
        f'name = "{"x" * 300}"',
        'name = "a\\u202Ecod.exe\\u001b[31m"',
        'name = ".wrinkle_cad-part-x"',
    ),
    *(
        'name = "summary.csv"',
        'input = "/dev/zero"',
        'output_dir = "/somewhere"',
        "output_dir = 5",
    ),
)
NAMES = (
    *("a\nb.step", "a\x1b[31m\x07b.step", "a\u202ecod.step", "-rf.step", "=cmd()|x.step"),
    *("a\"'<b>&.step", "a .step", "CON.step", "%s{stem}.step", "[a-z]*.step", "a\u2028\x85c.step"),
    *("manifest.step", "manifest.jsonl.step", "x.lock.step", "\U0001f45e" * 61 + ".step"),
)
NAMES_THAT_FAIL = ("index.step", "batch.sheets.step", "a\udcff.step", "good1.stp")


def write(name: str) -> Callable[[Path], object]:
    return lambda folder: Path(os.fsdecode(os.fsencode(folder / name))).write_text("1")


def settings_as(make: Callable[[Path], object]) -> Callable[[Path], object]:
    """A good input whose settings stand under the right name and are something else."""

    def put(folder: Path) -> None:
        name = f"odd{len(list(folder.iterdir()))}"
        (folder / f"{name}.step").write_text("1")
        make(folder / f"{name}.job.toml")

    return put


def chain_of_links(folder: Path) -> None:
    (folder / "chain0.step").write_text("1")
    for number in range(45):
        (folder / f"chain{number + 1}.step").symlink_to(f"chain{number}.step")


def folders_in_circles(folder: Path) -> None:
    (folder / "round").mkdir()
    (folder / "round" / "about").symlink_to(folder / "round")
    (folder / "one").symlink_to("other")
    (folder / "other").symlink_to("one")


def file_below(*names: str) -> Callable[[Path], object]:
    def put(folder: Path) -> None:
        below = folder.joinpath(*names)
        below.mkdir(parents=True)
        (below / "x.step").write_text("1")

    return put


TOGETHER = (
    *(Item(beside(f"bad{i}", text), 1) for i, text in enumerate(SETTINGS_THAT_FAIL)),
    *(Item(beside(f"fine{i}", text), 0) for i, text in enumerate(SETTINGS_THAT_DO)),
    *(Item(write(name), 0) for name in NAMES),
    *(Item(write(name), 1) for name in NAMES_THAT_FAIL),
    Item(settings_as(Path.mkdir), 1, "is a directory"),
    Item(settings_as(lambda path: path.symlink_to("gone")), 1, "No such file"),
    Item(settings_as(lambda path: path.symlink_to(path.name)), 1, "symbolic links"),
    Item(settings_as(lambda path: path.symlink_to("/proc/self/environ")), 1, "more than its size"),
    Item(lambda folder: os.link(folder / "good1.step", folder / "hard.step"), 0),
    Item(lambda folder: (folder / "dangling.step").symlink_to("gone.step"), 0),
    Item(lambda folder: (folder / "to_folder.step").symlink_to("/"), 0),
    Item(lambda folder: (folder / "proc.step").symlink_to("/proc/self/status"), 1, "its size says"),
    Item(chain_of_links, 0),
    Item(folders_in_circles, 0),
    Item(file_below("d" * 200, "e" * 200, "f" * 200), 0),
    Item(file_below("x\x1b[2J\u202e"), 0),
    Item(file_below("..x"), 0),
    # Their outputs would stand in a folder that has the name of a file.
    Item(file_below("index.html"), 1, "File exists"),
    Item(file_below("manifest.jsonl"), 1, "File exists"),
    Item(file_below("batch.log"), 1, "File exists"),
)


@LINUX_ONLY
def test_hostile_items_side_by_side_each_cost_themselves(bench: Bench, tmp_path: Path) -> None:
    bench.put(good1="1", good2="2")
    for item in TOGETHER:
        item.put(bench.inputs)
    check(bench, tmp_path, list(TOGETHER), 5.0)
    assert bench.run(workers=2).done == 0, "what was done is not done again"
    for path in bench.outputs.rglob("*"):
        assert path.resolve().is_relative_to(bench.outputs.resolve())
        assert path.name.isprintable()


def hidden(kind: str, files: dict[str, bytes]) -> Callable[[Path, Path], object]:
    def put(folder: Path, _: Path) -> None:
        aside = folder / f"{kind}{len(list(folder.iterdir()))}"
        aside.mkdir()
        for name, content in files.items():
            (aside / name).write_bytes(content)

    return put


def mark_by(make: Callable[[Path, Path], object]) -> Callable[[Path, Path], object]:
    """A hidden folder with a file of somebody's and a mark that is something else."""

    def put(folder: Path, victim: Path) -> None:
        hidden(PART_PREFIX, {"mine": b"mine"})(folder, victim)
        make(max(folder.glob(f"{PART_PREFIX}*"), key=lambda path: path.stat().st_ctime_ns), victim)

    return put


def claim(name: str, content: bytes) -> bytes:
    """The record of a planted folder that claims a file of somebody else."""
    from hashlib import sha256

    own = {"name": name, "bytes": len(content), "sha256": sha256(content).hexdigest()}
    texts = ("input_sha256", "settings_sha256")
    record = {"schema": 1, "key": "good1", "input": "good1.step", **dict.fromkeys(texts, "")}
    return json.dumps({**record, "outcome": "done", "outputs": [own]}).encode()


PLANTED: dict[str, Callable[[Path, Path], object]] = {
    "no mark": hidden(PART_PREFIX, {"mine": b"mine"}),
    "a mark of somebody": hidden(PART_PREFIX, {MARK_NAME: b"hello", "mine": b"mine"}),
    "a torn mark": hidden(PART_PREFIX, {MARK_NAME: MARK[:10], "mine": b"mine"}),
    "no record": hidden(READY_PREFIX, {"good1.dxf": b"mine"}),
    "a pipe for a mark": mark_by(lambda aside, _: os.mkfifo(aside / MARK_NAME)),
    "a folder for a mark": mark_by(lambda aside, _: (aside / MARK_NAME).mkdir()),
    "a link for a mark": mark_by(lambda aside, victim: (aside / MARK_NAME).symlink_to(victim)),
    "a file of that name": lambda folder, _: (folder / f"{PART_PREFIX}f").write_bytes(MARK),
    "a link of that name": lambda folder, victim: (folder / f"{PART_PREFIX}l").symlink_to(
        victim.parent
    ),
    "an earlier output of somebody": lambda folder, _: (folder / "good1.dxf.outdated").write_text(
        "mine"
    ),
}


@LINUX_ONLY
def test_what_is_planted_beside_the_outputs_stays_as_it_is(bench: Bench, tmp_path: Path) -> None:
    fence = tmp_path / "fence"
    fence.mkdir()
    victim = fence / "victim"
    victim.write_bytes(MARK)
    bench.put(good1="1", good2="2")
    bench.outputs.mkdir()
    for put in PLANTED.values():
        put(bench.outputs, victim)
    before = {**fingerprint(fence), **fingerprint(bench.outputs)}
    assert (bench.run(workers=2).done, bench.run().skipped) == (2, 2)
    after = {**fingerprint(fence), **fingerprint(bench.outputs)}
    assert {name: after.get(name) for name in before} == before


@LINUX_ONLY
def test_a_planted_folder_with_our_mark_takes_nobodys_file(bench: Bench, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("somebody's")
    bench.put(good1="1")
    bench.outputs.mkdir()
    (bench.outputs / "mine.txt").write_text("mine")
    claimed = {MARK_NAME: MARK, "mine.txt": b"new", RECORD_NAME: claim("mine.txt", b"new")}
    hidden(READY_PREFIX, claimed)(bench.outputs, victim)
    linked = bench.outputs / f"{PART_PREFIX}links"
    linked.mkdir()
    (linked / MARK_NAME).write_bytes(MARK)
    (linked / "link").symlink_to(tmp_path)
    (linked / "below").mkdir()
    (linked / "below" / "link").symlink_to(tmp_path)
    os.link(victim, linked / "second")
    assert bench.run().done == 1
    assert (bench.outputs / "mine.txt").read_text() == "mine"
    assert victim.read_text() == "somebody's"
    assert not list(bench.outputs.glob(".wrinkle_cad-*"))

"""summary.csv and index.html: complete, escaped, sorted."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from tests.batch.folder.test_manifest import RECORD
from wrinkle_cad.batch.folder.events import BatchSummary
from wrinkle_cad.batch.folder.index_page import index_page, write_index_page
from wrinkle_cad.batch.folder.manifest import OutputFile
from wrinkle_cad.batch.folder.summary_table import safe_cell, write_summary_table

SUMMARY = BatchSummary(
    folder=Path("out"), done=2, failed=1, skipped=0, left=0, missed_limits=0, seconds=1.0
)
FAILED = replace(
    RECORD, key="f", input="f.step", outcome="failed", outputs=(), figures={}, message="bad, x"
)


def done(name: str, developability: float) -> object:
    return replace(
        RECORD,
        key=name,
        input=f"{name}.step",
        outputs=(OutputFile(f"{name}.step", 1, ""), OutputFile(f"{name}.html", 1, "")),
        figures={"developability": developability, "invalid_bridges": 3, "overlaps": False},
    )


class Page(HTMLParser):
    """The rows of a page: text and link of each."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[str] = []
        self.links: list[str] = []
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "tr":
            self.rows.append("")
        if tag == "a":
            self.links.append(dict(attributes)["href"] or "")

    def handle_data(self, text: str) -> None:
        if self.rows:
            self.rows[-1] += text


def test_the_page_lists_the_most_developable_first_and_failures_last() -> None:
    page = Page(index_page([FAILED, done("worse", 10.0), done("better", 99.0)], SUMMARY))  # type: ignore[list-item]
    assert [row.split(".step")[0] for row in page.rows[1:]] == ["better", "worse", "f"]
    assert page.links == ["better.html", "worse.html"]
    assert "failed: bad, x" in page.rows[-1]


@pytest.mark.parametrize(
    "name", ["<script>alert(1)</script>", "a\"b'c&d", "x\ny\x1b", "a b#c?d%e", "\udcff", "{0}"]
)
def test_names_and_messages_stay_text(name: str, tmp_path: Path) -> None:
    hostile = replace(done("x", 1.0), key=f"{name}/x", input=name, message=name)  # type: ignore[type-var]
    failed = replace(FAILED, input=name, message=name)
    write_index_page(tmp_path, [hostile, failed], SUMMARY)
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    plain = Page(index_page([done("x", 1.0), FAILED], SUMMARY))  # type: ignore[list-item]
    assert Page(text).tags == plain.tags
    if "\udcff" not in name:
        assert unquote(Page(text).links[0]) == f"{name}/x.html".replace("\n", "\n")


def test_the_table_has_a_row_for_each_record(tmp_path: Path) -> None:
    write_summary_table(tmp_path, [done("x", 98.5), FAILED])  # type: ignore[list-item]
    with (tmp_path / "summary.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["input"] for row in rows] == ["x.step", "f.step"]
    assert float(rows[0]["developability"]) == 98.5
    assert rows[0]["overlaps"] == "no"
    assert rows[1]["message"] == "bad, x"


@pytest.mark.parametrize(
    "text", ["=cmd()", "+1", "-1", "@x", "\t=1", "\r=1", "\uff1d1", "\uff0b", "\uff0d", "\uff20"]
)
def test_no_cell_is_a_formula(text: str, tmp_path: Path) -> None:
    write_summary_table(tmp_path, [replace(FAILED, input=text, message=text)])
    content = (tmp_path / "summary.csv").read_text(encoding="utf-8-sig")
    for cell in next(csv.reader(content.splitlines()[1:])):
        assert not cell.startswith(("=", "+", "-", "@", "\t", "\r", "\uff1d", "\uff0b"))
    assert not str(safe_cell(text)).startswith(text[0])


def test_a_number_stays_a_number() -> None:
    assert safe_cell(-1.5) == -1.5
    assert safe_cell("a-1") == "a-1"


def test_a_piece_is_drawn_from_the_outline_alone() -> None:
    drawn = replace(RECORD, figures={"outline": "0,0 40.5,0 40.5,10 0,12"})
    page = index_page([drawn], SUMMARY)
    assert 'points="0,12 40.5,12 40.5,2 0,0"' in page
    for hostile in ('0,0 1,1"><script>', "0,0 1,1", "nan,0 1,1 2,2", "1e5,0 1,1 2,2", ""):
        assert "polygon points" not in index_page(
            [replace(RECORD, figures={"outline": hostile})], SUMMARY
        )


def test_failures_stand_together_by_cause_with_what_helps() -> None:
    late = replace(FAILED, input="g.step", error="TimeLimit", message="The time was up")
    damaged = [
        replace(FAILED, input=f"{at}.step", error="InputError", message="no curves") for at in "ab"
    ]
    page = index_page([late, *damaged, done("x", 1.0)], SUMMARY)  # type: ignore[list-item]
    first, second = page.split("<details")[1:]
    assert "cannot be used: 2<" in first
    assert "a.step: no curves" in first
    assert "b.step: no curves" in first
    assert "was up: 1<" in second
    assert "Give more with --timeout" in second
    assert "x.step" not in first + second.partition("<table")[0]


def test_a_file_is_found_by_its_state_and_by_pass_or_fail() -> None:
    kinds = {"developability": 90.0, "state": "creased", "limits": 2}
    missed = replace(RECORD, figures=kinds, missed_limits=("a crease",))
    passed = replace(RECORD, input="p.step", figures=kinds, missed_limits=())
    page = index_page([missed, passed, FAILED], SUMMARY)
    assert re.findall('<tr data-kinds="([^"]*)"', page) == [
        "creased passed", "creased missed", "failed",
    ]  # fmt: skip
    assert re.findall('data-choice="([^"]*)"', page) == ["creased", "passed", "missed", "failed"]

"""The methods of the paper side by side."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.report.pages import PageReader
from tests.report.strips import cylinder_rails, wavy_rails
from wrinkle_cad.errors import InputError
from wrinkle_cad.report.compare import (
    METHODS,
    Comparison,
    compare,
    comparison_summary,
    write_comparison_page,
)
from wrinkle_cad.report.numbers import Numbers
from wrinkle_cad.strip.triangulation import triangulate

NAMES = ["LODT+LMBT", "GODT+GMBT", "LMBT", "GMBT", "GMAT"]


@pytest.fixture(scope="module")
def rows() -> dict[str, Comparison]:
    return {row.method: row for row in compare(*wavy_rails(60, 67))}


def test_every_method_has_its_row(rows: dict[str, Comparison]) -> None:
    assert list(rows) == NAMES
    assert [method[0] for method in METHODS] == NAMES
    assert {row.bridges for row in rows.values()} == {124}


def test_each_global_method_is_best_at_what_it_looks_for(rows: dict[str, Comparison]) -> None:
    best = rows["GODT+GMBT"]
    assert best.valid_bridges == max(row.valid_bridges for row in rows.values())
    assert rows["GMBT"].bending <= min(row.bending for row in rows.values()) * (1 + 1e-12)
    assert rows["GMAT"].area_mm2 <= min(row.area_mm2 for row in rows.values()) * (1 + 1e-12)


def test_a_row_says_what_the_triangulation_says(rows: dict[str, Comparison]) -> None:
    strip = triangulate(*wavy_rails(60, 67), criteria=("area",))
    row = rows["GMAT"]
    assert row.area_mm2 == strip.area
    assert row.bending == strip.bending
    assert row.valid_bridges == strip.interior_count - strip.invalid_count
    assert row.max_fold_deg == pytest.approx(np.degrees(np.abs(strip.fold).max()))
    assert row.seconds > 0.0


def test_on_a_developable_strip_developable_methods_agree() -> None:
    rows = {row.method: row for row in compare(*cylinder_rails(40, 44))}
    assert rows["GODT+GMBT"].valid_bridges == rows["GODT+GMBT"].bridges


def test_a_rail_that_cannot_be_used_is_refused() -> None:
    with pytest.raises(InputError):
        compare(np.zeros((1, 3)), np.zeros((5, 3)))


def test_the_page_shows_the_numbers_of_the_json(rows: dict[str, Comparison]) -> None:
    hostile = "<script>alert(1)</script>"
    summary = comparison_summary({hostile: tuple(rows.values())}, file="lace & co.step")
    summary = json.loads(json.dumps(summary))
    reader = PageReader(write_comparison_page(summary))
    stored = Numbers(summary)
    shown = reader.all("data")
    assert len(shown) == 6 * len(NAMES)
    for part in shown:
        value = json.loads(part.attributes["value"] or "")
        assert value == stored.get(part.attributes["data-path"] or "")
    bold = [part for part in shown if part.parents[-1] == "b"]
    best = {(part.attributes["data-path"] or "").split("/")[-1] for part in bold}
    assert best == {"valid_bridges", "bending", "area_mm2", "max_fold_deg"}
    assert not reader.all("script")
    assert [part.text for part in reader.all("h2")] == [hostile]
    assert [part.text for part in reader.all("h1")] == ["lace & co.step"]

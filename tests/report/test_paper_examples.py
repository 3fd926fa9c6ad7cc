"""The examples of the kind of the paper's show what the paper's show."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wrinkle_cad.report.compare import Comparison
from wrinkle_cad.strip import triangulate
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

FOLDER = Path(__file__).parents[2] / "shoe_examples" / "paper_examples"


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    return runpy.run_path(str(FOLDER / "table.py"))


@pytest.fixture(scope="module")
def strips(script: dict[str, Any]) -> dict[str, WrinkleStrip]:
    return {name: script["make_strip"](name) for name in script["NAMES"]}


@pytest.fixture(scope="module")
def rows(
    script: dict[str, Any], strips: dict[str, WrinkleStrip]
) -> dict[str, dict[str, Comparison]]:
    return {name: script["methods_of"](strip) for name, strip in strips.items()}


@pytest.mark.parametrize(
    ("name", "bridges"),
    # The paper gives no number for its first example.
    [("example_1", 71), ("example_2", 225), ("example_3", 126)],
)
def test_the_examples_have_the_papers_numbers_of_bridges(
    strips: dict[str, WrinkleStrip], name: str, bridges: int
) -> None:
    assert len(strips[name].triangulation.bridges) == bridges


def test_on_the_easy_strip_both_searches_find_the_same(strips: dict[str, WrinkleStrip]) -> None:
    strip = strips["example_1"]
    samples = strip.triangulation
    best = triangulate(samples.p, samples.q, planarity=samples.planarity, price=None)
    assert np.array_equal(best.steps, strip.local.steps)


def test_on_the_lace_the_global_search_finds_many_more_valid_bridges(
    rows: dict[str, dict[str, Comparison]],
) -> None:
    lace = rows["example_2"]
    assert lace["GODT+GMBT"].valid_bridges >= 1.3 * lace["LODT+LMBT"].valid_bridges


def test_least_area_ruins_developability(rows: dict[str, dict[str, Comparison]]) -> None:
    third = rows["example_3"]
    assert third["GODT+GMBT"].valid_bridges > 4 * third["GMAT"].valid_bridges
    assert third["GODT+GMBT"].area_mm2 > 1.01 * third["GMAT"].area_mm2


def test_the_local_search_for_least_bending_costs_several_times_the_global_one(
    rows: dict[str, dict[str, Comparison]],
) -> None:
    third = rows["example_3"]
    assert 3.0 < third["LMBT"].bending / third["GMBT"].bending < 3.7


def test_the_table_shows_both_the_papers_figures_and_ours(
    script: dict[str, Any],
    strips: dict[str, WrinkleStrip],
    rows: dict[str, dict[str, Comparison]],
) -> None:
    lines = list(script["table_lines"](strips))
    assert [line.count("|") for line in lines] == [5] * 7
    assert "113 against 149 of 225" in lines[3]
    assert "95 against 21 of 126" in lines[4]
    lace = rows["example_2"]
    ours = [int(number) for number in re.findall(r"\d+", lines[3].split("|")[4])]
    assert ours == [lace["LODT+LMBT"].valid_bridges, lace["GODT+GMBT"].valid_bridges, 225]


def test_the_step_files_are_those_that_the_script_builds(
    strips: dict[str, WrinkleStrip],
) -> None:
    build = runpy.run_path(str(FOLDER / "build.py"))
    for name, rails in build["all_rails"]().items():
        again = [build["spline"](points, "") for points in rails]
        stored = strips[name]
        assert again[0].length == pytest.approx(stored.p.length, rel=1e-9)
        assert again[1].length == pytest.approx(stored.q.length, rel=1e-9)


def test_the_picture_is_drawn(
    script: dict[str, Any], strips: dict[str, WrinkleStrip], tmp_path: Path
) -> None:
    from PIL import Image

    script["draw"](strips, tmp_path / "again.png")
    with (
        Image.open(tmp_path / "again.png") as again,
        Image.open(FOLDER / "paper_examples.png") as stored,
    ):
        assert again.size == stored.size
        assert len(again.convert("L").histogram()) - again.convert("L").histogram().count(0) > 50

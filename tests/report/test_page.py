"""The page as text: whole, self-contained, escaped, its numbers those of the JSON."""

from __future__ import annotations

import copy
import json
import re
from base64 import b64encode
from hashlib import sha256
from importlib.resources import files
from typing import Any

import numpy as np
import pytest

from tests.report.pages import PageReader
from tests.report.strips import (
    cylinder_rails,
    dome,
    planar_rails,
    summary_of,
    view_of,
    wavy_rails,
)
from wrinkle_cad.errors import InputError
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.material import Material
from wrinkle_cad.report.numbers import Numbers, written
from wrinkle_cad.report.page import write_page
from wrinkle_cad.report.verdict import judge
from wrinkle_cad.report.views import MeshView, StripView

HOSTILE = (
    "</script><script>window.pwned=1</script><img src=x onerror='window.pwned=1'>&\"\x00\ud800"
)

# Of the files in the npm package three@0.180.0.
RELEASED = {
    "three.core.min.js": "61ba0df005b05991361d040d8ff670e1aadfd0ce7aeebd1fdb0725957a8957de",
    "three.module.min.js": "e2b5ee6bccd38fd6d8a2428546b83c5f2426d84b152ef82be8055556e3b40eb6",
    "OrbitControls.js": "b97879c748170baadeb3fb84cea1ffdf4674e283dc06042f34e2acb95a76042c",
    "LICENSE": "bfe119ea4fd413f5f7ca3fcd63adb0c4a073ed39daa2fe7d3e6b769e21272601",
}


@pytest.fixture(scope="module")
def bad_view() -> StripView:
    return view_of(wavy_rails())


@pytest.fixture(scope="module")
def good_view() -> StripView:
    return view_of(cylinder_rails())


@pytest.fixture(scope="module")
def bad_page(bad_view: StripView) -> tuple[dict[str, Any], str]:
    summary = summary_of([bad_view], Limits(max_fold_deg=1.0))
    return summary, write_page(summary, [bad_view], dome(40))


def shown_numbers(html: str) -> list[tuple[str, str, str]]:
    """Path, exact value and text of every number on a page, checked to be well formed."""
    parts = PageReader(html).all("data")
    for part in parts:
        digits = part.attributes["data-digits"]
        value = json.loads(part.attributes["value"] or "")
        unit = part.attributes["data-unit"] or ""
        assert part.text == written(value, unit, int(digits) if digits else None)
    return [
        (str(part.attributes["data-path"]), str(part.attributes["value"]), part.text)
        for part in parts
    ]


def unequal_numbers(html: str, summary: dict[str, Any]) -> list[str]:
    stored = Numbers(json.loads(json.dumps(summary)))
    return [
        path
        for path, value, _ in shown_numbers(html)
        if stored.get(path) is None or json.loads(value) != stored.get(path)
    ]


def test_every_number_on_the_page_is_the_one_in_the_json(
    bad_page: tuple[dict[str, Any], str],
) -> None:
    summary, html = bad_page
    assert len(shown_numbers(html)) > 40
    assert unequal_numbers(html, summary) == []


def test_the_comparison_of_numbers_fails_when_one_differs(
    bad_page: tuple[dict[str, Any], str],
) -> None:
    summary, html = bad_page
    changed = copy.deepcopy(summary)
    changed["strips"][0]["bending"] += 1e-9
    assert set(unequal_numbers(html, changed)) == {"/strips/0/bending"}


def test_no_number_of_a_strip_stands_on_the_page_without_its_path(
    bad_page: tuple[dict[str, Any], str],
) -> None:
    _, html = bad_page
    loose = [
        part.text
        for part in PageReader(html).parts
        if "main" in part.parents
        and part.tag in ("td", "dd", "small")
        and re.search(r"\d", part.text)
        and part.attributes.get("class") not in ("name", "text")
        and "0.1.0" not in part.text
        and "2.1.0" not in part.text
    ]
    assert loose == []


def test_the_embedded_json_is_the_summary(bad_page: tuple[dict[str, Any], str]) -> None:
    summary, html = bad_page
    assert json.loads(PageReader(html).by_id("summary").text) == json.loads(json.dumps(summary))


def test_the_verdict_stands_at_the_top_with_the_missed_limit(
    bad_page: tuple[dict[str, Any], str],
) -> None:
    summary, html = bad_page
    texts = [part.text for part in PageReader(html).parts if "main" in part.parents]
    verdict = summary["verdict"]
    assert verdict["headline"] in texts[:8]
    assert "FAIL" in texts
    assert verdict["reasons"][0] in texts


def test_without_limits_nothing_is_passed_or_refused(good_view: StripView) -> None:
    html = write_page(summary_of([good_view]), [good_view])
    texts = " ".join(part.text for part in PageReader(html).parts if "main" in part.parents)
    assert "PASS" not in texts
    assert "FAIL" not in texts
    assert "No limits were given" in texts


def test_the_page_asks_for_nothing_from_outside(bad_page: tuple[dict[str, Any], str]) -> None:
    for part in PageReader(bad_page[1]).parts:
        for name in ("src", "href", "action", "data", "poster", "srcset"):
            assert part.attributes.get(name) in (None, "data:,"), part
    assert "@import" not in bad_page[1]
    assert not re.search(r"url\(\s*['\"]?https?:", bad_page[1])


def test_text_from_the_file_stays_text(good_view: StripView) -> None:
    hostile = StripView(
        HOSTILE, good_view.triangulation, good_view.unrolling, good_view.pieces, good_view.valid,
        good_view.local, good_view.least_bending,
    )  # fmt: skip
    finding = {"code": HOSTILE, "severity": "warning", "message": HOSTILE}
    summary = summary_of(
        [hostile, hostile],
        Limits(max_fold_deg=0.1).of(Material(name=HOSTILE)),
        input={"file": HOSTILE, "unit": HOSTILE},
        findings=[finding],
        settings={"name": HOSTILE, HOSTILE: 1.0},
    )
    body = MeshView(HOSTILE, dome(5).vertices, dome(5).faces)
    reader = PageReader(write_page(summary, [hostile, hostile], body))
    assert not reader.all("img")
    harmless = write_page(summary_of([good_view, good_view]), [good_view, good_view], dome(5))
    assert len(reader.all("script")) == len(PageReader(harmless).all("script"))
    (title,) = reader.all("h1")
    assert title.text.startswith("</script><script>window.pwned=1")
    assert "\x00" not in title.text


def test_the_hostile_page_can_be_encoded(good_view: StripView) -> None:
    summary = summary_of([good_view], input={"file": HOSTILE})
    assert write_page(summary, [good_view]).encode("utf-8")


def test_the_page_is_the_same_every_time(
    bad_page: tuple[dict[str, Any], str], bad_view: StripView
) -> None:
    summary, html = bad_page
    assert write_page(summary, [bad_view], dome(40)) == html


def test_a_strip_of_500_triangles_with_its_upper_stays_below_3_mb() -> None:
    view = view_of(wavy_rails(250, 252))
    assert len(view.triangulation.triangles) == 500
    upper = dome(160)
    html = write_page(summary_of([view]), [view], upper)
    assert len(upper.faces) > 50_000
    assert len(html.encode()) <= 3_000_000


def test_a_flat_strip_has_no_price_and_no_bend_radius() -> None:
    view = view_of(planar_rails())
    summary = summary_of([view])
    html = write_page(summary, [view])
    assert summary["verdict"]["strips"][0]["price_of_developability"] is None
    assert not [path for path, *_ in shown_numbers(html) if "price" in path]
    assert "NaN" not in html.split('id="summary"')[1].split("</script>")[0]
    assert "Infinity" not in html.split('id="summary"')[1].split("</script>")[0]


def test_a_strip_without_a_matrix_or_pieces_still_has_a_page(good_view: StripView) -> None:
    bare = StripView("bare", good_view.triangulation, good_view.unrolling)
    full = summary_of([good_view])
    html = write_page(full, [bare])
    texts = " ".join(part.text for part in PageReader(html).parts)
    assert "too large to be drawn" in texts


def test_faces_beyond_the_vertices_are_refused(good_view: StripView) -> None:
    body = MeshView("upper", np.zeros((3, 3), np.float32), np.array([[0, 1, 3]], np.int32))
    with pytest.raises(InputError, match=r"faces of a body use vertices 0 to 3, and it has 3"):
        write_page(summary_of([good_view]), [good_view], body)


def test_the_licence_of_the_viewer_is_on_the_page(bad_page: tuple[dict[str, Any], str]) -> None:
    licence = PageReader(bad_page[1]).by_id("three-licence").text
    assert sha256(licence.encode()).hexdigest() == RELEASED["LICENSE"]


def test_the_viewer_is_shipped_as_it_was_released() -> None:
    folder = files("wrinkle_cad.report").joinpath("page", "three")
    shipped = {file.name: sha256(file.read_bytes()).hexdigest() for file in folder.iterdir()}
    del shipped["README.md"]
    assert shipped == RELEASED


def test_the_page_holds_the_viewer_as_it_was_released(bad_page: tuple[dict[str, Any], str]) -> None:
    library = json.loads(PageReader(bad_page[1]).by_id("library").text)
    held = {name.split("/")[-1]: sha256(text.encode()).hexdigest() for name, text in library}
    assert held == {
        "three.core.min.js": RELEASED["three.core.min.js"],
        "three": RELEASED["three.module.min.js"],
        "OrbitControls.js": RELEASED["OrbitControls.js"],
    }


def test_the_page_says_who_made_it(bad_page: tuple[dict[str, Any], str]) -> None:
    assert '<meta name="generator" content="wrinkle_cad' in bad_page[1]


def test_all_tables_of_a_stitched_job_are_there(good_view: StripView) -> None:
    stitch = {
        "free_edges_before": 12,
        "free_edges_after": 3,
        "max_edge_tolerance_mm": 2.1e-5,
        "area_balance_mm2": 0.0012,
        "is_valid": True,
        "seams": [
            {"seam": HOSTILE, "length_mm": 12.5, "mean_deg": 20.1, "largest_deg": 44.4},
        ],
    }
    summary = summary_of([good_view], stitch=stitch)
    html = write_page(summary, [good_view])
    titles = [part.text for part in PageReader(html).all("h2")]
    assert titles == [
        "In space", "Validity matrix", "Along the strip", "Flat pattern", "Findings", "Strips",
        "Seams and areas", "Sewn to the body", "Angles at the seams", "Versions", "Seconds",
        "Settings",
    ]  # fmt: skip
    assert unequal_numbers(html, summary) == []


@pytest.mark.parametrize(
    ("value", "unit", "digits", "text"),
    [
        (1104, "", None, "1,104"),
        (0.0, "°", 2, "0°"),
        (-0.0004, "mm", 3, "0\N{NO-BREAK SPACE}mm"),
        (-1.5, "mm", 3, "\N{MINUS SIGN}1.500\N{NO-BREAK SPACE}mm"),
        (12345.678, "mm²", 1, "12,345.7\N{NO-BREAK SPACE}mm²"),
        (2.1e-5, "", None, "2.1e-05"),
        (41783.77, "mm²", None, "41,784\N{NO-BREAK SPACE}mm²"),
        (999.96, "", None, "1000"),
    ],
)
def test_numbers_read_as_people_write_them(
    value: float, unit: str, digits: int | None, text: str
) -> None:
    assert written(value, unit, digits) == text


def test_of_several_strips_the_worst_gives_the_key_figures(
    bad_view: StripView, good_view: StripView
) -> None:
    views = [good_view, bad_view]
    html = write_page(summary_of(views), views)
    assert "Worst wrinkle: vamp wrinkle" in [part.text for part in PageReader(html).all("h2")]
    tiles = [path for path, *_ in shown_numbers(html)][:4]
    assert tiles[0] == "/strips/1/max_strain_percent"


def test_the_page_lets_only_its_own_scripts_run(good_view: StripView) -> None:
    page = PageReader(write_page(summary_of([good_view]), [good_view]))
    (policy,) = (
        part.attributes["content"] or ""
        for part in page.all("meta")
        if part.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    scripts = [part.text for part in page.all("script") if "type" not in part.attributes]
    digests = [b64encode(sha256(text.encode()).digest()).decode() for text in scripts]
    assert len(digests) > 3
    allowed = policy.partition("script-src ")[2].split()
    assert allowed == [*(f"'sha256-{digest}'" for digest in digests), "blob:"]
    assert "default-src 'none'" in policy
    assert page.parts.index(next(p for p in page.parts if p.tag == "meta")) < page.parts.index(
        page.all("script")[0]
    )


def test_a_good_verdict_on_another_surface_than_the_piece_is_shown_as_unsure(
    good_view: StripView,
) -> None:
    summary = summary_of([good_view])
    assert "card verdict developable" in write_page(summary, [good_view])
    summary["strips"][0]["cut"].update(longer_percent=14.0, differs=True)
    summary["verdict"] = judge(summary["strips"], Limits()).as_json()
    page = write_page(summary, [good_view])
    assert "card verdict unsure" in page
    assert "But the piece that is cut is another surface, up to 14.0% longer" in page

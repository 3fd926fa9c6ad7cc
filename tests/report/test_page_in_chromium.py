"""The page as a person uses it: opened from disk in Chromium, with the network off."""

from __future__ import annotations

import base64
import io
import re
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement

from tests.report.strips import cylinder_rails, dome, planar_rails, summary_of, view_of, wavy_rails
from wrinkle_cad.report.limits import Limits
from wrinkle_cad.report.material import Material
from wrinkle_cad.report.page import write_page
from wrinkle_cad.report.views import StripView

pytestmark = pytest.mark.chromium

VIEWS = ("space", "matrix", "curves", "pattern")
HOSTILE = "</script><script>window.pwned=1</script><img src=x onerror='window.pwned=1'>"
PATIENCE = 15.0


def until(holds: Callable[[], Any], what: str) -> Any:
    """Waits for a page to get somewhere."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        value = holds()
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"after {PATIENCE} s: {what}")


def without_policy(html: str) -> str:
    """The page for a test that changes or adds a script, which its policy would not let run."""
    shorter = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", html)
    assert shorter != html
    return shorter


def canvas(browser: webdriver.Chrome, name: str) -> WebElement:
    return browser.find_element(By.CSS_SELECTOR, f".current canvas.{name}, .stage canvas.{name}")


def open_page(
    browser: webdriver.Chrome,
    path: Path,
    html: str,
    *,
    width: int = 1280,
    height: int = 900,
    dark: bool = False,
    views: tuple[str, ...] = VIEWS,
) -> None:
    path.write_text(html, encoding="utf-8")
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    browser.get_log("browser")
    browser.get(path.as_uri())
    for name in views:
        until(lambda name=name: canvas(browser, name).get_attribute("data-drawn"), f"{name} drawn")


def errors(browser: webdriver.Chrome) -> list[str]:
    return [line["message"] for line in browser.get_log("browser") if line["level"] == "SEVERE"]


def picture(browser: webdriver.Chrome, name: str) -> NDArray[np.uint8]:
    script = "return document.querySelector(arguments[0]).toDataURL('image/png')"
    selector = f".current canvas.{name}, .stage canvas.{name}"
    data = browser.execute_script(script, selector).split(",")[1]
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGBA"))


def is_blank(image: NDArray[np.uint8]) -> bool:
    """Whether less than one pixel in two hundred is drawn in another color than the corner."""
    return bool((image != image[0, 0]).any(axis=2).mean() < 0.005)


def point_at(browser: webdriver.Chrome, element: WebElement, x: float, y: float) -> None:
    """Moves the pointer to shares of an element's width and height."""
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", element)
    size = element.size
    offset = (round((x - 0.5) * size["width"]), round((y - 0.5) * size["height"]))
    ActionChains(browser, duration=0).move_to_element_with_offset(element, *offset).perform()


def highlights(browser: webdriver.Chrome) -> dict[str, str | None]:
    return {name: canvas(browser, name).get_attribute("data-highlight") for name in VIEWS}


def agreed_highlight(browser: webdriver.Chrome) -> str | None:
    """The bridge that all views highlight."""
    found = set(highlights(browser).values())
    return found.pop() if len(found) == 1 else None


@pytest.fixture(scope="module")
def strip() -> StripView:
    return view_of(wavy_rails())


@pytest.fixture(scope="module")
def html(strip: StripView) -> str:
    return write_page(summary_of([strip], Limits(max_fold_deg=5.0)), [strip], dome(60))


@pytest.fixture
def page(browser: webdriver.Chrome, tmp_path: Path, html: str) -> webdriver.Chrome:
    open_page(browser, tmp_path / "vamp.html", html)
    return browser


def test_the_page_opens_without_errors(page: webdriver.Chrome) -> None:
    assert errors(page) == []
    assert page.execute_script("return navigator.onLine") is False


def test_an_error_on_the_page_would_be_seen(
    browser: webdriver.Chrome, tmp_path: Path, html: str
) -> None:
    broken = html.replace("Report.space = ", "Report.nowhere = ", 1)
    path = tmp_path / "broken.html"
    path.write_text(broken, encoding="utf-8")
    browser.get(path.as_uri())
    until(lambda: "3-D view" in " ".join(errors(browser)), "an error in the log")
    failure = browser.find_element(By.CSS_SELECTOR, ".stage .failure")
    assert failure.is_displayed()


@pytest.mark.parametrize(
    ("working", "failing", "reason"),
    [
        # A browser that does not know import() cannot read the script that says it.
        ("=> import(url)", "=> import @ (url)", "it cannot load modules"),
        ("=> import(url)", "=> Promise.reject(new Error('no blobs'))", "no blobs"),
        ("import{Matrix3 as", "import{Matrix33 as", "Matrix33"),
    ],
)
def test_without_its_library_only_the_3d_view_is_missing(
    browser: webdriver.Chrome, tmp_path: Path, html: str, working: str, failing: str, reason: str
) -> None:
    assert html.count(working) == 1
    broken = without_policy(html).replace(working, failing)
    flat = tuple(name for name in VIEWS if name != "space")
    open_page(browser, tmp_path / "old.html", broken, views=flat)
    failure = browser.find_element(By.CSS_SELECTOR, ".stage .failure")
    until(failure.is_displayed, "the failure told")
    assert failure.text.startswith("The 3-D view could not start in this browser: ")
    assert reason in failure.text
    point_at(browser, canvas(browser, "curves"), 0.5, 0.3)
    for name in flat:
        assert not is_blank(picture(browser, name))
        until(lambda name=name: canvas(browser, name).get_attribute("data-highlight"), name)


def test_a_bridge_chosen_before_the_3d_view_starts_is_lit_in_it(
    browser: webdriver.Chrome, tmp_path: Path, html: str
) -> None:
    start = "const library = Report.library"
    assert html.count(start) == 1
    early = without_policy(html).replace(start, f"Report.select(Report.strips[0], 7); {start}")
    open_page(browser, tmp_path / "early.html", early)
    assert agreed_highlight(browser) == "7"


@pytest.mark.parametrize("name", VIEWS)
def test_every_view_draws(page: webdriver.Chrome, name: str) -> None:
    assert not is_blank(picture(page, name))


def test_a_3d_view_without_layers_is_blank(page: webdriver.Chrome) -> None:
    before = picture(page, "space")
    for box in page.find_elements(By.CSS_SELECTOR, "[data-layer]"):
        box.click()
    until(lambda: is_blank(picture(page, "space")), "an empty 3-D view")
    assert not is_blank(before)


def test_the_3d_view_turns_zooms_and_returns(page: webdriver.Chrome) -> None:
    stage = canvas(page, "space")
    start = picture(page, "space")
    ActionChains(page, duration=50).drag_and_drop_by_offset(stage, 120, 40).perform()
    turned = until(
        lambda: (
            (now := picture(page, "space")).shape == start.shape
            and (now != start).any()
            and now.tobytes()
        ),
        "a turned view",
    )
    page.execute_script(
        "arguments[0].focus(); arguments[0].dispatchEvent(new WheelEvent('wheel',"
        " {deltaY: -400, bubbles: true, cancelable: true}))",
        stage,
    )
    until(lambda: picture(page, "space").tobytes() != turned, "a nearer view")
    look_from(page, "whole")
    until(lambda: (picture(page, "space") != start).any(axis=2).mean() < 0.02, "the first view")


def look_from(page: webdriver.Chrome, name: str) -> None:
    page.find_element(By.CSS_SELECTOR, f"[data-view={name}]").click()


def color_by(page: webdriver.Chrome, name: str) -> None:
    page.execute_script(f"document.querySelector('[name=color-by][value={name}]').click()")


def test_the_strips_are_seen_from_each_standpoint(page: webdriver.Chrome) -> None:
    seen = {picture(page, "space").tobytes()}
    for name in ("strips", "top", "front", "side"):
        look_from(page, name)
        until(lambda: picture(page, "space").tobytes() not in seen, f"another view: {name}")
        image = picture(page, "space")
        assert not is_blank(image)
        edge = np.concatenate((image[0], image[-1], image[:, 0], image[:, -1]))
        if name != "strips":
            assert not edge[:, 3].any(), f"{name}: something is cut off by the view's edge"
        seen.add(image.tobytes())


def test_the_surfaces_are_shown_as_leather(
    browser: webdriver.Chrome, tmp_path: Path, html: str
) -> None:
    page = browser
    open_page(page, tmp_path / "leather.html", html, width=420, height=500)
    before = picture(page, "space")
    color_by(page, "leather")
    until(lambda: picture(page, "space").tobytes() != before.tobytes(), "leather")
    image = picture(page, "space").astype(int)
    drawn = image[..., 3] > 250
    # Brown: red above green above blue; and grained: no two neighbours are of the same tone.
    assert (image[drawn][:, 0] > image[drawn][:, 2] + 10).mean() > 0.8
    assert not strip_pixels(before)[~drawn].any()
    assert errors(page) == []
    color_by(page, "state")
    until(lambda: picture(page, "space").tobytes() == before.tobytes(), "the verdict again")


def test_bands_are_part_of_the_body_until_they_are_asked_for(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    views = [view_of(wavy_rails(), "wrinkle"), view_of(cylinder_rails(), "band", role="band")]
    open_page(browser, tmp_path / "bands.html", write_page(summary_of(views), views, dome(20)))
    titles = [box.text for box in browser.find_elements(By.CSS_SELECTOR, "label:has([data-layer])")]
    assert titles == ["wrinkle", "Bands", "Bridges", "Rails", "upper"]
    color_by(browser, "fold")
    wrinkle = np.degrees(np.abs(views[0].triangulation.fold).max())
    band = np.degrees(np.abs(views[1].triangulation.fold).max())

    def high() -> float:
        return float(browser.find_element(By.CSS_SELECTOR, ".legend .high").text.rstrip("°"))

    assert high() == pytest.approx(wrinkle, abs=0.06)
    plain = picture(browser, "space")
    browser.find_element(By.CSS_SELECTOR, "[data-layer=bands]").click()
    until(lambda: (picture(browser, "space") != plain).any(), "the bands in color")
    assert high() == pytest.approx(max(wrinkle, band), abs=0.06)


@pytest.mark.parametrize("measure", ["fold", "twist"])
def test_bridges_are_colored_by_what_is_chosen(
    page: webdriver.Chrome, strip: StripView, measure: str
) -> None:
    before = picture(page, "space")
    color_by(page, measure)
    until(lambda: (picture(page, "space") != before).any(axis=2).mean() > 0.005, "other colors")
    high = page.find_element(By.CSS_SELECTOR, ".legend .high").text
    drawn = strip.triangulation
    angles = drawn.fold if measure == "fold" else drawn.twist
    assert float(high.rstrip("°")) == pytest.approx(np.degrees(np.abs(angles).max()), abs=0.06)


@pytest.mark.parametrize(
    ("name", "x", "y"), [("matrix", 0.55, 0.45), ("curves", 0.5, 0.3), ("pattern", 0.5, 0.5)]
)
def test_pointing_at_a_bridge_lights_it_in_every_view(
    page: webdriver.Chrome, name: str, x: float, y: float
) -> None:
    before = {view: picture(page, view) for view in VIEWS}
    point_at(page, canvas(page, name), x, y)
    until(lambda: agreed_highlight(page), "the same bridge in every view")
    for view in VIEWS:
        until(lambda view=view: (picture(page, view) != before[view]).any(), f"a change of {view}")
    line = page.find_element(By.CSS_SELECTOR, ".space-panel .readout").text
    assert line.startswith(f"vamp wrinkle: bridge {agreed_highlight(page)} of ")


def test_pointing_at_the_strip_in_space_lights_the_other_views(page: webdriver.Chrome) -> None:
    before = {view: picture(page, view) for view in VIEWS}
    stage = canvas(page, "space")
    drawn = np.argwhere(strip_pixels(before["space"]))
    y, x = drawn[len(drawn) // 2] / before["space"].shape[:2]
    point_at(page, stage, float(x), float(y))
    until(lambda: agreed_highlight(page), "the same bridge in every view")
    for view in VIEWS:
        until(lambda view=view: (picture(page, view) != before[view]).any(), f"a change of {view}")
    point_at(page, stage, 0.01, 0.01)
    until(lambda: set(highlights(page).values()) == {None}, "nothing highlighted")
    assert errors(page) == []


def strip_pixels(image: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Where the 3-D view is blue or orange: the strip, not the grey body."""
    red, blue = image[..., 0].astype(int), image[..., 2].astype(int)
    return np.asarray((abs(red - blue) > 60) & (image[..., 3] > 200))


def test_a_row_of_the_gap_list_shows_its_bridge(page: webdriver.Chrome) -> None:
    row = page.find_element(By.CSS_SELECTOR, "tr[data-first]")
    page.execute_script("arguments[0].click()", row)
    first, last = (int(row.get_attribute(f"data-{end}") or "") for end in ("first", "last"))
    shown = until(lambda: agreed_highlight(page), "the same bridge in every view")
    assert first <= int(shown) <= last


def test_layers_of_the_pattern_can_be_left_out(page: webdriver.Chrome) -> None:
    for box in page.find_elements(By.CSS_SELECTOR, "[data-pattern-layer]"):
        before = picture(page, "pattern").tobytes()
        box.click()
        until(lambda before=before: picture(page, "pattern").tobytes() != before, "a layer gone")


def test_the_matrix_zooms_to_single_bridges(browser: webdriver.Chrome, tmp_path: Path) -> None:
    view = view_of(wavy_rails(700, 720))
    assert view.valid is not None
    html = write_page(summary_of([view]), [view])
    open_page(browser, tmp_path / "large.html", html)
    before = picture(browser, "matrix")
    nearer = canvas(browser, "matrix").find_element(
        By.XPATH, "ancestor::*[contains(@class,'card')]//button[@title='Nearer']"
    )
    for _ in range(9):
        browser.execute_script("arguments[0].click()", nearer)
    # The cells around the middle of the matrix are then as wide as their grid lines are apart.
    until(lambda: (picture(browser, "matrix") != before).any(), "a nearer view")
    time.sleep(0.3)
    image = picture(browser, "matrix")
    assert not is_blank(image)
    assert errors(browser) == []


def test_a_hostile_label_stays_text(browser: webdriver.Chrome, tmp_path: Path) -> None:
    rails = cylinder_rails(20, 20)
    views = [view_of(rails, HOSTILE), view_of(planar_rails(), "second")]
    summary = summary_of(
        views, Limits(max_fold_deg=0.1).of(Material(name=HOSTILE)), input={"file": HOSTILE}
    )
    open_page(browser, tmp_path / "hostile.html", write_page(summary, views, dome(6)))
    point_at(browser, canvas(browser, "curves"), 0.5, 0.5)
    until(lambda: agreed_highlight(browser), "the same bridge in every view")
    assert browser.execute_script("return window.pwned") is None
    assert browser.find_elements(By.TAG_NAME, "img") == []
    assert browser.find_element(By.TAG_NAME, "h1").text == HOSTILE
    assert browser.find_element(By.CSS_SELECTOR, ".readout").text.startswith(HOSTILE)
    assert browser.find_element(By.CSS_SELECTOR, "[data-tab]").text == HOSTILE
    assert errors(browser) == []


def test_tabs_show_one_strip_at_a_time(browser: webdriver.Chrome, tmp_path: Path) -> None:
    views = [view_of(cylinder_rails(), "first"), view_of(planar_rails(), "second")]
    open_page(browser, tmp_path / "two.html", write_page(summary_of(views), views))
    sections = browser.find_elements(By.CSS_SELECTOR, "[data-strip]")
    assert [section.is_displayed() for section in sections] == [True, False]
    browser.find_elements(By.CSS_SELECTOR, "[data-tab]")[1].click()
    assert [section.is_displayed() for section in sections] == [False, True]
    until(lambda: canvas(browser, "matrix").get_attribute("data-drawn"), "the second matrix")
    assert not is_blank(picture(browser, "matrix"))


def test_every_number_in_the_browser_is_that_of_the_json(page: webdriver.Chrome) -> None:
    script = """
      const summary = JSON.parse(document.getElementById("summary").textContent);
      return [...document.querySelectorAll("data")].map((shown) => [
        shown.dataset.path, Number(shown.value),
        shown.dataset.path.slice(1).split("/").reduce((value, key) => value[key], summary)]);
    """
    rows = page.execute_script(script)
    assert len(rows) > 40
    assert [row for row in rows if row[1] != row[2]] == []


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [360, 820, 1440])
def test_nothing_sticks_out_sideways(
    browser: webdriver.Chrome, tmp_path: Path, html: str, width: int, dark: bool
) -> None:
    open_page(browser, tmp_path / "vamp.html", html, width=width, height=800, dark=dark)
    assert browser.execute_script("return document.documentElement.scrollWidth") <= width
    ground = browser.execute_script("return getComputedStyle(document.body).backgroundColor")
    brightness = sum(int(part) for part in ground[4:-1].split(","))
    assert (brightness < 150) == dark
    assert not is_blank(picture(browser, "space"))


@pytest.mark.parametrize("dark", [False, True])
def test_the_page_prints(browser: webdriver.Chrome, tmp_path: Path, html: str, dark: bool) -> None:
    open_page(browser, tmp_path / "vamp.html", html, dark=dark)
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": False})["data"]
    pdf = base64.b64decode(printed)
    assert pdf.startswith(b"%PDF")
    assert len(pdf) > 50_000
    assert len(re.findall(rb"/Type /Page\b", pdf)) <= 4
    assert errors(browser) == []


def test_three_wrinkles_with_their_bands_print_on_four_sheets(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    views = three_wrinkles()
    findings = [{"code": "a", "severity": "info", "message": "Seen. " * 40} for _ in range(30)]
    summary = summary_of(views) | {"findings": findings}
    open_page(browser, tmp_path / "three.html", write_page(summary, views, dome(20)))
    size = {"printBackground": False, "paperWidth": 8.27, "paperHeight": 11.69}
    pdf = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", size)["data"])
    assert 2 <= len(re.findall(rb"/Type /Page\b", pdf)) <= 4


def test_the_3d_view_is_there_once_the_page_has_loaded(
    browser: webdriver.Chrome, tmp_path: Path, html: str
) -> None:
    # As when printing from the command line, which waits for nothing but this.
    asked = """<script>addEventListener("load", () => {
      dispatchEvent(new Event("beforeprint"));
      window.printed = document.querySelector("canvas.space").dataset.drawn;
    });</script>"""
    changed = without_policy(html).replace("</body>", f"{asked}</body>")
    open_page(browser, tmp_path / "printed.html", changed)
    assert browser.execute_script("return window.printed") == "yes"


def test_a_script_that_is_not_the_pages_own_does_not_run(
    browser: webdriver.Chrome, tmp_path: Path, html: str
) -> None:
    smuggled = html.replace("</body>", "<script>window.pwned = 1</script></body>")
    open_page(browser, tmp_path / "smuggled.html", smuggled)
    assert browser.execute_script("return window.pwned") is None
    assert any("Content Security Policy" in message for message in errors(browser))


def crease_rails() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bent = np.array([(0.0, 0.0), (40.0, 0.0), (70.0, 30.0)])
    return np.insert(bent, 2, 0.0, axis=1), np.insert(bent, 2, 20.0, axis=1)


def stretch_rails() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    x = np.linspace(0.0, 100.0, 21)
    return np.stack((x, 0 * x, 0 * x), axis=1), np.stack((x, 0 * x + 20.0, 0.53 * x), axis=1)


def three_wrinkles() -> list[StripView]:
    names = ("front", "middle", "back")
    strips = [view_of(wavy_rails(offset=30.0 * at), name) for at, name in enumerate(names)]
    bands = [
        view_of(cylinder_rails(), f"{name} band {rail}", role="band")
        for name in names
        for rail in "PQ"
    ]
    return [*strips, *bands]


FIRST_SCREENS = {
    "one": lambda: [view_of(wavy_rails())],
    "three": three_wrinkles,
    "creased": lambda: [view_of(crease_rails())],
    "stretched": lambda: [view_of(stretch_rails())],
}


@pytest.mark.parametrize(
    ("name", "width", "height"),
    [
        ("three", 1366, 768),
        ("three", 390, 844),
        ("creased", 1366, 768),
        ("stretched", 390, 844),
        pytest.param("creased", 390, 844, marks=pytest.mark.slow),
        pytest.param("stretched", 1366, 768, marks=pytest.mark.slow),
        pytest.param("one", 1366, 768, marks=pytest.mark.slow),
        pytest.param("one", 390, 844, marks=pytest.mark.slow),
    ],
)
def test_verdict_picture_and_figures_stand_on_the_first_screen(
    browser: webdriver.Chrome, tmp_path: Path, name: str, width: int, height: int
) -> None:
    views = FIRST_SCREENS[name]()
    outputs = {kind: {"file": f"shoe.{kind}"} for kind in ("step", "stl", "dxf")}
    summary = summary_of(views) | {"outputs": outputs}
    html = write_page(summary, views, dome(40), moment=datetime(2026, 11, 25, tzinfo=UTC))
    open_page(browser, tmp_path / "first.html", html, width=width, height=height)
    links = [link.get_attribute("href") for link in browser.find_elements(By.CSS_SELECTOR, "nav a")]
    assert links == [(tmp_path / entry["file"]).as_uri() for entry in outputs.values()]
    sizes = "return [...document.querySelectorAll('.tile dd, .headline, .segments label, button')]"
    sizes += ".filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.innerText)"
    assert browser.execute_script(sizes) == []
    script = "return arguments[0].getBoundingClientRect().bottom"

    def bottom(element: WebElement) -> float:
        return float(browser.execute_script(script, element))

    headline = browser.find_element(By.CSS_SELECTOR, ".verdict .headline")
    tiles = browser.find_elements(By.CSS_SELECTOR, ".tiles .tile")
    titles = [tile.find_element(By.TAG_NAME, "dt").text for tile in tiles[:3]]
    assert titles == ["Largest strain", "Sharpest crease", "Developable share"]
    assert max(map(bottom, (headline, *tiles))) <= height
    assert bottom(canvas(browser, "space")) <= height
    assert "band" not in browser.find_element(By.CSS_SELECTOR, ".said").text.split("Bands:")[0]


@pytest.mark.parametrize(("name", "state"), [("creased", "creased"), ("stretched", "stretched")])
def test_the_picture_shows_the_verdict_first(
    browser: webdriver.Chrome, tmp_path: Path, name: str, state: str
) -> None:
    views = FIRST_SCREENS[name]()
    open_page(browser, tmp_path / "state.html", write_page(summary_of(views), views))
    chosen = browser.find_element(By.CSS_SELECTOR, "[name=color-by]:checked")
    assert chosen.get_attribute("value") == "state"
    states = browser.execute_script("return Report.strips[0].judged")
    assert state in states
    if state == "creased":  # at the corner only
        assert states.count("creased") == 1
    shown = [key for key in browser.find_elements(By.CSS_SELECTOR, ".legend [data-for]")
             if key.is_displayed()]  # fmt: skip
    assert {key.get_attribute("data-for") for key in shown} == {"state"}
    assert errors(browser) == []

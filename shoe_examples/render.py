"""Pictures of the examples, drawn by the page of their own run in headless Chromium.

``python -m shoe_examples.render [NAME...]`` draws all, or those that are named. It needs Debian's
``chromium`` and ``chromium-driver``, and the extra ``test``.
"""

from __future__ import annotations

import base64
import io
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import ezdxf
import ezdxf.path
import numpy as np
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

from wrinkle_cad import Job, JobDone, make_job, run_job

HERE: Final = Path(__file__).parent
GROUND: Final = (246, 243, 239)
SIZE: Final = (1600, 720)
SPACE: Final = (1000, 720)
CLOSE_UP: Final = (580, 380)
PATIENCE_S: Final = 300.0
DRAWN: Final = "return document.querySelector('canvas.space').dataset.drawn"
ZINC: Final = {
    "--hide": "#6d767e",
    "--hide-strip": "#6d767e",
    "--lining": "#5f676e",
    "--grain-mm": "0",
}
LINEN: Final = {
    "--hide": "#d9cdb4",
    "--hide-strip": "#d9cdb4",
    "--lining": "#e6dcc6",
    "--grain-mm": "0.02",
}
OAK: Final = {
    "--hide": "#b58a55",
    "--hide-strip": "#b58a55",
    "--lining": "#a77d4a",
    "--grain-mm": "0.03",
}


@dataclass(frozen=True)
class Picture:
    """How an example is shown."""

    options: Mapping[str, object] = field(default_factory=dict)
    """Of its job, beside those of its ``job.toml``."""
    style: Mapping[str, str] = field(default_factory=dict)
    """The material's colors, as the page's style names them."""
    has_close_up: bool = True
    """Whether the strip is shown from near as well."""


PICTURES: Final = {
    "vamp_strip": Picture({"seam_allowance": (4.0,) * 4, "notches": 5}, has_close_up=False),
    "one_wrinkle": Picture({"seam_allowance": (4.0,) * 4, "notches": 5}),
    "three_wrinkles": Picture(),
    "across_seam": Picture(),
    "feather_to_feather": Picture(),
    "cuff": Picture(),
    "square_to_round": Picture({"seam_allowance": (8.0,) * 4}, ZINC, has_close_up=False),
    "lampshade": Picture({"seam_allowance": (6.0,) * 4}, LINEN, has_close_up=False),
    "boat_plank": Picture({}, OAK, has_close_up=False),
    "auger": Picture({}, ZINC, has_close_up=False),
}


WITH_PAGE: Final = "one_wrinkle"
"""The example whose page is shown, too."""


@contextmanager
def chromium() -> Iterator[webdriver.Chrome]:
    """A headless browser that draws without a graphics card."""
    options = Options()
    for flag in ("headless", "no-sandbox", "use-gl=angle", "use-angle=swiftshader",
                 "enable-unsafe-swiftshader", "hide-scrollbars"):  # fmt: skip
        options.add_argument(f"--{flag}")
    driver = shutil.which("chromedriver")
    options.binary_location = shutil.which("chromium") or ""
    browser = webdriver.Chrome(options=options, service=Service(driver) if driver else None)
    browser.set_script_timeout(PATIENCE_S)
    try:
        yield browser
    finally:
        browser.quit()


def space_pictures(
    page: Path, style: Mapping[str, str], views: Mapping[str, tuple[int, int]]
) -> list[Image.Image]:
    """Returns what the page's 3-D view shows as leather, without background, from each view."""
    found = []
    with chromium() as browser:
        # Drawn larger and made smaller: edges come out smooth.
        size = {"width": 1400, "height": 1000, "deviceScaleFactor": 1.5, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        browser.get(page.resolve().as_uri())
        _wait(browser, DRAWN)
        for name, value in style.items():
            script = "document.documentElement.style.setProperty(arguments[0], arguments[1])"
            browser.execute_script(script, name, value)
        browser.execute_script(
            "dispatchEvent(new Event('beforeprint')); dispatchEvent(new Event('afterprint'))"
        )
        for view, (width, height) in views.items():
            browser.execute_script(
                "Object.assign(document.querySelector('.stage').style, {position: 'fixed', inset:"
                " 0, width: arguments[0] + 'px', height: arguments[1] + 'px', maxHeight: 'none'})",
                width, height,
            )  # fmt: skip
            for wanted in ("[value=leather]", f"[data-view={view}]"):
                browser.execute_script(
                    "delete document.querySelector('canvas.space').dataset.drawn;"
                    f"document.querySelector('{wanted}').click()"
                )
                _wait(browser, DRAWN)
            text = browser.execute_script(
                "return document.querySelector('canvas.space').toDataURL('image/png')"
            )
            drawn = Image.open(io.BytesIO(base64.b64decode(text.split(",")[1]))).convert("RGBA")
            found.append(drawn.resize((width, height), Image.Resampling.LANCZOS))
    return found


def page_picture(page: Path, target: Path) -> None:
    """Writes the first screen of a page as a PNG."""
    with chromium() as browser:
        size = {"width": 1366, "height": 768, "deviceScaleFactor": 1, "mobile": False}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        browser.get(page.resolve().as_uri())
        _wait(browser, DRAWN)
        time.sleep(2.0)
        shown = Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB")
    shown.quantize(128).save(target, optimize=True)


def _wait(browser: webdriver.Chrome, script: str) -> None:
    end = time.monotonic() + PATIENCE_S
    while not browser.execute_script(script):
        assert time.monotonic() < end, f"the page did not draw within {PATIENCE_S:g} s"
        time.sleep(0.1)


def pattern_picture(dxf: Path, tone: str, size: tuple[int, int]) -> Image.Image:
    """Returns the pieces of a pattern as cut from the material, to one scale; six at most."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    drawn: dict[str, list[np.ndarray]] = {layer: [] for layer in ("CUT", "SEW", "NOTCH")}
    for entity in ezdxf.readfile(dxf).modelspace():
        if entity.dxf.layer in drawn and entity.dxftype() in ("LWPOLYLINE", "LINE"):
            path = ezdxf.path.make_path(entity)
            points = np.array([(at.x, at.y) for at in path.control_vertices()])
            drawn[entity.dxf.layer].append(points)
    figure = plt.figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    cuts = drawn["CUT"][:6]
    widest, top = max(float(np.ptp(cut[:, 0])) for cut in cuts), 0.0
    for cut in cuts:
        low, high = cut.min(axis=0), cut.max(axis=0)
        shift = np.array([(widest - high[0] + low[0]) / 2 - low[0], top - high[1]])
        axes.fill(*(cut + shift).T, facecolor=tone, edgecolor="#3a2a1c", linewidth=1.2)
        for layer, color, dashes in (("SEW", "#fff7ea", (4, 3)), ("NOTCH", "#3a2a1c", (1, 0))):
            for line in drawn[layer]:
                if (line >= low - 1.0).all() and (line <= high + 1.0).all():
                    axes.plot(*(line + shift).T, color=color, linewidth=1.0, dashes=dashes)
        top -= float(high[1] - low[1]) + 0.05 * widest
    axes.set_aspect("equal")
    axes.margins(0.03)
    axes.set_axis_off()
    target = io.BytesIO()
    figure.savefig(target, transparent=True)
    plt.close(figure)
    return Image.open(target).convert("RGBA")


def draw(name: str) -> Path:
    """Runs an example and writes its picture.png: in space, from near, and its pattern."""
    shown = PICTURES[name]
    folder = HERE / name
    toml = folder / "job.toml"
    with tempfile.TemporaryDirectory() as outputs:
        keywords = {"output_dir": Path(outputs), **shown.options}
        job: Job = make_job(folder / f"{name}.step", keywords, toml if toml.exists() else None)
        done = run_job(job)
        assert isinstance(done, JobDone), done.message
        views = {"whole": SPACE} | ({"strips": CLOSE_UP} if shown.has_close_up else {})
        pictures = space_pictures(Path(outputs) / f"{job.name}.html", shown.style, views)
        if name == WITH_PAGE:
            page_picture(Path(outputs) / f"{job.name}.html", folder / "page.png")
        room = (560, SIZE[1] - 60 - (CLOSE_UP[1] if shown.has_close_up else 0))
        tone = shown.style.get("--hide-strip", "#9a7152")
        pattern = pattern_picture(Path(outputs) / f"{job.name}.dxf", tone, room)
    sheet = Image.new("RGBA", SIZE, (*GROUND, 255))
    sheet.alpha_composite(pictures[0], (10, 0))
    if shown.has_close_up:
        sheet.alpha_composite(pictures[1], (SIZE[0] - CLOSE_UP[0] - 10, 10))
    sheet.alpha_composite(pattern, (SIZE[0] - room[0] - 20, SIZE[1] - room[1] - 20))
    target = folder / "picture.png"
    quantized = sheet.convert("RGB").quantize(256, dither=Image.Dither.FLOYDSTEINBERG)
    quantized.save(target, optimize=True)
    return target


if __name__ == "__main__":
    for wanted in sys.argv[1:] or PICTURES:
        print(draw(wanted))

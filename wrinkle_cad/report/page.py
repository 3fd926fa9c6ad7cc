"""The HTML page of one job: self-contained, opened from disk, without a network.

Every number on it is taken from the JSON by its path; every text goes through the serialiser.

The 3-D view's library stands on the page as the text of its released files, unchanged, and is
loaded by ``library.js``. That relies on what the HTML standard says and current Chromium, Firefox
and Safari do: a script may ``import()`` the URL of a blob made by its own page, also when the page
comes from disk and its origin is ``null``; the blob's type ``text/javascript`` makes it a module;
modules with the same URL are loaded once, so that all files share one core. The tests try it in
Chromium. Where it fails, the page says that the 3-D view could not start and shows the rest.
"""

from __future__ import annotations

import datetime
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any, Final

from .header import page_header
from .markup import Element, node, script, to_html, to_script
from .numbers import Numbers
from .panels import figures_panel, space_panel, strip_section, tabs
from .tables import tables_panel, verdict_panel
from .views import MeshView, StripView, scene_payload

_SCRIPTS: Final = (
    "core.js", "library.js", "camera.js", "leather.js", "scene.js", "matrix.js", "curves.js",
    "pattern.js", "main.js",
)  # fmt: skip
# Under the names that they import each other by, each behind those that it imports.
_LIBRARY: Final = (
    ("./three.core.min.js", "three/three.core.min.js"),
    ("three", "three/three.module.min.js"),
    ("three/addons/controls/OrbitControls.js", "three/OrbitControls.js"),
)
_LICENSE: Final = "three/LICENSE"


def write_page(
    summary: Mapping[str, Any],
    strips: Sequence[StripView],
    body: MeshView | None = None,
    *,
    moment: datetime.datetime | None = None,
) -> str:
    """Writes the page of a job.

    Args:
        summary: what NAME.json holds, with ``verdict`` as ``Verdict.as_json`` gives it.
        strips: the strips in the order of ``summary["strips"]``.
        body: what the strips are sewn to.
        moment: when the outputs were made, as it stands in them.

    Returns:
        The whole page.

    Raises:
        InputError: the body's faces point at vertices that do not exist.
    """
    numbers = Numbers(summary)
    said = node("div", verdict_panel(numbers), figures_panel(numbers), class_="said")
    first = node("div", said, space_panel(strips, body), class_="first")
    main = node("main", page_header(numbers, moment), first)
    if len(strips) > 1:
        main.append(tabs([view.name for view in strips]))
    for index, view in enumerate(strips):
        main.append(strip_section(numbers, index, view))
    main.extend(tables_panel(numbers))
    scripts = [
        script(to_script(summary), type="application/json", id="summary"),
        script(to_script(scene_payload(strips, body)), type="application/json", id="scene"),
        script(_library(), type="application/json", id="library"),
        *(script(_packaged(name)) for name in _SCRIPTS),
    ]
    return page_of(str(numbers.get("/input/file") or "strip"), main, scripts)


def page_of(title: str, main: Element, scripts: Sequence[Element]) -> str:
    """Wraps the content of a page with its head, style, licences and scripts."""
    style = node("style")
    style.text = _packaged("page.css")
    head = node(
        "head",
        node("meta", charset="utf-8"),
        node("meta", http_equiv="Content-Security-Policy", content=_policy(scripts)),
        node("meta", name="generator", content="wrinkle_cad"),
        node("meta", name="viewport", content="width=device-width, initial-scale=1"),
        node("link", rel="icon", href="data:,"),
        node("title", f"{title} \N{MIDDLE DOT} wrinkle_cad"),
        style,
    )
    licences = [node("template", _packaged(_LICENSE), id="three-licence")] if scripts else []
    return to_html(node("html", head, node("body", main, *licences, *scripts), lang="en"))


def _policy(scripts: Sequence[Element]) -> str:
    """Lets the page run its own scripts, whatever a name smuggles in, and load nothing.

    ``blob:`` is for the library, whose modules only the page's own scripts can make.
    """
    digests = [
        sha256((element.text or "").encode()).digest()
        for element in scripts
        if element.get("type") is None
    ]
    own = [f"'sha256-{b64encode(digest).decode('ascii')}'" for digest in digests]
    allowed = " ".join([*own, "blob:"]) if own else "'none'"
    return (
        "default-src 'none'; base-uri 'none'; form-action 'none'; style-src 'unsafe-inline';"
        f" img-src data: blob:; script-src {allowed}"
    )


@cache
def _library() -> str:
    return to_script([[name, _packaged(path)] for name, path in _LIBRARY])


@cache
def _packaged(name: str) -> str:
    return files(__package__).joinpath("page", *name.split("/")).read_text(encoding="utf-8")

"""The head of the page: whose report it is, when it was made of which file, and its outputs."""

from __future__ import annotations

import datetime
from typing import Final
from urllib.parse import quote

from .markup import Element, node
from .numbers import Numbers

_DIGEST_SHOWN: Final = 12
"""Hexadecimal digits; enough to tell the versions of a file from each other."""


def page_header(numbers: Numbers, moment: datetime.datetime | None) -> Element:
    """The file's name, what its report was made with, and links to the other outputs.

    Args:
        numbers: the JSON.
        moment: when the outputs were made; left out when None.
    """
    said = [
        f"{what} {numbers.get(path)}"
        for what, path in (("wrinkle_cad", "/versions/wrinkle-cad"), ("unit", "/input/unit"))
        if numbers.get(path)
    ]
    if moment is not None:
        said.append(f"{moment:%Y-%m-%d %H:%M} UTC")
    line = node("p", " \N{MIDDLE DOT} ".join(("Strip report", *said)), class_="eyebrow")
    digest = numbers.get("/input/sha256")
    if digest:
        short = node("abbr", f"SHA-256 {digest[:_DIGEST_SHOWN]}\N{HORIZONTAL ELLIPSIS}")
        short.set("title", f"SHA-256 of the file that was read: {digest}")
        line.append(node("span", " \N{MIDDLE DOT} ", short, class_="digest"))
    title = node("h1", str(numbers.get("/input/file") or "Strip"))
    return node("header", line, title, *_links(numbers))


def _links(numbers: Numbers) -> list[Element]:
    """To the outputs that lie beside the page."""
    outputs = numbers.get("/outputs") or {}
    links = [
        node("a", kind.upper(), href=f"./{quote(entry['file'])}", title=entry["file"])
        for kind, entry in outputs.items()
    ]
    return [node("nav", *links, class_="outputs", aria_label="Outputs")] if links else []

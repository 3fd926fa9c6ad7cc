"""Tables and cards as the page has them."""

from __future__ import annotations

from collections.abc import Sequence

from .markup import Child, Element, node
from .numbers import Numbers


def card(title: str, *content: Child) -> Element:
    """A card with a title."""
    return node("section", node("h2", title, class_="head"), *content, class_="card")


def table(columns: Sequence[tuple[str, bool]], rows: Sequence[Element]) -> Element:
    """A table that scrolls sideways by itself.

    Args:
        columns: title and whether the column holds numbers.
        rows: its ``tr`` elements.
    """
    head = (node("th", title, scope="col", **_number_class(right)) for title, right in columns)
    body = node("tbody", *rows)
    return node("div", node("table", node("thead", node("tr", *head)), body), class_="scroll")


def cell(*content: Child, right: bool = False, kind: str = "") -> Element:
    """A table cell.

    Args:
        content: what stands in it.
        right: whether it holds a number.
        kind: ``name`` (any length), ``word`` (never broken), ``text`` (sentences).
    """
    return node("td", *content, **({"class_": kind} if kind else _number_class(right)))


def _number_class(right: bool) -> dict[str, str]:
    return {"class_": "n"} if right else {}


def strip_name(numbers: Numbers, at: int) -> str:
    """The name of a strip by its number."""
    return str(numbers.get(f"/strips/{at}/name"))

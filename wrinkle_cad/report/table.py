"""Tables and cards as the page has them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from .markup import Child, Element, node
from .numbers import Numbers

PRINTED_ROWS: Final = 6
"""A print shows no more of a table or a list; ``page.css`` leaves out the others."""


def card(title: str, *content: Child, is_printed: bool = True) -> Element:
    """A card with a title."""
    kind = "card" if is_printed else "card screen-only"
    return node("section", node("h2", title, class_="head"), *content, class_=kind)


def print_note(count: int) -> Element | None:
    """On paper, of a list that is longer than a print shows: how long it is."""
    if count <= PRINTED_ROWS:
        return None
    return node(
        "p",
        f"The first {PRINTED_ROWS} of {count}; the page on a screen has all.",
        class_="note print-only",
    )


def table(columns: Sequence[tuple[str, bool]], rows: Sequence[Element]) -> Element:
    """A table that scrolls sideways by itself.

    Args:
        columns: title and whether the column holds numbers.
        rows: its ``tr`` elements.
    """
    head = (node("th", title, scope="col", **_number_class(right)) for title, right in columns)
    body = node("tbody", *rows)
    shown = node("table", node("thead", node("tr", *head)), body)
    return node("div", shown, print_note(len(rows)), class_="scroll")


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

"""HTML as a tree, so that every text from outside is escaped by the serialiser.

Numbers carry the exact value and the place in the JSON that they come from:
``<data value="1.25" data-path="/strips/0/bending">1.25</data>``.
"""

from __future__ import annotations

import json
from typing import Any, Final
from xml.etree import ElementTree

from wrinkle_cad.files.json_values import finite
from wrinkle_cad.files.names import is_control

Element = ElementTree.Element
Child = Element | str | None

_REPLACEMENT: Final = "\N{REPLACEMENT CHARACTER}"


def node(tag: str, *children: Child, **attributes: str | bool) -> Element:
    """Makes an element; ``class_`` and ``data_x`` become ``class`` and ``data-x``.

    Args:
        tag: the element's name.
        children: elements and texts in their order; None is left out.
        attributes: True stands for an attribute without a value, False leaves it out.
    """
    element = Element(tag)
    for name, value in attributes.items():
        if value is not False:
            text = "" if value is True else plain(str(value))
            element.set(name.rstrip("_").replace("_", "-"), text)
    for child in children:
        append(element, child)
    return element


def append(element: Element, child: Child) -> None:
    """Puts an element or a text behind what an element already holds."""
    if child is None:
        return
    if isinstance(child, str):
        text = plain(child)
        if len(element):
            element[-1].tail = (element[-1].tail or "") + text
        else:
            element.text = (element.text or "") + text
    else:
        element.append(child)


def script(text: str, **attributes: str) -> Element:
    """A script or a block of JSON; ``text`` must come from this package or from ``to_script``."""
    element = node("script", **attributes)
    element.text = text
    return element


def to_script(value: Any) -> str:
    """JSON that may stand inside a script element: no ``<``, plain ASCII, no NaN."""
    text = json.dumps(finite(value), separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e")


def plain(text: str) -> str:
    """Returns a text that a page can hold, lines and all: what is no text is replaced."""
    return "".join(
        _REPLACEMENT if is_control(letter) and letter not in "\t\n\r" else letter for letter in text
    )


def to_html(root: Element) -> str:
    """Serialises a whole page."""
    return "<!DOCTYPE html>\n" + ElementTree.tostring(root, encoding="unicode", method="html")

"""HTML as a tree, so that every text from outside is escaped by the serialiser.

Numbers carry the exact value and the place in the JSON that they come from:
``<data value="1.25" data-path="/strips/0/bending">1.25</data>``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, Final
from xml.etree import ElementTree

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


def finite(value: Any) -> Any:
    """Returns the same value with null for every number that is not finite."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [finite(part) for part in value]
    return value


def plain(text: str) -> str:
    """Returns a text that a page can hold: control characters and lone surrogates replaced."""
    return "".join(
        _REPLACEMENT
        if (ord(letter) < 32 and letter not in "\t\n\r")
        or 0x7F <= ord(letter) < 0xA0
        or 0xD800 <= ord(letter) < 0xE000
        else letter
        for letter in text
    )


def to_html(root: Element) -> str:
    """Serialises a whole page."""
    return "<!DOCTYPE html>\n" + ElementTree.tostring(root, encoding="unicode", method="html")

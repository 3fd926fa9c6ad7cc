"""Names that STEP files give to single free curves, which the kernel drops.

Some programs write all free curves into one product and name the curves, or the sets that hold
them, instead of giving each a product of its own.
"""

from __future__ import annotations

import re
from typing import Final

from .text import entities

_CURVE: Final = (
    rb"(?:\w*CURVE\w*|LINE|CIRCLE|ELLIPSE|PARABOLA|HYPERBOLA|POLYLINE|GEOMETRIC_(?:CURVE_)?SET)"
)
_STRING: Final = rb"\(\s*'((?:[^']|'')*)'"
_SIMPLE: Final = re.compile(rb"#\s*(\d+)\s*=\s*" + _CURVE + rb"\s*" + _STRING)
_COMPLEX: Final = re.compile(
    rb"#\s*(\d+)\s*=\s*\([^;]*?\bB_SPLINE_CURVE\b[^;]*?\bREPRESENTATION_ITEM\s*" + _STRING
)
_REFERENCE: Final = re.compile(rb"#\s*(\d+)")
_ESCAPE: Final = re.compile(
    r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\|\\X4\\((?:[0-9A-F]{8})+)\\X0\\|\\X\\([0-9A-F]{2})"
    r"|\\S\\(.)|\\(\\)|''"
)


def curve_names(text: bytes) -> list[str]:
    """Returns the name of every free curve in the order of the shape's items.

    Args:
        text: a STEP file with one shape representation, as ``plain_text`` returns it.

    Returns:
        One entry per curve: its own name, else that of the set that holds it, else an empty one.
        An empty list if the file has no sets of curves.
    """
    sets = entities(text, rb"GEOMETRIC_(?:CURVE_)?SET")
    if not sets:
        return []
    names = {int(match[1]): decoded(match[2]) for match in _SIMPLE.finditer(text)}
    names |= {int(match[1]): decoded(match[2]) for match in _COMPLEX.finditer(text)}
    representations = entities(text, rb"\w*SHAPE_REPRESENTATION").values()
    return [
        names[curve] or names.get(group, "")
        for body in representations
        for group in _references(body)
        if group in sets
        for curve in _references(sets[group])
        if curve in names
    ]


def decoded(raw: bytes) -> str:
    r"""Returns the text of a STEP string without its outer quotes: ``\X2\``, ``\S\``, ``''``."""
    return _ESCAPE.sub(_unescaped, raw.decode("utf-8", "replace").replace("\n", ""))


def _unescaped(match: re.Match[str]) -> str:
    wide, wider, single, shifted, backslash = match.groups()
    if wide:
        return bytes.fromhex(wide).decode("utf-16-be", "replace")
    if wider:
        return bytes.fromhex(wider).decode("utf-32-be", "replace")
    if single:
        return chr(int(single, 16))
    if shifted:
        return chr(ord(shifted) + 128)
    return "\\" if backslash else "'"


def _references(body: bytes) -> list[int]:
    return [int(number) for number in _REFERENCE.findall(body)]

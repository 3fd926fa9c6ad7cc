"""Geometry that the kernel skips in a STEP file, written as what it reads.

Wires that are stored by their shells, and supplemental geometry: curves that some programs keep in
a representation of its own beside the part's.
"""

from __future__ import annotations

import re
from typing import Final

from .text import entities

_REFERENCE: Final = re.compile(rb"#\s*(\d+)")
_SHELL: Final = re.compile(
    rb"(=\s*)(WIRE|VERTEX)_SHELL(\s*\(\s*'(?:[^']|'')*'\s*,\s*)(\([^()']*\)|#\s*\d+)"
)
_MODEL: Final = re.compile(
    rb"(=\s*)SHELL(_BASED_WIREFRAME_(?:MODEL|SHAPE_REPRESENTATION))(?=\s*\()"
)
_CONSTRUCTION: Final = re.compile(
    rb"(=\s*)CONSTRUCTIVE_GEOMETRY_REPRESENTATION(_RELATIONSHIP)?(?=\s*\()"
)


def with_wires(text: bytes) -> bytes:
    """Returns the text with wires stored by their edges in place of those stored by shells.

    Args:
        text: a STEP file as ``plain_text`` returns it.
    """
    if _MODEL.search(text) is None:
        return text
    loops = entities(text, rb"EDGE_LOOP", rb"PATH", rb"OPEN_PATH", rb"ORIENTED_PATH")
    edges = entities(text, rb"ORIENTED_EDGE")

    def as_edges(match: re.Match[bytes]) -> bytes:
        held = [
            edge
            for loop in _REFERENCE.findall(match[4])
            for oriented in _REFERENCE.findall(loops.get(int(loop), b""))
            for edge in _REFERENCE.findall(edges.get(int(oriented), b""))[-1:]
        ]
        listed = b",".join(b"#%s" % edge for edge in held)
        return b"%sCONNECTED_EDGE_SET%s(%s)" % (match[1], match[3], listed)

    return _MODEL.sub(rb"\1EDGE\2", _SHELL.sub(as_edges, text))


def with_construction(text: bytes) -> bytes:
    """Returns the text with its supplemental geometry as part of the shape.

    Args:
        text: a STEP file as ``plain_text`` returns it.
    """
    return _CONSTRUCTION.sub(lambda at: b"%sSHAPE_REPRESENTATION%s" % (at[1], at[2] or b""), text)

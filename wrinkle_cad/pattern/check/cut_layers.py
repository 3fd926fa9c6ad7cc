"""Which layers of a drawing are to be cut, by the words in their names."""

from __future__ import annotations

import re
from typing import Final

from .reading import DxfContent

_WORD: Final = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_CUT: Final = frozenset((
    "cut", "cuts", "cutting", "cutline", "cutlines", "cutout", "cutouts", "knife", "blade",
    "laser", "contour", "contours", "outline", "outlines", "boundary", "perimeter", "kontur",
    "konturen", "schnitt", "schneiden", "messer", "coupe", "decoupe", "couteau", "taglio",
    "corte", "cuchilla",
))  # fmt: skip
_NOT_CUT: Final = frozenset((
    "engrave", "engraving", "engraved", "etch", "etching", "mark", "marks", "marking", "score",
    "scoring", "crease", "fold", "bend", "draw", "drawing", "pen", "plot", "print", "text",
    "texts", "note", "notes", "label", "labels", "dim", "dims", "dimension", "dimensions",
    "info", "comment", "comments", "sew", "sewing", "stitch", "stitching", "notch", "notches",
    "grain", "guide", "guides", "hidden", "gravur", "gravieren", "gravure", "nicht", "kein",
))  # fmt: skip


def likely_cut_layers(content: DxfContent) -> tuple[str, ...]:
    """Returns the layers that are taken as contours to be cut.

    1 and 11 in a file of pieces; else those whose names have a word for cutting and none for
    anything else; else every layer with a closed line and no such word; else all.
    """
    if content.is_blocks:
        return ("1", "11")
    used = sorted({line.layer for line in content.lines} | set(content.paper_layers))
    words = {layer: _words(layer) for layer in used}
    may_be_cut = [layer for layer in used if not words[layer] & _NOT_CUT]
    named = tuple(layer for layer in may_be_cut if words[layer] & _CUT)
    closed = {line.layer for line in content.lines if line.is_closed}
    return named or tuple(layer for layer in may_be_cut if layer in closed) or tuple(used)


def _words(name: str) -> frozenset[str]:
    return frozenset(word.lower() for word in _WORD.findall(name))

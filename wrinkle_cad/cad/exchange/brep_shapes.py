"""What is wrong with the table of shapes in a BREP text file.

The kernel reads what stands there until a number tells it to stop: one word too few, and it never
does. A shape that consists of one that is not there ends its process.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from .brep_words import ENDLESS, Tokens, shown

_HEAD: Final = re.compile(rb"\nTShapes (\d{1,9})\s")
_FLAGS: Final = re.compile(rb"[01]{7,}")
_PART: Final = re.compile(rb"[-+](\d{1,9})")
_SMOOTHNESS: Final = re.compile(rb"(\d{1,9})?(?:C[0-3N]|G[12])")
_WITHOUT_GEOMETRY: Final = (b"Wi", b"Sh", b"So", b"CS", b"Co")


def check_shapes(text: bytes, sizes: Mapping[str, int]) -> None:
    """Checks the table of shapes.

    Args:
        text: a BREP text file with line feeds as line ends.
        sizes: how many entries each table of geometry has.

    Raises:
        ValueError: what is wrong, and with which shape.
    """
    head = _HEAD.search(text)
    if head is None:
        raise ValueError("its table of shapes has no length")
    count = int(head[1])
    has_ends = b"Topology V2" in text[: head.start()]
    table = _Shapes(Tokens(text[head.end() :].split()), sizes, count, has_ends)
    for number in range(1, count + 1):
        try:
            table.read_shape()
        except ValueError as fault:
            raise ValueError(f"shape {number} of {count} {fault}") from None


@dataclass(frozen=True, slots=True)
class _Shapes:
    tokens: Tokens
    sizes: Mapping[str, int]
    count: int
    has_ends: bool
    """Whether the ends of curves on surfaces stand there, as in version 2."""

    def read_shape(self) -> None:
        kind = self.tokens.word()
        if kind == b"Ve":
            self._vertex()
        elif kind == b"Ed":
            self._edge()
        elif kind == b"Fa":
            self._face()
        elif kind not in _WITHOUT_GEOMETRY:
            raise ValueError(f"begins with '{shown(kind)}', which is no kind of shape")
        if not _FLAGS.fullmatch(flags := self.tokens.word()):
            raise ValueError(f"has '{shown(flags)}' where its seven flags belong")
        while (word := self.tokens.word()) != b"*":
            part = _PART.fullmatch(word)
            if part is None:
                raise ValueError(f"has '{shown(word)}' where the shapes in it belong")
            if not 0 < int(part[1]) <= self.count:
                raise ValueError("consists of a shape that the file does not have")
            self._indices("Locations")

    def _indices(self, *tables: str) -> None:
        """Reads the numbers of entries of tables; 0 stands for none."""
        for table in tables:
            self.tokens.whole(0, self.sizes[table])

    def _vertex(self) -> None:
        self.tokens.reals(4)
        while True:
            self.tokens.reals(1, ENDLESS)
            kind = self.tokens.whole(0, 3)
            if kind == 0:
                return
            # It lies on a curve, on a curve on a surface, or on a surface.
            if kind == 1:
                self._indices("Curves")
            elif kind == 2:
                self._indices("Curve2ds", "Surfaces")
            else:
                self.tokens.reals(1, ENDLESS)
                self._indices("Surfaces")
            self._indices("Locations")

    def _edge(self) -> None:
        self.tokens.reals(1)
        for _ in range(3):
            self.tokens.whole(0, 1)
        while kind := self.tokens.whole(0, 7):
            if kind == 1:
                self._indices("Curves", "Locations")
                self.tokens.reals(2, ENDLESS)
            elif kind in (2, 3):
                self._on_surface(is_seam=kind == 3)
            elif kind == 4:
                self._smoothness(self.tokens.word())
                self._indices("Surfaces", "Locations", "Surfaces", "Locations")
            elif kind == 5:
                self._indices("Polygon3D", "Locations")
            else:
                self._indices(*["PolygonOnTriangulations"] * (kind - 5))
                self._indices("Triangulations", "Locations")

    def _on_surface(self, *, is_seam: bool) -> None:
        self._indices("Curve2ds")
        if is_seam:
            word = self.tokens.word()
            found = _SMOOTHNESS.fullmatch(word)  # the kernel writes both in one word: 5CN
            number = word if found is None else found[1] or b""
            if not number.isdigit() or int(number[:10]) > self.sizes["Curve2ds"]:
                raise ValueError(f"has '{shown(word)}' where the number of a curve belongs")
            if found is None:
                self._smoothness(self.tokens.word())
        self._indices("Surfaces", "Locations")
        self.tokens.reals(6 if self.has_ends else 2, ENDLESS)

    def _smoothness(self, word: bytes) -> None:
        found = _SMOOTHNESS.fullmatch(word)
        if found is None or found[1]:
            raise ValueError(f"has '{shown(word)}' where a smoothness belongs")

    def _face(self) -> None:
        self.tokens.whole(0, 1)
        self.tokens.reals(1)
        self._indices("Surfaces", "Locations")
        if self.tokens.next_word() == b"2":
            self.tokens.word()
            self._indices("Triangulations")

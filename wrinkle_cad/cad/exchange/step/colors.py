"""The entities that color the shapes of a STEP text and single faces of them.

The kernel orders colors by memory addresses, so the entities are made here, in the order of the
parts and of their faces.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

_HOLDER: Final = re.compile(
    rb"#(\d+) = (?:SHELL_BASED_SURFACE_MODEL|(?:OPEN|CLOSED|ORIENTED_CLOSED)_SHELL"
    rb"|MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\(([^;]*)\);"
)
_NUMBER: Final = re.compile(rb"#(\d+)")

Rgb = Sequence[float]


@dataclass(frozen=True, slots=True, eq=False)
class Colored:
    """What one part of the text is to look like; entities are given by their numbers."""

    context: int
    """The context of the part's representation."""
    shapes: Sequence[int]
    """The representation's geometric items."""
    color: Rgb | None
    """Of all of them."""
    faces: Sequence[tuple[int, Rgb]]
    """Faces that have another color."""


def holders(data: bytes) -> dict[int, int]:
    """Returns for each face, shell and solid the entity that holds it."""
    return {
        int(number): int(match[1])
        for match in _HOLDER.finditer(data)
        for number in _NUMBER.findall(match[2])
    }


def color_lines(colored: Colored, first: int, holder_of: Mapping[int, int]) -> list[bytes]:
    """Returns the entities ``first`` and up that color one part; none if nothing has a color.

    Args:
        colored: the part.
        first: the number of the first entity.
        holder_of: as ``holders`` returns it; for parts with colored faces.
    """
    lines: list[str] = []
    items: list[int] = []
    style_of: dict[tuple[str, ...], int] = {}
    item_of: dict[int, int] = {}

    def styled(color: Rgb) -> int:
        key = tuple(_real(value) for value in color[:3])
        if key not in style_of:
            lines.extend(_look(first + len(lines), key))
            style_of[key] = first + len(lines) - 1
        return style_of[key]

    def add_item(text: str) -> int:
        items.append(first + len(lines))
        lines.append(text)
        return items[-1]

    if colored.color is not None:
        style = styled(colored.color)
        for shape in colored.shapes:
            item_of[shape] = add_item(f"STYLED_ITEM('color',(#{style}),#{shape})")
    for face, color in colored.faces:
        style, below = styled(color), item_of.get(_top(face, holder_of, colored.shapes))
        add_item(
            f"STYLED_ITEM('color',(#{style}),#{face})"
            if below is None
            else f"OVER_RIDING_STYLED_ITEM('overriding color',(#{style}),#{face},#{below})"
        )
    if items:
        listed = ",".join(f"#{item}" for item in items)
        lines.append(
            "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',"
            f"({listed}),#{colored.context})"
        )
    return [f"#{first + i} = {line};".encode() for i, line in enumerate(lines)]


def _top(number: int, holder_of: Mapping[int, int], shapes: Sequence[int]) -> int:
    """Returns the geometric item that holds a face, directly or not."""
    while number not in shapes and number in holder_of:
        number = holder_of[number]
    return number


def _look(first: int, color: Sequence[str]) -> list[str]:
    """Returns entities of which the last one gives faces and curves a color."""
    rgb, fill_color, fill, area, side, usage, font, curve = range(first, first + 8)
    return [
        f"COLOUR_RGB('',{','.join(color)})",
        f"FILL_AREA_STYLE_COLOUR('',#{rgb})",
        f"FILL_AREA_STYLE('',(#{fill_color}))",
        f"SURFACE_STYLE_FILL_AREA(#{fill})",
        f"SURFACE_SIDE_STYLE('',(#{area}))",
        f"SURFACE_STYLE_USAGE(.BOTH.,#{side})",
        "DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')",
        f"CURVE_STYLE('',#{font},POSITIVE_LENGTH_MEASURE(0.1),#{rgb})",
        f"PRESENTATION_STYLE_ASSIGNMENT((#{usage},#{curve}))",
    ]


def _real(value: float) -> str:
    """Returns a number from 0 to 1 as the standard wants it: with a decimal point."""
    return f"{float(value):.6f}"

"""How lines look on paper, where no color may tell them apart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from .layers import Role


@dataclass(frozen=True, slots=True)
class Pen:
    """A line's width and dashes, and what it is called in the legend."""

    width: float
    """Points of 1/72 inch."""
    dashes: tuple[float, ...] = ()
    """Dashes and gaps in turn, mm; none for a full line."""
    name: str = ""
    """In the legend; empty for what explains itself."""


PENS: Final[Mapping[Role, Pen]] = MappingProxyType(
    {
        "cut": Pen(1.2, (), "cut"),
        "sew": Pen(0.5, (3.0, 1.5), "sew"),
        "mountain": Pen(0.5, (5.0, 1.5, 0.5, 1.5), "fold, mountain"),
        "valley": Pen(0.5, (0.5, 1.5), "fold, valley"),
        "bend_up": Pen(0.5, (5.0, 0.7, 0.5, 0.7, 0.5, 0.7), "bend up"),
        "bend_down": Pen(0.5, (5.0, 0.7, 1.5, 0.7), "bend down"),
        "notch": Pen(0.8, (), "notch"),
        "grain": Pen(0.5, (), "grain"),
        "stretch": Pen(0.5, (8.0, 2.0), "stretch"),
    }
)
PLAIN_PEN: Final = Pen(0.5)


def pen_of(role: Role) -> Pen:
    """Returns the pen of a role, a plain one where it needs none of its own."""
    return PENS.get(role, PLAIN_PEN)

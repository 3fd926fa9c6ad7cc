"""What a reader finds and a writer takes: named shapes, as neutral records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

CURVE_KINDS: Final = ("edge", "wire")
SURFACE_KINDS: Final = ("face", "shell", "compound")
UPPER: Final = "upper"
RAILS: Final = ("P", "Q")


def rail_role(name: str) -> tuple[str, str] | None:
    """Splits ``<strip>:P``, in any case, into the strip (may be empty) and ``P``; else None."""
    strip, _, rail = name.rpartition(":")
    rail = rail.strip().upper()
    return (strip.strip(), rail) if rail in RAILS else None


def has_role(name: str) -> bool:
    """Tells whether a name says what its shape is for: a rail or the upper."""
    return rail_role(name) is not None or name.casefold() == UPPER


class Holder(NamedTuple):
    """Something with a name that holds a shape: a set, a product, a layer."""

    name: str
    """As in the file."""
    carrier: str
    """What it is: ``curve``, ``set``, ``representation``, ``product``, ``layer``, ..."""
    at: str
    """Tells it from others of the same name."""


@dataclass(frozen=True, slots=True, eq=False)
class FaceStyle:
    """The name and color of one face of a larger shape."""

    face: TopoDS_Face
    """The face, as the shape holds it."""
    name: str = ""
    """Empty if it has none of its own."""
    color: Sequence[float] | None = None
    """Red, green, blue, sRGB, 0 to 1; None where it looks like the shape."""


@dataclass(frozen=True, slots=True, eq=False)
class NamedShape:
    """One shape of a file that can be chosen by name or index."""

    name: str
    """The name in the file, its own or that of the nearest named ancestor; empty if none."""
    index: int
    """Its place in the file, from 1, as ``inspect`` prints it."""
    kind: str
    """``vertex``, ``edge``, ``wire``, ``face``, ``shell``, ``solid`` or ``compound`` (of faces or
    of vertices)."""
    shape: TopoDS_Shape
    """The shape, world coordinates, mm."""
    measure: float
    """Length in mm of an edge or wire, area in mm^2 of anything with faces, 0 of vertices."""
    color: tuple[float, float, float] | None = None
    """Red, green, blue, sRGB, 0 to 1; None where the file gives none."""
    is_free: bool = True
    """False for a named face or shell inside a solid or shell that is itself listed."""
    faces: tuple[FaceStyle, ...] = ()
    """Its faces that have names or colors of their own."""
    named_by: str = ""
    """What carries the name: ``curve``, ``set``, ``layer``, ``product``, ...; empty if unknown."""
    is_hidden: bool = False
    """Whether the file says that it is not shown."""
    holders: tuple[Holder, ...] = ()
    """Everything that has a name and holds it, the nearest first, itself included."""
    parts: tuple[int, ...] = ()
    """The numbers of the curves that were joined to it; none for a curve of the file."""

    @property
    def unit(self) -> str:
        """The unit of the measure: ``mm`` or ``mm2``; empty for vertices."""
        if self.kind in CURVE_KINDS:
            return "mm"
        return "mm2" if self.measure > 0.0 else ""

    @property
    def is_curve(self) -> bool:
        """Whether it can be a directrix."""
        return self.kind in CURVE_KINDS

    @property
    def is_surface(self) -> bool:
        """Whether it can be an upper without being asked for (a solid can when it is chosen)."""
        is_one = self.kind in SURFACE_KINDS and self.measure > 0.0 and self.is_free
        return is_one and (not self.is_hidden or has_role(self.name))

    def __str__(self) -> str:
        """One candidate in a list: index, name, kind and measure."""
        name = f" '{self.name}'" if self.name else ""
        measure = f" {self.measure:.6g} {self.unit}" if self.unit else ""
        hidden = " (hidden)" if self.is_hidden else ""
        joined = f" (joined from {_numbers(self.parts)})" if self.parts else ""
        return f"[{self.index}]{name} {self.kind}{measure}{hidden}{joined}"


def _numbers(parts: tuple[int, ...]) -> str:
    *others, last = (f"[{part}]" for part in parts)
    return f"{', '.join(others)} and {last}"


@dataclass(frozen=True, slots=True, eq=False)
class CadFile:
    """Everything in one CAD file that can be chosen."""

    path: Path
    """The file."""
    format: str
    """``STEP``, ``BREP`` or ``IGES``."""
    unit: str
    """The unit of length: as the file declares it, or as it was given where it declares none."""
    shapes: tuple[NamedShape, ...]
    """In the file's order; ``shapes[i].index == i + 1``."""
    is_compressed: bool = False
    """Whether the file was compressed with gzip."""
    sha256: str = ""
    """Of the file as it is stored: 64 hexadecimal digits."""

    def __repr__(self) -> str:
        return f"CadFile({self.path.name!r}, {self.format}, {self.unit}, {len(self.shapes)} shapes)"

    def curves(self) -> tuple[NamedShape, ...]:
        """Returns the free edges and wires; hidden ones only if their name says their role."""
        return tuple(
            shape
            for shape in self.shapes
            if shape.is_curve and (not shape.is_hidden or has_role(shape.name))
        )

    def surfaces(self) -> tuple[NamedShape, ...]:
        """Returns the free faces, shells and compounds of faces."""
        return tuple(shape for shape in self.shapes if shape.is_surface)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One shape to be written, with its name and color.

    Example:
        >>> from build123d import Edge
        >>> Part(Edge.make_line((0, 0), (90, 0)).wrapped, "P").name
        'P'
    """

    shape: TopoDS_Shape
    """World coordinates, mm; an edge, wire, face, shell, solid, vertex or compound of one kind."""
    name: str = ""
    """Any text; control characters become blanks in the file."""
    color: Sequence[float] | None = None
    """Red, green, blue, sRGB, 0 to 1; None for the reading program's default."""
    faces: Sequence[FaceStyle] = ()
    """Faces of a shell, solid or compound that have names or colors of their own; the last one of a
    face counts."""

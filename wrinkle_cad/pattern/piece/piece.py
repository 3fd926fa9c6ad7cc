"""PatternPiece: one flat piece of material with everything that is cut into or drawn on it.

Frame: millimetres, x along the strip, y across, right side up, the first point of P at the origin.
Seen from the side of ``p' x (q - p)`` P lies below and Q above. Where the other side is the right
one (the upper's outside decides), or for the other foot, Q lies below and ``is_mirrored`` says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import Finding

from .options import Hand, NotchKind, PerSide

RIGHT_SIDE: Final = "RIGHT SIDE UP"
"""Stands on every piece: patterns are drawn as seen from the right side of the material."""

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int8]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Notch:
    """A mark at the cut line that meets its partner on the piece sewn to it."""

    side: int
    """Index into ``SIDES``."""
    arc: float
    """mm along the rail in space, from the rail's start (for an end: along the ruling from P).
    The partner stands at the same arc."""
    seam: Floats
    """(2,) mm, its foot on the sew line."""
    position: Floats
    """(2,) mm, on the cut line."""
    direction: Floats
    """(2,) unit vector from the cut line into the piece."""
    depth: float
    """mm."""
    width: float
    """mm."""
    kind: NotchKind
    """Its form."""
    is_cut: bool = True
    """False where there is no allowance to cut into: it is then drawn as a mark."""


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A closed polygon, counter-clockwise, without a repeated last vertex."""

    points: Floats
    """(k, 2) mm."""
    sides: Ints
    """(k,) int8, ``SIDES`` index of the segment that starts at each vertex."""
    corners: Bools
    """(k,) bool, True at turn points, False where the outline is curved."""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """Where a piece is folded, in the order from its start to its end."""

    lines: Floats
    """(b, 2, 2) mm from P to Q."""
    fold: Floats
    """(b,) rad, positive for a mountain as seen from the right side (down), negative for a
    valley (up)."""
    arcs: Floats
    """(b, 2) mm along P and Q in space, from their starts."""
    radius: Floats
    """(b,) mm; 0 where one bend stands for several rulings."""
    deviation: float
    """mm that the bends leave the curve by at most."""


@dataclass(frozen=True, slots=True, eq=False)
class PatternPiece:
    """One piece of a pattern; every array is read-only and in mm."""

    name: str
    """What it is called."""
    size: str
    """Of the shoe, as the texts say."""
    quantity: int
    """How many are to be cut."""
    material: str
    """Its name, as the texts say."""
    tolerance: float
    """mm; the chord tolerance of its outlines."""
    cut: Outline
    """Outline to be cut."""
    sew: Outline
    """Outline to be sewn, inside or on the cut line."""
    cut_outs: tuple[Floats, ...]
    """(k, 2) polygons each, cut inside the cut line."""
    widths: PerSide
    """Allowance of each side in the order of ``SIDES``."""
    notches: tuple[Notch, ...]
    """Sorted by side, then by arc."""
    grain_line: Floats
    """(2, 2) from tail to head."""
    stretch_line: Floats | None
    """(2, 2) likewise, or None."""
    rulings: Floats
    """(r, 2, 2) from P to Q."""
    ruling_fold: Floats
    """(r,) rad, positive for a mountain as seen from the right side, negative for a valley."""
    drill_holes: Floats
    """(h, 2) centres."""
    p_span: tuple[float, float]
    """(first, last) mm along P in space that this piece covers."""
    q_span: tuple[float, float]
    """(first, last) mm along Q in space that this piece covers."""
    hand: Hand | None = None
    """The foot it is for."""
    is_mirrored: bool = False
    """Q lies below P, as the strip was mirrored or its other side is the right one."""
    bends: Bends | None = None
    """For makers who fold, None where they are not asked for."""
    findings: tuple[Finding, ...] = ()
    """What was noticed while making it."""

    def __repr__(self) -> str:
        counts = f"{len(self.cut.points)} corners, {len(self.notches)} notches"
        return f"PatternPiece({self.name[:60]!r}, {counts})"

    @property
    def cut_line(self) -> Floats:
        """(k, 2) mm, the outline to be cut, closed without a repeated vertex."""
        return self.cut.points

    @property
    def sew_line(self) -> Floats:
        """(k, 2) mm, the outline to be sewn, closed without a repeated vertex."""
        return self.sew.points

    @property
    def has_allowance(self) -> bool:
        """Whether the cut line differs from the sew line anywhere."""
        return any(width > 0.0 for width in self.widths)

    @property
    def texts(self) -> tuple[str, ...]:
        """What is written on the piece, line by line."""
        lines = [self.name, f"SIZE {self.size}".strip(), f"QUANTITY {self.quantity}", RIGHT_SIDE]
        if self.material:
            lines.append(f"MATERIAL {self.material}")
        return (*lines, "UNITS MM", f"CHORD TOLERANCE {self.tolerance:g} MM")

    def moved(self, offset: Floats) -> PatternPiece:
        """Returns the piece shifted by ``offset``: (2,) mm."""
        return _mapped(self, (1.0, 0.0, 0.0, 1.0), offset)

    def turned_round(self) -> PatternPiece:
        """Returns the piece turned by half a turn about the origin, right side up as before."""
        return _mapped(self, (-1.0, 0.0, 0.0, -1.0), np.zeros(2))

    def with_grain_along_x(self) -> PatternPiece:
        """Returns the piece turned about the origin until its grain line runs along +x."""
        x, y = self.grain_line[1] - self.grain_line[0]
        length = math.hypot(x, y)
        cosine, sine = float(x) / length, float(y) / length
        return _mapped(self, (cosine, sine, -sine, cosine), np.zeros(2))

    def turned_over(self) -> PatternPiece:
        """Returns the same piece as seen from its other side, which becomes the right one.

        y is turned over, outlines stay counter-clockwise, mountains become valleys.
        """
        turned = _mirrored(self)
        bends = turned.bends
        return replace(
            turned,
            ruling_fold=frozen(-self.ruling_fold),
            bends=None if bends is None else replace(bends, fold=frozen(-bends.fold)),
        )

    def mirrored(self, *, name: str, hand: Hand) -> PatternPiece:
        """Returns the piece for the other foot: y turned over, outlines kept counter-clockwise.

        Mountains stay mountains: the strip for the other foot is mirrored in space as well.
        """
        return replace(_mirrored(self), name=name, hand=hand)


def frozen(points: npt.ArrayLike) -> Floats:
    """Returns ``points`` as a read-only float array of its own."""
    array = np.array(points, dtype=np.float64)
    array.flags.writeable = False
    return array


def make_outline(points: npt.ArrayLike, sides: npt.ArrayLike, corners: npt.ArrayLike) -> Outline:
    """Returns an outline with read-only arrays: (k, 2) mm, (k,) side indices, (k,) bool."""
    side_array = np.array(sides, dtype=np.int8)
    corner_array = np.array(corners, dtype=np.bool_)
    side_array.flags.writeable = False
    corner_array.flags.writeable = False
    return Outline(frozen(points), side_array, corner_array)


def _reversed(outline: Outline) -> Outline:
    return make_outline(
        outline.points[::-1], np.roll(outline.sides[::-1], -1), outline.corners[::-1]
    )


def _mirrored(piece: PatternPiece) -> PatternPiece:
    turned = _mapped(piece, (1.0, 0.0, 0.0, -1.0), np.zeros(2))
    return replace(
        turned,
        cut=_reversed(turned.cut),
        sew=_reversed(turned.sew),
        cut_outs=tuple(frozen(outline[::-1]) for outline in turned.cut_outs),
        is_mirrored=not piece.is_mirrored,
    )


def _mapped(
    piece: PatternPiece, matrix: tuple[float, float, float, float], offset: Floats
) -> PatternPiece:
    """Returns a piece with all its points under a matrix, row by row, and then an offset."""
    xx, xy, yx, yy = matrix

    def turned(points: Floats) -> Floats:
        x, y = points[..., 0], points[..., 1]
        return np.stack((xx * x + xy * y, yx * x + yy * y), axis=-1)

    def placed(points: Floats) -> Floats:
        return frozen(turned(points) + offset)

    def placed_outline(outline: Outline) -> Outline:
        return make_outline(placed(outline.points), outline.sides, outline.corners)

    notches = tuple(
        replace(
            notch,
            seam=placed(notch.seam),
            position=placed(notch.position),
            direction=frozen(turned(notch.direction)),
        )
        for notch in piece.notches
    )
    return replace(
        piece,
        cut=placed_outline(piece.cut),
        sew=placed_outline(piece.sew),
        cut_outs=tuple(placed(outline) for outline in piece.cut_outs),
        notches=notches,
        grain_line=placed(piece.grain_line),
        stretch_line=None if piece.stretch_line is None else placed(piece.stretch_line),
        rulings=placed(piece.rulings),
        drill_holes=placed(piece.drill_holes),
        bends=None
        if piece.bends is None
        else replace(piece.bends, lines=placed(piece.bends.lines)),
    )

"""What a user may ask of a pattern piece, as frozen values that check themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, get_args

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError

SIDES: Final = ("P", "Q", "start", "end")
"""The sides of a strip in the order of every per-side option."""
P_SIDE, Q_SIDE, START_SIDE, END_SIDE = range(4)

PerSide = tuple[float, float, float, float]
Direction = Literal["along", "across"] | tuple[float, float, float]
NotchKind = Literal["slit", "v", "t", "castle", "check", "u"]
SurfaceSide = Literal["inside", "middle", "outside"]
Overlap = Literal["split", "refuse"]
Hand = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class NotchRule:
    """Where the notches of one side stand; at most one of the three is given.

    Attributes:
        count: notches at equal distances, none at the ends.
        spacing: mm of seam between notches; rounded so that all distances are equal.
        at: mm of seam from the rail's start, one per notch.
        partner_corners: mm of seam at which the piece sewn to this side has corners; notches keep
            away from them as well, so that both pieces get the same ones.
    """

    count: int = 0
    spacing: float | None = None
    at: tuple[float, ...] = ()
    partner_corners: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.count < 0:
            raise InputError(f"notches - count {self.count} - at least 0 - give a whole number")
        if self.spacing is not None and not 0.0 < self.spacing < math.inf:
            raise InputError(f"notches - spacing {self.spacing} mm - above 0 - give a length")
        if sum((self.count > 0, self.spacing is not None, bool(self.at))) > 1:
            raise InputError("notches - count, spacing and positions given together - one - choose")


@dataclass(frozen=True, slots=True)
class PieceSettings:
    """Everything about a piece that is not its shape. Lengths in mm.

    Attributes:
        seam_allowance: on P, Q, the start and the end.
        lasting_margin: added to the allowance of the same side.
        mitre_limit: corners of the allowance reach at most this many widths out.
        notches_p, notches_q: where the notches of the two seams stand.
        notch_kind, notch_depth, notch_width: what they look like.
        thickness: of the material; lengths are then taken at its middle, the neutral layer.
        surface_side: which side of the material the strip's surface is: ``inside`` (the material
            lies on the right side, where the surface normal points), ``middle``, ``outside``.
        grain: direction of the grain line: ``along`` or ``across`` the strip, or a direction in
            space, which is laid on the middle of the strip and unrolled with it.
        stretch: the same for the direction of stretch; None draws none.
        drill_holes: (along, across) as shares 0...1 of the rails and of the way from P to Q.
        rulings: draw the rulings. ``ruling_spacing`` leaves out those closer together than this.
        hand: the foot this strip is for; the piece for the other one is then made as well.
        size, quantity, material: what the texts say.
        tolerance: chord tolerance of the outline; shorter segments are merged.
        overlap: what happens to a pattern that overlaps itself when flat.
    """

    seam_allowance: PerSide = settings.SEAM_ALLOWANCE
    lasting_margin: PerSide = settings.SEAM_ALLOWANCE
    mitre_limit: float = settings.MITRE_LIMIT
    notches_p: NotchRule = NotchRule()
    notches_q: NotchRule = NotchRule()
    notch_kind: NotchKind = "slit"
    notch_depth: float = settings.NOTCH_DEPTH
    notch_width: float = settings.NOTCH_WIDTH
    thickness: float = 0.0
    surface_side: SurfaceSide = "middle"
    grain: Direction = "along"
    stretch: Direction | None = None
    drill_holes: tuple[tuple[float, float], ...] = ()
    rulings: bool = True
    ruling_spacing: float = 0.0
    hand: Hand | None = None
    size: str = settings.PIECE_SIZE
    quantity: int = 1
    material: str = ""
    tolerance: float = settings.TOLERANCE
    overlap: Overlap = settings.PATTERN_OVERLAP

    def __post_init__(self) -> None:
        for name in ("seam_allowance", "lasting_margin"):
            _check_per_side(name, getattr(self, name))
        for name in ("thickness", "ruling_spacing", "notch_width"):
            _check_length(name, getattr(self, name), at_least=True)
        for name in ("tolerance", "notch_depth"):
            _check_length(name, getattr(self, name), at_least=False)
        if not 1.0 <= self.mitre_limit < math.inf:
            raise InputError(f"mitre_limit - {self.mitre_limit} - at least 1 - give a larger one")
        if self.quantity < 1:
            raise InputError(f"quantity - {self.quantity} - at least 1 - give a whole number")
        for name, allowed in _CHOICES.items():
            if getattr(self, name) not in allowed:
                said = ", ".join(str(choice) for choice in allowed)
                raise InputError(f"{name} - {getattr(self, name)!r} - one of {said} - choose one")
        for name in ("grain", "stretch"):
            _check_direction(name, getattr(self, name))
        for hole in self.drill_holes:
            if not all(0.0 < share < 1.0 for share in hole) or len(hole) != 2:
                raise InputError(f"drill_holes - {hole} - two shares between 0 and 1 - move it in")

    @property
    def widths(self) -> PerSide:
        """Seam allowance and lasting margin together, mm, in the order of ``SIDES``."""
        first, second, third, fourth = (
            allowance + margin
            for allowance, margin in zip(self.seam_allowance, self.lasting_margin, strict=True)
        )
        return first, second, third, fourth

    @property
    def neutral_offset(self) -> float:
        """Mm from the surface to the neutral layer, along the surface normal (right side)."""
        return {"inside": 0.5, "middle": 0.0, "outside": -0.5}[self.surface_side] * self.thickness


_CHOICES: Final[dict[str, tuple[object, ...]]] = {
    "notch_kind": get_args(NotchKind),
    "surface_side": get_args(SurfaceSide),
    "overlap": get_args(Overlap),
    "hand": (None, *get_args(Hand)),
}


def _check_per_side(name: str, widths: PerSide) -> None:
    if len(widths) != 4 or not all(0.0 <= width < math.inf for width in widths):
        raise InputError(f"{name} - {widths} mm - four widths (P, Q, start, end) from 0 - correct")


def _check_length(name: str, length: float, *, at_least: bool) -> None:
    fits = length >= 0.0 if at_least else length > 0.0
    if not fits or not math.isfinite(length):
        limit = "at least 0" if at_least else "above 0"
        raise InputError(f"{name} - {length} mm - {limit} - give a length")


def _check_direction(name: str, direction: Direction | None) -> None:
    if direction is None and name == "stretch":
        return
    if isinstance(direction, str):
        if direction in ("along", "across"):
            return
    elif direction is not None and len(direction) == 3 and 0.0 < math.hypot(*direction) < math.inf:
        return
    raise InputError(f"{name} - {direction!r} - along, across or three numbers - give one of them")

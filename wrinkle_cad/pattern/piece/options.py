"""What a user may ask of a pattern piece, as frozen values that check themselves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Final, Literal

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.options.checking import check_options
from wrinkle_cad.options.option import option

if TYPE_CHECKING:
    # Every command line makes its flags of these classes, so arrays are loaded when there are any.
    from numpy import float64
    from numpy.typing import NDArray

    Floats = NDArray[float64]

SIDES: Final = ("P", "Q", "start", "end")
"""The sides of a strip in the order of every per-side option."""
P_SIDE, Q_SIDE, START_SIDE, END_SIDE = range(4)

PerSide = tuple[float, float, float, float]
Direction = Literal["along", "across"] | tuple[float, float, float]
NotchKind = Literal["slit", "v", "t", "castle", "check", "u"]
SurfaceSide = Literal["inside", "middle", "outside"]
Overlap = Literal["split", "refuse"]
Hand = Literal["left", "right"]
RightSide = Literal["front", "back"]

_LONGEST: Final = 1e6
"""mm; a kilometer: no length of a pattern is larger."""
_LONGEST_VECTOR: Final = 1e9

_NOTCHES: Final = option(
    "pairs of notches on each long seam, at equal distances", least=0, most=10_000
)
_NOTCH_SPACING: Final = option(
    "distance of the notches, instead of their number", unit="mm", above=0.0, most=_LONGEST
)
_NOTCH_AT_P: Final = option(
    "positions of the notches on P instead", unit="mm", least=0.0, most=_LONGEST
)
_NOTCH_AT_Q: Final = option(
    "positions of the notches on Q instead", unit="mm", least=0.0, most=_LONGEST
)


@dataclass(frozen=True, slots=True)
class NotchRule:
    """Where the notches of one side stand; at most one of the first three is given.

    Example:
        >>> PieceSettings(notches_p=NotchRule(at=(20, 55)), notches=3).notch_rules[0].at
        (20.0, 55.0)
    """

    count: int = field(default=0, metadata=_NOTCHES)
    """Notches at equal distances, none at the ends."""
    spacing: float | None = field(default=None, metadata=_NOTCH_SPACING)
    """Mm of seam between notches; rounded so that all distances are equal."""
    at: tuple[float, ...] = field(default=(), metadata=_NOTCH_AT_P)
    """Mm of seam from the rail's start, one per notch."""
    partner_corners: tuple[float, ...] = ()
    """Mm of seam at which the piece sewn to this side has corners; notches keep away from them as
    well, so that both pieces get the same ones."""

    def __post_init__(self) -> None:
        check_options(self, what="notches, ")
        if sum((self.count > 0, self.spacing is not None, bool(self.at))) > 1:
            raise InputError(
                "notches are given in two ways: give their number, their spacing or their positions"
                " on a side, not several of these."
            )


@dataclass(frozen=True, kw_only=True)
class PieceOptions:
    """What scripts, flags and job files alike may say about the pattern's pieces.

    Per side means on P, on Q, at the start and at the end.
    """

    title: ClassVar[str] = "the pattern's pieces"

    seam_allowance: PerSide = field(
        default=(0.0, 0.0, 0.0, 0.0),
        metadata=option(
            "widths of the seam allowance",
            unit="mm",
            least=0.0,
            most=1000.0,
            is_one_for_all=True,
            metavar="P,Q,START,END",
        ),
    )
    lasting_margin: PerSide = field(
        default=(0.0, 0.0, 0.0, 0.0),
        metadata=option(
            "widths added to the allowance of the same side",
            unit="mm",
            least=0.0,
            most=1000.0,
            is_one_for_all=True,
            metavar="P,Q,START,END",
        ),
    )
    mitre_limit: float = field(
        default=2.0,
        metadata=option(
            "how far corners of the allowance reach out, in widths",
            least=1.0,
            most=100.0,
            metavar="N",
        ),
    )
    notches: int = field(default=0, metadata=_NOTCHES)
    notch_spacing: float | None = field(default=None, metadata=_NOTCH_SPACING)
    notch_at_p: tuple[float, ...] = field(default=(), metadata=_NOTCH_AT_P)
    notch_at_q: tuple[float, ...] = field(default=(), metadata=_NOTCH_AT_Q)
    notch_kind: NotchKind = field(default="slit", metadata=option("shape of the notches"))
    notch_depth: float = field(
        default=3.0,
        metadata=option("how deep notches are cut", unit="mm", above=0.0, most=1000.0),
    )
    notch_width: float = field(
        default=2.0,
        metadata=option("opening of v, u, t and castle notches", unit="mm", least=0.0, most=1000.0),
    )
    drill_holes: tuple[tuple[float, float], ...] = field(
        default=(),
        metadata=option(
            "a hole at shares of the rails and of the way from P to Q; repeatable",
            above=0.0,
            below=1.0,
            flag="--drill-hole",
            metavar="ALONG,ACROSS",
        ),
    )
    thickness: float | None = field(
        default=None,
        metadata=option(
            "of the material: lengths are taken at its neutral layer",
            unit="mm",
            least=0.0,
            most=1000.0,
            when_none="the material's, or 0",
        ),
    )
    surface_side: SurfaceSide = field(
        default="middle",
        metadata=option(
            "the side of the material that the surface is; inside: the material lies on its right"
            " side"
        ),
    )
    k_factor: float | None = field(
        default=None,
        metadata=option(
            "where the neutral layer lies in a bend, as a share of the thickness from its inner"
            " face",
            above=0.0,
            below=1.0,
            when_none="the material's, or 0.5",
        ),
    )
    right_side: RightSide = field(
        default="front",
        metadata=option(
            "the strip's side that is the pattern's right one; front: the upper's outside, or"
            " where p' x (q - p) points without an upper"
        ),
    )
    grain: Direction = field(
        default="along",
        metadata=option(
            "the grain line: along or across the strip, or a direction in space",
            least=-_LONGEST_VECTOR,
            most=_LONGEST_VECTOR,
            metavar="along|across|X,Y,Z",
        ),
    )
    stretch: Direction | None = field(
        default=None,
        metadata=option(
            "the direction of stretch, likewise",
            least=-_LONGEST_VECTOR,
            most=_LONGEST_VECTOR,
            when_none="not drawn",
            metavar="along|across|X,Y,Z",
        ),
    )
    rulings: bool = field(default=False, metadata=option("draw the rulings"))
    ruling_spacing: float = field(
        default=0.0,
        metadata=option(
            "leave out rulings nearer to each other than this",
            unit="mm",
            least=0.0,
            most=_LONGEST,
        ),
    )
    bend_table: bool = field(
        default=False,
        metadata=option(
            "for makers who fold: every bend in NAME.bends.csv and on the layers BEND_UP and"
            " BEND_DOWN"
        ),
    )
    equal_bends: int | None = field(
        default=None,
        metadata=option(
            "bends of equal angle instead of one at every ruling",
            least=1,
            most=10_000,
            when_none="every ruling",
            metavar="K",
        ),
    )
    hand: Hand | None = field(
        default=None, metadata=option("the foot this strip is for; adds the mirrored twin")
    )
    size: str = field(
        default=settings.PIECE_SIZE, metadata=option("the size that is written on the pieces")
    )
    quantity: int = field(
        default=1,
        metadata=option("how many of each piece are to be cut", least=1, most=1_000_000),
    )
    overlap: Overlap = field(
        default="split",
        metadata=option("what to do with a flat strip that covers itself"),
    )

    def __post_init__(self) -> None:
        check_options(self)
        check_piece(self)


def check_piece(chosen: PieceOptions, error: type[InputError] = InputError) -> None:
    """Raises an ``InputError`` when a direction has no length or notches are asked for twice."""
    for name in ("grain", "stretch"):
        direction = getattr(chosen, name)
        if isinstance(direction, tuple) and not any(direction):
            raise error(f"{name} cannot be (0, 0, 0), which is no direction: give another one.")
    if chosen.notches and chosen.notch_spacing is not None:
        raise error(
            f"notches is {chosen.notches} and notch_spacing {chosen.notch_spacing:g} mm: give the"
            " number or the spacing, not both."
        )


@dataclass(frozen=True, kw_only=True)
class PieceSettings(PieceOptions):
    """Everything about a piece that is not its shape. Lengths in mm.

    Example:
        >>> PieceSettings(seam_allowance=6, lasting_margin=(15, 0, 0, 0)).widths
        (21.0, 6.0, 6.0, 6.0)
    """

    notches_p: NotchRule | None = None
    """Where the notches of P stand; as ``notches`` and the rest say when None."""
    notches_q: NotchRule | None = None
    """Likewise of Q."""
    material: str = ""
    """Name of the material, for the texts."""
    tolerance: float = field(
        default=settings.TOLERANCE,
        metadata=option(
            "chord tolerance of the outline; shorter segments are merged",
            unit="mm",
            least=1e-9,
            most=1000.0,
        ),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("notches_p", "notches_q"):
            rule = getattr(self, name)
            if rule is not None and not isinstance(rule, NotchRule):
                raise InputError(
                    f"{name} cannot be {rule!r}: give a NotchRule, such as NotchRule(count=5), or"
                    f" the option notches for both rails and notch_at_{name[-1]} for places."
                )

    @property
    def notch_rules(self) -> tuple[NotchRule, NotchRule]:
        """Where the notches of P and of Q stand."""
        return (
            self.notches_p or self._rule(self.notch_at_p),
            self.notches_q or self._rule(self.notch_at_q),
        )

    def _rule(self, at: tuple[float, ...]) -> NotchRule:
        return NotchRule(at=at) if at else NotchRule(self.notches, self.notch_spacing)

    @property
    def widths(self) -> PerSide:
        """Seam allowance and lasting margin together, mm, in the order of ``SIDES``."""
        first, second, third, fourth = (
            allowance + margin
            for allowance, margin in zip(self.seam_allowance, self.lasting_margin, strict=True)
        )
        return first, second, third, fourth

    def neutral_offsets(self, fold: Floats, *, turned_over: bool) -> Floats:
        """Returns how far the neutral layer lies above the surface at bends, (k,) mm.

        A bend's inner face, from which ``k_factor`` counts, is told by the sign of its fold.

        Args:
            fold: (k,) rad, positive where the surface is convex as seen along ``p' x (q - p)``.
            turned_over: whether the right side is the one that this normal points away from.
        """
        import numpy as np

        lowest = {"inside": 0.0, "middle": -0.5, "outside": -1.0}[self.surface_side]
        if turned_over:
            lowest = -lowest - 1.0
        k_factor = 0.5 if self.k_factor is None else self.k_factor
        share = np.where(fold > 0.0, k_factor, 1.0 - k_factor)
        offsets: Floats = (self.thickness or 0.0) * (lowest + share)
        return offsets


@dataclass(frozen=True)
class PatternArguments(PieceSettings):
    """What ``pattern()`` of a strip is called with."""

    piece_settings: PieceSettings | None = None
    """Settings that the options given one by one go before."""

"""What a user may ask of a strip."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import ClassVar, Final, Literal

from wrinkle_cad import settings
from wrinkle_cad.options.checking import check_options
from wrinkle_cad.options.option import option
from wrinkle_cad.pattern.piece.options import Direction, PieceOptions, SurfaceSide

_OF_PIECES: Final = {field.name: field.metadata for field in fields(PieceOptions)}
"""What is said of an option that a strip and its pieces share."""

Cut = Literal["shortest", "best"] | tuple[float, float]
"""Where a closed strip is cut open."""


@dataclass(frozen=True, kw_only=True)
class StripSettings:
    """How a strip is sampled, searched and made into a surface."""

    title: ClassVar[str] = "the strip"

    tolerance: float = field(
        default=settings.TOLERANCE,
        metadata=option(
            "largest distance of a chord from its curve", unit="mm", least=1e-9, most=1000.0
        ),
    )
    max_chord: float | None = field(
        default=None,
        metadata=option("longest chord", unit="mm", least=1e-6, most=1e6, when_none="unlimited"),
    )
    planarity: float | None = field(
        default=None,
        metadata=option(
            "slack of the convexity test", unit="mm", least=1e-15, most=1e3, when_none="derived"
        ),
    )
    join: float = field(
        default=0.0,
        metadata=option(
            "gaps between the edges of a rail up to this are closed, and reported",
            unit="mm",
            least=0.0,
            most=1000.0,
        ),
    )
    surface: settings.Surface = field(
        default=settings.SURFACE,
        metadata=option(
            "its faces: cones, whose banks are the exact curves; few smooth ones with the same"
            " banks; or flat facets"
        ),
    )
    criteria: tuple[settings.Criterion, ...] = field(
        default=settings.CRITERIA,
        metadata=option("what to minimize, the most important first", metavar="A,B"),
    )
    search: settings.Search = field(
        default=settings.SEARCH, metadata=option("the exact optimum, or one step ahead")
    )
    energy: settings.Energy = field(
        default=settings.ENERGY, metadata=option("how bending is measured")
    )
    price: float | None = field(
        default=settings.PRICE,
        metadata=option(
            "what one more locally convex bridge may cost, in mean bending energies of a bridge "
            "where the strip bends least; none: any bending",
            least=0.0,
            most=settings.LARGEST_PRICE,
        ),
    )

    pinned: tuple[tuple[float, ...], ...] = field(
        default=(),
        metadata=option(
            "a ruling that must be there: mm along P and along Q, or the points x, y, z of its two"
            " ends; repeatable",
            unit="mm",
            least=-1e9,
            most=1e9,
            flag="--pin",
            metavar="P,Q",
        ),
    )
    forbidden: tuple[tuple[float, float, float, float], ...] = field(
        default=(),
        metadata=option(
            "no ruling goes from this stretch of P, in mm along it, to that of Q; repeatable",
            unit="mm",
            least=0.0,
            most=1e9,
            flag="--forbid",
            metavar="P1,P2,Q1,Q2",
        ),
    )
    max_lean_deg: float | None = field(
        default=None,
        metadata=option(
            "largest angle of a ruling to the shortest crossing of the strip at one of its ends",
            unit="deg",
            above=0.0,
            most=90.0,
            when_none="any",
            flag="--max-lean",
        ),
    )
    max_ruling: float | None = field(
        default=None,
        metadata=option("longest ruling", unit="mm", above=0.0, most=1e9, when_none="any"),
    )
    fold_bound_deg: float | None = field(
        default=None,
        metadata=option(
            "largest fold at a ruling that the search may choose",
            unit="deg",
            above=0.0,
            most=180.0,
            when_none="any",
            flag="--fold-bound",
        ),
    )
    ends: settings.Ends = field(
        default="fixed",
        metadata=option(
            "the strip has the rails' ends, or begins and ends where that makes it more developable"
        ),
    )
    give_up: float | None = field(
        default=None,
        metadata=option(
            "what free ends may leave of each rail, at either end", unit="mm", least=0.0, most=1e9
        ),
    )
    cut: Cut = field(
        default="shortest",
        metadata=option(
            "where a closed strip is cut to be laid flat: its shortest ruling, the one with the"
            " smallest sheet, or from here on P to there on Q",
            unit="mm",
            least=0.0,
            most=1e9,
            metavar="shortest|best|P,Q",
        ),
    )

    def __post_init__(self) -> None:
        check_options(self)


@dataclass(frozen=True)
class StripArguments(StripSettings):
    """What ``WrinkleStrip`` is called with."""

    p: object
    """Rail P."""
    q: object
    """Rail Q."""
    name: str = field(
        default=settings.STRIP_NAME,
        kw_only=True,
        metadata=option("label of the surface and of the pattern"),
    )
    color: tuple[float, float, float] = field(
        default=settings.STRIP_COLOR,
        kw_only=True,
        metadata=option("of the surface: red, green, blue", least=0.0, most=1.0),
    )
    thickness: float = field(default=0.0, kw_only=True, metadata=_OF_PIECES["thickness"])
    k_factor: float = field(
        default=settings.K_FACTOR, kw_only=True, metadata=_OF_PIECES["k_factor"]
    )
    grain: Direction = field(default="along", kw_only=True, metadata=_OF_PIECES["grain"])
    surface_side: SurfaceSide = field(
        default="middle", kw_only=True, metadata=_OF_PIECES["surface_side"]
    )

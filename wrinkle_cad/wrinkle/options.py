"""What a user may ask of a strip."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import ClassVar, Final

from wrinkle_cad import settings
from wrinkle_cad.options.checking import check_options
from wrinkle_cad.options.option import option
from wrinkle_cad.pattern.piece.options import Direction, PieceOptions

_OF_PIECES: Final = {field.name: field.metadata for field in fields(PieceOptions)}
"""What is said of an option that a strip and its pieces share."""


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
    surface: settings.Surface = field(
        default=settings.SURFACE,
        metadata=option("its faces: cones, whose banks are the exact curves, or flat facets"),
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

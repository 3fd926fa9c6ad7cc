"""What a user may ask of the wrinkle that is designed on an upper."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.options.checking import check_options
from wrinkle_cad.options.option import option

Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class WaveSettings:
    """The opening and the waves over it; of two numbers the first is P's, the second Q's."""

    title: ClassVar[str] = "the wrinkle on an upper"

    waves: Pair | None = field(
        default=None,
        metadata=option(
            "full waves along P and Q",
            above=0.0,
            most=1000.0,
            is_one_for_all=True,
            metavar="N[,N]",
        ),
    )
    height: Pair | None = field(
        default=None,
        metadata=option(
            "height of the waves", unit="mm", least=-1000.0, most=1000.0, is_one_for_all=True
        ),
    )
    phase_deg: Pair = field(
        default=settings.WAVE_PHASES_DEG,
        metadata=option(
            "where in their periods the waves start",
            unit="deg",
            least=-3600.0,
            most=3600.0,
            is_one_for_all=True,
        ),
    )
    side: settings.WaveSide = field(
        default=settings.WAVE_SIDE, metadata=option("the side of the upper that the waves stand on")
    )
    shape: settings.WaveKind = field(
        default="sine",
        metadata=option(
            "even waves, rounded folds that overhang, or such folds of uneven width and height"
        ),
    )
    lean_deg: float = field(
        default=0.0,
        metadata=option(
            "how far the waves lean over, along the rails", unit="deg", least=-75.0, most=75.0
        ),
    )
    seed: int = field(
        default=0,
        metadata=option("of what is uneven in gathered folds", least=0, most=2**31, metavar="N"),
    )
    amplitude: tuple[float, ...] = field(
        default=(),
        metadata=option(
            "shares of the height at even distances along the rails",
            least=-10.0,
            most=10.0,
            metavar="N,N",
        ),
    )
    margin: float | None = field(
        default=None,
        metadata=option(
            "how far the opening reaches beyond the rails",
            unit="mm",
            least=0.0,
            most=10_000.0,
            when_none="the height",
        ),
    )
    fade: float = field(
        default=settings.FADE,
        metadata=option(
            "share of the rails over which waves and margin grow and die away",
            least=settings.FADE_MIN,
            most=0.5,
            metavar="SHARE",
        ),
    )
    allow_split: bool = field(
        default=False, metadata=option("let the opening cut the upper in two")
    )

    def __post_init__(self) -> None:
        check_options(self)
        check_waves(self)

    @property
    def margin_asked(self) -> float | None:
        """mm; without a margin the waves' height, so that bands lie at 45 degrees; or None."""
        if self.margin is None and self.height is not None:
            return max(abs(height) for height in self.height)
        return self.margin


def check_waves(chosen: WaveSettings, error: type[InputError] = InputError) -> None:
    """Raises an ``InputError`` when the waves' number is given without their height, or so."""
    if (chosen.waves is None) != (chosen.height is None):
        given, missing = ("waves", "height") if chosen.height is None else ("height", "waves")
        raise error(
            f"{given} is given without {missing}: a wrinkle is designed by both, so give {missing}"
            " as well."
        )

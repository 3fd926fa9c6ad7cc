"""What a user may ask of a run beside its strips, waves, pieces and limits."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from wrinkle_cad import settings
from wrinkle_cad.options.option import option
from wrinkle_cad.report.limits import LimitSettings


@dataclass(frozen=True, kw_only=True)
class ShapeSettings:
    """Which shapes of the file are taken."""

    title: ClassVar[str] = "which shapes"

    p: str | None = field(
        default=None,
        metadata=option("directrix P, as inspect prints it", metavar="NAME|INDEX"),
    )
    q: str | None = field(
        default=None, metadata=option("directrix Q, likewise", metavar="NAME|INDEX")
    )
    upper: str | None = field(
        default=None, metadata=option("the upper surface, likewise", metavar="NAME|INDEX")
    )
    unit: settings.Unit | None = field(
        default=None, metadata=option("unit of a file that states none")
    )


@dataclass(frozen=True, kw_only=True)
class FileSettings:
    """Which files are written, and how."""

    title: ClassVar[str] = "the files"

    profile: str = field(
        default=settings.DXF_PROFILE,
        metadata=option(
            "layers of the DXF: cutter, aama, astm or a file of your own",
            may_be_file=True,
            metavar="NAME|FILE.toml",
        ),
    )
    dxf_version: settings.DxfVersion | None = field(
        default=None,
        metadata=option("version of the DXF", when_none="R2000; R12 for aama, astm"),
    )
    curves: settings.Curves = field(
        default="lines", metadata=option("what curved cut lines are written as")
    )
    test_square: bool = field(
        default=False, metadata=option("add a square of 100 mm to the DXF, to check the scale")
    )
    svg: bool = field(default=False, metadata=option("write the pattern as SVG, too"))
    pdf: bool = field(
        default=False, metadata=option("write the pattern as PDF, 1:1 on A4 sheets, too")
    )
    sheet: tuple[float, float] | None = field(
        default=None,
        metadata=option(
            "nest the pieces on sheets of this length along the grain and width; a DXF for each",
            unit="mm",
            above=0.0,
            most=100_000.0,
            when_none="no sheets",
            metavar="LENGTHxWIDTH",
        ),
    )
    nest_seconds: int = field(
        default=settings.NESTING_SECONDS,
        metadata=option(
            "seconds that each sheet is searched further (needs spyrrow); with 0 the layout is the"
            " same on every machine",
            least=0,
            most=86_400,
            metavar="N",
        ),
    )
    pieces_file: bool = field(
        default=False,
        metadata=option(
            "write the pieces as they are, NAME.pieces, for nesting those of many files", flag=None
        ),
    )
    step_schema: settings.StepSchema = field(
        default=settings.STEP_SCHEMA, metadata=option("schema of the STEP file")
    )


@dataclass(frozen=True, kw_only=True)
class JudgingSettings(LimitSettings):
    """What the strips are judged by, and what comes of it."""

    material: str | None = field(
        default=None,
        metadata=option(
            "its limits, thickness and K-factor; see wrinkle-cad materials",
            may_be_file=True,
            metavar="NAME|FILE.toml",
        ),
    )
    no_trials: bool = field(
        default=False,
        metadata=option(
            "do not try what would help a strip that is not developable or misses a limit"
        ),
    )
    strict: bool = field(
        default=False, metadata=option("a missed limit is a failure (exit code 1)")
    )

"""The flags that one job and a batch of jobs share; light, since every command line loads it."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job


def add_job_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the flags of a job, in groups."""
    parser.add_argument(
        "-o", "--output-dir", type=Path, metavar="DIR", help="folder for the outputs (out)"
    )
    _add_curve_arguments(parser.add_argument_group("which shapes").add_argument)
    _add_strip_arguments(parser.add_argument_group("the strip").add_argument)
    _add_wrinkle_arguments(parser.add_argument_group("the wrinkle on an upper").add_argument)
    _add_piece_arguments(parser.add_argument_group("the pattern's pieces").add_argument)
    _add_file_arguments(parser.add_argument_group("the pattern's files").add_argument)
    _add_limit_arguments(parser.add_argument_group("limits").add_argument)


def job_keywords(given: argparse.Namespace, environment: Mapping[str, str]) -> dict[str, Any]:
    """The settings of a job among the arguments given; None where a flag was not given.

    Args:
        given: the parsed arguments.
        environment: the environment variables; SOURCE_DATE_EPOCH is taken from them.

    Raises:
        InputError: SOURCE_DATE_EPOCH is not a whole number.
    """
    names = {field.name for field in fields(Job)} - {"input", "source_date_epoch"}
    keywords = {name: value for name, value in vars(given).items() if name in names}
    return {**keywords, "source_date_epoch": _epoch(environment.get("SOURCE_DATE_EPOCH", ""))}


def _add_curve_arguments(add: Callable[..., Any]) -> None:
    add("--p", metavar="NAME|INDEX", help="directrix P, as inspect prints it")
    add("--q", metavar="NAME|INDEX", help="directrix Q")
    add("--upper", metavar="NAME|INDEX", help="the upper surface")
    add("--unit", choices=("mm", "cm", "m", "inch", "ft"), help="unit of a file that states none")


def _add_strip_arguments(add: Callable[..., Any]) -> None:
    add(
        "--tolerance",
        type=float,
        metavar="MM",
        help=f"largest distance of a chord from its curve in mm ({settings.TOLERANCE:g})",
    )
    add("--max-chord", type=float, metavar="MM", help="longest chord in mm (unlimited)")
    add("--planarity", type=float, metavar="MM", help="slack of the convexity test in mm (derived)")
    add("--surface", choices=settings.SURFACES, help=f"kind of faces ({settings.SURFACE})")
    add("--criteria", type=_words, metavar="A,B", help="what to minimise (invalid,bending)")
    add("--search", choices=("global", "local"), help=f"search ({settings.SEARCH})")
    add("--energy", choices=("hinge", "paper"), help=f"bending energy ({settings.ENERGY})")
    add("--step-schema", choices=("AP214", "AP242"), help=f"({settings.STEP_SCHEMA})")


def _add_wrinkle_arguments(add: Callable[..., Any]) -> None:
    add("--waves", type=_numbers, metavar="N[,N]", help="full waves along P and Q")
    add("--height", type=_numbers, metavar="MM[,MM]", help="height of the waves in mm")
    add("--phase-deg", type=_numbers, metavar="DEG[,DEG]", help="where the waves start (0)")
    add("--side", choices=("out", "in", "both"), help=f"of the upper ({settings.WAVE_SIDE})")
    add("--margin", type=float, metavar="MM", help="opening beyond the rails in mm (the height)")
    add("--fade", type=float, metavar="SHARE", help=f"of the rails, 0 to 0.5 ({settings.FADE:g})")
    _add_switch(add, "--allow-split", "let the opening cut the upper in two")


def _add_piece_arguments(add: Callable[..., Any]) -> None:
    add("--seam-allowance", type=_numbers, metavar="P,Q,START,END", help="widths in mm (0)")
    add("--lasting-margin", type=_numbers, metavar="P,Q,START,END", help="added widths in mm (0)")
    add("--notches", type=int, metavar="N", help="pairs of notches on each long seam (0)")
    add("--notch-spacing", type=float, metavar="MM", help="their distance instead, in mm")
    add("--notch-at-p", type=_numbers, metavar="MM,MM", help="positions on P instead, in mm")
    add("--notch-at-q", type=_numbers, metavar="MM,MM", help="positions on Q instead, in mm")
    add("--notch-kind", choices=("slit", "v", "t", "castle", "check", "u"), help="(slit)")
    add(
        "--drill-hole",
        dest="drill_holes",
        action="append",
        type=_numbers,
        metavar="ALONG,ACROSS",
        help="a hole at shares 0 to 1 of the rails and of the way from P to Q; repeatable",
    )
    add("--mitre-limit", type=float, metavar="N", help=f"in widths ({settings.MITRE_LIMIT:g})")
    add("--thickness", type=float, metavar="MM", help="of the material in mm (the material's)")
    add("--surface-side", choices=("inside", "middle", "outside"), help="of the material (middle)")
    add("--hand", choices=("left", "right"), help="the strip's foot; adds the mirrored twin")
    add("--size", metavar="TEXT", help=f"written on the pieces ({settings.PIECE_SIZE})")
    add("--quantity", type=int, metavar="N", help="written on the pieces (1)")
    add("--overlap", choices=("split", "refuse"), help=f"({settings.PATTERN_OVERLAP})")
    add("--grain", type=_numbers, metavar="X,Y,Z", help="grain in space (along the strip)")
    add("--stretch", type=_numbers, metavar="X,Y,Z", help="stretch in space (not drawn)")
    _add_switch(add, "--rulings", "draw the rulings")
    add("--ruling-spacing", type=float, metavar="MM", help="leave out rulings nearer than this")


def _add_file_arguments(add: Callable[..., Any]) -> None:
    add(
        "--profile",
        metavar="NAME|FILE.toml",
        help=f"layers of the DXF: cutter, aama, astm or your own ({settings.DXF_PROFILE})",
    )
    add("--dxf-version", choices=("R12", "R2000", "R2010"), help="(R2000; R12 for aama, astm)")
    add("--curves", choices=("lines", "arcs", "splines"), help="curved cut lines (lines)")
    _add_switch(add, "--test-square", "add a square of 100 mm to the DXF")
    _add_switch(add, "--svg", "write the pattern as SVG, too")
    _add_switch(add, "--pdf", "write the pattern as PDF, 1:1 on A4 sheets, too")


def _add_limit_arguments(add: Callable[..., Any]) -> None:
    add("--max-fold", dest="max_fold_deg", type=float, metavar="DEG", help="largest fold angle")
    add("--max-twist", dest="max_twist_deg", type=float, metavar="DEG", help="largest twist")
    add(
        "--max-invalid",
        dest="max_invalid_percent",
        type=float,
        metavar="PERCENT",
        help="largest share of the rails under bridges that are not locally convex",
    )
    add("--material", type=Path, metavar="FILE.toml", help="a material's limits and thickness")
    _add_switch(add, "--strict", "a missed limit is a failure (exit code 1)")


def _add_switch(add: Callable[..., Any], flag: str, help_text: str) -> None:
    # None, not False, where it is not given: a job file may say so.
    add(flag, action="store_true", default=None, help=help_text)


def _words(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(float(part) for part in text.split(","))


def _epoch(text: str) -> int | None:
    if text == "":
        return None
    if not text.isdecimal():
        raise InputError(f"SOURCE_DATE_EPOCH - {text!r} - whole seconds since 1970 - correct it")
    return int(text)

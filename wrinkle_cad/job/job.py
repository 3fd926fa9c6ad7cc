"""One job: the frozen settings of one run, from keywords, a TOML file or both.

Precedence: keywords (the command line's flags) over the TOML file over the defaults.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final

from wrinkle_cad import settings
from wrinkle_cad.errors import JobError

_PATH_FIELDS: Final = ("input", "output_dir", "material")
_CHOICES: Final[dict[str, tuple[str, ...]]] = {
    "surface": settings.SURFACES,
    "search": ("global", "local"),
    "energy": ("hinge", "paper"),
    "step_schema": ("AP214", "AP242"),
    "unit": ("mm", "cm", "m", "inch", "ft"),
    "side": ("out", "in", "both"),
    "dxf_version": ("R12", "R2000", "R2010"),
    "notch_kind": ("slit", "v", "t", "castle", "check", "u"),
    "curves": ("lines", "arcs", "splines"),
    "surface_side": ("inside", "middle", "outside"),
    "hand": ("left", "right"),
    "overlap": ("split", "refuse"),
}
_POSITIVE: Final = (
    "tolerance",
    "max_chord",
    "planarity",
    "notch_spacing",
    "quantity",
    "mitre_limit",
)
_NOT_NEGATIVE: Final = (
    "margin",
    "fade",
    "ruling_spacing",
    "thickness",
    "notches",
    "max_fold_deg",
    "max_twist_deg",
    "max_invalid_percent",
)
_VECTORS: Final = {
    "waves": 2,
    "height": 2,
    "phase_deg": 2,
    "seam_allowance": 4,
    "lasting_margin": 4,
    "grain": 3,
    "stretch": 3,
}
_LISTS: Final = ("notch_at_p", "notch_at_q")
_ONE_FOR_ALL: Final = ("waves", "height", "phase_deg", "seam_allowance", "lasting_margin")
"""Of these one number stands for all of its parts."""
_KINDS: Final[dict[str, tuple[type, ...]]] = {
    "str": (str,),
    "bool": (bool,),
    "int": (int,),
    "float": (float, int),
    "Path": (Path, str),
    "tuple[str, ...]": (tuple, list),
}
_NAME_LIMIT: Final = 200
_EPOCH_LIMIT: Final = 253_402_300_800
"""The year 10000, which no date format of the outputs can hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """The settings of one run; lengths in mm unless a name says otherwise."""

    input: Path
    """The STEP, IGES or BREP file to read."""
    output_dir: Path = Path("out")
    """Folder that receives the outputs; made when it is missing."""
    name: str = ""
    """Stem of the outputs; the input's stem when empty."""
    p: str | None = None
    """Directrix P: its name in the file or its index as ``inspect`` prints it."""
    q: str | None = None
    """Directrix Q, likewise."""
    upper: str | None = None
    """The upper surface, likewise."""
    unit: str | None = None
    """Unit of a file that states none."""
    tolerance: float = settings.TOLERANCE
    """How far a chord may lie from its curve."""
    max_chord: float | None = None
    """Longest chord; unlimited when None."""
    planarity: float | None = None
    """How far a neighbour may lie on the wrong side of a tangent plane; derived when None."""
    surface: str = settings.SURFACE
    """``cones`` (banks are the exact curves) or ``facets``."""
    criteria: tuple[str, ...] = settings.CRITERIA
    """What the search minimises, most important first."""
    search: str = settings.SEARCH
    """``global`` or ``local``."""
    energy: str = settings.ENERGY
    """``hinge`` or ``paper``."""
    step_schema: str = settings.STEP_SCHEMA
    """``AP214`` or ``AP242``."""
    rulings: bool = False
    """Whether the pattern shows the rulings as a layer of their own."""
    waves: tuple[float, float] | None = None
    """Full waves of a wrinkle along P and Q on the upper; when None, P and Q are the profiles."""
    height: tuple[float, float] | None = None
    """How high the waves of P and Q stand over the upper."""
    phase_deg: tuple[float, float] | None = None
    """Where in their periods the waves of P and Q start."""
    side: str = settings.WAVE_SIDE
    """``out`` of the upper, ``in`` or ``both``."""
    margin: float | None = None
    """How far the opening reaches beyond the rails; the waves' height when None."""
    fade: float = settings.FADE
    """Share of the rails over which waves and margin grow and die away."""
    allow_split: bool = False
    """Whether an opening may cut the upper in two."""
    profile: str = settings.DXF_PROFILE
    """Layers of the DXF: ``cutter``, ``aama``, ``astm`` or the path of a TOML file."""
    dxf_version: str | None = None
    """``R12``, ``R2000`` or ``R2010``; when None, R2000, and R12 for aama and astm."""
    curves: str = "lines"
    """What curved cut lines are written as: ``lines``, ``arcs`` or ``splines``."""
    seam_allowance: tuple[float, float, float, float] = settings.SEAM_ALLOWANCE
    """Widths on P, Q, the start and the end."""
    lasting_margin: tuple[float, float, float, float] = settings.SEAM_ALLOWANCE
    """Widths added to the allowance of the same edge."""
    notches: int = 0
    """Pairs of notches on each long seam, at equal distances."""
    notch_spacing: float | None = None
    """Distance of the notches instead of their number."""
    notch_at_p: tuple[float, ...] = ()
    """Positions of the notches on P instead, mm of seam from its start."""
    notch_at_q: tuple[float, ...] = ()
    """Likewise on Q."""
    notch_kind: str = "slit"
    """``slit``, ``v``, ``t``, ``castle``, ``check`` or ``u``."""
    drill_holes: tuple[tuple[float, float], ...] = ()
    """(along, across) as shares 0 to 1 of the rails and of the way from P to Q."""
    mitre_limit: float = settings.MITRE_LIMIT
    """Corners of the allowance reach at most this many widths out."""
    thickness: float | None = None
    """Of the material; lengths are taken at its neutral layer. The material's own when None."""
    surface_side: str = "middle"
    """Which side of the material the surface is: ``inside``, ``middle`` or ``outside``."""
    hand: str | None = None
    """``left`` or ``right``: the foot of this strip; its mirrored twin is made as well."""
    size: str = settings.PIECE_SIZE
    """Size that is written on the pieces."""
    quantity: int = 1
    """How many of each piece are to be cut."""
    overlap: str = settings.PATTERN_OVERLAP
    """A flat strip that covers itself: ``split`` or ``refuse``."""
    grain: tuple[float, float, float] | None = None
    """Grain direction in space; along the strip when None."""
    stretch: tuple[float, float, float] | None = None
    """Stretch direction in space; not drawn when None."""
    ruling_spacing: float = 0.0
    """Rulings nearer to each other than this are not drawn."""
    test_square: bool = False
    """Whether the DXF has a square of 100 mm to check the scale."""
    svg: bool = False
    """Whether the pattern is written as SVG, too."""
    pdf: bool = False
    """Whether the pattern is written as PDF, 1:1 tiled on A4, too."""
    max_fold_deg: float | None = None
    """Largest fold angle that passes."""
    max_twist_deg: float | None = None
    """Largest twist that passes."""
    max_invalid_percent: float | None = None
    """Largest share of the rails under invalid bridges that passes."""
    material: Path | None = None
    """TOML file of a material: its limits and thickness."""
    strict: bool = False
    """Whether a missed limit counts as a failure."""
    source_date_epoch: int | None = None
    """Seconds since 1970 (UTC) that stand as the time in every output; now when None."""

    def __post_init__(self) -> None:
        """Checks every setting by itself.

        Raises:
            JobError: a setting is out of its range; the message names it.
        """
        self._check_types()
        for field in _PATH_FIELDS:
            if getattr(self, field, None) is not None:
                object.__setattr__(self, field, Path(getattr(self, field)))
        object.__setattr__(self, "criteria", tuple(self.criteria))
        for field, count in _VECTORS.items():
            value = _vector(field, getattr(self, field), count)
            object.__setattr__(self, field, value)
        for field in _LISTS:
            object.__setattr__(self, field, _numbers(field, getattr(self, field)))
        holes = tuple(_vector("drill_holes", hole, 2) for hole in self.drill_holes)
        object.__setattr__(self, "drill_holes", holes)
        object.__setattr__(self, "name", self.name or _stem_of(self.input))
        _check_name(self.name)
        for field, choices in _CHOICES.items():
            value = getattr(self, field)
            if value is not None and value not in choices:
                raise JobError(f"{field} - {value!r} - one of {', '.join(choices)}")
        for field in (*_POSITIVE, *_NOT_NEGATIVE):
            _check_number(field, getattr(self, field, None), may_be_zero=field in _NOT_NEGATIVE)
        for field in ("notches", "quantity"):
            if not isinstance(getattr(self, field), int):
                raise JobError(f"{field} - {getattr(self, field)!r} - a whole number")
        if (self.waves is None) != (self.height is None):
            raise JobError("waves and height - one without the other - both design a wrinkle")
        epoch = self.source_date_epoch
        if epoch is not None and not 0 <= epoch < _EPOCH_LIMIT:
            raise JobError(f"source_date_epoch - {epoch} s - 0 to {_EPOCH_LIMIT - 1} - correct it")

    def _check_types(self) -> None:
        for field in fields(self):
            kinds = _KINDS.get(str(field.type).removesuffix(" | None"))
            value = getattr(self, field.name)
            if kinds is None or (value is None and str(field.type).endswith("None")):
                continue
            if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
                raise JobError(f"{field.name} - {value!r} - {kinds[0].__name__} - correct it")
        if not all(isinstance(name, str) for name in self.criteria):
            raise JobError(f"criteria - {self.criteria!r} - names of criteria - correct it")


def make_job(
    input_path: Path, keywords: Mapping[str, Any] | None = None, toml_path: Path | None = None
) -> Job:
    """Joins keywords, a TOML file and the defaults into a job.

    Args:
        input_path: the file to read.
        keywords: settings by name; a None counts as not given.
        toml_path: a ``job.toml`` whose keys are the names of the settings.

    Raises:
        JobError: the TOML file cannot be read, or a setting is unknown or out of range.
    """
    merged = read_job_toml(toml_path) if toml_path is not None else {}
    merged.update({key: value for key, value in (keywords or {}).items() if value is not None})
    merged.pop("input", None)
    _check_known(merged, "settings")
    return Job(input=input_path, **merged)


def read_job_toml(path: Path) -> dict[str, Any]:
    """Reads the settings of a ``job.toml``; relative paths in it start at its folder.

    Raises:
        JobError: not TOML, an unknown key or a value of the wrong type.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise JobError(
            f"{path.name} - cannot be read as TOML: {error} - correct the file"
        ) from error
    _check_known(table, path.name)
    for field in _PATH_FIELDS:
        if field in table:
            table[field] = path.parent / str(table[field])
    if str(table.get("profile", "")).lower().endswith(".toml"):
        table["profile"] = str(path.parent / str(table["profile"]))
    return table


def _vector(field: str, value: Any, count: int) -> tuple[float, ...] | None:
    """The numbers of a setting that has several, one standing for all where that makes sense."""
    if value is None:
        return None
    if isinstance(value, int | float):
        value = (value,)
    numbers = _numbers(field, value)
    if len(numbers) == 1 and field in _ONE_FOR_ALL:
        numbers *= count
    if len(numbers) != count:
        raise JobError(f"{field} - {len(numbers)} numbers - {count}")
    return numbers


def _numbers(field: str, value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple):
        raise JobError(f"{field} - {value!r} - a list of numbers")
    for number in value:
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise JobError(f"{field} - {number!r} - a number")
        if not math.isfinite(number):
            raise JobError(f"{field} - {number} - a finite number")
    return tuple(float(number) for number in value)


def _check_known(table: Mapping[str, Any], source: str) -> None:
    known = {field.name for field in fields(Job)}
    for key in table:
        if key not in known:
            raise JobError(
                f"{source} - unknown setting {key!r} - known: {', '.join(sorted(known))}"
            )


def _stem_of(path: Path) -> str:
    stem = path.name
    for suffix in (".gz", ".step", ".stp", ".p21", ".iges", ".igs", ".brep", ".brp"):
        if stem.lower().endswith(suffix) and len(stem) > len(suffix):
            stem = stem[: -len(suffix)]
    return stem


def _check_name(name: str) -> None:
    if name in ("", ".", "..") or any(c in "/\\:\0" or ord(c) < 32 for c in name):
        raise JobError(
            f"name - {name!r} - the stem of a file, without folders or control characters"
        )
    if len(name.encode()) > _NAME_LIMIT:
        raise JobError(
            f"name - {len(name.encode())} bytes - at most {_NAME_LIMIT} - give a shorter --name"
        )


def _check_number(field: str, value: Any, *, may_be_zero: bool) -> None:
    if value is None:
        return
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise JobError(f"{field} - {value!r} - a finite number")
    if value < 0 or (value == 0 and not may_be_zero):
        raise JobError(f"{field} - {value:g} - {'at least' if may_be_zero else 'above'} 0")

"""What a file holds and what a run would take from it, as plain values."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.loading import kernel_importable
from wrinkle_cad.errors import InputError

if TYPE_CHECKING:
    from wrinkle_cad.cad.exchange.choose import Chosen


@dataclass(frozen=True, slots=True)
class ShapeRow:
    """One shape of the file."""

    index: int
    """What ``--p``, ``--q`` and ``--upper`` take."""
    name: str
    """As in the file; empty without one."""
    kind: str
    """``edge``, ``wire``, ``face``, ``shell``, ``solid``, ``compound`` or ``vertex``."""
    measure: float
    """Length in mm of a curve, area in mm2 of a surface."""
    measure_unit: str
    """``mm``, ``mm2`` or empty."""
    taken_as: str
    """``P``, ``<strip>:Q``, ``upper`` or empty."""


@dataclass(frozen=True, slots=True)
class Inspection:
    """The shapes of a file and how a run would use them."""

    file: str
    """The file's name."""
    format: str
    """``STEP``, ``IGES`` or ``BREP``."""
    unit: str
    """The file's unit of length, which was converted to mm."""
    rows: tuple[ShapeRow, ...]
    """Every shape that can be chosen."""
    reasons: tuple[str, ...]
    """Why these shapes would be taken, or why none can be."""
    is_runnable: bool
    """Whether ``run`` with the same choice has its P and Q."""

    def as_json(self) -> dict[str, Any]:
        """The inspection as plain values."""
        return asdict(self)


def inspect_file(
    path: Path,
    *,
    unit: str | None = None,
    p: str | None = None,
    q: str | None = None,
    upper: str | None = None,
    join: float = 0.0,
) -> Inspection:
    """Reads a file and tells what a run would take from it.

    Args:
        path: a STEP, IGES or BREP file.
        unit: unit of a file that states none.
        p: name or index of directrix P, as for a run.
        q: likewise of Q.
        upper: likewise of the upper surface.
        join: mm; gaps between the edges of a rail that a run would close.

    Raises:
        InputError: the file cannot be read.
    """
    with kernel_importable():
        from wrinkle_cad.cad.exchange.choose import choose_inputs
        from wrinkle_cad.cad.exchange.read import read_cad
    file = read_cad(path, unit=unit)
    chosen: Chosen | None = None
    try:
        chosen = choose_inputs(file, p=p, q=q, upper=upper, join=join)
        reasons = chosen.reasons
    except InputError as error:
        reasons = (str(error),)
    taken = {} if chosen is None else _taken_by_index(chosen)
    rows = tuple(
        ShapeRow(s.index, s.name, s.kind, s.measure, s.unit, taken.get(s.index, ""))
        for s in file.shapes
    )
    return Inspection(path.name, file.format, file.unit, rows, reasons, chosen is not None)


def _taken_by_index(chosen: Chosen) -> dict[int, str]:
    taken = {}
    for strip in chosen.strips:
        prefix = "" if strip.name == settings.STRIP_NAME else f"{strip.name}:"
        for rail, role in ((strip.p, "P"), (strip.q, "Q")):
            taken.update(dict.fromkeys((rail.index, *rail.parts), f"{prefix}{role}"))
    if chosen.upper is not None:
        taken[chosen.upper.index] = "upper"
    return taken

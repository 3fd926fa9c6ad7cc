"""Units of length where files come in: what a file declares, what the user says, what a mm is."""

from __future__ import annotations

from typing import Final

from wrinkle_cad import settings

from .sniff import Source

MM_PER_UNIT: Final[dict[str, float]] = {
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "inch": 25.4,
    "ft": 304.8,
}


def check_unit(source: Source, declared: tuple[str, ...], unit: str | None) -> float:
    """Returns by how much the kernel's lengths are to be multiplied.

    Args:
        source: the file.
        declared: the units that it declares; empty if none.
        unit: the unit that the user gave.

    Raises:
        InputError: the file declares a unit and the user another one.
    """
    if not declared:
        return MM_PER_UNIT[unit or settings.FILE_UNIT]
    if unit is not None and declared != (unit,):
        raise source.fail(
            f"the file declares its unit as {' and '.join(declared)}, {unit} was given."
            " Leave --unit away, it is for files that declare none."
        )
    return 1.0


def unit_words(declared: tuple[str, ...], unit: str | None) -> str:
    """Returns the unit of a file in words, and whose word it is where the file has none."""
    if declared:
        return " and ".join(declared)
    return f"{unit} (given)" if unit else f"{settings.FILE_UNIT} (assumed, the file has none)"

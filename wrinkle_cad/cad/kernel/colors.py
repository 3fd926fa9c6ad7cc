"""Colors as the kernel keeps them."""

from __future__ import annotations

from collections.abc import Sequence

from OCP.Quantity import Quantity_Color, Quantity_ColorRGBA, Quantity_TOC_sRGB

from wrinkle_cad.errors import InputError


def occ_color(color: Sequence[float]) -> Quantity_ColorRGBA:
    """Returns the kernel's color for (3,) red, green, blue or (4,) with opacity, sRGB, 0 to 1.

    Raises:
        InputError: not three or four numbers from 0 to 1.
    """
    values = [float(value) for value in color]
    if len(values) not in (3, 4) or not all(0.0 <= value <= 1.0 for value in values):
        raise InputError(f"The color is {tuple(color)}. Pass 3 or 4 numbers from 0 to 1.")
    opacity = values[3] if len(values) == 4 else 1.0
    return Quantity_ColorRGBA(Quantity_Color(*values[:3], Quantity_TOC_sRGB), opacity)

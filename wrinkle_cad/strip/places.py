"""Places in space as a message names them."""

from __future__ import annotations

import math
from collections.abc import Iterable


def place_text(point: Iterable[float], size: float) -> str:
    """Returns a place in mm, to a thousandth of a size or a tenth of a millimetre.

    Args:
        point: x, y, z in mm.
        size: mm; of what the place is on.

    Example:
        >>> place_text((50.0, 10.00001, -0.0), 200.0)
        '(50.0, 10.0, 0.0) mm'
    """
    decimals = 1 if size >= 100.0 or not size > 0.0 else min(9, math.ceil(3.0 - math.log10(size)))
    # Adding zero turns a negative zero into a plain one.
    rounded = (round(float(x), decimals) + 0.0 for x in point)
    return f"({', '.join(f'{x:.{decimals}f}' for x in rounded)}) mm"

"""A closed strip as the middle of an open one that runs around three times.

What is measured at a bridge looks at bridges before and behind it; where the strip runs around
three times, the middle turn has all of them, and no measure need know that the strip is closed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError

Floats = npt.NDArray[np.float64]


def check_closed(p: Floats, q: Floats) -> None:
    """Refuses rails that cannot be closed.

    Raises:
        InputError: a rail has fewer than three samples or repeats its first one.
    """
    for name, rail in (("P", p), ("Q", q)):
        if len(rail) < 3:
            raise InputError(
                f"Closed rail {name} has {len(rail)} samples: at least 3 are needed. Sample it "
                "more finely."
            )
        if (rail[0] == rail[-1]).all():
            raise InputError(
                f"Closed rail {name} ends with its first sample again: leave the last one out."
            )


def closed_line(rail: Floats, repeated: int = 1) -> Floats:
    """Returns a closed rail (k, 3) with its first points repeated at the end, (k+repeated, 3)."""
    return np.concatenate((rail, rail[:repeated]))


def three_turns(p: Floats, q: Floats, start: tuple[int, int]) -> tuple[Floats, Floats]:
    """Returns both rails three times around, from the start's samples to the same again.

    Args:
        p: (m, 3) float64, mm; closed directrix P.
        q: (n, 3) float64, mm; closed directrix Q.
        start: i, j of the bridge where the strip begins.

    Returns:
        (3m+1, 3) and (3n+1, 3) float64, mm.
    """
    first, second = (
        rail[(at + np.arange(3 * len(rail) + 1)) % len(rail)]
        for rail, at in zip((p, q), start, strict=True)
    )
    return first, second


def middle_turn(arrays: Mapping[str, Any], count: int) -> dict[str, Any]:
    """Returns what was measured along three turns for the middle one.

    Args:
        arrays: by name; of a path of 3 count steps, each with an entry per bridge, per step or per
            interior bridge; others, as the rails, as they are.
        count: m+n, the steps of one turn.

    Returns:
        The same names: count+1 entries per bridge, count per step, and count per interior bridge,
        from the turn's first bridge on.
    """
    spans = {
        3 * count + 1: slice(count, 2 * count + 1),
        3 * count: slice(count, 2 * count),
        3 * count - 1: slice(count - 1, 2 * count - 1),
    }
    return {
        name: array if name in ("p", "q") else array[spans[len(array)]].copy()
        for name, array in arrays.items()
    }

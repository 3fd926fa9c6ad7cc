"""Zeros of many functions at once, each in a bracket of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def bracketed_secants(
    function: Callable[[Floats], Floats],
    low: Floats,
    high: Floats,
    values: tuple[Floats, Floats],
    rounds: int,
) -> Iterator[tuple[Floats, Floats]]:
    """Yields (k,) places that come nearer to zeros, and (k,) values there.

    By the Illinois rule: secants that keep a bracket, whose end counts half when it stays.

    Args:
        function: from (k,) places to (k,) values.
        low: (k,) places.
        high: (k,) places; the values there have the other sign.
        values: (k,) each; at ``low`` and at ``high``.
        rounds: so many are yielded at most.

    Example:
        >>> def cube(x):
        ...     return x**3 - 8.0
        >>> ends = np.array([0.0]), np.array([5.0])
        >>> *_, (place, _) = bracketed_secants(cube, *ends, (cube(ends[0]), cube(ends[1])), 20)
        >>> place.round(9).tolist()
        [2.0]
    """
    f_low, f_high = values
    side = np.zeros(len(low))
    for _ in range(rounds):
        fall = f_low - f_high
        share = np.where(fall != 0.0, f_low / np.where(fall != 0.0, fall, 1.0), 0.5)
        at = low + (high - low) * np.clip(share, 0.0, 1.0)
        f_at = function(at)
        yield at, f_at
        upward = f_at * f_low > 0.0
        f_high = np.where(upward, np.where(side > 0.0, f_high / 2.0, f_high), f_at)
        f_low = np.where(upward, f_at, np.where(side < 0.0, f_low / 2.0, f_low))
        low, high = np.where(upward, at, low), np.where(upward, high, at)
        side = np.where(upward, 1.0, -1.0)

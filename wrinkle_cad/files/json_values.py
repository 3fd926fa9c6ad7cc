"""Values that JSON can hold."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def finite(value: Any) -> Any:
    """Returns the same value with null for every number that is not finite, tuples as lists.

    Args:
        value: numbers, texts, None, and mappings, lists and tuples of these.

    Example:
        >>> finite({"radius": float("inf"), "ends": (1.0, 2.0)})
        {'radius': None, 'ends': [1.0, 2.0]}
    """
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): finite(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [finite(part) for part in value]
    return value

"""Seeds of properties: some are tried by default, the rest with ``-m slow``."""

from __future__ import annotations

import pytest

DEFAULT = 20
"""A fault that so many random inputs do not show is looked for by hand, not at every run."""


def seeds(count: int, default: int = DEFAULT) -> list[object]:
    """``range(count)`` for ``parametrize``; what comes after ``default`` is marked slow."""
    return [
        seed if seed < default else pytest.param(seed, marks=pytest.mark.slow)
        for seed in range(count)
    ]

"""A closed strip cut open at one of its bridges: an open one, its last samples its first again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .triangulation import Triangulation, measured


def cut_at(closed: Triangulation, number: int, *, turns: int = 1) -> Triangulation:
    """Returns the open strip from a bridge of a closed one around to the same bridge again.

    Args:
        closed: the closed strip.
        number: of the bridge where it is cut.
        turns: how often it goes around.

    Returns:
        A strip of turns * m + 1 and turns * n + 1 samples.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> p = np.array([[4.0, 0, 0], [0, 4.0, 0], [-4.0, -4.0, 0]])
        >>> opened = cut_at(triangulate(p, p + [0, 0, 9.0], closed=True), 2)
        >>> opened.p.shape, opened.bridges[-1].tolist(), bool((opened.p[0] == opened.p[-1]).all())
        ((4, 3), [3, 3], True)
    """
    p, q = (
        rail[(start + np.arange(turns * len(rail) + 1)) % len(rail)]
        for rail, start in zip((closed.p, closed.q), closed.bridges[number], strict=True)
    )
    found = measured(
        p,
        q,
        np.tile(np.roll(closed.steps, -number), turns),
        planarity=closed.planarity,
        criteria=closed.criteria,
        search=closed.search,
        energy=closed.energy,
        price=closed.price,
        least_bending=closed.least_bending,
    )
    return replace(found, unused=closed.unused, max_lean=closed.max_lean)

"""Pairs of lines that meet, without the memory that all pairs of a hostile file would take."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from wrinkle_cad.pattern.piece.flat import Indices

from . import limits

_AT_ONCE = 64


def meeting_pairs(
    shapes: Sequence[shapely.Geometry], *, distance: float = 0.0
) -> tuple[Indices, Indices]:
    """Returns the pairs (first, second), first < second, of shapes no further apart than that.

    No more than ``limits.MOST_PAIRS`` are looked for.

    Args:
        shapes: lines.
        distance: mm.
    """
    everything = np.asarray(shapes, dtype=object)
    tree = shapely.STRtree(everything)
    found: list[Indices] = [np.zeros((2, 0), dtype=np.int64)]
    count = 0
    for start in range(0, len(everything), _AT_ONCE):
        asked = everything[start : start + _AT_ONCE]
        if distance > 0.0:
            pairs = tree.query(asked, predicate="dwithin", distance=distance)
        else:
            pairs = tree.query(asked, predicate="intersects")
        pairs[0] += start
        pairs = pairs[:, pairs[0] < pairs[1]]
        found.append(pairs[:, np.lexsort((pairs[1], pairs[0]))])
        count += pairs.shape[1]
        if count >= limits.MOST_PAIRS:
            break
    first, second = np.hstack(found)[:, : limits.MOST_PAIRS]
    return first, second

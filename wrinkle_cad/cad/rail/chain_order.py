"""In which order the edges of a rail follow one another, and which way the rail runs.

Only where the edges start and end counts, and the order in which they were given: they were drawn
one after the other, but a list may be shuffled, a file sorted, and a wire starts where the kernel
likes.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.curve.polyline import row_lengths

Floats = NDArray[np.float64]


class Link(NamedTuple):
    """One edge of a chain."""

    edge: int
    """Which of the given edges it is."""
    is_turned: bool
    """Whether the chain runs against it."""


def chain_order(ends: Floats, meeting: float) -> list[Link]:
    """Returns the edges of one chain in order, from the start of the rail to its end.

    The rail runs the way most of its edges do, so that it is the same in whatever order they are
    given. Edges that are listed one after the other, of which the first runs as drawn, keep their
    order though; and if all this says nothing, the first given edge comes as early as it can.

    Args:
        ends: (k, 2, 3) mm: start and end of each edge as it was drawn.
        meeting: mm; ends no further apart than this meet.

    Returns:
        All k edges, each once. Where they form no chain, the next nearest follows.

    Example:
        >>> import numpy as np
        >>> ends = np.array([[[1, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0]]], dtype=float)
        >>> [link.edge for link in chain_order(ends, 1e-3)]
        [1, 0]
    """
    count = len(ends)
    if count < 2:
        return [Link(i, is_turned=False) for i in range(count)]
    as_given = _walked(ends, list(range(count)), first_turned=_first_is_turned(ends))
    is_listed_in_order = _largest_gap(ends, as_given) <= meeting
    chain = as_given if is_listed_in_order else _nearest_next(ends, meeting)
    first_at = next(i for i, link in enumerate(chain) if link.edge == 0)
    is_closed = _apart(_exit(ends, chain[-1]), _entry(ends, chain[0])) <= meeting
    if is_closed:
        return _from_first(chain, first_at)
    if is_listed_in_order and not chain[0].is_turned:
        return chain
    return chain if _runs_as_drawn(chain, first_at) else _turned_round(chain)


def _runs_as_drawn(chain: Sequence[Link], first_at: int) -> bool:
    """Whether an open chain runs the way most of its edges do."""
    turned = sum(link.is_turned for link in chain)
    if 2 * turned != len(chain):
        return 2 * turned < len(chain)
    return 2 * first_at <= len(chain) - 1


def _from_first(chain: Sequence[Link], first_at: int) -> list[Link]:
    """A closed chain begins with the edge that was given first, as it was drawn."""
    begun = [*chain[first_at:], *chain[:first_at]]
    if begun[0].is_turned:
        begun = [begun[0], *begun[:0:-1]]
        begun = [Link(link.edge, not link.is_turned) for link in begun]
    return begun


def _turned_round(chain: Sequence[Link]) -> list[Link]:
    return [Link(link.edge, not link.is_turned) for link in reversed(chain)]


def _first_is_turned(ends: Floats) -> bool:
    """Whether the first edge's start, and not its end, is near the second edge."""
    from_start = min(_apart(ends[0, 0], end) for end in ends[1])
    return from_start < min(_apart(ends[0, 1], end) for end in ends[1])


def _walked(ends: Floats, order: Sequence[int], *, first_turned: bool) -> list[Link]:
    """Follows the edges in a given order, each turned so that its nearer end comes first."""
    links = [Link(order[0], first_turned)]
    for i in order[1:]:
        here = _exit(ends, links[-1])
        links.append(Link(i, _apart(ends[i, 1], here) < _apart(ends[i, 0], here)))
    return links


def _nearest_next(ends: Floats, meeting: float) -> list[Link]:
    """Walks from a loose end, if there is one, always to the nearest edge that is left."""
    first, side = _loosest_end(ends, meeting)
    links = [Link(first, side == 1)]
    left = np.ones(len(ends), dtype=bool)
    left[first] = False
    for _ in range(len(ends) - 1):
        here = _exit(ends, links[-1])
        apart = row_lengths((ends - here).reshape(-1, 3)).reshape(-1, 2)
        apart[~left] = np.inf
        i, entry = divmod(int(apart.argmin()), 2)
        links.append(Link(i, entry == 1))
        left[i] = False
    return links


def _loosest_end(ends: Floats, meeting: float) -> tuple[int, int]:
    """The first edge and end that meets no other edge; if all do, the start of the first edge."""
    points = ends.reshape(-1, 3)
    farthest, found = meeting, (0, 0)
    for i, pair in enumerate(ends):
        for side, end in enumerate(pair):
            apart = row_lengths(points - end)
            apart[2 * i : 2 * i + 2] = np.inf
            if float(apart.min()) > farthest:
                farthest, found = float(apart.min()), (i, side)
    return found


def _largest_gap(ends: Floats, chain: Sequence[Link]) -> float:
    return max(_apart(_exit(ends, one), _entry(ends, other)) for one, other in pairwise(chain))


def _entry(ends: Floats, link: Link) -> Floats:
    return np.asarray(ends[link.edge, int(link.is_turned)])


def _exit(ends: Floats, link: Link) -> Floats:
    return np.asarray(ends[link.edge, 1 - int(link.is_turned)])


def _apart(one: Floats, other: Floats) -> float:
    return float(row_lengths((one - other)[None])[0])

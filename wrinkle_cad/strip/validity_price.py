"""What one invalid bridge more is worth in bending energy.

The last bridges of a strip to become locally convex may cost folds of over 90 degrees. With a price
the search minimises bending plus so much per invalid bridge, where so much is the price times the
mean bending of the strip's least-bending triangulation. The mean is taken per bridge, so the price
does not depend on the sampling; it is taken on rails of at most 250 samples, so it costs little.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import LARGEST_PRICE, PRICE_SAMPLES

from .closed_search import closed_steps
from .closed_strip import closed_line, three_turns
from .curve.polyline import polyline_length
from .folding import HINGE
from .global_search import best_steps
from .objective import weights_of
from .path import walk

Floats = npt.NDArray[np.float64]

GIVE_UP_PRICE: Final = 10.0
"""A length of rail is given up where it holds so many times the bending that it would hold if the
least bending were spread over both rails. At 5 and at 10 none of 30 pieces of cones with unequal
ends lost any rail (at 2.5 nine did), and a tail of 8 mm that turns out of a cylinder's square cut
by 20 degrees or more was left; at 20 not even one that leaves it at a right angle was."""


def checked_price(price: float | None) -> float | None:
    """Returns a price as a float.

    Raises:
        InputError: it is out of range.
    """
    if price is not None and not 0.0 <= price <= LARGEST_PRICE:
        raise InputError(
            f"price cannot be {price}: give a number from 0 to {LARGEST_PRICE:g}, or None, which"
            " puts validity before any bending."
        )
    return None if price is None else float(price)


def thinned_rail(rail: Floats) -> Floats:
    """Returns at most PRICE_SAMPLES samples of a rail: evenly chosen, its ends kept.

    The reversed rail gives the same samples, reversed.

    Args:
        rail: (k, 3) float64, mm.

    Example:
        >>> import numpy as np
        >>> len(thinned_rail(np.zeros((1000, 3)))), len(thinned_rail(np.zeros((7, 3))))
        (250, 7)
    """
    last, room = rail.shape[0] - 1, PRICE_SAMPLES - 1
    if last <= room:
        return rail
    first_half = np.arange(PRICE_SAMPLES // 2)
    # The nearest sample, halves rounded up: in integers, and mirrored rather than rounded again.
    chosen = (2 * first_half * last + room) // (2 * room)
    thinned: Floats = rail[np.concatenate((chosen, last - chosen[::-1]))]
    return thinned


def least_bending(
    p: Floats, q: Floats, *, planarity: float, nothing: float, closed: bool = False
) -> tuple[float, int]:
    """Returns the least hinge energy of the strip, thinned where it is long, and its bridges.

    Args:
        p: (m, 3) float64, mm; checked samples of directrix P.
        q: (n, 3) float64, mm; checked samples of directrix Q.
        planarity: mm; see validity_matrix.
        nothing: mm; a distance that is round-off.
        closed: both rails are closed, their first points not repeated.

    Returns:
        The least among all triangulations of the thinned strip with the fewest fold-backs and then
        the fewest triangles of zero area; how many interior bridges they have.
    """
    if closed:
        # The sample where the rail is closed is the last of it too, and then left out again.
        p, q = (thinned_rail(closed_line(rail))[:-1] for rail in (p, q))
    else:
        p, q = thinned_rail(p), thinned_rail(q)
    weights = weights_of(("bending",), bridge_count=p.shape[0] + q.shape[0])
    if not closed:
        steps = best_steps(p, q, weights, planarity=planarity, nothing=nothing, energy=HINGE)
        path = walk(p, q, steps, planarity=planarity, nothing=nothing, energy=HINGE)
        return math.fsum(path.bending_at), path.bending_at.size
    way = closed_steps(p, q, weights, planarity=planarity, nothing=nothing, energy=HINGE)
    rails = three_turns(p, q, way.start)
    path = walk(*rails, np.tile(way.steps, 3), planarity=planarity, nothing=nothing, energy=HINGE)
    count = len(way.steps)
    return math.fsum(path.bending_at[count - 1 : 2 * count - 1]), count


def invalid_cost(price: float, least: float, interior_count: int) -> float:
    """Returns the bending energy that one invalid bridge is worth: 0 where nothing need bend.

    Args:
        price: in mean bending energies of a bridge.
        least: bending energy of the least-bending triangulation.
        interior_count: its interior bridges.
    """
    return price * least / interior_count if interior_count else 0.0


def unused_cost(least: float, p: Floats, q: Floats) -> float:
    """Returns the bending energy that 1 mm of rail is worth where ends are free.

    Args:
        least: bending energy of the least-bending triangulation of the whole strip.
        p: (m, 3) float64, mm; samples of directrix P.
        q: (n, 3) float64, mm; samples of directrix Q.
    """
    return GIVE_UP_PRICE * least / (polyline_length(p) + polyline_length(q))

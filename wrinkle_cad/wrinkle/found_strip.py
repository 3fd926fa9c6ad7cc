"""From two rails to the strip between them: sampled, searched, searched anew where it must be."""

from __future__ import annotations

from functools import partial

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.apart import check_apart
from wrinkle_cad.cad.rail.closed_starts import are_closed, started_alike
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.cad.rail.joint_samples import mended_between, sample_rails
from wrinkle_cad.strip.flat.turning import without_turning_back
from wrinkle_cad.strip.triangulation import triangulate

from .closed_cut import FoundStrip, cut_at_shortest, without_end
from .options import StripSettings


def found_between(p: Directrix, q: Directrix, chosen: StripSettings) -> FoundStrip:
    """Returns the best strip between two rails that run alike.

    Between closed rails it is the best over all seams, cut at one of its bridges.

    Args:
        p: rail P.
        q: rail Q.
        chosen: tolerance, objective and the rest.

    Raises:
        InputError: rails that cross, touch or coincide between their ends, one closed and one open
            rail, or an option that cannot be used.
    """
    is_closed = are_closed(p, q)
    rails = started_alike(p, q) if is_closed else (p, q)
    samples = sample_rails(*rails, chosen.tolerance, chosen.max_chord)
    check_apart(*rails, *samples)
    search = partial(
        triangulate,
        criteria=chosen.criteria,
        search=chosen.search,
        energy=chosen.energy,
        price=chosen.price,
        planarity=(
            settings.planarity_from(chosen.tolerance)
            if chosen.planarity is None
            else chosen.planarity
        ),
    )
    # The local search chooses no seam: there the strip is cut where its rails were started.
    if is_closed and chosen.search == "global":
        around = search(without_end(samples[0]), without_end(samples[1]), closed=True)
        found = cut_at_shortest(around, rails, samples)
        rails, samples, triangulation = found.rails, found.samples, found.triangulation
    else:
        triangulation = search(samples[0].points, samples[1].points)
    triangulation, samples = without_turning_back(
        *mended_between(triangulation, rails, samples, chosen.tolerance, search),
        (rails[0].point_at, rails[1].point_at),
        search,
        tolerance=settings.FLAT_LINE_PER_TOLERANCE * chosen.tolerance,
    )
    return FoundStrip(rails, samples, triangulation)

"""From two rails to the strip between them: sampled, searched, searched anew where it must be."""

from __future__ import annotations

from functools import partial
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.apart import check_apart
from wrinkle_cad.cad.rail.closed_starts import are_closed, started_alike
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.cad.rail.joint_samples import mended_between, sampled_alone, sampled_jointly
from wrinkle_cad.strip.curve.polyline import polyline_length
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.flat.turning import without_turning_back
from wrinkle_cad.strip.partners import Pair, Search
from wrinkle_cad.strip.triangulation import Triangulation, triangulate

from .closed_cut import FoundStrip, cut_at_shortest, without_end
from .options import StripSettings

SAME_BENDING: Final = 1e-9
"""Energies closer than this share of themselves are equal: round-off is not to choose samples."""
SAME_LENGTH: Final = 1e-12
"""The same for the lengths of a rail's chords."""


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
    alone = sampled_alone(*rails, chosen.tolerance, chosen.max_chord)
    samples = sampled_jointly(*rails, alone, chosen.tolerance)
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
        triangulation, samples = _better(search, samples, alone)
    triangulation, samples = without_turning_back(
        *mended_between(triangulation, rails, samples, chosen.tolerance, search),
        (rails[0].point_at, rails[1].point_at),
        search,
        tolerance=settings.FLAT_LINE_PER_TOLERANCE * chosen.tolerance,
    )
    return FoundStrip(rails, samples, triangulation)


def _better(search: Search, jointly: Pair, alone: Pair) -> tuple[Triangulation, Pair]:
    """The best triangulation between the samples taken jointly, if these bring anything.

    Samples that a straight stretch has only because of the other rail are to keep the strip from
    folding. Where it folds back no more, counts no more invalid bridges and bends no more without
    them, they would only divide its planes.
    """
    found = search(jointly[0].points, jointly[1].points)
    more = [len(new.points) - len(old.points) for new, old in zip(jointly, alone, strict=True)]
    if not any(more) or not all(map(_are_chords_kept, jointly, alone)):
        return found, jointly
    plain = search(alone[0].points, alone[1].points)
    is_no_worse = (
        plain.fold_back_count <= found.fold_back_count
        and plain.counted_invalid_count <= found.counted_invalid_count
        and plain.bending <= (1.0 + SAME_BENDING) * found.bending
    )
    return (plain, alone) if is_no_worse else (found, jointly)


def _are_chords_kept(jointly: Samples, alone: Samples) -> bool:
    """Whether the vertices that were added to a rail lie on the chords that it had."""
    before, after = polyline_length(alone.points), polyline_length(jointly.points)
    return abs(after - before) <= SAME_LENGTH * before

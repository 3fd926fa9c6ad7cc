"""From two rails to the strip between them: sampled, searched, searched anew where it must be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.apart import check_apart
from wrinkle_cad.cad.rail.closed_cut import Cut, FoundStrip, cut_open, without_end
from wrinkle_cad.cad.rail.closed_starts import are_closed, started_alike
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.cad.rail.joint_samples import (
    mended_between,
    met_at_ends,
    sampled_alone,
    sampled_jointly,
)
from wrinkle_cad.cad.rail.trimming import trimmed
from wrinkle_cad.errors import ConstraintError
from wrinkle_cad.strip.curve.polyline import polyline_length, segment_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.flat.turning import without_turning_back
from wrinkle_cad.strip.partners import Pair, Search
from wrinkle_cad.strip.triangulation import Triangulation, triangulate
from wrinkle_cad.strip.ways import checked_give_up

from .options import StripSettings
from .ruling_control import RulingControl, control_of

Floats = NDArray[np.float64]
Mend = Callable[[Triangulation, Pair], tuple[Triangulation, Pair]]

FINER: Final = 3
"""So often chords are halved before it is said that no strip keeps what is asked."""
NOTHING_UNUSED: Final = (0.0, 0.0, 0.0, 0.0)
"""A strip that has all of its rails."""

SAME_BENDING: Final = 1e-9
"""Energies closer than this share of themselves are equal: round-off is not to choose samples."""
SAME_FOLD: Final = 1e-6
"""rad; likewise for folds."""
SAME_LENGTH: Final = 1e-12
"""The same for the lengths of a rail's chords."""


def found_between(p: Directrix, q: Directrix, chosen: StripSettings) -> FoundStrip:
    """Returns the best strip between two rails that run alike.

    Between closed rails it is the best over all seams, cut at one of its bridges.

    Args:
        p: rail P.
        q: rail Q.
        chosen: tolerance, objective and the rest.

    Where no strip between the samples keeps what is asked of its rulings, the rails are sampled
    more finely before that is said.

    Raises:
        ConstraintError: no strip keeps what is asked of its rulings.
        InputError: rails that cross, touch or coincide between their ends, one closed and one open
            rail, or an option that cannot be used.
    """
    chord = chosen.max_chord
    for _ in range(0 if p.is_polyline and q.is_polyline else FINER):
        try:
            return _found_with(p, q, chosen, chord)
        except ConstraintError:
            chord = 0.5 * _longest_chord(p, q, chosen, chord)
    return _found_with(p, q, chosen, chord)


def _longest_chord(
    p: Directrix, q: Directrix, chosen: StripSettings, max_chord: float | None
) -> float:
    alone = sampled_alone(p, q, chosen.tolerance, max_chord)
    samples = sampled_jointly(p, q, alone, chosen.tolerance)
    return max(float(segment_lengths(own.points).max(initial=0.0)) for own in samples)


def _found_with(
    p: Directrix, q: Directrix, chosen: StripSettings, max_chord: float | None
) -> FoundStrip:
    """The best strip between rails sampled with chords no longer than given."""
    is_closed = are_closed(p, q)
    give_up = checked_give_up(chosen.ends, chosen.give_up)
    rails = started_alike(p, q) if is_closed else (p, q)
    control = control_of(chosen, p, q, closed=is_closed)
    alone = sampled_alone(*rails, chosen.tolerance, max_chord)
    samples = control.marked(rails, sampled_jointly(*rails, alone, chosen.tolerance))
    check_apart(*rails, *samples)
    own = control.marked(rails, alone)
    if not is_closed:
        samples, own = met_at_ends(*samples), met_at_ends(*own)
    search = _search(chosen, control)
    unused = NOTHING_UNUSED
    if is_closed:
        around = search(
            without_end(samples[0]),
            without_end(samples[1]),
            closed=True,
            ends=chosen.ends,
            give_up=give_up,
        )
        found = cut_open(around, rails, samples, _cut_of(chosen, control, samples))
        rails, samples, triangulation = found.rails, found.samples, found.triangulation
    elif chosen.ends == "free":
        rails, samples, triangulation = _with_free_ends(search, rails, samples, give_up)
        unused = triangulation.unused
    else:
        mend = _mending(rails, search, chosen.tolerance)
        triangulation, samples = _better(search, mend, samples, own)
        return FoundStrip(rails, samples, triangulation, control.held_by(samples, triangulation))
    triangulation, samples = _mending(rails, search, chosen.tolerance)(triangulation, samples)
    held = control.held_by(samples, triangulation)
    return FoundStrip(rails, samples, replace(triangulation, unused=unused), held)


def _mending(rails: tuple[Directrix, Directrix], search: Search, tolerance: float) -> Mend:
    """What gives a strip the samples without which it would fold or its cones would turn back."""

    def mend(found: Triangulation, samples: Pair) -> tuple[Triangulation, Pair]:
        return without_turning_back(
            *mended_between(found, rails, samples, tolerance, search),
            (rails[0].point_at, rails[1].point_at),
            search,
            tolerance=settings.FLAT_LINE_PER_TOLERANCE * tolerance,
        )

    return mend


def _search(chosen: StripSettings, control: RulingControl) -> Callable[..., Triangulation]:
    """How the best triangulation between two rows of samples is found under what was asked."""
    is_derived = chosen.planarity is None
    planarity = settings.planarity_from(chosen.tolerance) if is_derived else chosen.planarity

    def search(p: Floats, q: Floats, *, closed: bool = False, **more: Any) -> Triangulation:
        return triangulate(
            p,
            q,
            criteria=chosen.criteria,
            search=chosen.search,
            energy=chosen.energy,
            price=chosen.price,
            planarity=planarity,
            closed=closed,
            **control.asked_of(p, q, closed=closed),
            **more,
        )

    return search


def _cut_of(chosen: StripSettings, control: RulingControl, samples: Pair) -> Cut:
    """Where a closed strip is to be cut: a rule, or the samples of P and Q."""
    if isinstance(chosen.cut, str):
        return chosen.cut
    asked = control.asked_of(*map(without_end, samples), closed=True)["pinned"]
    i, j = asked[-1]
    return i, j


def _with_free_ends(
    search: Callable[..., Triangulation],
    rails: tuple[Directrix, Directrix],
    samples: Pair,
    give_up: float | None,
) -> tuple[tuple[Directrix, Directrix], Pair, Triangulation]:
    """The best strip between parts of the rails, and these parts."""
    found = search(samples[0].points, samples[1].points, ends="free", give_up=give_up)
    cut = [
        trimmed(rail, own, first, first + len(points) - 1)
        for rail, own, first, points in zip(
            rails, samples, found.first_samples, (found.p, found.q), strict=True
        )
    ]
    (p, p_samples), (q, q_samples) = cut
    return (p, q), (p_samples, q_samples), replace(found, first_samples=(0, 0))


def _better(search: Search, mend: Mend, jointly: Pair, alone: Pair) -> tuple[Triangulation, Pair]:
    """The best triangulation between the samples taken jointly, if these bring anything; mended.

    Samples that a straight stretch has only because of the other rail are to keep the strip from
    folding. Where it folds back no more, counts no more invalid bridges, bends no more and folds no
    more sharply without them, they would only divide its planes. What a strip must be mended by
    counts as well: without them more of its cones may turn back.
    """
    found = search(jointly[0].points, jointly[1].points)
    more = [len(new.points) - len(old.points) for new, old in zip(jointly, alone, strict=True)]
    if not any(more) or not all(map(_are_chords_kept, jointly, alone)):
        return mend(found, jointly)
    try:
        plain = search(alone[0].points, alone[1].points)
    except ConstraintError:
        return mend(found, jointly)
    if not _is_no_worse(plain, found):
        return mend(found, jointly)
    mended = mend(plain, alone)
    if mended[0] is plain:
        return mended
    other = mend(found, jointly)
    return mended if _is_no_worse(mended[0], other[0]) else other


def _is_no_worse(plain: Triangulation, found: Triangulation) -> bool:
    return (
        plain.fold_back_count <= found.fold_back_count
        and plain.counted_invalid_count <= found.counted_invalid_count
        and plain.bending <= (1.0 + SAME_BENDING) * found.bending
        and _sharpest_fold(plain) <= _sharpest_fold(found) + SAME_FOLD
    )


def _sharpest_fold(strip: Triangulation) -> float:
    """rad, not negative."""
    return float(np.abs(strip.fold).max(initial=0.0))


def _are_chords_kept(jointly: Samples, alone: Samples) -> bool:
    """Whether the vertices that were added to a rail lie on the chords that it had."""
    before, after = polyline_length(alone.points), polyline_length(jointly.points)
    return abs(after - before) <= SAME_LENGTH * before

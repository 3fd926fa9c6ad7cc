"""What closes a gap, tried: rails turned against its twist, and the strip between them ruled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import numpy.typing as npt

from .closed import rule_closed_strip
from .gaps import Gap
from .rail_curve import RailCurve
from .surface import RuledStrip, rule_strip
from .turned_rail import RailName, Stays, TurnedRail, turned_in

Floats = npt.NDArray[np.float64]

AMOUNTS: Final = (0.5, 0.25)
"""Shares of the twist that are tried after the whole of it is enough."""
BRIDGES: Final = 200
"""Rulings of the strip as it is that say where to look for those between the turned rails."""
LESS: Final = 0.8
"""A cure leaves at most this share of the strain."""
SLIGHT_CREASE: Final = 0.05
"""rad; a cure makes no sharper crease than this, or than the strip has."""


@dataclass(frozen=True, slots=True, eq=False)
class Cure:
    """A turn of one rail that was tried, and what it leaves of a gap's strain."""

    turned: TurnedRail
    """The turn."""
    strain: float
    """The largest strain that is left where the gap was, 0 to 1."""


def cure_of(
    rails: tuple[RailCurve, RailCurve],
    strip: RuledStrip,
    gap: Gap,
    *,
    is_closed: bool,
    enough: float,
) -> Cure | None:
    """Returns the least turn of a rail that leaves little enough strain, or the least strain.

    Both rails are tried, each so that its start, its end or both stay; then half and a quarter of
    the turn that does. Whatever strains or creases the strip more elsewhere is no cure.

    Args:
        rails: the curves P and Q.
        strip: the exact surface between them.
        gap: one of its gaps.
        is_closed: whether the rails end where they start; then they must after the turn.
        enough: strain, 0 to 1, that counts as none.

    Returns:
        None if nothing that was tried lessens the strain by a fifth.
    """
    attempt = partial(_tried, rails, strip, gap, is_closed)
    tried = [cure for way in _ways(is_closed) if (cure := attempt(*way, 1.0)) is not None]
    if not tried:
        return None
    doing = [cure for cure in tried if cure.strain <= enough]
    if not doing:
        return min(tried, key=lambda cure: cure.strain)
    best = min(doing, key=lambda cure: cure.turned.distance)
    for amount in AMOUNTS:
        less = attempt(best.turned.rail, best.turned.stays, amount)
        if less is None or less.strain > enough:
            break
        best = less
    return best


def _ways(is_closed: bool) -> Iterator[tuple[RailName, Stays]]:
    kept: tuple[Stays, ...] = ("both",) if is_closed else ("both", "start", "end")
    rails: tuple[RailName, ...] = ("P", "Q")
    for stays in kept:
        for rail in rails:
            yield rail, stays


def _tried(
    rails: tuple[RailCurve, RailCurve],
    strip: RuledStrip,
    gap: Gap,
    is_closed: bool,
    rail: RailName,
    stays: Stays,
    amount: float,
) -> Cure | None:
    p, q = rails
    turned = turned_in(strip, gap, rail, stays, amount)
    if turned is None:
        return None
    if rail == "P":
        p = turned.of(p, is_closed=is_closed)
    else:
        q = turned.of(q, is_closed=is_closed)
    after = _ruled(p, q, strip, is_closed=is_closed)
    left = after.strain.largest if is_closed else _strain_in(after, strip, gap)
    is_worse = after.strain.largest > strip.strain.largest
    is_worse |= after.largest_crease > max(SLIGHT_CREASE, strip.largest_crease)
    return None if is_worse or left > LESS * gap.strain else Cure(turned, left)


def _ruled(p: RailCurve, q: RailCurve, strip: RuledStrip, *, is_closed: bool) -> RuledStrip:
    """The surface between two rails near that between the rails as they were."""
    rulings = strip.sheet.rulings
    count = len(rulings.u)
    chosen = np.arange(count)[:: max(1, count // BRIDGES)]
    chosen = np.append(chosen[chosen < count - 1], count - 1)
    u, v = rulings.u[chosen], rulings.v[chosen]
    if not is_closed:
        return rule_strip(p, q, (u, v))
    for at, rail in ((u, p), (v, q)):
        at[-1] = at[0] + (rail.interval[1] - rail.interval[0])
    return rule_closed_strip(p, q, (np.maximum.accumulate(u), np.maximum.accumulate(v)))


def _strain_in(after: RuledStrip, before: RuledStrip, gap: Gap) -> float:
    """The largest strain between the ends of a gap, on either rail."""
    ends = before.sheet.rulings
    new = after.sheet.rulings
    inside = (new.u[1:] >= ends.u[gap.first]) & (new.u[:-1] <= ends.u[gap.last])
    inside |= (new.v[1:] >= ends.v[gap.first]) & (new.v[:-1] <= ends.v[gap.last])
    return float(after.strain.share[inside].max(initial=0.0))

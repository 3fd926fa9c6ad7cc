"""The exact surface of a strip between two directrices."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wrinkle_cad.strip.rulings.closed import rule_closed_strip
from wrinkle_cad.strip.rulings.held import NOTHING_HELD, Held
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip
from wrinkle_cad.strip.rulings.through_points import rail_through

if TYPE_CHECKING:
    from wrinkle_cad.cad.rail.directrix import Directrix
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.triangulation import Triangulation


def exact_surface(
    p: Directrix,
    q: Directrix,
    p_samples: Samples,
    q_samples: Samples,
    triangulation: Triangulation,
    held: Held = NOTHING_HELD,
    *,
    is_cut: bool = False,
) -> RuledStrip:
    """Returns the surface between two directrices that their triangulation approximates.

    Args:
        p: directrix P.
        q: directrix Q, in the same direction.
        p_samples: the samples of P.
        q_samples: the samples of Q.
        triangulation: of these samples.
        held: what was asked of the rulings, in parameters of the directrices.
        is_cut: take a closed strip from its first bridge to its last, as if it were open. That
            bridge, where it is cut, then counts as a ruling, if only nearly one.
    """
    rails = (rail_curve(p), rail_curve(q))
    counts = (len(triangulation.p), len(triangulation.q))
    at_p, at_q = (
        samples.parameters[index % count] + (index // count) * (rail.interval[1] - rail.interval[0])
        for samples, index, count, rail in zip(
            (p_samples, q_samples), triangulation.bridges.T, counts, rails, strict=True
        )
    )
    # A closed strip's triangulation is cut open; its rails start where it is cut.
    is_closed = p.is_closed and q.is_closed and not is_cut
    rule = rule_closed_strip if is_closed else rule_strip
    return rule(*rails, (at_p, at_q), triangulation.max_lean, held)


def rail_curve(directrix: Directrix) -> RailCurve:
    """Returns a directrix as the mathematics takes it; points as the curve they lie on."""
    if directrix.is_polyline:
        (piece,) = directrix.pieces
        return rail_through(piece.poles)
    return RailCurve(
        directrix.point_at, directrix.velocity_at, directrix.interval, directrix.breaks
    )

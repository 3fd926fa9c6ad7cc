"""A closed strip, found over all its seams and then cut at a ruling to be laid flat.

The search knows no seam; a sheet does. So the strip is cut where that is shortest to sew, at its
shortest bridge that does not divide a cone, and both rails are started again there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.cad.rail.closed_starts import started_at
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.triangulation import Triangulation, measured

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class FoundStrip:
    """A strip between two rails; if these are closed, its last bridge is its first one again."""

    rails: tuple[Directrix, Directrix]
    """P and Q; closed ones start at the cut."""
    samples: tuple[Samples, Samples]
    """Of P and of Q; of a closed rail the first point is repeated at the end."""
    triangulation: Triangulation
    """Between these samples."""


def without_end(samples: Samples) -> Floats:
    """Returns the points of a closed rail, none twice: its last sample is its first."""
    return samples.points[:-1]


def cut_at_shortest(
    closed: Triangulation,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
) -> FoundStrip:
    """Returns a closed strip cut at its shortest bridge between two faces; of equal ones the first.

    Args:
        closed: the best triangulation over all starting bridges, of samples without their ends.
        rails: P and Q, closed and alike.
        samples: of P and of Q, with the first point repeated at the end.
    """
    i, j = closed.bridges[:-1].T
    m, n = len(closed.p), len(closed.q)
    lengths = row_lengths(closed.p[i % m] - closed.q[j % n])
    lengths[_is_inside_fan(closed)] += float(lengths.max())
    shortest = float(lengths.min())
    at = int(np.flatnonzero(lengths <= shortest + 1e-9 * max(shortest, 1.0))[0])
    cuts = int(i[at]) % m, int(j[at]) % n
    turned = [_started(rail, own, cut) for rail, own, cut in zip(rails, samples, cuts, strict=True)]
    (p, p_samples), (q, q_samples) = turned
    triangulation = measured(
        p_samples.points,
        q_samples.points,
        np.roll(closed.steps, -at),
        planarity=closed.planarity,
        criteria=closed.criteria,
        search=closed.search,
        energy=closed.energy,
        price=closed.price,
        least_bending=closed.least_bending,
    )
    return FoundStrip((p, q), (p_samples, q_samples), triangulation)


def _is_inside_fan(closed: Triangulation) -> NDArray[np.bool_]:
    """(m+n,) bool: bridges between two steps on one rail, which are one face and stay one."""
    return np.asarray(np.roll(closed.steps, 1) == closed.steps, dtype=np.bool_)


def _started(rail: Directrix, samples: Samples, cut: int) -> tuple[Directrix, Samples]:
    """A rail and its samples, both started at one of these."""
    first, last = rail.interval
    at = float(samples.parameters[cut])
    points = np.roll(samples.points[:-1], -cut, axis=0)
    parameters = np.roll(samples.parameters[:-1], -cut) - at
    parameters = np.where(parameters < 0.0, parameters + (last - first), parameters)
    return started_at(rail, at), Samples(
        np.append(parameters, last - first), np.concatenate((points, points[:1]))
    )

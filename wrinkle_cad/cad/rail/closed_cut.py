"""A closed strip, found over all its seams and then cut at a ruling to be laid flat.

The search knows no seam; a sheet does. So the strip is cut where that is shortest to sew, at its
shortest bridge that does not divide a cone, or where the user says, or where the flat strip fits
the smallest sheet; and both rails are started again there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from wrinkle_cad.strip.curve.polyline import row_lengths
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.cut_open import cut_at
from wrinkle_cad.strip.flat.overlap import is_overlapping
from wrinkle_cad.strip.flat.unrolling import unroll
from wrinkle_cad.strip.rulings.held import NOTHING_HELD, Held
from wrinkle_cad.strip.triangulation import Triangulation

from .closed_starts import started_at
from .directrix import Directrix

Floats = NDArray[np.float64]
Cut = Literal["shortest", "best"] | tuple[int, int]
"""Where to cut: by a rule, or at the bridge between two samples."""

SAME: Final = 1e-9
"""Lengths and sheets that differ by a smaller share are equal but for round-off."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundStrip:
    """A strip between two rails; if these are closed, its last bridge is its first one again."""

    rails: tuple[Directrix, Directrix]
    """P and Q; closed ones start at the cut."""
    samples: tuple[Samples, Samples]
    """Of P and of Q; of a closed rail the first point is repeated at the end."""
    triangulation: Triangulation
    """Between these samples."""
    held: Held = NOTHING_HELD
    """What was asked of its rulings, in parameters of the rails."""


def without_end(samples: Samples) -> Floats:
    """Returns the points of a closed rail, none twice: its last sample is its first."""
    return samples.points[:-1]


def cut_open(
    closed: Triangulation,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
    cut: Cut,
) -> FoundStrip:
    """Returns a closed strip cut at one of its bridges.

    Args:
        closed: the best triangulation over all starting bridges, of samples without their ends.
        rails: P and Q, closed and alike.
        samples: of P and of Q, with the first point repeated at the end.
        cut: ``shortest``: the shortest bridge between two faces, not in the middle of a plane if
            there is another, of equal ones the first; ``best``:
            the bridge between two faces at which the flat strip fits the smallest rectangle without
            covering itself, the shortest of those; or i, j of a bridge that the strip has.
    """
    at = _bridge_to_cut(closed, cut)
    m, n = len(closed.p), len(closed.q)
    i, j = closed.bridges[at].tolist()
    turned = [
        _started(rail, own, start)
        for rail, own, start in zip(rails, samples, (i % m, j % n), strict=True)
    ]
    (p, p_samples), (q, q_samples) = turned
    return FoundStrip((p, q), (p_samples, q_samples), cut_at(closed, at))


def _bridge_to_cut(closed: Triangulation, cut: Cut) -> int:
    """The number of the bridge where a closed strip is cut."""
    i, j = closed.bridges[:-1].T
    i, j = i % len(closed.p), j % len(closed.q)
    if not isinstance(cut, str):
        return int(np.flatnonzero((i == cut[0]) & (j == cut[1]))[0])
    lengths = row_lengths(closed.p[i] - closed.q[j])
    longest = float(lengths.max())
    lengths[closed.bending_at == 0.0] += longest
    lengths[_is_inside_fan(closed)] += 2.0 * longest
    if cut == "best":
        lengths = _among_best(closed, lengths)
    shortest = float(lengths.min())
    return int(np.flatnonzero(lengths <= shortest + SAME * max(shortest, 1.0))[0])


def _among_best(closed: Triangulation, lengths: Floats) -> Floats:
    """The lengths of bridges, infinite where the flat strip needs a larger sheet."""
    twice = cut_at(closed, 0, turns=2)
    flat, count = unroll(twice), len(closed.steps)
    starts, ends = twice.bridges[:count], twice.bridges[count : 2 * count] + 1
    sheets = np.full(count, np.inf)
    pieces = []
    for (i, j), (last_i, last_j) in zip(starts.tolist(), ends.tolist(), strict=True):
        pieces.append((flat.p[i:last_i], flat.q[j:last_j]))
        outline = shapely.MultiPoint(np.concatenate(pieces[-1]))
        sheets[len(pieces) - 1] = outline.minimum_rotated_rectangle.area
    sheets[_is_inside_fan(closed)] += 2.0 * float(sheets.max())
    for at in np.argsort(sheets, kind="stable").tolist():
        if not is_overlapping(*pieces[at]):
            return np.where(np.abs(sheets - sheets[at]) <= SAME * sheets[at], lengths, np.inf)
    return lengths


def _is_inside_fan(closed: Triangulation) -> NDArray[np.bool_]:
    """(m+n,) bool: bridges between two steps on one rail, which are one face and stay one."""
    return np.asarray(np.roll(closed.steps, 1) == closed.steps, dtype=np.bool_)


def _started(rail: Directrix, samples: Samples, cut: int) -> tuple[Directrix, Samples]:
    """A rail and its samples, both started at one of these; the same if that is the first."""
    if cut == 0 and (samples.points[0] == samples.points[-1]).all():
        return rail, samples
    first, last = rail.interval
    at = float(samples.parameters[cut])
    points = np.roll(samples.points[:-1], -cut, axis=0)
    parameters = np.roll(samples.parameters[:-1], -cut) - at
    parameters = np.where(parameters < 0.0, parameters + (last - first), parameters)
    return started_at(rail, at), Samples(
        np.append(parameters, last - first), np.concatenate((points, points[:1]))
    )

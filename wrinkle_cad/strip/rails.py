"""The two sampled rails of a strip: what is accepted, and how finely they are sampled."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.errors import InputError
from wrinkle_cad.settings import (
    COINCIDENT_SAGITTAS,
    LARGEST_COORDINATE,
    PLANARITY_FLOOR_PER_COORDINATE,
    PLANARITY_PER_TOLERANCE,
    ROUND_OFF_PER_COORDINATE,
)

from .curve.nearest import nearest_on_polyline
from .curve.polyline import polyline_length
from .portable import dot
from .runs import runs_of

Floats = npt.NDArray[np.float64]

OUTSIDE_SHARE: Final = 0.25
"""Samples of one curve lie off the chords between others of it towards its outer side: the cosine
of the two directions is 0.3 to 0.97. Of two rails beside each other one has minus the other's."""


def checked_rails(p: npt.ArrayLike, q: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Returns both rails as new float64 arrays, or says what is wrong with them.

    Args:
        p: (m, 3) float, mm; samples of directrix P, m >= 1. Not written to.
        q: (n, 3) float, mm; samples of directrix Q, n >= 1. Not written to.

    Raises:
        InputError: a rail is no (k, 3) array of finite points, or both are single points.
    """
    rails = _checked_rail(p, "P"), _checked_rail(q, "Q")
    if len(rails[0]) == len(rails[1]) == 1:
        raise InputError(
            "P and Q are a single point each. At most one of them may be a point: pass at least two"
            " samples of the other."
        )
    return rails


def _checked_rail(points: npt.ArrayLike, name: str) -> Floats:
    try:
        rail = np.array(points, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InputError(
            f"Rail {name} is no array of numbers ({error}). Pass a (k, 3) array: one x, y, z"
            " per sample."
        ) from error
    if rail.ndim != 2 or rail.shape[1] != 3 or rail.shape[0] < 1:
        raise InputError(
            f"Rail {name} has the shape {rail.shape}. Pass an array of shape (k, 3) with k >="
            " 1: one x, y, z per sample."
        )
    bad = np.flatnonzero(~np.isfinite(rail).all(axis=1))
    if bad.size:
        raise InputError(
            f"Rail {name} has {bad.size} samples that are not finite; the first is number"
            f" {bad[0]}. Every coordinate must be a finite number: repair the curve or its"
            " sampling."
        )
    largest = float(np.abs(rail).max())
    if largest > LARGEST_COORDINATE:
        raise InputError(
            f"Rail {name} has a coordinate of {largest:.3g} mm; at most"
            f" {LARGEST_COORDINATE:.0e} mm is allowed. Check the unit of the input."
        )
    return rail


def round_off(*rails: Floats) -> float:
    """Returns the distance in mm below which coordinates of these rails say nothing."""
    return ROUND_OFF_PER_COORDINATE * _largest(*rails)


def _largest(*rails: Floats) -> float:
    return max(float(np.abs(rail).max()) for rail in rails)


def sagittas(rail: Floats) -> Floats:
    """Returns the distance of each inner sample from the chord between its neighbours.

    Args:
        rail: (k, 3) float64, mm.

    Returns:
        (k-2,) float64, mm.
    """
    chord = rail[2:] - rail[:-2]
    arm = rail[1:-1] - rail[:-2]
    length = np.sqrt((chord * chord).sum(axis=1))
    along = np.divide(
        (arm * chord).sum(axis=1), length * length, where=length > 0.0, out=length * 0
    )
    off = arm - np.clip(along, 0.0, 1.0)[:, None] * chord
    result: Floats = np.sqrt((off * off).sum(axis=1))
    return result


def typical_sagitta(*rails: Floats) -> float:
    """Returns the median sagitta in mm of the bent triples of all rails; 0 when all are straight.

    Some four times the chord tolerance for rails sampled to one. Straight stretches are left out:
    they are sampled as sparsely as one likes and tell nothing.

    Args:
        rails: (k, 3) float64 each, mm.
    """
    sagitta = np.concatenate([sagittas(rail) for rail in rails])
    bent = sagitta[sagitta > round_off(*rails)]
    return float(np.median(bent)) if bent.size else 0.0


def coarser_sagitta(p: Floats, q: Floats) -> float:
    """Returns the typical sagitta in mm of the rail that is sampled more coarsely."""
    return max(typical_sagitta(p), typical_sagitta(q))


def default_planarity(p: Floats, q: Floats) -> float:
    """Returns the planarity in mm for rails that come without a chord tolerance.

    A fixed share of the typical sagitta, never below what round-off of the coordinates does to
    neighbours whose spacings differ some hundredfold.
    """
    floor = PLANARITY_FLOOR_PER_COORDINATE * _largest(p, q)
    return max(PLANARITY_PER_TOLERANCE * typical_sagitta(p, q), floor)


def checked_planarity(p: Floats, q: Floats, planarity: float | None) -> float:
    """Returns the planarity to use, in mm: the one given, or the default one of these rails.

    Raises:
        InputError: it is negative or not finite.
    """
    if planarity is None:
        return default_planarity(p, q)
    if not (np.isfinite(planarity) and planarity >= 0.0):
        raise InputError(
            f"planarity cannot be {planarity} mm: give a finite distance of at least 0 mm, or leave"
            " it out to have it chosen."
        )
    return float(planarity)


def check_rails_apart(p: Floats, q: Floats, planarity: float) -> None:
    """Refuses rails that coincide: everywhere, or over more than one bank edge.

    A rail may touch the other in single samples, and share one bank edge with it, as where both run
    into the same end. Everywhere means: no sample is further from the other rail than two samplings
    of one curve are from each other, and each rail lies on the outer side of the other's chords, as
    these do. Of two rails beside each other one lies on the inner side.

    Raises:
        InputError: the strip has no width over a stretch; the message says where.
    """
    # A rail of one point is a polyline of one segment without length.
    p_line, q_line = (np.repeat(rail, 2, axis=0) if len(rail) == 1 else rail for rail in (p, q))
    p_gap = nearest_on_polyline(p, q_line).distance
    q_gap = nearest_on_polyline(q, p_line).distance
    p_limit = max(planarity, COINCIDENT_SAGITTAS * typical_sagitta(q))
    q_limit = max(planarity, COINCIDENT_SAGITTAS * typical_sagitta(p))
    is_near = p_gap.max() <= p_limit and q_gap.max() <= q_limit
    if is_near and _outside_share(p, q_line) + _outside_share(q, p_line) >= 2.0 * OUTSIDE_SHARE:
        raise InputError(
            f"P and Q coincide: they are nowhere more than {max(p_gap.max(), q_gap.max()):.3g} mm"
            f" apart, and their sampling tells {max(p_limit, q_limit):.3g} mm. Choose two different"
            " curves."
        )
    for name, gap, rail in (("P", p_gap, p), ("Q", q_gap, q)):
        first, last = _longest_run(gap <= planarity)
        if last - first >= 2:
            length = polyline_length(rail[first : last + 1])
            raise InputError(
                f"P and Q coincide over {length:.3g} mm, from sample {first} to {last} of {name}."
                " They may share one bank edge at most: trim both curves there."
            )


def _outside_share(points: Floats, line: Floats) -> float:
    """Returns how far points lie off a line towards the curve that it samples: -1 to 1.

    The mean cosine of the two directions, by their sizes; 1 for points on the line.
    """
    found = nearest_on_polyline(points, line)
    start, end = line[found.segment], line[found.segment + 1]
    offset = points - start - found.share[:, None] * (end - start)
    bulge = np.zeros_like(line)
    bulge[1:-1] = line[1:-1] - 0.5 * (line[:-2] + line[2:])
    outward = bulge[found.segment] + bulge[found.segment + 1]
    most = math.fsum(np.sqrt(dot(offset, offset) * dot(outward, outward)).tolist())
    return math.fsum(dot(offset, outward).tolist()) / most if most > 0.0 else 1.0


def _longest_run(marked: npt.NDArray[np.bool_]) -> tuple[int, int]:
    """First and last index of the longest run of True; (0, -1) if there is none."""
    first, stop = max(runs_of(marked), key=lambda run: run[1] - run[0], default=(0, 0))
    return first, stop - 1

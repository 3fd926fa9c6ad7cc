"""The two rails of a strip, sampled with regard to each other."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError

from .directrix import Directrix, sample_directrix

if TYPE_CHECKING:
    from wrinkle_cad.strip.curve.sampling import Samples
    from wrinkle_cad.strip.triangulation import Triangulation

Floats = NDArray[np.float64]
Search = Callable[[Floats, Floats], "Triangulation"]

MOST_CHORDS: Final = 20_000
"""A rail that needs more of them has another unit than was meant; its strip would take minutes."""


def sampled_alone(
    p: Directrix, q: Directrix, tolerance: float, max_chord: float | None = None
) -> tuple[Samples, Samples]:
    """Returns the vertices of both rails of a strip, each for itself.

    Args:
        p: rail P.
        q: rail Q.
        tolerance: mm; how far a chord may lie from its curve.
        max_chord: mm; longest chord, unlimited when None.

    Raises:
        InputError: a tolerance or ``max_chord`` that is not positive, or too fine.
    """
    p_samples, q_samples = (_sampled(rail, tolerance, max_chord) for rail in (p, q))
    for name, rail, samples in (("P", p, p_samples), ("Q", q, q_samples)):
        if not rail.is_polyline and len(samples.points) > MOST_CHORDS:
            raise InputError(
                f"Rail {name} needs {len(samples.points) - 1} chords to be followed within"
                f" {tolerance:g} mm, and at most {MOST_CHORDS} are taken: give a larger"
                f" tolerance or max_chord, or check its unit (it is {rail.length:.6g} mm long)."
            )
    return p_samples, q_samples


def _sampled(rail: Directrix, tolerance: float, max_chord: float | None) -> Samples:
    """The vertices of a rail; those of a closed one by its arc length."""
    if not rail.is_closed or rail.is_polyline:
        return sample_directrix(rail, tolerance, max_chord)
    # Compiled code is loaded when it is needed, not when a file is read.
    from wrinkle_cad.strip.curve.sampling import Samples, sample_curve

    from .by_arc import RailByArc

    by_arc = RailByArc(rail)
    samples = sample_curve(
        lambda arcs: rail.point_at(by_arc.parameters_at(arcs)),
        (0.0, by_arc.length),
        tolerance,
        breaks=by_arc.arcs_at(np.array(rail.breaks, dtype=np.float64)),
        max_chord=max_chord,
    )
    parameters = by_arc.parameters_at(samples.parameters)
    # Where the curve has a corner its parameter is known to the last digit.
    for mark in (*rail.interval, *rail.breaks):
        parameters[np.abs(parameters - mark).argmin()] = mark
    return Samples(parameters, rail.point_at(parameters))


def sampled_jointly(
    p: Directrix, q: Directrix, alone: tuple[Samples, Samples], tolerance: float
) -> tuple[Samples, Samples]:
    """Returns the vertices of both rails of a strip, each with regard to the other.

    Both are judged as they are sampled on their own, so that the rails' order does not matter.

    Args:
        p: rail P.
        q: rail Q, which runs as P does.
        alone: their vertices, each for itself.
        tolerance: mm; how far a chord may lie from its curve.
    """
    return (
        samples_against(p, alone[0], alone[1].points, tolerance),
        samples_against(q, alone[1], alone[0].points, tolerance),
    )


def met_at_ends(
    p: Samples, q: Samples, keeps: tuple[bool, bool] = (False, False)
) -> tuple[Samples, Samples]:
    """Returns the vertices of two open rails, with ends that the kernel takes for one point as one.

    A bridge of 1e-11 mm would have a direction, and the triangles over it folds.

    Args:
        p: vertices of P.
        q: vertices of Q.
        keeps: whether P and Q are to keep their ends; half way between them otherwise.
    """
    points = [p.points.copy(), q.points.copy()]
    if min(map(len, points)) < 2:
        return p, q
    is_moved = False
    for at in (0, -1):
        ends = [own[at].copy() for own in points]
        apart = math.dist(*(end.tolist() for end in ends))
        if not 0.0 < apart <= settings.CONFUSION or all(keeps):
            continue
        one = ends[keeps.index(True)] if any(keeps) else 0.5 * (ends[0] + ends[1])
        points[0][at], points[1][at], is_moved = one, one, True
    if not is_moved:
        return p, q
    moved = (type(p)(p.parameters, points[0]), type(q)(q.parameters, points[1]))
    return p if keeps[0] else moved[0], q if keeps[1] else moved[1]


def samples_against(
    directrix: Directrix, samples: Samples, other: Floats, tolerance: float
) -> Samples:
    """Adds to a rail's vertices those that it needs because of the other rail of its strip.

    A directrix given as points keeps these.

    Args:
        directrix: the rail.
        samples: its vertices, sampled on its own.
        other: (l, 3) float64, mm: vertices of the other rail.
        tolerance: mm; how far a chord may lie from its curve.
    """
    # Compiled code is loaded when it is needed, not when a file is read.
    from wrinkle_cad.strip.curve.joint import sample_against

    if directrix.is_polyline:
        return samples
    return sample_against(directrix.point_at, samples, other, tolerance)


def search_between(
    rails: tuple[Directrix | None, Directrix | None],
    samples: tuple[Samples, Samples],
    tolerance: float,
    search: Search,
) -> tuple[Triangulation, tuple[Samples, Samples]]:
    """Returns the best strip between two rails, and the samples it was found between.

    These are the given ones, and more if the strip would fold back on itself without them.

    Args:
        rails: the rails; None for one that is to keep its samples, as one given as points does.
        samples: of both rails.
        tolerance: mm; how far a chord may lie from its curve.
        search: the best triangulation between two rows of points, (m, 3) and (n, 3) float64, mm.

    Raises:
        InputError: what ``search`` refuses.
    """
    found = search(samples[0].points, samples[1].points)
    return mended_between(found, rails, samples, tolerance, search)


def mended_between(
    found: Triangulation,
    rails: tuple[Directrix | None, Directrix | None],
    samples: tuple[Samples, Samples],
    tolerance: float,
    search: Search,
) -> tuple[Triangulation, tuple[Samples, Samples]]:
    """Returns what ``search_between`` returns where the best strip was found already.

    Args:
        found: the best triangulation between the samples.
        rails: see ``search_between``.
        samples: of both rails.
        tolerance: mm; how far a chord may lie from its curve.
        search: the best triangulation between two rows of points.
    """
    from wrinkle_cad.strip.partners import without_fold_backs

    p, q = (None if rail is None or rail.is_polyline else rail.point_at for rail in rails)
    return without_fold_backs(found, samples, (p, q), tolerance, search)

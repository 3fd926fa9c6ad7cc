"""Wavy profiles over an opening (Fig. 11b of the paper): the rails of a wrinkle.

A profile is its rail on the upper, moved along the surface normal (and, if asked, across the strip)
by a wave of the arc length that fades out at both ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix
from wrinkle_cad.errors import InputError
from wrinkle_cad.options.checking import check_numbers
from wrinkle_cad.options.signature import knows_its_options
from wrinkle_cad.strip.portable import cos, sin

from .opening import Opening
from .opening_outline import Rail
from .smooth import curve_edges, smooth_edge

if TYPE_CHECKING:
    from build123d import Edge

Floats = NDArray[np.float64]
Wave = Callable[[Floats], Floats]
"""(k,) arc lengths in mm from the rail's start -> (k,) offsets in mm."""
Pair = float | tuple[float, float]
Shift = float | Wave | tuple[float | Wave, float | Wave]


@knows_its_options
def wrinkle_profiles(
    opening: Opening,
    *,
    waves: Pair,
    height: Shift,
    phase_deg: Pair = settings.WAVE_PHASES_DEG,
    fade: float = settings.FADE,
    side: settings.WaveSide = settings.WAVE_SIDE,
    across: Shift = 0.0,
) -> tuple[Edge, Edge]:
    """Designs the two profiles of a wrinkle over an opening.

    Every value may be one number or a pair, for P and for Q.

    Args:
        opening: what ``carve`` returned.
        waves: full waves along the rail.
        height: mm, from the upper to the highest crest; or a callable of (k,) arc lengths in mm
            that returns (k,) mm along the outward normal, to which waves, phase_deg, fade and side
            do not apply.
        phase_deg: where in its period the wave starts.
        fade: the share of the rail, 0 to 0.5, over which the wave grows and dies away.
        side: ``out``: the wave stays outside of the upper, from 0 to its height; ``in``: inside;
            ``both``: to either side of it.
        across: mm, in the same wave, along the upper and towards the other rail; or a callable, as
            for ``height``.

    Returns:
        Two build123d edges, each one B-spline, P and Q.

    Raises:
        InputError: a value out of range; a callable that returns something else.

    Example:
        >>> from wrinkle_cad import carve
        >>> from build123d import Edge, Face
        >>> upper = Face.make_rect(100, 60)
        >>> p, q = Edge.make_line((-40, -8), (40, -8)), Edge.make_line((-40, 8), (40, 8))
        >>> opening = carve(upper, p, q, margin=2)
        >>> profile, _ = wrinkle_profiles(opening, waves=3, height=2)
        >>> round(profile.length, 1), round(profile.bounding_box().max.Z, 1)
        (80.8, 2.0)
    """
    # Its import brings build123d, which profiles as directrices do without.
    from wrinkle_cad.cad.build123d_objects import to_build123d

    p, q = profile_curves(
        opening,
        waves=waves,
        height=height,
        phase_deg=phase_deg,
        fade=fade,
        side=side,
        across=across,
    )
    return to_build123d(curve_edges(p)[0], label="P"), to_build123d(curve_edges(q)[0], label="Q")


def profile_curves(
    opening: Opening,
    *,
    waves: Pair,
    height: Shift,
    phase_deg: Pair = settings.WAVE_PHASES_DEG,
    fade: float = settings.FADE,
    side: settings.WaveSide = settings.WAVE_SIDE,
    across: Shift = 0.0,
) -> tuple[Directrix, Directrix]:
    """Returns the profiles of ``wrinkle_profiles`` as directrices."""
    if not isinstance(opening, Opening):
        raise InputError(
            f"The opening cannot be a {type(opening).__name__}: pass what carve() returned."
        )
    check_numbers(waves=waves, height=height, phase_deg=phase_deg, fade=fade, across=across)
    if not settings.FADE_MIN <= fade <= 0.5:
        raise InputError(f"fade is {fade:g}: {settings.FADE_MIN:g} to 0.5 is allowed.")
    if side not in get_args(settings.WaveSide):
        raise InputError(f"side is {side!r}. Choose {', '.join(get_args(settings.WaveSide))}.")
    made = []
    for i, (rail, name) in enumerate(zip(opening.rails, "PQ", strict=True)):
        shape = _wave_shape(
            rail, _one(waves, i), math.radians(_one(phase_deg, i)), fade, side, name
        )
        outward = _offset(rail, _one(height, i), shape, "height")
        sideways = _offset(rail, _one(across, i), shape, "across")
        points = (
            rail.points
            + outward[:, None] * rail.feet.normals
            + sideways[:, None] * opening.across[i]
        )
        if rail.is_ring:
            points[-1] = points[0]
        made.append(make_directrix(smooth_edge(points), name=name))
    return made[0], made[1]


def _one(value: Any, i: int) -> Any:
    return value[i] if isinstance(value, tuple) else value


def _wave_shape(
    rail: Rail, waves: float, phase: float, fade: float, side: settings.WaveSide, name: str
) -> Floats:
    """Returns (k,) the wave of height 1 at the points of a rail."""
    most = settings.WAVES_PER_POINT * len(rail.points)
    if not 0.0 < waves <= most:
        raise InputError(
            f"waves is {waves:g} on {name}: more than 0 and up to {most:.0f} are allowed."
        )
    if not np.isfinite(phase):
        raise InputError(f"phase_deg is {math.degrees(phase):g} on {name}. Give a finite angle.")
    if rail.is_ring and waves != round(waves):
        raise InputError(
            f"waves is {waves:g} on {name}, which is closed: a whole number of waves is needed"
            " there."
        )
    angle = 2.0 * np.pi * waves * rail.shares + phase
    near = np.minimum(rail.shares, 1.0 - rail.shares)
    # A squared sine: at the ends it grows slower than the margin, so the band does not stand up.
    envelope = sin(0.5 * np.pi * np.clip(near / fade, 0.0, 1.0)) ** 2
    if rail.is_ring:
        envelope = np.ones(len(near))
    if side == "both":
        return np.asarray(envelope * sin(angle))
    sign = 1.0 if side == "out" else -1.0
    return np.asarray(sign * envelope * 0.5 * (1.0 - cos(angle)))


def _offset(rail: Rail, amount: float | Wave, shape: Floats, name: str) -> Floats:
    """Returns (k,) mm: how far the points of a rail move."""
    if not callable(amount):
        if not np.isfinite(amount):
            raise InputError(f"{name} is {amount} mm. Give a finite height.")
        return amount * shape
    arc = rail.shares * rail.length
    offset = np.asarray(amount(arc), dtype=np.float64)
    if offset.shape != arc.shape or not np.isfinite(offset).all():
        raise InputError(
            f"The callable {name} returned shape {offset.shape} for {arc.shape} arc lengths,"
            f" {int((~np.isfinite(offset)).sum())} values not finite. Let it take and return"
            " arrays: one finite offset in mm per arc length."
        )
    return offset

"""Wavy profiles over an opening (Fig. 11b of the paper): the rails of a wrinkle.

A profile is its rail on the upper, moved along the surface normal (and, if asked, across the strip)
by a wave of the arc length that fades out at both ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad import settings
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix
from wrinkle_cad.errors import InputError
from wrinkle_cad.options.checking import check_numbers
from wrinkle_cad.options.signature import knows_its_options

from .opening import Opening
from .opening_outline import Rail
from .smooth import curve_edges, smooth_edge
from .wave_shapes import frame_at, waves_along

if TYPE_CHECKING:
    from build123d import Edge

Floats = NDArray[np.float64]
Wave = Callable[[Floats], Floats]
"""(k,) arc lengths in mm from the rail's start -> (k,) offsets in mm."""
Pair = float | tuple[float, float]
Shift = float | Wave | tuple[float | Wave, float | Wave]
Amplitude = Wave | Sequence[float]
_MOST_LEAN_DEG: Final = 75.0


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
    shape: settings.WaveKind = "sine",
    lean_deg: float = 0.0,
    seed: int = 0,
    amplitude: Amplitude = (),
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
        shape: ``sine``; ``pleat``: rounded folds that overhang without touching; ``gather``: such
            folds of uneven width and height, as in gathered leather.
        lean_deg: deg, -75 to 75; how far the waves lean over, forward along the rail.
        seed: of what is uneven in ``gather``; the same on P and Q.
        amplitude: shares of the height, at even distances along the rail; or a callable of (k,) arc
            lengths in mm that returns (k,) shares. The height everywhere when empty.

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
        shape=shape,
        lean_deg=lean_deg,
        seed=seed,
        amplitude=amplitude,
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
    shape: settings.WaveKind = "sine",
    lean_deg: float = 0.0,
    seed: int = 0,
    amplitude: Amplitude = (),
) -> tuple[Directrix, Directrix]:
    """Returns the profiles of ``wrinkle_profiles`` as directrices."""
    if not isinstance(opening, Opening):
        raise InputError(
            f"The opening cannot be a {type(opening).__name__}: pass what carve() returned."
        )
    check_numbers(
        waves=waves, height=height, phase_deg=phase_deg, fade=fade, across=across, lean_deg=lean_deg
    )
    _check_shape(shape, lean_deg, height)
    if not settings.FADE_MIN <= fade <= 0.5:
        raise InputError(f"fade is {fade:g}: {settings.FADE_MIN:g} to 0.5 is allowed.")
    if side not in get_args(settings.WaveSide):
        raise InputError(f"side is {side!r}. Choose {', '.join(get_args(settings.WaveSide))}.")
    made = []
    for i, (rail, name) in enumerate(zip(opening.rails, "PQ", strict=True)):
        count, phase = _one(waves, i), math.radians(_one(phase_deg, i))
        _check_waves(rail, count, phase, name)
        drawn = waves_along(rail, shape, count, phase, fade=fade, side=side, seed=seed)
        heights = drawn.heights * _amplitude(rail, drawn.turns, amplitude)
        outward = _offset(rail, _one(height, i), heights, "height")
        sideways = _offset(rail, _one(across, i), heights, "across")
        shares = drawn.shares + math.tan(math.radians(lean_deg)) * outward / rail.length
        frame = frame_at(rail, opening.across[i], shares)
        points = frame.points + outward[:, None] * frame.normals + sideways[:, None] * frame.across
        if rail.is_ring:
            points[-1] = points[0]
        made.append(make_directrix(smooth_edge(points), name=name))
    return made[0], made[1]


def _one(value: Any, i: int) -> Any:
    return value[i] if isinstance(value, tuple) else value


def _check_shape(shape: str, lean_deg: float, heights: Shift) -> None:
    if shape not in get_args(settings.WaveKind):
        raise InputError(f"shape is {shape!r}. Choose {', '.join(get_args(settings.WaveKind))}.")
    if not -_MOST_LEAN_DEG <= lean_deg <= _MOST_LEAN_DEG:
        raise InputError(
            f"lean_deg is {lean_deg:g}: {-_MOST_LEAN_DEG:g} to {_MOST_LEAN_DEG:g} is allowed."
        )
    if shape != "sine" and any(callable(_one(heights, i)) for i in range(2)):
        raise InputError(
            f"The height is a callable, which draws the waves itself, and shape is {shape}. Give"
            " a height in mm, or leave the shape out."
        )


def _check_waves(rail: Rail, waves: float, phase: float, name: str) -> None:
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


def _amplitude(rail: Rail, shares: Floats, amplitude: Amplitude) -> Floats:
    """Returns (k,) the shares of the height at (k,) places along a rail."""
    if callable(amplitude):
        return _offset(rail, amplitude, shares, "amplitude", arc=shares * rail.length)
    given = np.asarray(amplitude, dtype=np.float64)
    if given.ndim != 1 or not np.isfinite(given).all():
        raise InputError(
            f"amplitude has the shape {given.shape}. Give finite shares of the height in a row."
        )
    if not len(given):
        return np.ones(len(shares))
    if rail.is_ring:
        given = np.append(given, given[0])
    return np.interp(shares, np.linspace(0.0, 1.0, len(given)), given)


def _offset(
    rail: Rail, amount: float | Wave, shape: Floats, name: str, *, arc: Floats | None = None
) -> Floats:
    """Returns (k,) mm: how far the points of a rail move."""
    if not callable(amount):
        if not np.isfinite(amount):
            raise InputError(f"{name} is {amount} mm. Give a finite height.")
        return amount * shape
    arc = rail.shares * rail.length if arc is None else arc
    offset = np.asarray(amount(arc), dtype=np.float64)
    if offset.shape != arc.shape or not np.isfinite(offset).all():
        raise InputError(
            f"The callable {name} returned shape {offset.shape} for {arc.shape} arc lengths,"
            f" {int((~np.isfinite(offset)).sum())} values not finite. Let it take and return"
            " arrays: one finite offset in mm per arc length."
        )
    return offset

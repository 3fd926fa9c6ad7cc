"""Rails with exact derivatives, and strips between them whose surface is known."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.curve.sampling import sample_curve
from wrinkle_cad.strip.rulings.rail_curve import CurveFunction, RailCurve
from wrinkle_cad.strip.rulings.surface import RuledStrip, rule_strip
from wrinkle_cad.strip.triangulation import triangulate

Floats = npt.NDArray[np.float64]
Rails = tuple[RailCurve, RailCurve]


def stack(*coordinates: Floats | float) -> Floats:
    return np.stack(np.broadcast_arrays(*coordinates), axis=-1).astype(np.float64)


def analytic(point_at: CurveFunction, interval: tuple[float, float]) -> RailCurve:
    """A smooth rail; its derivative by a difference of fourth order, exact to some 1e-11."""
    step = 1e-3 * (interval[1] - interval[0])

    def velocity_at(u: Floats) -> Floats:
        near = point_at(u + step) - point_at(u - step)
        far = point_at(u + 2 * step) - point_at(u - 2 * step)
        return (8.0 * near - far) / (12.0 * step)

    return RailCurve(point_at, velocity_at, interval)


def polyline(points: Sequence[tuple[float, float, float]]) -> RailCurve:
    corner = np.array(points, dtype=np.float64)
    chord = np.diff(corner, axis=0)
    length = np.sqrt((chord * chord).sum(axis=1))
    at = np.concatenate(([0.0], np.cumsum(length)))

    def point_at(u: Floats) -> Floats:
        return np.stack([np.interp(u, at, corner[:, axis]) for axis in range(3)], axis=-1)

    def velocity_at(u: Floats) -> Floats:
        chosen = np.clip(np.searchsorted(at, u, side="right") - 1, 0, len(chord) - 1)
        return (chord / length[:, None])[chosen]

    return RailCurve(point_at, velocity_at, (0.0, float(at[-1])), tuple(at[1:-1].tolist()))


def reversed_rail(rail: RailCurve) -> RailCurve:
    first, last = rail.interval
    return RailCurve(
        lambda u: rail.point_at(first + last - u),
        lambda u: -rail.velocity_at(first + last - u),
        rail.interval,
        tuple(first + last - at for at in reversed(rail.breaks)),
    )


def ruled(rails: Rails, tolerance: float = 0.05) -> RuledStrip:
    """The surface near the triangulation that bends least between samples of both rails."""
    p, q = rails
    samples = [
        sample_curve(rail.point_at, rail.interval, tolerance, breaks=rail.breaks, max_chord=10.0)
        for rail in rails
    ]
    strip = triangulate(samples[0].points, samples[1].points, criteria=("bending",))
    i, j = strip.bridges.T
    return rule_strip(p, q, (samples[0].parameters[i], samples[1].parameters[j]))


def helicoid(width: float, rate: float) -> Rails:
    """Rulings across the x axis that turn with it; a strain of 1 - 1 / sqrt(1 + (w t / 2)^2)."""

    def rail(side: float) -> RailCurve:
        half = side * width / 2.0
        return RailCurve(
            lambda x: stack(x, half * np.cos(rate * x), half * np.sin(rate * x)),
            lambda x: stack(1.0, -half * rate * np.sin(rate * x), half * rate * np.cos(rate * x)),
            (0.0, 100.0),
        )

    return rail(1.0), rail(-1.0)


def circle(radius: float, height: float, interval: tuple[float, float] = (0.0, 2.0)) -> RailCurve:
    return RailCurve(
        lambda u: stack(radius * np.cos(u), radius * np.sin(u), height),
        lambda u: stack(-radius * np.sin(u), radius * np.cos(u), 0.0),
        interval,
    )


def spiral(radius: float, height: float, rise: float, interval: tuple[float, float]) -> RailCurve:
    """A helix on a cylinder of a radius: its ends need not lie on one ruling with another's."""
    return RailCurve(
        lambda u: stack(radius * np.cos(u), radius * np.sin(u), height + rise * u),
        lambda u: stack(-radius * np.sin(u), radius * np.cos(u), rise),
        interval,
    )


def bumps(seed: int) -> Rails:
    """Two cubic B-splines side by side, some nearly straight, some wavy."""
    from scipy.interpolate import make_interp_spline

    random = np.random.default_rng([11, seed])
    count = int(random.integers(5, 9))
    width, length = random.uniform(10.0, 40.0), random.uniform(80.0, 200.0)
    wave = float(random.choice([0.5, 1.5, 3.0]))
    x = np.linspace(0.0, length, count)
    common = random.normal(0.0, 6.0, (count, 3)) * [0.3, 0.5, 1.0]
    rails = []
    for side in (0.0, 1.0):
        points = common + stack(
            x + random.normal(0.0, 0.3 * wave, count),
            side * width + random.normal(0.0, 0.5 * wave, count),
            random.normal(0.0, wave, count),
        )
        curve = make_interp_spline(np.linspace(0.0, 1.0, count), points, k=3)
        rails.append(RailCurve(curve, curve.derivative(), (0.0, 1.0)))
    return rails[0], rails[1]


def percent_of_twist(twist: float) -> float:
    """Strain in per cent where both rails run equally fast across rulings of this twist in rad."""
    return 100.0 * (1.0 - math.cos(twist / 2.0))


def twisted(seed: int) -> Rails:
    """Two rails that wind about a middle line while they wave: most stretch a sheet."""
    random = np.random.default_rng([12, seed])
    half, length = random.uniform(5.0, 20.0), random.uniform(80.0, 200.0)
    turn, swing = random.uniform(-2.0, 2.0), random.uniform(0.0, 0.4)
    waves, high = random.uniform(0.5, 2.0), random.uniform(0.0, 3.0)
    phase = random.uniform(0.0, 2.0 * np.pi, 2)

    def rail(side: float) -> RailCurve:
        def point_at(share: Floats) -> Floats:
            angle = turn * share + swing * np.sin(2.0 * np.pi * waves * share + phase[0])
            rise = high * np.sin(2.0 * np.pi * waves * share + phase[1])
            return stack(
                length * share, side * half * np.cos(angle), rise + side * half * np.sin(angle)
            )

        return analytic(point_at, (0.0, 1.0))

    return rail(1.0), rail(-1.0)

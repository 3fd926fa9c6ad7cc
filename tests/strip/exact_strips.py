"""Strips known in closed form: exact developables with their inflection rulings, and wavy strips.

Every family gives both rails as functions of one ruling parameter, so a ruling joins equal
parameters. All are some 10 mm long and seeded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from wrinkle_cad.strip.curve.sampling import sample_curve

Floats = npt.NDArray[np.float64]
Curve = Callable[[Floats], Floats]


@dataclass(frozen=True)
class ExactStrip:
    name: str
    p_at: Curve
    q_at: Curve
    interval: tuple[float, float]
    inflections: Floats

    def sampled(self, tolerance: float) -> SampledStrip:
        p = sample_curve(self.p_at, self.interval, tolerance)
        q = sample_curve(self.q_at, self.interval, tolerance)
        at = [
            np.interp(self.inflections, s.parameters, np.arange(s.parameters.size)) for s in (p, q)
        ]
        return SampledStrip(self.name, p.points, q.points, np.stack(at, axis=1))


@dataclass(frozen=True)
class SampledStrip:
    name: str
    p: Floats
    q: Floats
    inflections: Floats
    """(k, 2): fractional sample numbers i, j of each inflection ruling."""

    def samples_to_inflection(self, bridges: npt.NDArray[np.int64]) -> Floats:
        """Distance of each bridge from the nearest inflection, in samples of the nearer rail."""
        if not self.inflections.size:
            return np.full(bridges.shape[0], np.inf)
        apart = np.abs(bridges[:, None, :] - self.inflections[None, :, :])
        return apart.min(axis=2).min(axis=1)


def zeros_of(function: Callable[[Floats], Floats], interval: tuple[float, float]) -> Floats:
    """Zeros by a dense scan and bisection."""
    t = np.linspace(*interval, 20_001)
    value = function(t)
    here = np.flatnonzero(np.sign(value[:-1]) * np.sign(value[1:]) < 0)
    low, high = t[here], t[here + 1]
    for _ in range(60):
        middle = (low + high) / 2
        same = np.sign(function(middle)) == np.sign(function(low))
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2


@dataclass(frozen=True)
class Wave:
    """A sum of three sines with its derivatives."""

    size: Floats
    rate: Floats
    phase: Floats

    def __call__(self, t: Floats, order: int = 0) -> Floats:
        turn = np.multiply.outer(t, self.rate) + self.phase + order * np.pi / 2
        return (self.size * self.rate**order * np.sin(turn)).sum(axis=-1)


def random_wave(random: np.random.Generator, size: float, slowest: float, fastest: float) -> Wave:
    return Wave(
        random.uniform(0.2, 1.0, 3) * size,
        random.uniform(slowest, fastest, 3),
        random.uniform(0.0, 2 * np.pi, 3),
    )


def heights(random: np.random.Generator, width: float) -> tuple[Wave, Callable[[Floats], Floats]]:
    """Where both rails cross the rulings: never nearer than half the width."""
    low = random_wave(random, width / 12, 0.3, 1.5)
    high = random_wave(random, width / 12, 0.3, 1.5)
    return low, lambda t: width + high(t)


def stack(*coordinates: Floats) -> Floats:
    return np.stack(np.broadcast_arrays(*coordinates), axis=-1)


def cylinder(seed: int) -> ExactStrip:
    """Rulings along z over a wavy graph y = f(x)."""
    random = np.random.default_rng([1, seed])
    f = random_wave(random, 0.6, 0.5, 2.5)
    low, high = heights(random, 1.5)
    interval = (0.0, 9.0)
    return ExactStrip(
        f"cylinder {seed}",
        lambda t: stack(t, f(t), low(t)),
        lambda t: stack(t, f(t), high(t)),
        interval,
        zeros_of(lambda t: f(t, 2), interval),
    )


def cone(seed: int) -> ExactStrip:
    """Rulings from the origin through a wavy graph in the plane z = 4."""
    random = np.random.default_rng([2, seed])
    f = random_wave(random, 0.5, 0.5, 2.0)
    low, high = heights(random, 0.4)
    interval = (-4.0, 4.0)
    return ExactStrip(
        f"cone {seed}",
        lambda t: stack(t, f(t), 4.0 + 0 * t) * (1.0 + low(t))[:, None],
        lambda t: stack(t, f(t), 4.0 + 0 * t) * (1.0 + high(t))[:, None],
        interval,
        zeros_of(lambda t: f(t, 2), interval),
    )


def tangent_developable(seed: int) -> ExactStrip:
    """Tangents of (cos t, sin t, h(t)); the torsion has the sign of h' + h'''."""
    random = np.random.default_rng([3, seed])
    rate = float(random.uniform(1.5, 3.0))
    size = float(random.uniform(1.5, 3.0)) / (rate * (rate * rate - 1.0))
    low, high = heights(random, 1.0)
    return _tangents(f"tangent developable {seed}", size, rate, low, high)


def convex_cylinder(seed: int) -> ExactStrip:
    """Rulings along z over a curve whose radius of curvature stays positive."""
    random = np.random.default_rng([4, seed])
    k, share = float(random.uniform(1.5, 4.0)), float(random.uniform(0.0, 0.8))
    low, high = heights(random, 1.5)

    def base(t: Floats) -> tuple[Floats, Floats]:
        # The integral of (1 + share cos k t) (cos t, sin t).
        up, down = (k + 1.0) * t, (k - 1.0) * t
        x = np.sin(t) + share / 2 * (np.sin(up) / (k + 1) + np.sin(down) / (k - 1))
        y = -np.cos(t) + share / 2 * (-np.cos(up) / (k + 1) + np.cos(down) / (k - 1))
        return 3 * x, 3 * y

    return ExactStrip(
        f"convex cylinder {seed}",
        lambda t: stack(*base(t), low(t)),
        lambda t: stack(*base(t), high(t)),
        (0.0, 3.3),
        np.empty(0),
    )


def convex_cone(seed: int) -> ExactStrip:
    """Rulings from the origin through an ellipse in the plane z = 3."""
    random = np.random.default_rng([5, seed])
    a, b = random.uniform(1.0, 3.0, 2)
    low, high = heights(random, 0.4)

    def ray(t: Floats) -> Floats:
        return stack(a * np.cos(t), b * np.sin(t), 3.0 + 0 * t)

    return ExactStrip(
        f"convex cone {seed}",
        lambda t: ray(t) * (1.0 + low(t))[:, None],
        lambda t: ray(t) * (1.0 + high(t))[:, None],
        (0.3, 5.0),
        np.empty(0),
    )


def convex_tangent_developable(seed: int) -> ExactStrip:
    """Tangents of a helix."""
    random = np.random.default_rng([6, seed])
    low, high = heights(random, 1.0)
    return _tangents(f"convex tangent developable {seed}", 0.0, 2.0, low, high)


def _tangents(
    name: str, size: float, rate: float, low: Wave, high: Callable[[Floats], Floats]
) -> ExactStrip:
    def at(t: Floats, along: Floats) -> Floats:
        h, slope = t + size * np.sin(rate * t), 1.0 + size * rate * np.cos(rate * t)
        edge = stack(np.cos(t), np.sin(t), h)
        return 1.5 * (edge + (0.8 + along)[:, None] * stack(-np.sin(t), np.cos(t), slope))

    interval = (0.0, 4.0)
    torsion = lambda t: 1.0 - size * rate * (rate * rate - 1.0) * np.cos(rate * t)  # noqa: E731
    return ExactStrip(
        name,
        lambda t: at(t, low(t)),
        lambda t: at(t, high(t)),
        interval,
        zeros_of(torsion, interval),
    )


WAVY = (cylinder, cone, tangent_developable)
CONVEX = (convex_cylinder, convex_cone, convex_tangent_developable)


def wrinkled(seed: int) -> ExactStrip:
    """Two rails that wave out of phase: no developable surface joins them."""
    random = np.random.default_rng([7, seed])
    f, g = random_wave(random, 0.3, 1.0, 4.0), random_wave(random, 0.3, 1.0, 4.0)
    return ExactStrip(
        f"wrinkled {seed}",
        lambda t: stack(t, 0 * t, f(t)),
        lambda t: stack(t, 1.0 + 0.2 * np.sin(t), g(t)),
        (0.0, 10.0),
        np.empty(0),
    )


def random_points(seed: int, m: int, n: int) -> tuple[Floats, Floats]:
    """Two rough rails side by side; some with repeated points, some planar, some that meet."""
    random = np.random.default_rng([8, seed])
    along = [np.sort(random.uniform(0.0, 5.0, k)) for k in (m, n)]
    p = stack(along[0], random.normal(0.0, 0.4, m), random.normal(0.0, 0.4, m))
    q = stack(along[1], random.normal(1.5, 0.4, n), random.normal(0.0, 0.4, n))
    if seed % 10 == 7:
        p[m // 2] = p[m // 2 - 1]
    if seed % 10 == 8:
        p[:, 2] = q[:, 2] = 0.0
    if seed % 10 == 9:
        q[0] = p[0]
        if m + n > 4:
            q[-1] = p[-1]
    return p, q


def twisted_plane_and_cone() -> tuple[Floats, Floats]:
    """A straight rail and one that winds about it: often called twisted by 31 degrees."""
    t = np.linspace(0.0, 4.0, 60)
    f = 1.2 * (t / 4.0) ** 2
    return stack(t, 0 * t, 0 * t), stack(t, np.sin(f), np.cos(f))

"""Rails and uppers at random, from plain to degenerate; seeded."""

from __future__ import annotations

from typing import Any

import numpy as np
from build123d import Edge, Face, Line, Pos, Spline
from numpy.typing import NDArray

from tests.cad.strips import edge_of

Floats = NDArray[np.float64]


def random_rail(rng: np.random.Generator, y: float) -> Any:
    """A rail near a height y: clamped, periodic, rational, straight, of points, or degenerate."""
    count = int(rng.integers(3, 13))
    poles = np.column_stack(
        (np.linspace(0.0, 80.0, count), rng.normal(y, 4.0, count), rng.normal(0.0, 4.0, count))
    )
    kind = int(rng.integers(10))
    if kind < 3:
        degree = int(rng.integers(1, min(count, 9)))
        weights = rng.uniform(0.05, 20.0, count) if kind == 1 else None
        return edge_of(poles, degree, weights)
    if kind == 3:
        return Pos(40.0, 0.0, y) * Edge.make_circle(float(rng.uniform(1.0, 50.0)))
    if kind == 4:
        around = np.linspace(0.0, 2.0 * np.pi, count + 3)[:-1]
        radii = rng.uniform(20.0, 40.0, len(around))
        points = np.column_stack((radii * np.cos(around), radii * np.sin(around), 0.0 * around + y))
        return Edge.make_spline([tuple(point) for point in points], periodic=True)
    if kind == 5:
        return Line(tuple(poles[0]), tuple(poles[-1]))
    if kind == 6:
        return poles
    if kind == 7:
        return Spline(*[tuple(pole) for pole in poles])
    return _degenerate(rng, poles)


def _degenerate(rng: np.random.Generator, poles: Floats) -> Any:
    kind = int(rng.integers(8))
    if kind == 0:
        poles[:] = poles[0]
    elif kind == 1:
        # Coincident poles: the curve stands still.
        poles[1:-1] = poles[1]
    elif kind == 2:
        poles[:, 1:] = 0.0
    elif kind == 3:
        poles = poles[rng.permutation(len(poles))]
    elif kind == 4:
        poles *= float(rng.choice((1e-9, 1e-6, 1e-3, 1e3, 1e6)))
    elif kind == 5:
        poles[int(rng.integers(len(poles)))] = rng.choice((np.nan, np.inf, 1e300))
        return poles
    elif kind == 6:
        return poles[: int(rng.integers(3))]
    weights = rng.choice((1e-9, 1.0, 1e9), len(poles)) if kind == 7 else None
    return edge_of(poles, min(3, len(poles) - 1), weights)


def random_pair(seed: int) -> tuple[Any, Any]:
    """Two rails, some a hair apart, one the other, or crossing."""
    rng = np.random.default_rng(seed)
    width = float(rng.choice((0.0, 1e-7, 1e-3, 0.1, 5.0, 20.0, 20.0, 60.0)))
    first = random_rail(rng, 0.0)
    if rng.random() < 0.1:
        return first, first
    return first, random_rail(rng, width)


def smooth_height(x: Floats, y: Floats) -> Floats:
    """How high an upper that is not wild stands over the plane, about."""
    height: Floats = 15.0 * np.sin(x / 60.0) * np.cos(y / 50.0)
    return height


def random_upper(seed: int) -> Face:
    """A face of one B-spline, as smooth or as wild as the seed has it."""
    rng = np.random.default_rng(seed)
    rows, columns = (int(number) for number in rng.integers(4, 9, 2))
    wildness = float(rng.choice((0.0, 1.0, 5.0, 20.0)))
    x, y = np.meshgrid(np.linspace(0.0, 150.0, columns), np.linspace(0.0, 120.0, rows))
    z = smooth_height(x, y) + wildness * rng.normal(size=x.shape)
    return Face.make_surface_from_array_of_points(
        [
            [(float(a), float(b), float(c)) for a, b, c in zip(*row, strict=True)]
            for row in zip(x, y, z, strict=True)
        ]
    )

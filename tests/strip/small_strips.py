"""Small strips of every kind on which round-off, ties and flat places lie in wait."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import numpy.typing as npt

from tests.strip import exact_strips

Floats = npt.NDArray[np.float64]
Rails = tuple[Floats, Floats]


def rough(seed: int, m: int, n: int) -> Rails:
    """Some with repeated points, some planar, some that meet at their ends."""
    return exact_strips.random_points(seed, m, n)


def lattice(seed: int, m: int, n: int) -> Rails:
    """Integer coordinates: coplanar, collinear, folded back and equally good in many places."""
    random = np.random.default_rng([21, seed])
    p, q = random.integers(0, 3, (m, 3)), random.integers(0, 3, (n, 3))
    p[:, 0], q[:, 0] = np.sort(p[:, 0]), np.sort(q[:, 0])
    q[:, 1] += 2
    return p.astype(float), q.astype(float)


def meeting(seed: int, m: int, n: int) -> Rails:
    """Integer coordinates, one or both ends in common."""
    p, q = lattice(seed, m, n)
    q[0] = p[0]
    if seed % 2 and m + n > 4:
        q[-1] = p[-1]
    return p, q


def zigzag_prism(seed: int, m: int, n: int) -> Rails:
    """A zigzag extruded square to its plane or aslant, some legs in line with the one before."""
    random = np.random.default_rng([22, seed])
    steps = np.zeros((max(m, n), 3))
    steps[:, 0] = random.integers(1, 4, max(m, n))
    steps[:, 2] = random.integers(-2, 3, max(m, n))
    p = np.cumsum(steps, axis=0)
    return p, p + np.array([random.integers(-2, 3), random.integers(1, 4), 0])


def flat(seed: int, m: int, n: int) -> Rails:
    """A flat strap with a tab on either side, in any plane."""
    random = np.random.default_rng([23, seed])
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    along = [np.sort(random.uniform(0.0, 6.0, k)) for k in (m, n)]
    p = exact_strips.stack(along[0], -(random.uniform(0.0, 1.0, m) ** 4) * 2, 0 * along[0])
    q = exact_strips.stack(along[1], 1.0 + random.uniform(0.0, 1.0, n) ** 4 * 2, 0 * along[1])
    return p @ turn, q @ turn


def straight(seed: int, m: int, n: int) -> Rails:
    """Straight rails, parallel, skew or in one plane, evenly sampled or not."""
    random = np.random.default_rng([24, seed])
    ends = random.integers(0, 3, (4, 3)) + np.array([[0, 0, 0], [5, 0, 0], [0, 3, 0], [5, 3, 0]])
    rails = []
    for start, end, count in ((ends[0], ends[1], m), (ends[2], ends[3], n)):
        share = np.sort(random.integers(0, 9, count)) / 8 if seed % 2 else np.linspace(0, 1, count)
        rails.append(start + share[:, None] * (end - start))
    return rails[0], rails[1]


def pointed(seed: int, m: int, n: int) -> Rails:
    """One rail is a single point."""
    p, q = rough(seed, m, n) if seed % 3 else lattice(seed, m, n)
    return (p[m // 2 : m // 2 + 1], q) if seed % 2 else (p, q[n // 2 : n // 2 + 1])


def bent_sheet(seed: int, m: int, n: int) -> Rails:
    """On a cylinder, the rails sampled at the same rulings or at others."""
    random = np.random.default_rng([25, seed])
    turns = [np.sort(random.uniform(0.0, 3.0, k)) for k in (m, n)]
    turns[1] = turns[0] if seed % 2 and m == n else turns[1]
    return (
        exact_strips.stack(np.cos(turns[0]), np.sin(turns[0]), 0.2 * np.sin(3 * turns[0])),
        exact_strips.stack(np.cos(turns[1]), np.sin(turns[1]), 1.0 + 0.2 * turns[1]),
    )


FAMILIES: tuple[Callable[[int, int, int], Rails], ...] = (
    rough,
    lattice,
    meeting,
    zigzag_prism,
    flat,
    straight,
    pointed,
    bent_sheet,
)


def small_strip(seed: int, largest: int = 6) -> Rails:
    """Strip number `seed`; the families take turns, m and n are at most `largest`."""
    m, n = np.random.default_rng([9, seed]).integers(2, largest + 1, 2)
    return FAMILIES[seed % len(FAMILIES)](seed // len(FAMILIES), int(m), int(n))


def makes_a_strip(seeds: Iterable[int]) -> list[int]:
    """The seeds without those whose rails coincide over a stretch, or enclose nothing."""
    return [seed for seed in seeds if seed not in _NO_STRIP]


_NO_STRIP = frozenset((90, 210, 225, 330))

"""Strips whose shape is known, and an unrolling of facets by the law of cosines alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wrinkle_cad.strip import triangulate


@dataclass(frozen=True)
class FlatFacets:
    """Stands in for an Unrolling of facets: the same fields, made by other means."""

    p: np.ndarray
    q: np.ndarray
    p_line: np.ndarray
    q_line: np.ndarray
    p_arc: np.ndarray
    q_arc: np.ndarray
    p_index: np.ndarray
    q_index: np.ndarray
    overlaps: bool = False


def flat_facets(triangulation) -> FlatFacets:
    p, q = triangulation.p, triangulation.q
    flat_p, flat_q = np.zeros((len(p), 2)), np.zeros((len(q), 2))
    flat_q[0] = (0.0, np.linalg.norm(q[0] - p[0]))
    for (i, j), (k, h) in zip(triangulation.bridges[:-1], triangulation.bridges[1:], strict=True):
        tip = p[k] if k > i else q[h]
        placed = third_corner(
            flat_p[i], flat_q[j], np.linalg.norm(tip - p[i]), np.linalg.norm(tip - q[j])
        )
        if k > i:
            flat_p[k] = placed
        else:
            flat_q[h] = placed
    return FlatFacets(
        flat_p, flat_q, flat_p, flat_q, lengths_along(p), lengths_along(q),
        np.arange(len(p)), np.arange(len(q)),
    )  # fmt: skip


def third_corner(first, second, from_first, from_second):
    """The corner on the right of first -> second at the two distances."""
    base = np.linalg.norm(second - first)
    if base < 1e-14:
        return first + np.array((from_first, 0.0))
    along = (second - first) / base
    foot = (from_first**2 - from_second**2 + base**2) / (2.0 * base)
    height = np.sqrt(max(from_first**2 - foot**2, 0.0))
    return first + foot * along + height * np.array((along[1], -along[0]))


def lengths_along(points):
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))


def unrolled(p, q):
    """(unrolling, triangulation) of the strip between two sampled rails."""
    triangulation = triangulate(np.asarray(p, float), np.asarray(q, float))
    return flat_facets(triangulation), triangulation


def rectangle(length=120.0, width=40.0, count=2):
    x = np.linspace(0.0, length, count)
    zero = np.zeros(count)
    return unrolled(np.column_stack((x, zero, zero)), np.column_stack((x, zero + width, zero)))


def cylinder(radius=30.0, angle=2.0, width=25.0, count=60, *, inward=False):
    """A part of a cylinder; its right side is the outside of the cylinder, or the inside."""
    turn = np.linspace(0.0, angle, count)
    sign = -1.0 if inward else 1.0
    ring = np.column_stack((radius * np.sin(turn), 0.0 * turn, sign * radius * np.cos(turn)))
    return unrolled(ring, ring + (0.0, width, 0.0))


def random_strip(seed):
    """Wavy rails, tapering to points at times, at times strongly curved."""
    random = np.random.default_rng(seed)
    count = int(random.integers(8, 60))
    t = np.linspace(0.0, 1.0, count)
    length = random.uniform(20.0, 300.0)
    sweep = random.uniform(-2.2, 2.2) if seed % 3 else random.uniform(-0.3, 0.3)
    heading = sweep * (t - 0.5) + random.uniform(0, 0.6) * np.sin(2 * np.pi * random.uniform(1, 4) * t)
    step = length / (count - 1)
    spine = np.cumsum(np.column_stack((np.cos(heading), np.sin(heading))), axis=0) * step
    across = np.column_stack((-np.sin(heading), np.cos(heading)))
    width = length * random.uniform(0.03, 0.15) * (1 + 0.5 * np.sin(6.3 * random.uniform(0.5, 3) * t))
    taper = int(random.integers(4))
    if taper in (1, 3):
        width = width * np.sqrt(t)
    if taper in (2, 3):
        width = width * np.sqrt(1 - t)
    lift = random.uniform(0, 0.05) * length * np.sin(6.3 * random.uniform(0.5, 3) * t)
    p = np.column_stack((spine - 0.5 * width[:, None] * across, lift))
    q = np.column_stack((spine + 0.5 * width[:, None] * across, 0.7 * lift))
    return unrolled(p, q)

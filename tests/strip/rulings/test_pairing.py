from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pytest

from wrinkle_cad.strip.rulings.pairing import (
    FAN_P,
    FAN_Q,
    RULED,
    corridor,
    crease_cost,
    pair_nodes,
    twist_at,
)

Floats = npt.NDArray[np.float64]
BENDING = 0.01


class Grid:
    """Random nodes on both rails; with corners, two nodes share a place."""

    def __init__(self, seed: int, m: int, n: int) -> None:
        random = np.random.default_rng([5, seed])
        self.points, self.tangents, self.arcs = [], [], []
        for side, count in ((0.0, m), (1.0, n)):
            arc = np.cumsum(random.uniform(0.2, 1.0, count))
            arc -= arc[0]
            tangent = np.array([1.0, 0.0, 0.0]) + random.normal(0.0, 0.4, (count, 3))
            tangent /= np.linalg.norm(tangent, axis=1)[:, None]
            point = np.stack((arc, np.full(count, side), random.normal(0.0, 0.2, count)), axis=1)
            if seed % 2 and count > 2:
                arc[2:] -= arc[2] - arc[1]
                point[2:] -= point[2] - point[1]
            self.points.append(point)
            self.tangents.append(tangent)
            self.arcs.append(arc)

    def cost(self, pairs: list[tuple[int, int]], ways: tuple[int, ...]) -> float:
        """What a pairing costs, term by term from the module's description."""
        total = 0.0
        for (i, j), (i2, j2), way in zip(pairs[:-1], pairs[1:], ways, strict=True):
            rail = 0 if i2 > i else 1
            here, there = (i, j)[rail], (i2, j2)[rail]
            ds = self.arcs[rail][there] - self.arcs[rail][here]
            length = self.length(i2, j2)
            if ds == 0.0:
                continue
            turns = [self.turn((i, j), (i2, j2), end) ** 2 for end in (0, 1)]
            weight = BENDING * length**2 / ds
            if way == RULED:
                twist = [self.twist(*pair) ** 2 for pair in ((i, j), (i2, j2))]
                total += 0.25 * ds * sum(twist) + weight * sum(turns) / 2.0
            elif (way == FAN_P) == (rail == 1):
                total += weight * turns[rail]
            else:
                return math.inf
        return total + self.cost_of_creases(pairs, ways)

    def cost_of_creases(self, pairs: list[tuple[int, int]], ways: tuple[int, ...]) -> float:
        """Of the larger jumps at both ends of the rulings between two steps that move."""
        total = 0.0
        for k, after in itertools.pairwise(self.moving(pairs)):
            before, here = pairs[k + 1], pairs[after]
            p, q = self.points[0][here[0]], self.points[1][here[1]]
            planes = [self.tangents_of(pair, ways[at]) for pair, at in ((before, k), (here, after))]
            jump = max(abs(twist_at(p, q, *ends)) for ends in zip(*planes, strict=True))
            total += self.length(*here) * crease_cost(jump**2)
        return total

    def moving(self, pairs: list[tuple[int, int]]) -> list[int]:
        """The steps that do more than cross a corner."""
        return [
            k
            for k, (here, there) in enumerate(itertools.pairwise(pairs))
            if any(arc[a] < arc[b] for arc, a, b in zip(self.arcs, here, there, strict=True))
        ]

    def all_ways(self, pairs: list[tuple[int, int]]) -> Iterator[tuple[int, ...]]:
        """All choices of ways; that of a step across a corner does not matter."""
        moving = self.moving(pairs)
        for choice in itertools.product((RULED, FAN_P, FAN_Q), repeat=len(moving)):
            ways = [RULED] * (len(pairs) - 1)
            for k, way in zip(moving, choice, strict=True):
                ways[k] = way
            yield tuple(ways)

    def tangents_of(self, pair: tuple[int, int], way: int) -> tuple[Floats, Floats]:
        """What spans the planes at both ends of a ruling together with it."""
        a, b = (tangent[at] for tangent, at in zip(self.tangents, pair, strict=True))
        return (b, b) if way == FAN_P else (a, a) if way == FAN_Q else (a, b)

    def length(self, i: int, j: int) -> float:
        return float(np.linalg.norm(self.points[1][j] - self.points[0][i]))

    def twist(self, i: int, j: int) -> float:
        return twist_at(
            self.points[0][i], self.points[1][j], self.tangents[0][i], self.tangents[1][j]
        )

    def turn(self, before: tuple[int, int], after: tuple[int, int], rail: int) -> float:
        normals = []
        for pair in (before, after):
            d = self.points[1][pair[1]] - self.points[0][pair[0]]
            normal = np.cross(self.tangents[rail][pair[rail]], d)
            normals.append(normal / np.linalg.norm(normal))
        d /= np.linalg.norm(d)
        return float(np.dot(normals[1] - normals[0], np.cross(normals[1], d)))


def all_pairings(m: int, n: int) -> itertools.chain[list[tuple[int, int]]]:
    def of(steps: tuple[int, ...]) -> list[tuple[int, int]]:
        pairs = [(0, 0)]
        for step in range(m + n - 2):
            i, j = pairs[-1]
            pairs.append((i + 1, j) if step in steps else (i, j + 1))
        return pairs

    return itertools.chain.from_iterable(
        [of(steps)] for steps in itertools.combinations(range(m + n - 2), m - 1)
    )


@pytest.mark.parametrize("seed", range(12))
def test_no_pairing_is_cheaper_than_the_one_found(seed: int) -> None:
    m, n = (4, 4) if seed % 2 else (3 + (seed == 0), 3)
    grid = Grid(seed, m, n)
    low, high = np.zeros(m, np.int64), np.full(m, n - 1)
    pairs, ways = pair_nodes(*grid.points, *grid.tangents, *grid.arcs, low, high, BENDING)
    found = grid.cost([(int(i), int(j)) for i, j in pairs], tuple(int(way) for way in ways))
    least = min(
        grid.cost(pairing, choice)
        for pairing in all_pairings(m, n)
        for choice in grid.all_ways(pairing)
    )
    assert found == pytest.approx(least, rel=1e-6, abs=1e-9)


def test_a_pairing_stays_in_its_corridor() -> None:
    grid = Grid(0, 40, 50)
    at = np.linspace(0.0, 1.0, 30)
    known = [at * arc[-1] for arc in grid.arcs]
    low, high = corridor(*grid.arcs, *known, np.full(30, 1.5))
    pairs, _ = pair_nodes(*grid.points, *grid.tangents, *grid.arcs, low, high, BENDING)
    assert (low[pairs[:, 0]] <= pairs[:, 1]).all()
    assert (pairs[:, 1] <= high[pairs[:, 0]]).all()
    assert tuple(pairs[0]) == (0, 0)
    assert tuple(pairs[-1]) == (39, 49)
    assert (np.diff(pairs, axis=0).sum(axis=1) == 1).all()


def test_a_corridor_holds_everything_within_reach_of_the_known_pairs() -> None:
    p, q = np.linspace(0.0, 10.0, 101), np.linspace(0.0, 10.0, 101)
    at = np.linspace(0.0, 10.0, 11)
    low, high = corridor(p, q, at, at, np.full(11, 0.5))
    for i, arc in enumerate(p):
        near = np.flatnonzero(np.abs(q - arc) <= 0.5)
        assert low[i] <= near[0]
        assert near[-1] <= high[i]
    assert (high - low).max() <= 40


def test_a_sharp_crease_costs_about_what_its_parts_do_and_a_slight_one_its_square() -> None:
    slight, sharp = math.radians(3.0), math.radians(120.0)
    assert crease_cost(slight**2) == pytest.approx(4.0 * crease_cost((slight / 2.0) ** 2))
    assert crease_cost(sharp**2) < 1.1 * 2.0 * crease_cost((sharp / 2.0) ** 2)


def test_twist_is_the_turn_from_one_tangent_to_the_other_seen_along_the_ruling() -> None:
    p, q, x = np.zeros(3), np.array([0.0, 5.0, 0.0]), np.array([1.0, 0.0, 0.0])
    for angle in (-2.0, -0.3, 0.0, 0.7, 3.0):
        b = np.array([math.cos(angle), 0.0, -math.sin(angle)])
        assert twist_at(p, q, x, b) == pytest.approx(angle)
        leaning = 0.6 * b + np.array([0.0, 0.8, 0.0])
        assert twist_at(p, q, x, leaning) == pytest.approx(angle)
    assert twist_at(p, p, x, q / 5.0) == 0.0
    assert twist_at(p, q, q / 5.0, x) == 0.0

"""Constraints inside the search, against every triangulation of small strips."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.seeds import seeds
from tests.strip import brute_force
from tests.strip.brute_force import Bridge
from tests.strip.small_strips import makes_a_strip, small_strip
from tests.strip.test_closed_search import Around, cost_of_invalid, every_way_around, ring
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate

CHOICES = [
    (("invalid", "bending"), "hinge", None),
    (("invalid", "bending"), "hinge", 50.0),
    (("invalid", "bending", "area"), "hinge", 1.0),
    (("bending",), "hinge", None),
    (("bending", "invalid"), "paper", None),
    (("area",), "hinge", None),
    (("length", "invalid"), "hinge", None),
]


def nearest(point: list[float], line: list) -> tuple[float, ...]:
    """The vector to the nearest point of a polyline, tried segment by segment."""
    best: tuple[float, ...] = brute_force.minus(line[0], point)
    for a, b in pairwise(line):
        along, off = brute_force.minus(b, a), brute_force.minus(point, a)
        square = brute_force.dot(along, along)
        share = min(max(brute_force.dot(off, along) / square, 0.0), 1.0) if square else 0.0
        way = brute_force.minus([x + share * y for x, y in zip(a, along, strict=True)], point)
        if brute_force.norm(way) < brute_force.norm(best):
            best = way
    return best


def angle(first: tuple[float, ...], second: tuple[float, ...]) -> float:
    if not brute_force.norm(first):
        return 0.0
    if not brute_force.norm(second):
        return math.pi / 2
    across = brute_force.norm(brute_force.cross(first, second))
    return math.atan2(across, brute_force.dot(first, second))


def lean(p: list, q: list, i: int, j: int, lines: tuple[list, list]) -> float:
    """The smaller angle to the shortest crossings from the bridge's two ends."""
    bridge = brute_force.minus(q[j], p[i])
    back = tuple(-x for x in bridge)
    return min(angle(bridge, nearest(p[i], lines[1])), angle(back, nearest(q[j], lines[0])))


def fold_at(p: list, q: list, before: Bridge, here: Bridge, after: Bridge) -> float:
    """The angle between the normals of two triangles, 0 beside one without area."""
    corners = [brute_force.third(p, q, *pair) for pair in ((before, here), (here, after))]
    if any(brute_force.is_flat(three) for three in corners):
        return 0.0
    normals = [
        brute_force.cross(brute_force.minus(b, a), brute_force.minus(c, a)) for a, b, c in corners
    ]
    return angle(normals[0], normals[1])


def between(values: list[float], share: float) -> float:
    """A limit that no value lies near."""
    ordered = sorted(set(values))
    gaps = [(a, b) for a, b in pairwise(ordered) if b - a > 1e-6 * (1.0 + b)]
    if not gaps:
        return ordered[-1] + 1.0
    low, high = gaps[min(int(share * len(gaps)), len(gaps) - 1)]
    return 0.5 * (low + high)


def asked_of(kind: str, random: np.random.Generator, p: list, q: list, lines) -> dict:
    m, n = len(p), len(q)
    bridges = [(i, j) for i in range(m) for j in range(n)]
    if kind == "pinned":
        return {"pinned": [tuple(int(random.integers(k)) for k in (m, n)) for _ in range(2)]}
    if kind == "forbidden":
        (a, b), (c, d) = (np.sort(random.integers(0, k, 2)).tolist() for k in (m, n))
        return {"forbidden": [(a, b, c, d)]}
    if kind == "max_lean":
        leans = [lean(p, q, i, j, lines) for i, j in bridges]
        return {"max_lean": min(between(leans, random.uniform(0.2, 1.0)), math.pi / 2)}
    if kind == "max_ruling":
        sizes = [brute_force.norm(brute_force.minus(q[j], p[i])) for i, j in bridges]
        return {"max_ruling": between(sizes, random.uniform(0.2, 1.0))}
    return {"fold_bound": float(random.uniform(0.3, 2.8))}


KINDS = ("pinned", "forbidden", "max_lean", "max_ruling", "fold_bound")


def is_kept(asked: dict, p, q, path: list[Bridge], lines, wrap: tuple[int, int] | None) -> bool:
    around = list(path)
    if wrap:
        around = [(path[-2][0] - wrap[0], path[-2][1] - wrap[1]), *path]
    own = [(i % wrap[0], j % wrap[1]) for i, j in path] if wrap else list(path)
    if not set(asked.get("pinned", ())) <= set(own):
        return False
    for a, b, c, d in asked.get("forbidden", ()):
        if any(a <= i <= b and c <= j <= d for i, j in own):
            return False
    leans = [lean(p, q, i, j, lines) for i, j in own] if "max_lean" in asked else []
    if any(one > asked["max_lean"] for one in leans):
        return False
    sizes = [brute_force.norm(brute_force.minus(q[j], p[i])) for i, j in own]
    if max(sizes) > asked.get("max_ruling", math.inf):
        return False
    if "fold_bound" not in asked:
        return True
    inner = range(1, len(around) - 1)
    folds = [fold_at(p, q, *around[k - 1 : k + 2]) for k in inner]
    return max(folds, default=0.0) <= asked["fold_bound"]


def assert_best(kept: list[tuple[dict, float]], one: dict | None, criteria, cost, note) -> None:
    least = brute_force.best([brute_force.cost_of(each, criteria, cost) for each in kept])
    assert one is not None
    for part, best in zip(brute_force.cost_of(one, criteria, cost), least, strict=True):
        assert brute_force.is_close(part, best), (*note, part, least)


@pytest.mark.parametrize("seed", seeds(100, default=3))
@pytest.mark.parametrize("kind", KINDS)
def test_the_best_small_strip_that_keeps_a_constraint_is_found(kind: str, seed: int) -> None:
    seed = makes_a_strip(range(300))[seed]
    p, q = (rail.tolist() for rail in small_strip(seed))
    random = np.random.default_rng([51, seed])
    lines = (p * 2 if len(p) == 1 else p, q * 2 if len(q) == 1 else q)
    asked = asked_of(kind, random, p, q, lines)
    for criteria, energy, price in CHOICES if seed < 8 else CHOICES[:2]:
        every = brute_force.every_triangulation(p, q, energy)
        cost = None if price is None else brute_force.invalid_cost(every, price)
        kept = [one for path, one in every.items() if is_kept(asked, p, q, list(path), lines, None)]
        settings = {"criteria": criteria, "energy": energy, "price": price, **asked}
        if not kept:
            with pytest.raises(InputError, match=r"No strip between these rails|cross"):
                triangulate(p, q, planarity=brute_force.PLANARITY, **settings)
            continue
        found = triangulate(p, q, planarity=brute_force.PLANARITY, **settings)
        path = list(map(tuple, found.bridges.tolist()))
        assert is_kept(asked, p, q, path, lines, None)
        assert_best(kept, every[tuple(path)], criteria, cost, (seed, criteria, price))


def makes_a_closed_strip(p: np.ndarray, q: np.ndarray) -> bool:
    """Enough samples, none twice, and rails that do not coincide."""
    try:
        triangulate(p, q, closed=True)
    except InputError:
        return False
    return True


@pytest.mark.parametrize("seed", seeds(100, default=3))
@pytest.mark.parametrize("kind", KINDS)
def test_the_best_closed_strip_that_keeps_a_constraint_is_found(kind: str, seed: int) -> None:
    p, q = next(pair for pair in map(ring, range(seed, 9999, 1000)) if makes_a_closed_strip(*pair))
    m, n = len(p), len(q)
    random = np.random.default_rng([52, seed])
    lines = ([*p.tolist(), p[0].tolist()], [*q.tolist(), q[0].tolist()])
    asked = asked_of(kind, random, p.tolist(), q.tolist(), lines)
    endless = Around(p), Around(q)
    energy = "hinge"
    ways: dict = {}
    every = every_way_around(p, q, energy, ways)
    kept = [one for key, one in every.items() if is_kept(asked, *endless, ways[key], lines, (m, n))]
    for criteria, price in ((("invalid", "bending"), None), (("invalid", "bending"), 50.0)):
        cost = None if price is None else cost_of_invalid(every, price, m + n)
        settings = {"criteria": criteria, "price": price, "closed": True, **asked}
        if not kept:
            with pytest.raises(InputError, match=r"No strip|cross"):
                triangulate(p, q, planarity=brute_force.PLANARITY, **settings)
            continue
        found = triangulate(p, q, planarity=brute_force.PLANARITY, **settings)
        path = [(int(i), int(j)) for i, j in found.bridges]
        assert is_kept(asked, *endless, path, lines, (m, n))
        key = frozenset((a[0] % m, a[1] % n, b[0] - a[0]) for a, b in pairwise(path))
        assert_best(kept, every[key], criteria, cost, (seed, criteria, price))


@pytest.mark.parametrize("seed", seeds(100, default=2))
@pytest.mark.parametrize("kind", KINDS)
def test_the_local_search_keeps_a_constraint_wherever_a_strip_does(kind: str, seed: int) -> None:
    seed = makes_a_strip(range(300))[seed]
    p, q = (rail.tolist() for rail in small_strip(seed))
    lines = (p * 2 if len(p) == 1 else p, q * 2 if len(q) == 1 else q)
    asked = asked_of(kind, np.random.default_rng([54, seed]), p, q, lines)
    every = brute_force.every_triangulation(p, q, "hinge")
    can_be = any(is_kept(asked, p, q, list(path), lines, None) for path in every)
    if not can_be:
        with pytest.raises(InputError, match=r"No strip between these rails|cross"):
            triangulate(p, q, search="local", planarity=brute_force.PLANARITY, **asked)
        return
    found = triangulate(p, q, search="local", planarity=brute_force.PLANARITY, **asked)
    path = list(map(tuple, found.bridges.tolist()))
    assert is_kept(asked, p, q, path, lines, None)


def circle(count: int, radius: float, z: float, start: float = 0.0) -> np.ndarray:
    t = np.linspace(0.0, 2 * np.pi, count, endpoint=False) + start
    return np.stack((radius * np.cos(t), radius * np.sin(t), z + 0 * t), axis=1)


ASKED = [
    {"pinned": [(3, 4), (20, 24)]},
    {"max_lean": 0.3},
    {"max_ruling": 61.6},
    {"fold_bound": 0.4},
    {"forbidden": [(28, 2, 3, 9)]},
]


@pytest.mark.parametrize("asked", ASKED, ids=lambda asked: next(iter(asked)))
@pytest.mark.parametrize("search", ["global", "local"])
def test_closed_strips_keep_constraints_in_both_searches(asked: dict, search: str) -> None:
    p, q = circle(30, 50.0, 0.0), circle(36, 40.0, 60.0, 0.1)
    found = triangulate(p, q, closed=True, search=search, **asked)
    assert len(found.bridges) == 67
    i, j = found.bridges[:-1].T
    own = set(zip((i % 30).tolist(), (j % 36).tolist(), strict=True))
    assert own.issuperset(asked.get("pinned", ()))
    assert not any((a >= 28 or a <= 2) and 3 <= b <= 9 for a, b in own) or "forbidden" not in asked
    lengths = np.linalg.norm(p[i % 30] - q[j % 36], axis=1)
    assert lengths.max() <= asked.get("max_ruling", np.inf)
    assert np.abs(found.fold).max() <= asked.get("fold_bound", np.inf)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"max_ruling": 5.0}, r"keeps max_ruling of 5 mm: the longest ruling .* is 11.45 mm"),
        ({"max_lean": 0.1}, r"keeps max_lean of 5.73 degrees: the largest lean"),
        (
            {"fold_bound": 0.3},
            r"keeps fold_bound of 17.19 degrees: the largest fold .* degrees, at",
        ),
        (
            {"forbidden": [(1, 1, 0, 3)]},
            r"keeps the forbidden stretch from \(5.00.* of P on: every",
        ),
        (
            {"pinned": [(1, 3)], "max_lean": 0.7},
            r"keeps pinned ruling 1 from \(5.00.* of P and max_lean of 40.11 degrees:",
        ),
        ({"pinned": [(1, 2), (2, 1)]}, "Pinned rulings 1 and 2 cross"),
        ({"pinned": [(9, 2)]}, "pinned cannot name sample 9 of P: it has samples 0 to 3"),
        ({"max_lean": -1.0}, "max_lean cannot be -1 rad: give a number above 0"),
    ],
)
def test_what_cannot_be_kept_is_said_with_the_constraint_that_fails(asked, message) -> None:
    x = np.arange(4.0)
    p = np.stack((5 * x, 0 * x, [0, 4, 0, 4]), axis=1)
    q = np.stack((5 * x, 0 * x + 9, [0, 3, -1, 4]), axis=1)
    with pytest.raises(InputError, match=message):
        triangulate(p, q, **asked)


def test_the_constraints_exclude_some_strips_and_change_others() -> None:
    """The comparisons above can fail: without the constraint the best strip often breaks it."""
    broken = 0
    for seed in makes_a_strip(range(30)):
        p, q = (rail.tolist() for rail in small_strip(seed))
        lines = (p * 2 if len(p) == 1 else p, q * 2 if len(q) == 1 else q)
        for kind in KINDS:
            asked = asked_of(kind, np.random.default_rng([51, seed]), p, q, lines)
            path = list(map(tuple, triangulate(p, q).bridges.tolist()))
            broken += not is_kept(asked, p, q, path, lines, None)
    assert broken > 40

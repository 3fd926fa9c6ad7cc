"""Every triangulation of a small strip, tried one by one in plain Python.

Shares no code with the package: validity by the largest angular gap between neighbours, folds by
the angle between triangle normals, coplanar triangles by distances from planes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations, pairwise

Point = Sequence[float]
Bridge = tuple[int, int]

NOTHING = 1e-12
"""mm; coordinates of the strips tried here are of order 1."""

PLANARITY = 1e-9
"""mm; no distance of the strips tried here lies near it: what is not 0 is far larger."""

TIE = 1e-11
"""Real values whose difference is a smaller share of them are equal but for round-off."""


def minus(a: Point, b: Point) -> tuple[float, float, float]:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def cross(a: Point, b: Point) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Point, b: Point) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def norm(a: Point) -> float:
    return math.sqrt(dot(a, a))


def paths(m: int, n: int) -> Iterator[list[Bridge]]:
    """Every path of bridges: choose which of the m+n-2 steps are P-steps."""
    total = m + n - 2
    for chosen in combinations(range(total), m - 1):
        path = [(0, 0)]
        for step in range(total):
            i, j = path[-1]
            path.append((i + 1, j) if step in chosen else (i, j + 1))
        yield path


def is_valid(p: Sequence[Point], q: Sequence[Point], i: int, j: int) -> bool:
    """Neighbours seen along the bridge leave a gap of at least half a turn."""
    e = minus(q[j], p[i])
    length = norm(e)
    if length <= NOTHING:
        return True
    e = (e[0] / length, e[1] / length, e[2] / length)
    side = min(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), key=lambda a: abs(dot(a, e)))
    u = cross(e, side)
    v = cross(e, u)
    angles = []
    for rail, index in ((p, i), (q, j)):
        for other in (index - 1, index + 1):
            if 0 <= other < len(rail):
                offset = minus(rail[other], rail[index])
                x, y = dot(offset, u), dot(offset, v)
                if math.hypot(x, y) > PLANARITY:
                    angles.append(math.atan2(y, x))
    angles.sort()
    if len(angles) < 2:
        return True
    gaps = [b - a for a, b in zip(angles, [*angles[1:], angles[0] + 2 * math.pi], strict=True)]
    return max(gaps) >= math.pi - PLANARITY


def third(p: Sequence[Point], q: Sequence[Point], a: Bridge, b: Bridge) -> list[Point]:
    """The corners of the triangle between two bridges."""
    (i, j), (next_i, next_j) = a, b
    return [p[i], p[next_i], q[j]] if next_i > i else [p[i], q[next_j], q[j]]


def height(corners: Sequence[Point], start: Point, end: Point) -> float:
    """Height over the side start-end: twice the area by the side's length."""
    return 2 * area_of(corners) / norm(minus(end, start))


def area_of(corners: Sequence[Point]) -> float:
    a, b, c = corners
    return 0.5 * norm(cross(minus(b, a), minus(c, a)))


def is_flat(corners: Sequence[Point]) -> bool:
    a, b, c = corners
    longest = max(norm(minus(b, a)), norm(minus(c, b)), norm(minus(a, c)))
    return 2 * area_of(corners) <= NOTHING * longest


def off_plane(point: Point, triangle: Sequence[Point]) -> float:
    a, b, c = triangle
    normal = cross(minus(b, a), minus(c, a))
    return abs(dot(minus(point, a), normal)) / norm(normal)


def is_same_side(start: Point, end: Point, one: Point, other: Point) -> bool:
    """Whether two points lie on one side of the line, seen along it."""
    along = minus(end, start)
    return dot(cross(along, minus(one, start)), cross(along, minus(other, start))) > 0.0


def bend(
    p: Sequence[Point], q: Sequence[Point], before: Bridge, here: Bridge, after: Bridge, energy: str
) -> tuple[float, int, int]:
    """Bending energy at a bridge; 1 if its triangles are not coplanar; 1 if it folds back."""
    first, second = third(p, q, before, here), third(p, q, here, after)
    if is_flat(first) or is_flat(second):
        return 0.0, 0, 0
    start, end = p[here[0]], q[here[1]]
    outer = p[before[0]] if before[0] < here[0] else q[before[1]]
    other = p[after[0]] if after[0] > here[0] else q[after[1]]
    is_back = is_same_side(start, end, outer, other)
    if min(off_plane(outer, second), off_plane(other, first)) <= PLANARITY:
        return 0.0, int(is_back), int(is_back)
    normals = [cross(minus(t[1], t[0]), minus(t[2], t[0])) for t in (first, second)]
    angle = math.atan2(norm(cross(*normals)), dot(*normals))
    if angle > math.pi - 2e-6:
        return 0.0, 1, 1
    length = norm(minus(end, start))
    if energy == "paper":
        return area_of(second) * math.sin(angle) ** 2 / height(second, start, end) ** 2, 1, 0
    heights = 1 / height(first, start, end) + 1 / height(second, start, end)
    return length / 4 * heights * (2 * math.tan(angle / 2)) ** 2, 1, 0


Measures = dict[str, float]


def every_triangulation(
    p: Sequence[Point], q: Sequence[Point], energy: str
) -> dict[tuple[Bridge, ...], Measures]:
    """What each triangulation measures; what paths share is worked out once."""
    valid = cache(lambda i, j: is_valid(p, q, i, j))
    flat = cache(lambda a, b: is_flat(third(p, q, a, b)))
    area = cache(lambda a, b: area_of(third(p, q, a, b)))
    bent = cache(lambda a, b, c: bend(p, q, a, b, c, energy))
    length = cache(lambda i, j: norm(minus(q[j], p[i])))
    tried = {}
    for path in paths(len(p), len(q)):
        sides = list(pairwise(path))
        bends = [bent(*path[k - 1 : k + 2]) for k in range(1, len(path) - 1)]
        invalid = [not valid(*bridge) for bridge in path[1:-1]]
        tried[tuple(path)] = {
            "fold-backs": sum(back for _, _, back in bends),
            "degenerate": sum(flat(*side) for side in sides),
            "invalid": sum(a and b for a, (_, b, _) in zip(invalid, bends, strict=True)),
            "all invalid": sum(invalid),
            "bending": math.fsum(bending for bending, _, _ in bends),
            "area": math.fsum(area(*side) for side in sides),
            "length": math.fsum(length(*bridge) for bridge in path),
        }
    return tried


def cost_of(one: Measures, criteria: Sequence[str], invalid_cost: float | None) -> list[float]:
    """The parts of a triangulation's cost in order of comparison."""
    names = list(criteria)
    parts = [one["fold-backs"]]
    if invalid_cost is not None:
        parts += [one["degenerate"], one["bending"] + invalid_cost * one["invalid"]]
        names = names[2:]
    for name in names:
        parts += [one["degenerate"]] * (name == "bending") + [one[name]]
    return [*parts, one["length"]]


def invalid_cost(tried: dict[tuple[Bridge, ...], Measures], price: float) -> float:
    """What an invalid bridge is worth in bending energy."""
    fewest = min((one["fold-backs"], one["degenerate"]) for one in tried.values())
    least = min(
        one["bending"] for one in tried.values() if (one["fold-backs"], one["degenerate"]) == fewest
    )
    interior = len(next(iter(tried))) - 2
    return price * least / interior if interior else 0.0


def is_close(a: float, b: float, tie: float = 1e-9) -> bool:
    return abs(a - b) <= 1e-13 + tie * abs(b)


def best(costs: Sequence[list[float]]) -> list[float]:
    """The least value of each part in order, each among the paths that are best so far."""
    left = list(costs)
    least = []
    for part in range(len(left[0])):
        least.append(min(one[part] for one in left))
        left = [one for one in left if is_close(one[part], least[part], TIE)]
    return least

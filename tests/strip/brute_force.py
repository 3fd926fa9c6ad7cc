"""Every triangulation of a small strip, tried one by one in plain Python.

Shares no code with the package: validity by the largest angular gap between neighbours, folds by
the angle between triangle normals.
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
                if math.hypot(x, y) > NOTHING:
                    angles.append(math.atan2(y, x))
    angles.sort()
    if len(angles) < 2:
        return True
    gaps = [b - a for a, b in zip(angles, [*angles[1:], angles[0] + 2 * math.pi], strict=True)]
    return max(gaps) >= math.pi - 1e-12


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


def bend(
    p: Sequence[Point], q: Sequence[Point], before: Bridge, here: Bridge, after: Bridge, energy: str
) -> tuple[float, int]:
    """Bending energy at a bridge, and 1 if it folds back by 180 degrees."""
    first, second = third(p, q, before, here), third(p, q, here, after)
    if is_flat(first) or is_flat(second):
        return 0.0, 0
    start, end = p[here[0]], q[here[1]]
    normals = [cross(minus(t[1], t[0]), minus(t[2], t[0])) for t in (first, second)]
    angle = math.atan2(norm(cross(*normals)), dot(*normals))
    length = norm(minus(end, start))
    if energy == "paper":
        return area_of(second) * math.sin(angle) ** 2 / height(second, start, end) ** 2, 0
    if angle > math.pi - 2e-6:
        return 0.0, 1
    heights = 1 / height(first, start, end) + 1 / height(second, start, end)
    return length / 4 * heights * (2 * math.tan(angle / 2)) ** 2, 0


def every_triangulation(
    p: Sequence[Point], q: Sequence[Point], energy: str
) -> list[dict[str, float]]:
    """What each triangulation measures; what paths share is worked out once."""
    valid = cache(lambda i, j: is_valid(p, q, i, j))
    flat = cache(lambda a, b: is_flat(third(p, q, a, b)))
    area = cache(lambda a, b: area_of(third(p, q, a, b)))
    bent = cache(lambda a, b, c: bend(p, q, a, b, c, energy))
    length = cache(lambda i, j: norm(minus(q[j], p[i])))
    tried = []
    for path in paths(len(p), len(q)):
        sides = list(pairwise(path))
        bends = [bent(*path[k - 1 : k + 2]) for k in range(1, len(path) - 1)]
        tried.append(
            {
                "invalid": sum(not valid(*bridge) for bridge in path[1:-1]),
                "degenerate": sum(flat(*side) for side in sides) + sum(back for _, back in bends),
                "bending": math.fsum(bending for bending, _ in bends),
                "area": math.fsum(area(*side) for side in sides),
                "length": math.fsum(length(*bridge) for bridge in path),
            }
        )
    return tried


def is_close(a: float, b: float) -> bool:
    return abs(a - b) <= 1e-12 + 1e-9 * abs(b)


def best(
    tried: list[dict[str, float]], criteria: Sequence[str]
) -> tuple[list[tuple[str, float]], bool]:
    """The best values in order, each among the paths that are best so far.

    Stops behind the first real-valued criterion if several paths are left there: what comes behind
    an exact tie depends on round-off.
    """
    values = []
    left = tried
    for name in criteria:
        for part in ("degenerate", "bending") if name == "bending" else (name,):
            least = min(one[part] for one in left)
            left = [one for one in left if is_close(one[part], least)]
            values.append((part, least))
        if name != "invalid" and len(left) > 1:
            return values, True
    return values, False

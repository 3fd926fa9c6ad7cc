"""What is wrong with the tables of geometry in a BREP text file.

The kernel believes every count in them: one number too many or too few, and it reads what follows
as something else, for minutes or for ever. So each table is read here first, as the kernel's own
description of the format has it (Open CASCADE, "BRep Format").
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from wrinkle_cad import settings

from .brep_words import ENDLESS, Tokens, shown

HIGHEST_DEGREE: Final = 25
"""The kernel takes no splines of a higher one."""
_DEEPEST: Final = 20
"""Curves and surfaces that are made from others: trimmed, offset, swept."""
_MOST_POWER: Final = 1000
_CURVES: Final = {2: {1: 4, 2: 7, 3: 8, 4: 7, 5: 8}, 3: {1: 6, 2: 13, 3: 14, 4: 13, 5: 14}}
"""Numbers of lines, circles, ellipses, parabolas and hyperbolas, by dimension."""
_SURFACES: Final = {1: 12, 2: 13, 3: 14, 4: 13, 5: 14}
"""Numbers of planes, cylinders, cones, spheres and tori."""


def geometry_sizes(text: bytes) -> dict[str, int]:
    """Reads the tables before that of the shapes.

    Args:
        text: a BREP text file with line feeds as line ends.

    Returns:
        How many entries each has.

    Raises:
        ValueError: what is wrong with one; the message names the table.
    """
    start, end = text.find(b"\nLocations "), text.find(b"\nTShapes ")
    version = 3 if b"Topology V3" in text[:start] else 1
    tokens = Tokens(text[start:end].split())
    readers: dict[str, Callable[[Tokens, int], object]] = {
        "Locations": _location,
        "Curve2ds": lambda found, _: _curve(found, 2),
        "Curves": lambda found, _: _curve(found, 3),
        "Polygon3D": _polygon,
        "PolygonOnTriangulations": _polygon_on_triangles,
        "Surfaces": lambda found, _: _surface(found),
        "Triangulations": lambda found, _: _triangles(found, version),
    }
    sizes: dict[str, int] = {}
    for name, read in readers.items():
        if (header := tokens.word()) != name.encode():
            raise ValueError(f"'{shown(header)}' stands where its table of {name} begins")
        entry = 0
        try:
            sizes[name] = tokens.whole(0, len(text))
            for entry in range(1, sizes[name] + 1):
                read(tokens, entry)
        except ValueError as fault:
            where = f"entry {entry} of its table of {name}" if entry else f"its table of {name}"
            raise ValueError(f"{where} {fault}") from None
    if rest := tokens.word():
        raise ValueError(f"'{shown(rest)}' stands behind its tables of geometry")
    return sizes


def _location(tokens: Tokens, entry: int) -> None:
    if tokens.whole(1, 2) == 1:
        tokens.reals(12)
        return
    while tokens.whole(0, entry - 1):
        tokens.whole(-_MOST_POWER, _MOST_POWER)


def _curve(tokens: Tokens, dimension: int, depth: int = 0) -> None:
    kind = tokens.whole(1, 9)
    if kind in _CURVES[dimension]:
        tokens.reals(_CURVES[dimension][kind])
    elif kind == 6:
        is_rational, degree = tokens.whole(0, 1), tokens.whole(1, HIGHEST_DEGREE)
        _poles(tokens, degree + 1, dimension, is_rational=bool(is_rational))
    elif kind == 7:
        is_rational, is_periodic = tokens.whole(0, 1), tokens.whole(0, 1)
        degree, poles, knots = _spline_counts(tokens)
        _poles(tokens, poles, dimension, is_rational=bool(is_rational))
        _knots(tokens, degree, poles, knots, is_periodic=bool(is_periodic))
    else:
        tokens.reals(2, ENDLESS) if kind == 8 else tokens.reals(1 if dimension == 2 else 4)
        _check_depth(depth)
        _curve(tokens, dimension, depth + 1)


def _spline_counts(tokens: Tokens) -> tuple[int, int, int]:
    return (
        tokens.whole(1, HIGHEST_DEGREE),
        tokens.whole(2, settings.FILE_SIZE_LIMIT),
        tokens.whole(2, settings.FILE_SIZE_LIMIT),
    )


def _check_depth(depth: int) -> None:
    if depth >= _DEEPEST:
        raise ValueError(f"is made from others more than {_DEEPEST} times over")


def _poles(tokens: Tokens, count: int, dimension: int, *, is_rational: bool) -> None:
    numbers = tokens.reals(count * (dimension + is_rational))
    weights = numbers[dimension :: dimension + 1] if is_rational else ()
    if not all(weight > 0.0 for weight in weights):
        raise ValueError("has a weight that is not above 0")


def _knots(tokens: Tokens, degree: int, poles: int, count: int, *, is_periodic: bool) -> None:
    """Reads knots with their multiplicities, and holds them against the poles."""
    before, multiplicities = -math.inf, []
    for _ in range(count):
        (knot,) = tokens.reals(1)
        multiplicities.append(tokens.whole(1, degree + 1))
        if not knot > before:
            raise ValueError(f"has knots that do not grow: {before:.6g}, then {knot:.6g}")
        before = knot
    needed = sum(multiplicities[:-1]) if is_periodic else sum(multiplicities) - degree - 1
    if needed != poles:
        raise ValueError(f"has {poles} poles, and its knots are those of {needed}")


def _surface(tokens: Tokens, depth: int = 0) -> None:
    kind = tokens.whole(1, 11)
    if kind in _SURFACES:
        tokens.reals(_SURFACES[kind])
    elif kind in (6, 7):
        tokens.reals(3 if kind == 6 else 6)
        _curve(tokens, 3)
    elif kind == 8:
        is_rational = max(tokens.whole(0, 1), tokens.whole(0, 1))
        u, v = tokens.whole(1, HIGHEST_DEGREE), tokens.whole(1, HIGHEST_DEGREE)
        _poles(tokens, (u + 1) * (v + 1), 3, is_rational=bool(is_rational))
    elif kind == 9:
        _spline_surface(tokens)
    else:
        tokens.reals(4, ENDLESS) if kind == 10 else tokens.reals(1)
        _check_depth(depth)
        _surface(tokens, depth + 1)


def _spline_surface(tokens: Tokens) -> None:
    is_rational = max(tokens.whole(0, 1), tokens.whole(0, 1))
    periodic = tokens.whole(0, 1), tokens.whole(0, 1)
    degrees = tokens.whole(1, HIGHEST_DEGREE), tokens.whole(1, HIGHEST_DEGREE)
    counts = [tokens.whole(2, settings.FILE_SIZE_LIMIT) for _ in range(4)]
    _poles(tokens, counts[0] * counts[1], 3, is_rational=bool(is_rational))
    for way in range(2):
        _knots(tokens, degrees[way], counts[way], counts[2 + way], is_periodic=bool(periodic[way]))


def _polygon(tokens: Tokens, _: int) -> None:
    count, has_parameters = tokens.whole(1, settings.FILE_SIZE_LIMIT), tokens.whole(0, 1)
    tokens.reals(1)
    tokens.reals(count * (3 + has_parameters))


def _polygon_on_triangles(tokens: Tokens, _: int) -> None:
    count = tokens.whole(1, settings.FILE_SIZE_LIMIT)
    tokens.reals(count)
    if tokens.word() != b"p":
        raise ValueError("has other numbers of nodes than it says")
    tokens.reals(1)
    tokens.reals(count * tokens.whole(0, 1))


def _triangles(tokens: Tokens, version: int) -> None:
    nodes, triangles = (tokens.whole(1, settings.FILE_SIZE_LIMIT) for _ in range(2))
    has_parameters = tokens.whole(0, 1)
    has_normals = tokens.whole(0, 1) if version == 3 else 0
    tokens.reals(1)
    tokens.reals(nodes * (3 + 2 * has_parameters))
    for _ in range(3 * triangles):
        tokens.whole(1, nodes)
    tokens.reals(3 * nodes * has_normals)

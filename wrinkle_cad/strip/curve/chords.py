"""Chords as long as a tolerance allows, placed along a curve that is given as cells.

From each vertex the farthest point of the curve is sought whose chord has every curve point
between within the tolerance. That a chord fails does not mean that no longer one succeeds (a wave
flatter than the tolerance), so the search goes on until no chord can succeed any more: seen from
the vertex, every curve point farther off than the tolerance confines the chord's direction to a
cone, and two of these cones have become disjoint. Then the same number of chords is spread evenly,
with the smallest share of the tolerance that still needs no more of them.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from wrinkle_cad.strip.compiled import compiled

from .chebyshev import FloatArray, point_in_cell, point_in_cells

IndexArray = NDArray[np.int64]

BISECTIONS: Final = 10
"""Table points stand about 1/14 of a chord apart: an end is found to 1e-4 of a chord. Not to
round-off: ends on this grid stay where they are when round-off differs, as it does for the curve
run the other way; ends off it pass the difference on to the next, some 1e4-fold at inflections."""
EVENING_STEPS: Final = 6
RETRIES: Final = (1.0, 0.98, 0.93, 0.85, 0.7, 0.5, 0.3)
"""Shares of the tolerance's square root, tried until no chord comes out too short."""
DEEPEST: Final = 48


@compiled
def _gap2(
    x: float, y: float, z: float, a: tuple[float, float, float], b: tuple[float, float, float]
) -> float:
    """Squared distance from a point to the segment a-b."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = x - a[0], y - a[1], z - a[2]
    square = ux * ux + uy * uy + uz * uz
    share = ux * vx + uy * vy + uz * vz
    share = 0.0 if square == 0.0 else min(1.0, max(0.0, share / square))
    vx, vy, vz = vx - share * ux, vy - share * uy, vz - share * uz
    return vx * vx + vy * vy + vz * vz


@compiled
def tabulate(
    edges: FloatArray, coefficients: FloatArray, sag: float, spacing: float, most: int
) -> tuple[FloatArray, FloatArray]:
    """Points along the curve so close that it bulges at most ``sag`` between neighbours.

    Args:
        edges: (c + 1,) float64: the cells' parameters; each becomes a point of the table.
        coefficients: (c, 17, 3) float64, mm.
        sag: mm; largest distance from the curve midway to the segment between neighbours.
        spacing: mm; largest distance between neighbours.
        most: the table stops growing at so many points (then it is not complete).

    Returns:
        (k,) float64 parameters and (k, 3) float64 points in mm.
    """
    size = 1024
    t = np.empty(size)
    x = np.empty((size, 3))
    ends = np.empty(DEEPEST + 2)
    count = 0
    for cell in range(len(edges) - 1):
        low, stack = -1.0, 0
        ends[0] = 1.0
        a = point_in_cell(coefficients[cell], low)
        while stack >= 0:
            high = ends[stack]
            b = point_in_cell(coefficients[cell], high)
            m = point_in_cell(coefficients[cell], 0.5 * (low + high))
            length2 = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2
            fine = _gap2(m[0], m[1], m[2], a, b) <= sag * sag and length2 <= spacing * spacing
            if not fine and stack < DEEPEST:
                stack += 1
                ends[stack] = 0.5 * (low + high)
                continue
            if count + 2 > size:
                if count >= most:
                    return t[:count], x[:count]
                size *= 2
                grown_t = np.empty(size)
                grown_t[:count] = t[:count]
                grown_x = np.empty((size, 3))
                grown_x[:count] = x[:count]
                t, x = grown_t, grown_x
            t[count] = edges[cell] + 0.5 * (low + 1.0) * (edges[cell + 1] - edges[cell])
            x[count, 0], x[count, 1], x[count, 2] = a
            count += 1
            low, a = high, b
            stack -= 1
    t[count] = edges[-1]
    x[count, 0], x[count, 1], x[count, 2] = point_in_cell(coefficients[-1], 1.0)
    return t[: count + 1], x[: count + 1]


@compiled
def excess(
    x: FloatArray,
    first: int,
    last: int,
    a: tuple[float, float, float],
    b: tuple[float, float, float],
    limits: tuple[float, float, float],
    enough: float,
) -> float:
    """By what factor the chord a-b exceeds the limits, squared; above 1 it is not allowed.

    Args:
        x: (k, 3) float64, mm: a table of curve points, as ``tabulate`` makes it.
        first: the first table point between the chord's ends.
        last: the last one; before ``first`` if there is none.
        a: mm; where the chord begins.
        b: mm; where it ends.
        limits: mm; distance of the curve from a chord, longest chord (may be infinite), shortest.
        enough: at a factor above it the rest is not looked at.

    Returns:
        The largest of the points' gaps over the tolerance and the chord over the longest, squared;
        infinite if the chord is too short.
    """
    tolerance, longest, shortest = limits
    length2 = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2
    if length2 < shortest * shortest:
        return np.inf
    worst = length2 / (longest * longest)
    square = 1.0 / (tolerance * tolerance)
    for i in range(first, last + 1):
        if worst > enough:
            return worst
        worst = max(worst, _gap2(x[i, 0], x[i, 1], x[i, 2], a, b) * square)
    return worst


@compiled
def _horizon(
    x: FloatArray,
    first: int,
    end: int,
    a: tuple[float, float, float],
    limits: tuple[float, float, float],
    cones: FloatArray,
) -> int:
    """The last table point up to ``end`` that a chord from ``a`` might still reach.

    ``cones`` is scratch (k, 5): direction, sine and cosine of the half angle.
    """
    tolerance, longest, _ = limits
    count = 0
    for i in range(first, end + 1):
        vx, vy, vz = x[i, 0] - a[0], x[i, 1] - a[1], x[i, 2] - a[2]
        distance = np.sqrt(vx * vx + vy * vy + vz * vz)
        if distance > longest + tolerance:
            return i
        if distance <= tolerance:
            continue
        vx, vy, vz = vx / distance, vy / distance, vz / distance
        sine = tolerance / distance
        cosine = np.sqrt(1.0 - sine * sine)
        for j in range(count):
            dot = cones[j, 0] * vx + cones[j, 1] * vy + cones[j, 2] * vz
            if dot < cones[j, 4] * cosine - cones[j, 3] * sine:
                return i
        cones[count, 0], cones[count, 1], cones[count, 2] = vx, vy, vz
        cones[count, 3], cones[count, 4] = sine, cosine
        count += 1
    return end


@compiled
def _refine(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    first: int,
    k: int,
    low: float,
    a: tuple[float, float, float],
    limits: tuple[float, float, float],
) -> tuple[float, bool]:
    """Moves a chord's end from ``low`` (table point k or before it) towards table point k + 1."""
    t, x, edges, coefficients = curve
    high = t[k + 1]
    found = False
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        b = point_in_cells(edges, coefficients, middle)
        if excess(x, first, k, a, b, limits, 1.0) <= 1.0:
            low, found = middle, True
        else:
            high = middle
    return low, found


@compiled
def _greedy(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    start: int,
    end: int,
    limits: tuple[float, float, float],
    out: FloatArray,
    cones: FloatArray,
) -> int:
    """Writes the parameters of the vertices after table point ``start`` up to ``end``.

    Returns how many chords there are, or -1 if some chord is bound to be too short.
    """
    t, x, edges, coefficients = curve
    goal = (x[end, 0], x[end, 1], x[end, 2])
    a = (x[start, 0], x[start, 1], x[start, 2])
    parameter = t[start]
    first = start + 1
    for count in range(len(out)):
        if excess(x, first, end - 1, a, goal, limits, 1.0) <= 1.0:
            out[count] = t[end]
            return count + 1
        k = min(_horizon(x, first, end, a, limits, cones), end - 1)
        while k >= first:
            reached = (x[k, 0], x[k, 1], x[k, 2])
            if excess(x, first, k - 1, a, reached, limits, 1.0) <= 1.0:
                break
            k -= 1
        low = t[k] if k >= first else parameter
        low, found = _refine(curve, first, k, low, a, limits)
        if k < first and not found:
            return -1
        out[count] = parameter = low
        a = point_in_cells(edges, coefficients, parameter)
        first = k + 1
        if t[first] <= parameter:
            first += 1
    return -1


@compiled
def _scaled(limits: tuple[float, float, float], share: float) -> tuple[float, float, float]:
    """Limits for chords ``share`` times as long: the bulge of a chord grows as its square."""
    return limits[0] * share * share, limits[1] * share, limits[2]


@compiled
def even_piece(
    curve: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    start: int,
    end: int,
    limits: tuple[float, float, float],
    best: FloatArray,
    trial: FloatArray,
    cones: FloatArray,
) -> int:
    """Places the vertices of one smooth piece from its start, evened out.

    Args:
        curve: the table's parameters and points, the cells' edges and coefficients.
        start: table point where the piece begins.
        end: table point where it ends.
        limits: mm; distance of the curve from a chord, longest chord (may be infinite), shortest.
        best: (k,) float64: receives the parameters of the vertices after ``start`` up to ``end``.
        trial: (k,) float64, scratch.
        cones: (k, 5) float64, scratch.

    Returns:
        How many chords there are, or -1 if one is bound to be too short.
    """
    count = -1
    good = 1.0
    for share in RETRIES:
        count = _greedy(curve, start, end, _scaled(limits, share), best, cones)
        good = share
        if count > 0:
            break
    if count < 2:
        return count
    bad = good * (count - 1.5) / count
    for _ in range(EVENING_STEPS):
        share = 0.5 * (good + bad)
        needed = _greedy(curve, start, end, _scaled(limits, share), trial, cones)
        if 0 < needed <= count:
            best[:needed] = trial[:needed]
            count = needed
            good = share
        else:
            bad = share
    return count

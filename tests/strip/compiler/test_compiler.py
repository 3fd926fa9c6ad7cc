"""Compiled functions give what Python gives, to the bit."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

from wrinkle_cad.strip.compiled import compiled
from wrinkle_cad.strip.compiler.kinds import CannotCompileError

Floats = npt.NDArray[np.float64]
SCALE = 3.0
TABLE = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])


class Pair(NamedTuple):
    x: float
    y: float


def both(function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function returns, the same from Python and compiled."""
    expected = function(*arguments)
    found = compiled(function)(*arguments)
    assert type(found) is type(expected) or isinstance(expected, np.generic), (found, expected)
    np.testing.assert_equal(found, expected)
    return found


def arithmetic(a: float, b: float, i: int, j: int) -> tuple[float, ...]:
    return (a + b, a - b, a * b, a / b, a**2, -a, a * i, i / j, abs(a), abs(-i))


def integers(i: int, j: int) -> tuple[int, ...]:
    return (i + j, i - j, i * j, i // j, i % j, i & j, i | j, i ^ j, i << 2, i >> 1, -i)


def test_arithmetic_is_that_of_python() -> None:
    for a, b, i, j in ((0.1, 3.7, 7, 3), (-1e100, 1e-9, -7, 3), (5.5, -0.3, 7, -3), (1.0, 2, 0, 5)):
        both(arithmetic, a, float(b), i, j)
        both(integers, i, j)


def comparisons(a: float, b: float, i: int) -> tuple[bool, ...]:
    return (a < b, a <= b, a > b, a >= b, a == b, a != b, 0 < i <= 3, i in (1, 4), i not in (1, 4))


def test_comparisons_are_those_of_python_also_with_nan() -> None:
    for a, b in ((1.0, 2.0), (2.0, 1.0), (1.0, 1.0), (math.nan, 1.0), (1.0, math.nan)):
        for i in (0, 1, 4):
            both(comparisons, a, b, i)


def extremes(a: float, b: float, c: float) -> tuple[float, float, float]:
    return min(a, b, c), max(a, b, c), max(min(a, b), c)


def test_the_least_of_equal_numbers_is_the_first_and_nan_stays_where_python_leaves_it() -> None:
    numbers = (0.0, -0.0, 1.0, math.nan)
    for a in numbers:
        for b in numbers:
            for c in numbers:
                found, expected = compiled(extremes)(a, b, c), extremes(a, b, c)
                assert str(found) == str(expected)


def divided(a: float, b: float, i: int) -> tuple[float, int, int]:
    return a / b, i // 0, i % 0


def test_division_by_zero_is_that_of_ieee_754_and_of_integers_zero() -> None:
    assert compiled(divided)(1.0, 0.0, 3) == (math.inf, 0, 0)
    assert math.isnan(compiled(divided)(0.0, 0.0, 3)[0])


def shortened(i: int, numbers: Floats) -> bool:
    return i < len(numbers) and numbers[i] > 0.0 and not numbers[i] > 5.0


def test_the_second_side_is_looked_at_only_if_it_matters() -> None:
    for i in (0, 1, 2, 10**12):
        both(shortened, i, np.array([1.0, 7.0, -1.0]))


def loops(count: int, numbers: Floats) -> tuple[float, int, int]:
    total, seen, last = 0.0, 0, -1
    for i in range(count):
        if i == 3:
            continue
        for k in range(len(numbers) - 1, -1, -1):
            if numbers[k] < 0.0:
                break
            total += numbers[k] * i
        last = i
    while True:
        seen += 1
        if seen * seen > count:
            break
    for factor in (2.0, 3.0, 4):
        if factor == 4:
            continue
        total *= factor
    return total, seen, last


def test_loops_leave_and_go_on_where_they_are_told() -> None:
    for count in (0, 1, 7):
        both(loops, count, np.array([1.0, -2.0, 3.0, 4.0]))


def growing(count: int) -> float:
    value = 0
    for _ in range(count):
        value = value + 1 if value < 2 else value + 0.5
    return value * 1.0


def test_a_variable_that_becomes_a_float_is_one_from_the_start() -> None:
    for count in range(5):
        both(growing, count)


def views(a: Floats, i: int) -> tuple[float, ...]:
    row, column, inner = a[i], a[:, -1], a[1:-1, i:]
    turned = a[::-1]
    return (
        row[0], row[-1], column[i], len(inner) * 1.0, inner.shape[1] * 1.0, turned[0, 0],
        a[5:, 0].size * 1.0, a[:-9].shape[0] * 1.0, a[1::2][0, i], float(inner.size),
    )  # fmt: skip


def test_places_and_slices_are_those_of_numpy_whatever_the_layout() -> None:
    plain = np.arange(20.0).reshape(5, 4)
    for a in (plain, np.asfortranarray(plain), np.arange(40.0).reshape(5, 8)[:, ::2], plain[::-1]):
        for i in (0, 2, -1):
            both(views, a, i)


def written(a: Floats, b: Floats, i: int) -> Floats:
    made = np.zeros((3, 4))
    made[0] = a
    made[1, :2] = 7.0
    made[1, 2:] = 0.5 * (a[:2] + b[:2]) - a[1]
    made[2] = np.sqrt(a**2 + b**2)
    made[:, i] *= -2.0
    made[i, i] += 1
    made[2, 0], made[2, 1] = made[2, 1], made[2, 0]
    return made


def test_arithmetic_on_arrays_is_that_of_numpy() -> None:
    a, b = np.array([1.0, 2.5, 3.0, 4.0]), np.array([0.1, 0.2, 0.3, 0.4])
    for i in (0, 1, 2):
        both(written, a, b, i)


def kinds(flags: Any, small: Any, counts: Any) -> tuple[Any, ...]:
    out = np.zeros(4, dtype=np.uint8)
    steps = np.full(3, -1, dtype=np.int8)
    seen = np.ones(2, dtype=np.bool_)
    seen[1] = flags[0] and not flags[1]
    for k in range(len(small)):
        out[k] = (small[k] >> 1) | (4 if flags[k] else 0)
    counts[1] += 5
    return out, steps, seen, counts[-1], np.empty_like(out).shape[0]


def test_arrays_of_small_integers_and_truth_values_keep_their_kind() -> None:
    flags = np.array([True, False, True, False])
    arguments = (flags, np.array([1, 2, 200, 255], np.uint8))
    found = compiled(kinds)(*arguments, np.array([1, 2, 3]))
    expected = kinds(*arguments, np.array([1, 2, 3]))
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_array_equal(a, b)
        assert np.asarray(a).dtype == np.asarray(b).dtype


@compiled
def mean_of(a: Pair, *, weight: float = 0.5) -> Pair:
    return Pair(a.x * weight + a.y * (1.0 - weight), y=a.x)


@compiled
def scratch(count: int) -> Floats:
    made = np.zeros(count)
    for k in range(count):
        made[k] = k * SCALE
    return made


def composed(a: Pair, i: int) -> tuple[Pair, float, Floats, tuple[int, int]]:
    points = ((1.0, 2.0), (3.0, 4.0), (a.x, a.y))
    both_of = mean_of(mean_of(a), weight=0.25)
    first, *_ = (i, i)  # noqa: F841
    return both_of, points[i][1] + TABLE[i, 0], scratch(i + 2)[1:], (i, len(points))


def composed_plainly(a: Pair, i: int) -> tuple[Pair, float, Floats, tuple[int, int]]:
    points = ((1.0, 2.0), (3.0, 4.0), (a.x, a.y))
    both_of = mean_of(mean_of(a), weight=0.25)
    return both_of, points[i][1] + TABLE[i, 0], scratch(i + 2)[1:], (i, len(points))


def test_functions_call_each_other_with_tuples_and_arrays() -> None:
    for i in range(3):
        found = both(composed_plainly, Pair(1.5, -2.0), i)
        assert isinstance(found[0], Pair)


def searched(ordered: Floats, value: float) -> tuple[int, int]:
    return np.searchsorted(ordered, value), np.searchsorted(ordered, value, side="right")


def test_places_in_ordered_numbers_are_those_of_numpy() -> None:
    ordered = np.array([0.0, 1.0, 1.0, 2.0])
    for value in (-1.0, 0.0, 0.5, 1.0, 2.0, 3.0):
        both(searched, ordered, value)


def angles(x: float, y: float) -> tuple[float, ...]:
    return math.sin(x), math.cos(x), math.atan2(y, x), math.sqrt(x * x), math.hypot(x, y)


def test_angles_are_those_of_the_c_library() -> None:
    for x, y in np.random.default_rng(1).uniform(-9, 9, (20, 2)):
        both(angles, float(x), float(y))


def test_what_cannot_be_compiled_is_named_with_its_place() -> None:
    with pytest.raises(CannotCompileError, match=r"test_compiler\.py:\d+, composed: .*set"):
        compiled(composed)(Pair(1.0, 2.0), 1)
    with pytest.raises(CannotCompileError, match="take no str"):
        compiled(growing)("three")
    with pytest.raises(CannotCompileError, match="complex128"):
        compiled(searched)(np.zeros(3, complex), 1.0)


@compiled
def huge(count: int) -> Floats:
    return np.zeros((count, 1 << 20))


def test_memory_that_is_refused_is_an_error_of_python() -> None:
    with pytest.raises(MemoryError):
        huge(1 << 25)
    assert huge(1).shape == (1, 1 << 20)


@compiled
def long_sum(count: int) -> float:
    total = 0.0
    for k in range(count):
        total += math.sin(k * 1.0)
    return total


def test_other_threads_run_meanwhile() -> None:
    ticks, done = 0, threading.Event()
    long_sum(1)

    def work() -> None:
        long_sum(20_000_000)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        ticks += 1
    thread.join()
    assert ticks > 5

"""Sums and angles with one last digit for all processors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wrinkle_cad.strip.flat.development import NODES, WEIGHTS
from wrinkle_cad.strip.portable import atan2, cos, dot, norm, sin


def test_products_are_added_from_the_first_component_on() -> None:
    # Any other order, or a product kept unrounded, gives another sum.
    first = np.array([[1e16, 1.0, -1e16], [0.1, 0.2, 0.3]])
    second = np.array([[1.0, 1.0, 1.0], [0.3, 0.2, 0.1]])
    expected = [(1e16 + 1.0) - 1e16, (0.1 * 0.3 + 0.2 * 0.2) + 0.3 * 0.1]
    assert dot(first, second).tolist() == expected


def test_one_vector_meets_each_of_many() -> None:
    many = np.arange(24.0).reshape(4, 2, 3)
    one = np.array([1.0, 10.0, 100.0])
    assert np.array_equal(dot(many, one), many @ one)


def test_a_length_is_the_root_of_the_ordered_sum() -> None:
    vector = [0.1, 0.2, 0.7]
    assert norm(vector) == math.sqrt((0.1 * 0.1 + 0.2 * 0.2) + 0.7 * 0.7)


@pytest.mark.parametrize(("ours", "scalar"), [(sin, math.sin), (cos, math.cos)])
def test_each_element_is_what_the_scalar_function_gives(ours, scalar) -> None:  # type: ignore[no-untyped-def]
    angles = np.random.default_rng(1).uniform(-10.0, 10.0, (7, 3))
    assert ours(angles).tolist() == [[scalar(angle) for angle in row] for row in angles.tolist()]


def test_angles_keep_their_quadrant_and_shape() -> None:
    y, x = np.array([[1.0], [-1.0]]), np.array([2.0, 0.0, -2.0])
    expected = [[math.atan2(above, right) for right in x.tolist()] for above in (1.0, -1.0)]
    assert atan2(y, x).tolist() == expected


def test_ten_nodes_integrate_polynomials_of_degree_nineteen() -> None:
    for degree in range(20):
        exact = 0.0 if degree % 2 else 2.0 / (degree + 1)
        assert math.fsum(WEIGHTS * NODES**degree) == pytest.approx(exact, abs=1e-15)

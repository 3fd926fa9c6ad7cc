from __future__ import annotations

from itertools import permutations

import pytest

from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.objective import (
    AREA,
    BENDING,
    DEGENERATE,
    FLAT_INVALID,
    FOLD_BACK,
    INVALID,
    LENGTH,
    TIE,
    Weights,
    weights_of,
)


def named(weights: Weights) -> list[dict[int, float]]:
    """The weights of each part that are not 0."""
    return [{k: w for k, w in enumerate(part[:TIE]) if w} for part in weights]


def test_counts_are_the_digits_of_one_number_and_come_before_everything_behind_them() -> None:
    assert named(weights_of(("invalid", "bending"), bridge_count=100)) == [
        {FOLD_BACK: 2.0**14, INVALID: 2.0**7, DEGENERATE: 1.0},
        {BENDING: 1.0},
        {LENGTH: 1.0},
        {FLAT_INVALID: 1.0},
    ]


def test_counts_of_long_strips_that_do_not_fit_into_one_number_are_parts_of_their_own() -> None:
    assert named(weights_of(("invalid", "bending"), bridge_count=2**18))[:3] == [
        {FOLD_BACK: 2.0**19, INVALID: 1.0},
        {DEGENERATE: 1.0},
        {BENDING: 1.0},
    ]


def test_with_a_price_bending_and_invalid_bridges_are_one_sum() -> None:
    weights = weights_of(("invalid", "bending", "area"), bridge_count=100, invalid_cost=0.25)
    assert named(weights) == [
        {FOLD_BACK: 2.0**7, DEGENERATE: 1.0},
        {BENDING: 1.0, INVALID: 0.25},
        {AREA: 1.0},
        {LENGTH: 1.0},
        {FLAT_INVALID: 1.0},
        {},
        {},
    ]


def test_length_is_added_last_unless_it_is_a_criterion() -> None:
    assert named(weights_of(("length", "bending"), bridge_count=100))[:4] == [
        {FOLD_BACK: 1.0},
        {LENGTH: 1.0},
        {DEGENERATE: 1.0},
        {BENDING: 1.0},
    ]


def test_every_objective_has_one_of_two_numbers_of_parts() -> None:
    names = ("invalid", "bending", "area", "length")
    lists = [some for count in range(1, 5) for some in permutations(names, count)]
    assert {
        len(weights_of(some, bridge_count=count)) for some in lists for count in (9, 2**25)
    } == {
        4,
        7,
    }


def test_counts_are_compared_exactly_and_sums_up_to_round_off() -> None:
    parts = weights_of(("invalid", "bending"), bridge_count=100)
    assert [part[TIE] > 0.0 for part in parts] == [False, True, True, False]


@pytest.mark.parametrize("criteria", [(), ("invalid", "invalid"), ("beauty",), ("area", "size")])
def test_criteria_that_are_no_ordered_choice_are_refused(criteria: tuple[str, ...]) -> None:
    with pytest.raises(
        InputError, match=r"criteria cannot be .*: give an ordered choice of invalid"
    ):
        weights_of(criteria, bridge_count=10)

"""Rails and uppers at random into the library: a strip that is right, or a sentence, in time."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from tests.cad.strips import edge_of
from tests.fuzz.rails import random_pair, random_upper, smooth_height
from tests.seeds import seeds
from wrinkle_cad import WrinkleError, WrinkleStrip, carve, stitch, wrinkle_profiles
from wrinkle_cad.cad.kernel.measures import is_valid

MOST_SECONDS = 20.0
"""CPU time of one strip or one wrinkle."""


@contextmanager
def in_time() -> Iterator[None]:
    start = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
    assert time.process_time() - start < MOST_SECONDS


def check_strip(strip: WrinkleStrip) -> None:
    """A valid shell and no figure that is none."""
    report = strip.report
    figures = [report.area_3d_mm2, report.area_pattern_mm2, report.bending, report.max_fold_deg]
    assert all(math.isfinite(figure) for figure in figures), figures
    assert is_valid(strip.shell().wrapped)
    for piece in strip.pattern().pieces:
        assert np.isfinite(piece.cut_line).all()


def check_sentence(error: WrinkleError) -> None:
    assert len(str(error).splitlines()) == 1, str(error)


@pytest.mark.parametrize("seed", seeds(500, default=6))
def test_random_rails_make_a_right_strip_or_a_sentence(seed: int) -> None:
    with in_time():
        try:
            p, q = random_pair(seed)
        except Exception:
            # The kernel itself makes no such curve: nothing is handed to us.
            return
        try:
            check_strip(WrinkleStrip(p, q))
        except WrinkleError as error:
            check_sentence(error)


@pytest.mark.parametrize("seed", seeds(200, default=1))
def test_random_uppers_take_a_wrinkle_or_say_why_not(seed: int) -> None:
    rng = np.random.default_rng(10_000 + seed)
    upper = random_upper(seed)
    ends = rng.uniform((20.0, 20.0), (130.0, 50.0), (4, 2))
    ends[2:, 1] += 45.0
    rails = []
    for start, end in (ends[:2], ends[2:]):
        along = np.linspace(0.0, 1.0, 5)[:, None]
        flat = start + along * (end - start)
        flat[1:-1] += rng.normal(0.0, float(rng.choice((0.0, 2.0, 8.0))), (3, 2))
        height = smooth_height(*flat.T) + rng.normal(0.0, 1.0, 5)
        rails.append(edge_of(np.column_stack((flat, height)), 3))
    with in_time():
        try:
            opening = carve(upper, *rails, margin=float(rng.choice((0.0, 2.0, 5.0))))
            waves, height = float(rng.uniform(1.0, 7.0)), float(rng.uniform(0.2, 5.0))
            p, q = wrinkle_profiles(opening, waves=waves, height=height)
            stitched = stitch(opening, WrinkleStrip(p, q))
        except WrinkleError as error:
            check_sentence(error)
            return
    assert is_valid(stitched.shell.wrapped)
    assert math.isfinite(stitched.report.max_edge_tolerance_mm)


@pytest.mark.parametrize("seed", [32, 90])
def test_rails_with_coordinates_that_are_none_are_one_sentence(seed: int) -> None:
    with in_time(), pytest.raises(WrinkleError, match="NaN or infinite"):
        WrinkleStrip(*random_pair(seed))

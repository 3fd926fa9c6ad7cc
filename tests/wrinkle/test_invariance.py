"""One strip, however its rails are named, drawn, moved, scaled or mirrored."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.cad.strips import edge_of
from wrinkle_cad import WrinkleStrip

Rails = tuple[np.ndarray, np.ndarray]


def poles(seed: int) -> Rails:
    """Poles of two wavy B-splines beside each other."""
    rng = np.random.default_rng(seed)
    rails = []
    for y in (0.0, rng.uniform(10.0, 35.0)):
        count = int(rng.integers(5, 10))
        x = np.linspace(0.0, 80.0, count)
        rails.append(np.column_stack((x, rng.normal(y, 3.0, count), rng.normal(0.0, 4.0, count))))
    return rails[0], rails[1]


def strip_of(rails: Rails, scale: float = 1.0) -> WrinkleStrip:
    p, q = (edge_of(rail, 3) for rail in rails)
    return WrinkleStrip(p, q, tolerance=0.05 * scale)


def figures(strip: WrinkleStrip) -> dict[str, object]:
    report = strip.report
    return {
        "samples": sorted((report.samples_p, report.samples_q)),
        "bridges": report.interior_bridges,
        "invalid": report.invalid_bridges,
        "counted": report.counted_invalid_bridges,
        "fold-backs": report.fold_backs,
        "state": report.state,
        "overlaps": report.overlaps,
        "findings": [finding.code for finding in strip.findings],
    }


def swapped(rails: Rails) -> Rails:
    return rails[1], rails[0]


def reversed_both(rails: Rails) -> Rails:
    return rails[0][::-1].copy(), rails[1][::-1].copy()


def mirrored(rails: Rails) -> Rails:
    return rails[0] * (1.0, 1.0, -1.0), rails[1] * (1.0, 1.0, -1.0)


def moved(rails: Rails) -> Rails:
    turn, r = np.linalg.qr(np.random.default_rng(7).normal(size=(3, 3)))
    turn = turn * np.sign(np.diag(r))
    turn[:, 0] *= np.linalg.det(turn)
    shift = np.array([120.0, -80.0, 45.0])
    return rails[0] @ turn.T + shift, rails[1] @ turn.T + shift


WAYS: dict[str, Callable[[Rails], Rails]] = {
    "swapped": swapped,
    "both reversed": reversed_both,
    "swapped and reversed": lambda rails: reversed_both(swapped(rails)),
    "mirrored": mirrored,
    "moved": moved,
}


def check(seed: int, other: WrinkleStrip) -> None:
    one = strip_of(poles(seed))
    assert figures(other) == figures(one)
    assert other.triangulation.bending == pytest.approx(one.triangulation.bending, rel=1e-9)
    assert other.report.least_bending == pytest.approx(one.report.least_bending, rel=1e-9)
    folds = [np.sort(np.abs(strip.triangulation.fold)) for strip in (one, other)]
    np.testing.assert_allclose(folds[1], folds[0], atol=1e-7)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("seed", range(4))
def test_a_strip_is_the_same_however_its_rails_are_drawn(seed: int, way: str) -> None:
    check(seed, strip_of(WAYS[way](poles(seed))))


# Number 25 was stretched where it was a thousand times as large.
@pytest.mark.parametrize("scale", [1e-3, 1e3])
@pytest.mark.parametrize("seed", [0, 1, 2, 25])
def test_a_strip_is_the_same_at_any_size(seed: int, scale: float) -> None:
    p, q = poles(seed)
    check(seed, strip_of((scale * p, scale * q), scale))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4, 40))
def test_many_strips_are_the_same_in_every_way(seed: int) -> None:
    for way in WAYS.values():
        check(seed, strip_of(way(poles(seed))))
    for scale in (1e-3, 1e3):
        test_a_strip_is_the_same_at_any_size(seed, scale)


def test_the_comparison_sees_another_strip() -> None:
    with pytest.raises(AssertionError):
        check(0, strip_of(poles(1)))

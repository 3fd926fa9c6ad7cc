"""Whether the piece that is cut is the surface that the verdict is about."""

from __future__ import annotations

import re
import warnings

import build123d as b3d
import numpy as np
import pytest

from tests.strip.rulings.rails import bumps, twisted
from wrinkle_cad import WrinkleStrip, WrinkleWarning


def strip_of(family: object, seed: int, **options: object) -> WrinkleStrip:
    rails = []
    for rail in family(seed):  # type: ignore[operator]
        points = rail.point_at(np.linspace(*rail.interval, 41))
        rails.append(b3d.Spline(*[tuple(point) for point in points.tolist()]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WrinkleWarning)
        return WrinkleStrip(*rails, name="vamp", **options)


def codes(strip: WrinkleStrip) -> list[str]:
    return [finding.code for finding in strip.findings]


@pytest.mark.parametrize("seed", [1, 5, 7, 12, 16])
def test_a_piece_that_is_not_the_surface_judged_is_said_with_its_figures(seed: int) -> None:
    strip = strip_of(twisted, seed)
    with pytest.warns(WrinkleWarning, match="is not the surface that the verdict is about"):
        report = strip.trial_report
    cut = report.cut
    assert cut.differs
    assert max(cut.longer_percent, abs(cut.larger_percent)) > 1.0
    (finding,) = (each for each in strip.findings if each.code == "cut-differs")
    assert finding.severity == "warning"
    found = re.search(r"it is up to ([\d.]+)% \(([\d.]+) mm\) longer, at", finding.message)
    assert found is not None
    assert float(found[1]) == pytest.approx(cut.longer_percent, abs=0.05)
    assert float(found[2]) == pytest.approx(cut.longer_mm, abs=0.005)


@pytest.mark.parametrize("seed", [5, 16])
def test_the_strip_that_bends_least_is_often_the_surface_judged(seed: int) -> None:
    strip = strip_of(twisted, seed, criteria=("bending",))
    assert "cut-differs" not in codes(strip)
    assert abs(strip.cut.larger_percent) < 1.0


def test_a_smooth_surface_is_the_one_that_is_judged() -> None:
    assert strip_of(bumps, 2).cut.differs
    smooth = strip_of(bumps, 2, surface="smooth").cut
    assert not smooth.differs
    assert abs(smooth.longer_mm) <= 0.02
    assert abs(smooth.larger_percent) <= 0.01


@pytest.mark.parametrize("seed", [0, 1, 5, 11])
@pytest.mark.parametrize("surface", ["cones", "facets"])
def test_where_there_is_one_developable_surface_it_is_the_piece(seed: int, surface: str) -> None:
    strip = strip_of(bumps, seed, surface=surface)
    assert "cut-differs" not in codes(strip)
    assert abs(strip.cut.longer_mm) <= 2.0 * strip.tolerance
    assert abs(strip.cut.larger_percent) <= 0.1


def test_a_closed_strip_is_compared_around_its_cut() -> None:
    square = b3d.Rectangle(200, 200).wire()
    strip = WrinkleStrip(square, b3d.Pos(0, 0, 150) * b3d.Edge.make_circle(50))
    assert abs(strip.cut.longer_percent) <= 0.01
    assert abs(strip.cut.larger_percent) <= 0.05
    assert "cut-differs" not in codes(strip)

"""Where a rail starts decides where its notches, its first end and its allowances are."""

from __future__ import annotations

import random

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip


def drawn_rail() -> b3d.BuildLine:
    with b3d.BuildLine() as builder:
        b3d.Line((0, 0), (40, 0))
        b3d.Line((40, 0), (70, 0))
        b3d.Line((70, 0), (100, 0))
    return builder


Q = b3d.Line((0, 10), (100, 30))


def given(how: str) -> object:
    builder = drawn_rail()
    edges = list(builder.edges())
    random.Random(5).shuffle(edges)
    return {
        "builder": builder,
        "line": builder.line,
        "wire": builder.wire(),
        "edges": builder.edges(),
        "shuffled": edges,
        "points": np.array([[0.0, 0, 0], [40, 0, 0], [70, 0, 0], [100, 0, 0]]),
    }[how]


@pytest.mark.parametrize("how", ["builder", "line", "wire", "edges", "shuffled", "points"])
def test_notches_and_allowances_follow_the_rail_as_it_was_drawn(how: str) -> None:
    strip = WrinkleStrip(given(how), Q)
    assert strip.rail_points("P", [20.0]).tolist() == [[20.0, 0.0, 0.0]]
    pattern = strip.pattern(notch_at_p=(20.0,), seam_allowance=(0, 0, 5, 0))
    assert pattern.notch_arcs(0, 0) == (20.0,)
    notch = next(one for one in pattern.pieces[0].notches if one.side == 0)
    # Flat parts keep their distances: 20 mm from the start of P and 80 from its end.
    corners = pattern.pieces[0].sew_line
    gaps = np.hypot(*(corners - np.array(notch.position)).T)
    at_start, at_end = (corners[np.abs(gaps - gap) < 1e-6] for gap in (20.0, 80.0))
    lengths = [np.hypot(*(one - other)) for one in at_start for other in at_end]
    assert min(abs(length - 100.0) for length in lengths) < 1e-6


def area_of(points: np.ndarray) -> float:
    x, y = points.T
    return 0.5 * abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()))


def end_areas(p: object) -> tuple[float, float]:
    """mm2 that an allowance of 5 mm adds at the start and at the end."""
    strip = WrinkleStrip(p, Q)
    whole = area_of(strip.pattern().pieces[0].cut_line)
    return tuple(
        area_of(strip.pattern(seam_allowance=widths).pieces[0].cut_line) - whole
        for widths in ((0, 0, 5, 0), (0, 0, 0, 5))
    )


def test_the_allowance_of_the_start_is_where_the_first_edge_starts() -> None:
    """The end at x = 0 is 10 mm long, the other 30."""
    at_start, at_end = end_areas(drawn_rail())
    assert at_start == pytest.approx(50.0, rel=0.1)
    assert at_end == pytest.approx(150.0, rel=0.1)
    turned = end_areas(b3d.Line((100, 0), (0, 0)))
    assert turned == pytest.approx((at_end, at_start), rel=1e-9)


def test_a_rail_drawn_the_other_way_has_its_notches_from_the_other_end() -> None:
    strip = WrinkleStrip(b3d.Line((100, 0), (0, 0)), Q)
    assert strip.rail_points("P", [20.0]).tolist() == [[80.0, 0.0, 0.0]]
    assert strip.pattern(notch_at_p=(20.0,)).notch_arcs(0, 0) == (20.0,)
    assert "rails-turned-alike" in [finding.code for finding in strip.findings]

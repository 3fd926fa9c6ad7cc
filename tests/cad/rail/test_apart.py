from __future__ import annotations

import math
import re

import build123d as b3d
import numpy as np
import pytest

from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.rail.apart import check_apart
from wrinkle_cad.cad.rail.directrix import make_directrix, sample_directrix
from wrinkle_cad.errors import InputError

ADVICE = " Rails may meet at their ends only: shorten one, or move them apart."


def complaint(p: object, q: object, tolerance: float = 0.05) -> str:
    """What is wrong with two rails; empty if they may bound a strip."""
    rails = [make_directrix(source) for source in (p, q)]
    samples = [sample_directrix(rail, tolerance) for rail in rails]
    try:
        check_apart(rails[0], rails[1], samples[0], samples[1])
    except InputError as error:
        return str(error)
    return ""


def arc(degrees: float, first: float = 0.0, radius: float = 50.0) -> b3d.Edge:
    return b3d.Edge.make_circle(radius, start_angle=first, end_angle=first + degrees)


def test_rails_that_cross_are_refused_with_the_place() -> None:
    p = b3d.Edge.make_line((0, 0, 0), (100, 20, 0))
    q = b3d.Edge.make_line((0, 20, 0), (100, 0, 0))
    with pytest.raises(InputError) as caught:
        WrinkleStrip(p, q)
    assert str(caught.value) == "P and Q cross at (50.0, 10.0, 0.0) mm." + ADVICE


def test_rails_that_cross_more_than_once_are_refused_with_the_first_place() -> None:
    wave = b3d.Spline(*[(x, 5 * math.sin(x / 20), 0) for x in range(0, 201, 10)])
    said = complaint(wave, b3d.Line((0, 1, 0), (200, 1, 0)))
    assert said == "P and Q cross at (4.0, 1.0, 0.0) mm and at 3 more places." + ADVICE


@pytest.mark.parametrize("tolerance", [1.0, 0.05, 1e-3])
def test_rails_that_touch_are_refused_whatever_their_chords(tolerance: float) -> None:
    top = b3d.Line((-60, 50, 0), (50, 50, 0))
    said = complaint(arc(180.0), top, tolerance)
    place = re.fullmatch(
        r"P and Q touch at \((-?[\d.]+), 50.0, 0.0\) mm\." + re.escape(ADVICE), said
    )
    assert place is not None
    assert abs(float(place[1])) <= 0.1
    assert complaint(arc(180.0), b3d.Pos(0, 1e-3, 0) * top, tolerance) == ""


def test_a_rail_that_ends_on_the_other_is_refused() -> None:
    said = complaint(b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((50, 0, 0), (100, 20, 0)))
    assert said == "P and Q touch at (50.0, 0.0, 0.0) mm." + ADVICE


@pytest.mark.parametrize(
    ("p", "q", "over"),
    [
        (b3d.Line((0, 0, 0), (90, 0, 0)), b3d.Line((0, 0, 0), (80, 0, 0)), 80.0),
        (arc(120.0), arc(120.0, first=60.0), 50.0 * math.pi / 3.0),
        (
            b3d.Polyline((0, 0, 0), (50, 0, 0), (100, 0, 0), (150, 30, 0)),
            b3d.Polyline((0, 30, 0), (50, 0, 0), (100, 0, 0), (150, 0, 0)),
            50.0,
        ),
    ],
    ids=["from an end", "arcs", "in the middle"],
)
def test_rails_that_coincide_in_part_are_refused(p: b3d.Edge, q: b3d.Edge, over: float) -> None:
    said = complaint(p, q)
    found = re.match(r"P and Q coincide over some ([\d.]+) mm, from \(.*\) mm to \(.*\) mm\.", said)
    assert found is not None, said
    assert float(found[1]) == pytest.approx(over, rel=0.01)


@pytest.mark.parametrize("is_turned", [False, True])
def test_the_ends_of_a_common_part_are_named(is_turned: bool) -> None:
    p, q = (
        b3d.Polyline(*[(0, -y, 0), (30, 0, 0), (60, 0, 0), (100, y, 0)][:: -1 if is_turned else 1])
        for y in (10, -20)
    )
    ends = ["(30.0, 0.0, 0.0) mm", "(60.0, 0.0, 0.0) mm"][:: -1 if is_turned else 1]
    assert f"mm, from {ends[0]} to {ends[1]}." in complaint(p, q)


def test_an_offset_with_its_ends_closed_contains_the_curve_itself() -> None:
    curve = b3d.Spline((0, 0), (30, 10), (60, -5), (100, 0))
    assert "coincide" in complaint(curve, curve.offset_2d(7, side=b3d.Side.LEFT))


@pytest.mark.parametrize(
    ("p", "q"),
    [
        (
            b3d.Edge.make_three_point_arc((0, 0, 0), (50, 20, 5), (100, 0, 0)),
            b3d.Edge.make_three_point_arc((0, 0, 0), (50, -20, 8), (100, 0, 0)),
        ),
        (b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((0, 0, 0), (100, 60, 0))),
        (b3d.Line((0, 0, 0), (100, 0, 0)), b3d.Line((100, 0, 0), (100, 60, 0))),
        (
            b3d.Spline((0, 0, 0), (50, 5, 0), (100, 0, 0), tangents=[(1, 0, 0), (1, 0, 0)]),
            b3d.Line((0, 0, 0), (100, 0, 0)),
        ),
    ],
    ids=["lens", "common start", "end to start", "tangent at the start"],
)
def test_rails_may_meet_at_their_ends(p: b3d.Edge, q: b3d.Edge) -> None:
    assert complaint(p, q) == ""


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_crossing_does_not_depend_on_the_size_or_the_pose(scale: float) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    rails = [
        np.array(ends, dtype=float)
        for ends in (((0, 0, 0), (100, 20, 0)), ((0, 20, 0), (100, 0, 0)))
    ]
    moved = [b3d.Line(*[tuple(row) for row in (scale * rail @ turn.T).tolist()]) for rail in rails]
    place = scale * turn @ np.array([50.0, 10.0, 0.0])
    said = complaint(*moved, tolerance=0.05 * scale)
    found = re.match(r"P and Q cross at \((.*), (.*), (.*)\) mm\.", said)
    assert found is not None, said
    assert [float(x) for x in found.groups()] == pytest.approx(
        place.tolist(), abs=0.051 * min(scale, 1.0) + 2e-5 * scale
    )


def test_crossing_is_told_however_the_rails_are_drawn() -> None:
    p, q = b3d.Line((0, 0, 0), (100, 20, 3)), b3d.Line((0, 20, 3), (100, 0, 0))
    back = [b3d.Line(rail @ 1, rail @ 0) for rail in (p, q)]
    assert complaint(p, q) == complaint(q, p) == complaint(*back) == complaint(p, back[1]) != ""


def test_a_rail_that_uses_an_edge_twice_is_refused() -> None:
    side = b3d.Solid.make_cone(60, 30, 50).faces().sort_by(b3d.Axis.Z)[1]
    with pytest.raises(InputError, match=r"Rail P runs twice over one edge, from \(60.00, 0.00, "):
        make_directrix(side.outer_wire(), name="P")
    edge = b3d.Line((0, 0, 0), (10, 0, 0))
    with pytest.raises(InputError, match="runs twice over one edge"):
        make_directrix([edge, b3d.Line(edge @ 1, edge @ 0)], name="P")

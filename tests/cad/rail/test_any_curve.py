"""Whatever curve an edge has, the rail is that curve; what is none is refused in words."""

from __future__ import annotations

import math
from collections.abc import Callable

import build123d as b3d
import numpy as np
import pytest
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import (
    Geom_Circle,
    Geom_Curve,
    Geom_Ellipse,
    Geom_Hyperbola,
    Geom_Line,
    Geom_OffsetCurve,
    Geom_Parabola,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge

from tests.cad.makers import line
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.splines import make_curve
from wrinkle_cad.cad.rail.directrix import make_directrix
from wrinkle_cad.errors import InputError

UP = gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
WIGGLE = b3d.Spline((0, 0, 0), (30, 8, 0), (60, -4, 0), (100, 0, 0))


def edge(curve: Geom_Curve, *interval: float) -> TopoDS_Edge:
    return BRepBuilderAPI_MakeEdge(curve, *interval).Edge()


def bezier(degree: int, *, is_rational: bool = False) -> Geom_Curve:
    poles = [(100 * i / degree, 10 * math.sin(i), 3 * math.cos(i)) for i in range(degree + 1)]
    weights = np.linspace(1.0, 5.0, degree + 1) if is_rational else None
    return make_curve(poles, [0.0, 1.0], [degree + 1, degree + 1], degree, weights)


def farthest(made: TopoDS_Edge) -> float:
    """How far the rail is from the edge's own curve, at 501 of its parameters."""
    own, rail = BRepAdaptor_Curve(made), edge_curve(made)
    at = np.linspace(own.FirstParameter(), own.LastParameter(), 501)
    share = (at - at[0]) / (at[-1] - at[0])
    first, last = rail.FirstParameter(), rail.LastParameter()
    return max(
        rail.Value(first + (last - first) * float(s)).Distance(own.Value(float(u)))
        for s, u in zip(share, at, strict=True)
    )


@pytest.mark.parametrize("is_rational", [False, True])
@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9, 14, 20, 25])
def test_splines_of_any_degree_are_followed_exactly(degree: int, is_rational: bool) -> None:
    # The kernel's own evaluation loses digits with the degree: 5e-9 mm at 25.
    assert farthest(edge(bezier(degree, is_rational=is_rational))) < 1e-8


def test_offset_curves_are_followed_to_a_tenth_of_a_micrometre() -> None:
    circle = Geom_OffsetCurve(Geom_Circle(UP, 20.0), 5.0, gp_Dir(0, 0, 1))
    assert make_directrix(edge(circle)).length == pytest.approx(50.0 * math.pi, abs=1e-6)
    poles = [(5 * i, 10 * math.sin(i), 0) for i in range(21)]
    wavy = make_curve(poles, np.linspace(0, 1, 19), [4, *[1] * 17, 4], 3)
    assert farthest(edge(Geom_OffsetCurve(wavy, 1.0, gp_Dir(0, 0, 1)))) < 1e-6
    assert farthest(edge(circle, 0.3, 2.0)) < 1e-6


CLOSED_FORMS: dict[str, tuple[Callable[[], object], float]] = {
    "circle across its seam": (lambda: edge(Geom_Circle(UP, 20.0), 5.5, 7.5), 40.0),
    "parabola": (
        lambda: edge(Geom_Parabola(UP, 5.0), -20.0, 20.0),
        20.0 * math.sqrt(5.0) + 10.0 * math.asinh(2.0),
    ),
    "helix": (lambda: b3d.Helix(10, 40, 30), 4.0 * math.hypot(10.0, 60.0 * math.pi)),
    "edge of a face": (lambda: b3d.Face.make_rect(40, 20).edges().sort_by(b3d.Axis.Y)[0], 40.0),
    "scaled": (lambda: WIGGLE.scale(2.0), 2.0 * WIGGLE.length),
    "mirrored": (lambda: WIGGLE.mirror(b3d.Plane.YZ), WIGGLE.length),
    "trimmed": (lambda: WIGGLE.trim(0.2, 0.7), 0.5 * WIGGLE.length),
    "located": (lambda: b3d.Pos(10, 20, 30) * b3d.Rot(10, 20, 30) * WIGGLE, WIGGLE.length),
    "sum of lines": (
        lambda: b3d.Line((0, 0), (1, 0)) + b3d.Line((1, 0), (2, 1)),
        1.0 + math.sqrt(2.0),
    ),
}


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_lengths_are_those_of_the_closed_forms(name: str) -> None:
    make, length = CLOSED_FORMS[name]
    assert make_directrix(make()).length == pytest.approx(length, rel=1e-9)


@pytest.mark.parametrize(
    "made",
    [
        edge(Geom_Ellipse(UP, 30.0, 10.0)),
        edge(Geom_Ellipse(UP, 30.0, 10.0), 5.0, 8.0),
        edge(Geom_Hyperbola(UP, 5.0, 3.0), -1.0, 1.5),
        WIGGLE.wrapped,
    ],
    ids=["ellipse", "its arc", "hyperbola", "spline"],
)
def test_points_of_a_rail_lie_on_its_conic(made: TopoDS_Edge) -> None:
    rail, own = make_directrix(made), BRepAdaptor_Curve(made)
    at = np.linspace(own.FirstParameter(), own.LastParameter(), 2001)
    dense = np.array([own.Value(float(u)).Coord() for u in at])
    chords = np.linalg.norm(np.diff(dense, axis=0), axis=1)
    assert rail.length == pytest.approx(float(chords.sum()), rel=1e-5)
    for point in rail.point_at(np.linspace(0.0, rail.length, 41)):
        assert np.linalg.norm(dense - point, axis=1).min() < chords.max()


def test_a_periodic_spline_is_closed_wherever_it_starts() -> None:
    around = b3d.Spline((0, 0, 0), (30, 20, 0), (60, 0, 0), (30, -20, 5), periodic=True)
    assert make_directrix(around).is_closed
    assert make_directrix(around).length == pytest.approx(around.length, rel=1e-8)


def test_a_reversed_edge_starts_at_its_other_end_and_a_moved_one_where_it_was_put() -> None:
    turned = TopoDS.Edge(WIGGLE.wrapped.Reversed())
    assert make_directrix(turned).point_at(np.zeros(1)).tolist() == [[100.0, 0.0, 0.0]]
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(0.0, 0.0, 33.0))
    moved = line((0, 0, 0), (9, 0, 0)).Moved(TopLoc_Location(shift))
    assert make_directrix(moved).point_at(np.zeros(1)).tolist() == [[0.0, 0.0, 33.0]]


REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "a line without ends": (
        lambda: edge(Geom_Line(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0))),
        r"reaches to 2e\+100 mm, as a line without ends does",
    ),
    "an empty builder": (b3d.BuildLine, "is an empty BuildLine. Draw a curve in it first"),
    "a face": (lambda: b3d.Face.make_rect(9, 9), "cannot be a face"),
    "faces": (lambda: b3d.Box(1, 1, 1).faces(), "cannot be a face"),
    "vertices": (lambda: b3d.Box(1, 1, 1).vertices(), "cannot be a vertex"),
    "a letter": (lambda: b3d.Text("O", 60), "a compound with 1 faces and 2 outlines"),
    "a plane": (lambda: b3d.Plane.XY, "cannot be of type Plane"),
    "nothing": (lambda: None, "cannot be of type NoneType"),
    "no edges": (list, "has no curve in it"),
    "an edge and its reverse": (
        lambda: [WIGGLE.wrapped, WIGGLE.wrapped.Reversed()],
        "an edge is given twice",
    ),
    "points in a plane": (lambda: np.zeros((4, 2)), r"an array of shape \(4, 2\)"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_rail_is_refused_in_words(name: str) -> None:
    make, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        make_directrix(make())


@pytest.mark.parametrize("drawn", [WIGGLE, b3d.Polyline((0, 0), (30, 8), (60, -4), (100, 0))])
def test_an_offset_that_was_closed_runs_back_along_the_other_rail(drawn: b3d.Edge) -> None:
    closed = drawn.offset_2d(7, side=b3d.Side.LEFT)
    length = f"{drawn.length:.4g}"
    with pytest.raises(InputError, match=f"P and Q coincide over {length} mm.*closed=False"):
        WrinkleStrip(drawn, closed)
    with pytest.raises(InputError, match=f"Rail P is closed, and P and Q coincide over {length}"):
        WrinkleStrip(closed, drawn)
    opened = drawn.offset_2d(7, side=b3d.Side.LEFT, closed=False)
    assert WrinkleStrip(drawn, opened).report.is_developable


def test_a_closed_rail_beside_an_open_one_says_how_far_its_ends_are_apart() -> None:
    with pytest.raises(InputError, match=r"Rail Q is closed, but the ends of rail P are 100 mm"):
        WrinkleStrip(WIGGLE, b3d.Pos(50, 60, 0) * b3d.Circle(30))

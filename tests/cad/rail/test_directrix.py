from __future__ import annotations

import importlib.util
import itertools
import math
from pathlib import Path

import build123d as b3d
import numpy as np
import pytest
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepTools import BRepTools
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from tests.cad.makers import Point, box, line, polyline
from tests.cad.strips import edge_of, random_edge
from wrinkle_cad.cad.kernel.curves import edge_curve
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of, faces_of, make_compound, make_vertex
from wrinkle_cad.cad.rail.directrix import (
    Directrix,
    check_distinct,
    make_directrix,
    orient_alike,
    reversed_directrix,
    sample_directrix,
)
from wrinkle_cad.cad.rail.joint_samples import sampled_alone
from wrinkle_cad.errors import InputError

HAS_CADQUERY = importlib.util.find_spec("cadquery") is not None
# CadQuery has no release for the kernel of build123d 0.13.
needs_cadquery = pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery does not fit this kernel")

A, B, C, D = (0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (3.0, 4.0, 2.0), (9.0, 4.0, 2.0)
CURVE = [(0, 0, 0), (10, 8, 3), (20, -9, 5), (30, 2, 0), (40, 0, 0)]


def ends(rail: Directrix) -> list[list[float]]:
    return rail.point_at(np.array(rail.interval)).round(9).tolist()


def dense_length(rail: Directrix, start: float, end: float) -> float:
    points = rail.point_at(np.linspace(start, end, 20_001))
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def test_an_edge_makes_a_rail_as_long_as_itself() -> None:
    rail = make_directrix(edge_of(CURVE, 3), name="P")
    assert rail.name == "P"
    assert rail.interval == (0.0, rail.length)
    assert rail.length == pytest.approx(dense_length(rail, *rail.interval), rel=1e-7)
    assert rail.breaks == ()
    assert [rail.is_closed, rail.is_polyline, rail.is_reversed] == [False, False, False]
    assert len(rail.curves) == len(rail.pieces) == 1


def test_points_are_those_of_the_kernels_curves() -> None:
    edges = [random_edge(np.random.default_rng(i), 0.0, i, is_rational=i % 2 == 0) for i in (2, 5)]
    joint = edge_curve(edges[0]).EndPoint()
    edges[1] = edge_of([(joint.X(), joint.Y(), joint.Z()), (90, 9, 9), (99, 0, 5)], 2, [1, 3, 1])
    rail = make_directrix(edges)
    for curve in rail.curves:
        for u in np.linspace(curve.FirstParameter(), curve.LastParameter(), 50)[:-1].tolist():
            at = curve.Value(u)
            assert np.allclose(
                rail.point_at(np.array([u])), [(at.X(), at.Y(), at.Z())], rtol=0.0, atol=1e-10
            )
    assert rail.curves[0].LastParameter() == rail.curves[1].FirstParameter() == rail.breaks[0]


def test_parameters_outside_count_as_the_ends() -> None:
    rail = make_directrix(line(A, B))
    assert rail.point_at(np.array([-1.0, 99.0])).tolist() == [list(A), list(B)]


def test_tangents_are_units_along_the_rail() -> None:
    rail = make_directrix(edge_of(CURVE, 3))
    u = np.linspace(0.5, rail.length - 0.5, 40)
    chords = rail.point_at(u + 1e-4) - rail.point_at(u - 1e-4)
    expected = chords / np.linalg.norm(chords, axis=1, keepdims=True)
    assert np.abs(rail.tangent_at(u) - expected).max() < 1e-7


def test_edges_in_order_are_chained_and_flipped_as_needed() -> None:
    for edges in (
        [line(A, B), line(B, C), line(C, D)],
        [line(A, B), line(C, B), line(C, D)],
        [line(B, A), line(B, C), line(C, D)],
        [line(A, B), line(C, B), line(D, C)],
    ):
        rail = make_directrix(edges)
        assert ends(rail) == [list(A), list(D)]
        assert rail.breaks == (5.0, 7.0)
        assert rail.length == 13.0


@pytest.mark.parametrize(
    "drawn",
    [
        [(A, B), (B, C), (C, D)],
        [(A, B), (C, B), (C, D)],
        [(B, A), (B, C), (C, D)],
    ],
)
def test_edges_in_any_order_run_the_way_most_were_drawn(drawn: list[tuple[Point, Point]]) -> None:
    edges = [line(*pair) for pair in drawn]
    for shuffled in itertools.permutations(edges):
        for source in (list(shuffled), make_compound(shuffled)):
            assert ends(make_directrix(source)) == [list(A), list(D)]


def test_edges_that_run_alike_make_a_rail_that_runs_so() -> None:
    assert ends(make_directrix([line(D, C), line(C, B), line(B, A)])) == [list(D), list(A)]


def test_of_two_edges_drawn_head_to_head_the_first_leads() -> None:
    assert ends(make_directrix([line(A, B), line(C, B)])) == [list(A), list(C)]
    assert ends(make_directrix([line(C, B), line(A, B)])) == [list(C), list(A)]


def test_a_reversed_edge_runs_backwards() -> None:
    edge = as_edge(line(A, B).Reversed())
    assert ends(make_directrix(edge)) == [list(B), list(A)]


def test_edges_of_a_compound_are_put_in_order() -> None:
    rail = make_directrix(make_compound([line(C, B), line(C, D), line(B, A)]))
    assert ends(rail) == [list(D), list(A)]
    assert rail.length == 13.0


def test_a_wire_runs_from_end_to_end() -> None:
    rail = make_directrix(polyline(A, B, C, D))
    assert ends(rail) == [list(A), list(D)]
    assert rail.breaks == (5.0, 7.0)


def test_a_wire_whose_edges_meet_smoothly_breaks_there_all_the_same() -> None:
    assert make_directrix(polyline(A, (1.5, 2.0, 0.0), B)).breaks == (2.5,)


def test_a_closed_wire_ends_where_it_starts() -> None:
    rail = make_directrix(polyline(A, B, C, A))
    assert rail.is_closed
    assert ends(rail) == [list(A), list(A)]


def test_a_circle_is_closed_and_smooth() -> None:
    rail = make_directrix(b3d.Edge.make_circle(5.0))
    assert rail.is_closed
    assert rail.breaks == ()
    assert rail.length == pytest.approx(10.0 * math.pi, rel=1e-12)
    radii = np.linalg.norm(rail.point_at(np.linspace(*rail.interval, 999)), axis=1)
    assert np.abs(radii - 5.0).max() < 1e-14 * 5.0


def test_a_gap_is_refused_with_its_size_and_place() -> None:
    message = (
        r"Rail P has a gap of 0\.5 mm: its edges are apart at \(3, 4, 0\) and \(3, 4\.5, 0\) mm,"
        r" and at most 0\.0006 mm is allowed\. .*the option join"
    )
    with pytest.raises(InputError, match=message):
        make_directrix([line(A, B), line((3.0, 4.5, 0.0), D)], name="P")


def test_a_gap_within_the_limit_is_closed_in_its_middle() -> None:
    rail = make_directrix([line(A, B), line((3.0, 4.0, 4e-4), D)])
    before, after = rail.pieces
    assert before.poles[-1].tolist() == after.poles[0].tolist() == [3.0, 4.0, 2e-4]


@pytest.mark.parametrize(
    ("multiplicity", "poles", "breaks"),
    [
        (1, CURVE[:5], 0),
        (2, [*CURVE, (50, 3, 1)], 0),
        # A knot as multiple as the degree: a kink, or not if the poles beside it line up ...
        (3, [(0, 0, 0), (1, 2, 0), (2, 2, 0), (3, 0, 0), (4, 5, 0), (5, 5, 1), (6, 0, 0)], 1),
        (3, [(0, 0, 0), (1, 2, 0), (2, 2, 0), (3, 0, 0), (4, -2, 0), (5, 5, 1), (6, 0, 0)], 0),
        # ... and are as far apart: the same direction at another speed is not C1.
        (3, [(0, 0, 0), (1, 2, 0), (2, 2, 0), (3, 0, 0), (5, -4, 0), (5, 5, 1), (6, 0, 0)], 1),
    ],
)
def test_a_rail_breaks_where_its_derivative_jumps(
    multiplicity: int, poles: list[tuple[float, ...]], breaks: int
) -> None:
    rail = make_directrix(edge_of(poles, 3, inner=(multiplicity,)))
    assert len(rail.breaks) == breaks
    for at in rail.breaks:
        assert at == pytest.approx(rail.length / 2.0)


def test_points_are_their_own_samples() -> None:
    points = np.array([A, B, C, D, (9.0, 9.0, 9.0)])
    rail = make_directrix(points)
    samples = sample_directrix(rail, 100.0, max_chord=0.1)
    assert rail.is_polyline
    assert np.array_equal(samples.points, points)
    assert np.allclose(rail.point_at(samples.parameters), points, rtol=0.0, atol=1e-15)
    assert rail.breaks == pytest.approx((5.0, 7.0, 13.0))
    points[0] = 7.0
    assert rail.pieces[0].poles[0].tolist() == list(A)


def test_rows_of_numbers_are_points_whatever_holds_them() -> None:
    for source in ([A, B, D], [list(A), list(B), list(D)], [b3d.Vector(*at) for at in (A, B, D)]):
        assert make_directrix(source).pieces[0].poles.tolist() == [list(A), list(B), list(D)]


def test_a_curve_is_sampled_within_the_tolerance() -> None:
    rail = make_directrix([edge_of(CURVE, 3), line((40.0, 0.0, 0.0), (60.0, 0.0, 0.0))])
    samples = sample_directrix(rail, 0.01)
    assert rail.breaks[0] in samples.parameters
    for (first, last), (start, end) in zip(
        zip(samples.parameters[:-1], samples.parameters[1:], strict=True),
        zip(samples.points[:-1], samples.points[1:], strict=True),
        strict=True,
    ):
        points = rail.point_at(np.linspace(first, last, 101))
        way = (end - start) / np.linalg.norm(end - start)
        gaps = np.linalg.norm(np.cross(points - start, way), axis=1)
        assert gaps.max() <= 0.01 * (1.0 + 1e-9)
    assert len(sample_directrix(rail, 0.01, max_chord=0.5).points) > 2 * len(samples.points)


@pytest.mark.slow
def test_a_rail_of_another_unit_is_told_by_its_length() -> None:
    p, q = (make_directrix(edge_of(1e7 * np.array(CURVE) + [0, y, 0], 3)) for y in (0.0, 30.0))
    with pytest.raises(InputError, match=r"Rail P needs \d+ chords .* 4\.\d+e\+08 mm long"):
        sampled_alone(p, q, 0.05)
    assert len(sampled_alone(p, q, 5e4)[0].points) < 100


@pytest.mark.parametrize("source", [[A], np.array([A]), make_vertex(A)])
def test_one_point_is_a_rail_without_length(source: object) -> None:
    rail = make_directrix(source)
    assert rail.is_point
    assert rail.point_at(np.zeros(1)).tolist() == [list(A)]


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (None, "cannot be of type NoneType"),
        (3, "cannot be of type int"),
        ("edge", "cannot be of type str"),
        ([], "no curve in it"),
        (TopoDS_Edge(), "empty TopoDS_Edge"),
        (np.zeros((4, 2)), "array of shape"),
        (np.array([A, (1.0, math.nan, 0.0)]), "NaN or infinite"),
        (np.array([A, B, B, C]), "points 2 and 3 that are 0 mm apart"),
        (line((0.0, 0.0, 0.0), (9e-7, 0.0, 0.0)), "9e-07 mm long"),
        (box(), "cannot be a solid"),
        (faces_of(box())[0], "cannot be a face"),
        (make_compound(faces_of(box())), "cannot be a compound"),
        (make_compound([]), "no curve in it"),
    ],
)
def test_what_is_no_rail_is_refused(source: object, message: str) -> None:
    with pytest.raises(InputError, match=f"^Rail Q .*{message}"):
        make_directrix(source, name="Q")


def test_a_curve_with_infinite_poles_is_refused() -> None:
    with pytest.raises(InputError, match="NaN or infinite poles"):
        make_directrix(edge_of([A, (1.0, math.inf, 0.0), (2.0, 0.0, 0.0)], 2))


def test_objects_of_build123d_are_rails() -> None:
    a_line, an_arc = b3d.Edge.make_line(A, B), b3d.Edge.make_three_point_arc(B, (5, 4, 0), C)
    wire = b3d.Wire([a_line, an_arc])
    with b3d.BuildLine() as builder:
        b3d.Line(A, B)
        b3d.Line(B, C)
    both = a_line.length + an_arc.length
    # build123d measures a spline to some 1e-4 only.
    for source, length in (
        (a_line, 5.0),
        (wire, both),
        ([a_line, an_arc], both),
        (b3d.ShapeList([a_line, an_arc]), both),
        (b3d.Polyline(A, B, C), 7.0),
        (builder, 7.0),
        (b3d.Pos(1, 2, 3) * b3d.Spline(A, B, C), b3d.Spline(A, B, C).length),
    ):
        rail = make_directrix(source)
        assert rail.length == pytest.approx(length, rel=1e-3)
        start, _ = ends(rail)
        assert start == ([1, 2, 3] if isinstance(source, b3d.Spline) else list(A))


@needs_cadquery
def test_objects_of_cadquery_are_rails() -> None:
    import cadquery as cq

    points = [cq.Vector(*at) for at in (A, B, C)]
    edges = [cq.Edge.makeLine(*points[:2]), cq.Edge.makeLine(*points[1:])]
    for source in (
        edges,
        cq.Wire.assembleEdges(edges),
        cq.Workplane().polyline([A, B, C]).wire(),
        points,
    ):
        rail = make_directrix(source)
        assert rail.length == pytest.approx(7.0, rel=1e-12)
        assert ends(rail) == [list(A), list(C)]
    assert make_directrix(edges[0]).length == 5.0


@pytest.mark.parametrize("scale", [1e-5, 1e-3, 1.0, 500.0])
def test_rails_of_microns_and_of_20_metres_are_rails(scale: float) -> None:
    poles = np.array(CURVE, dtype=float) * scale
    rail = make_directrix(edge_of(poles, 3))
    assert rail.length == pytest.approx(make_directrix(edge_of(CURVE, 3)).length * scale, rel=1e-8)
    assert np.allclose(ends(rail), poles[[0, -1]].round(9), atol=1e-9)


def test_a_reversed_rail_is_the_same_curve_the_other_way() -> None:
    rail = make_directrix(
        [edge_of(CURVE, 3), edge_of([(40, 0, 0), (50, 5, 5), (60, 0, 0)], 2, [1, 2, 3])]
    )
    turned = reversed_directrix(rail)
    u = np.linspace(*rail.interval, 333)
    assert np.abs(turned.point_at(rail.length - u) - rail.point_at(u)).max() < 1e-12
    assert turned.breaks == pytest.approx([rail.length - at for at in rail.breaks])
    assert turned.is_reversed
    assert not reversed_directrix(turned).is_reversed
    assert turned.curves[0].FirstParameter() == 0.0


def shifted(rail: Directrix, by: NDArray[np.float64]) -> NDArray[np.float64]:
    return rail.point_at(np.linspace(*rail.interval, 40)) + by


def test_rails_that_run_against_each_other_are_turned_alike() -> None:
    p = make_directrix(edge_of(CURVE, 3))
    alike = make_directrix(shifted(p, np.array([0.0, 5.0, 0.0])))
    against = make_directrix(shifted(p, np.array([0.0, 5.0, 0.0]))[::-1].copy())
    first, second, was_reversed = orient_alike(p, alike)
    assert (first, second, was_reversed) == (p, alike, False)
    first, second, was_reversed = orient_alike(p, against)
    assert first is p
    assert was_reversed
    assert second.is_reversed
    assert np.allclose(ends(second), ends(alike))


def test_closed_rails_are_turned_to_run_round_the_same_way() -> None:
    p = make_directrix(b3d.Edge.make_circle(5.0))
    q = make_directrix(b3d.Edge.make_circle(6.0, b3d.Plane((0, 0, 9), z_dir=(0, 0, -1))))
    assert orient_alike(p, q)[2]
    assert not orient_alike(p, reversed_directrix(q))[2]


def test_a_lens_is_told_by_its_ends() -> None:
    p = make_directrix(edge_of([A, (20, 20, 0), (40, 0, 0)], 2))
    q = make_directrix(edge_of([(40, 0, 0), (20, -20, 0), A], 2))
    assert orient_alike(p, q)[2]


def test_a_closed_and_an_open_rail_are_told_by_what_lies_between() -> None:
    closed = make_directrix(edge_of([A, (30, 0, 0), (30, 30, 0), (0, 30, 0), A], 3))
    beside = shifted(closed, np.array([0.0, 0.0, 9.0]))[2:-2]
    assert not orient_alike(closed, make_directrix(beside))[2]
    assert orient_alike(closed, make_directrix(beside[::-1].copy()))[2]


def test_a_tie_is_left_as_it_is() -> None:
    p = make_directrix(line((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    q = make_directrix(line((0.0, -1.0, 5.0), (0.0, 1.0, 5.0)))
    assert not orient_alike(p, q)[2]


def test_one_curve_given_twice_is_refused_however_it_is_run() -> None:
    p = make_directrix(edge_of(CURVE, 3), name="one")
    elevated = edge_curve(edge_of(CURVE, 3))
    elevated.IncreaseDegree(6)
    again = make_directrix(BRepBuilderAPI_MakeEdge(elevated).Edge(), name="two")
    for q in (p, again, reversed_directrix(p)):
        with pytest.raises(InputError, match=r"^Rails one and .*same curve.* mm is needed"):
            check_distinct(p, q)


def test_one_curve_at_another_speed_is_the_same_curve() -> None:
    straight = make_directrix(line(A, B), name="P")
    # The same line, run slowly at first: poles along it, unevenly spread.
    uneven = make_directrix(edge_of([A, (0.3, 0.4, 0.0), (0.6, 0.8, 0.0), B], 3), name="Q")
    with pytest.raises(InputError, match="Rails P and Q"):
        check_distinct(straight, uneven)


@pytest.mark.parametrize("by", [1e-3, 1e-4])
def test_rails_that_differ_a_little_are_two(by: float) -> None:
    p = make_directrix(edge_of(CURVE, 3))
    bent = [(x, y + (by if i == 2 else 0.0), z) for i, (x, y, z) in enumerate(CURVE)]
    check_distinct(p, make_directrix(edge_of(bent, 3)))


def test_a_part_of_a_rail_is_another_rail() -> None:
    check_distinct(make_directrix(line(A, (9, 0, 0))), make_directrix(line(A, (8, 0, 0))))


@pytest.mark.realdata
def test_the_coincident_pair_of_a_real_file_is_refused(realdata: Path) -> None:
    shape = TopoDS_Shape()
    assert BRepTools.Read_s(shape, str(realdata / "spiralwing_guides.brep"), BRep_Builder())
    first, second, third = (
        make_directrix(edge, name=str(i)) for i, edge in enumerate(edges_of(shape), start=1)
    )
    check_distinct(first, second)
    check_distinct(second, third)
    with pytest.raises(InputError, match="Rails 1 and 3 are the same curve"):
        check_distinct(first, third)
    assert len(first.breaks) == 1

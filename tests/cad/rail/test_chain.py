"""One and the same rail, however its edges are held, listed and turned."""

from __future__ import annotations

import importlib.util
import random
from itertools import pairwise

import build123d as b3d
import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS_Wire

from tests.cad.makers import line
from tests.seeds import seeds
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.kernel.topology import make_compound
from wrinkle_cad.cad.rail.chain_order import chain_order
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix
from wrinkle_cad.errors import InputError

HAS_CADQUERY = importlib.util.find_spec("cadquery") is not None
# CadQuery has no release for the kernel of build123d 0.13.
needs_cadquery = pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery does not fit this kernel")


def start(rail: Directrix) -> list[float]:
    return rail.point_at(np.zeros(1))[0].round(9).tolist()


def drawn_lines() -> list[b3d.BuildLine]:
    with b3d.BuildLine() as straight:
        b3d.Polyline((0, 0), (10, 0), (20, 5))
        b3d.Line((20, 5), (40, 5))
    with b3d.BuildLine() as one_backwards:
        b3d.Line((0, 0), (10, 0))
        b3d.Line((20, 5), (10, 0))
        b3d.Line((20, 5), (40, 5))
    with b3d.BuildLine() as first_backwards:
        b3d.Line((10, 0), (0, 0))
        b3d.Spline((10, 0), (15, 4), (20, 5))
        b3d.Line((20, 5), (40, 5))
    with b3d.BuildLine() as head_to_head:
        b3d.Line((0, 0), (10, 0))
        b3d.Line((40, 5), (10, 0))
    return [straight, one_backwards, first_backwards, head_to_head]


@pytest.mark.parametrize("drawn", range(4))
def test_a_builder_its_line_its_wire_and_its_edges_are_one_rail(drawn: int) -> None:
    builder = drawn_lines()[drawn]
    given = builder, builder.line, builder.wire(), builder.edges(), list(builder.edges())
    rails = [make_directrix(source) for source in given]
    at = np.linspace(0.0, rails[0].length, 33)
    for rail in rails:
        assert start(rail) == [0.0, 0.0, 0.0]
        assert np.abs(rail.point_at(at) - rails[0].point_at(at)).max() < 1e-9


def test_a_strip_is_the_same_from_a_builder_and_from_its_shuffled_edges() -> None:
    builder = drawn_lines()[0]
    other = b3d.Line((0, 20), (40, 20))
    expected = WrinkleStrip(builder, other).triangulation
    edges = list(builder.edges())
    for _ in range(3):
        edges = [*edges[1:], edges[0]]
        found = WrinkleStrip(edges, other).triangulation
        assert np.array_equal(found.p, expected.p)
        assert np.array_equal(found.bridges, expected.bridges)


@pytest.mark.parametrize("seed", seeds(20))
def test_edges_drawn_one_after_the_other_are_found_so_in_any_order(seed: int) -> None:
    chance = random.Random(seed)
    count = chance.randint(2, 40)
    steps = np.random.default_rng(seed).uniform(1.0, 9.0, (count + 1, 3))
    points = np.cumsum(steps, axis=0)
    order = list(range(count))
    chance.shuffle(order)
    links = chain_order(np.stack((points[order], points[[i + 1 for i in order]]), axis=1), 1e-3)
    assert [order[link.edge] for link in links] == list(range(count))
    assert not any(link.is_turned for link in links)


@pytest.mark.parametrize("seed", seeds(20))
def test_few_edges_drawn_backwards_do_not_turn_a_shuffled_rail(seed: int) -> None:
    chance = random.Random(seed)
    points = np.cumsum(np.random.default_rng(seed).uniform(1.0, 9.0, (12, 3)), axis=0)
    pairs = [(i, i + 1) if chance.random() < 0.7 else (i + 1, i) for i in range(11)]
    forward = sum(first < last for first, last in pairs)
    chance.shuffle(pairs)
    links = chain_order(points[np.array(pairs)], 1e-3)
    found = [min(pairs[link.edge]) for link in links]
    assert found == (list(range(11)) if forward > 5 else list(range(11))[::-1])


def test_a_closed_line_begins_with_its_first_edge_as_drawn() -> None:
    corners = [(0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (9.0, 5.0, 0.0), (0.0, 5.0, 0.0)]
    edges = [line(one, other) for one, other in pairwise([*corners, corners[0]])]
    rail = make_directrix([edges[2], edges[0], edges[3], edges[1]])
    assert rail.is_closed
    assert rail.point_at(np.array([0.0, 9.0])).tolist() == [list(corners[2]), list(corners[3])]


def loose_wire(gap: float, tolerance: float) -> TopoDS_Wire:
    """Two edges of 10 mm whose common vertex is as wide as it has to be."""
    first, second = line((0, 0, 0), (10, 0, 0)), line((10, gap, 0), (20, gap, 0))
    builder, wire = BRep_Builder(), TopoDS_Wire()
    for vertex in (TopExp.LastVertex_s(first), TopExp.FirstVertex_s(second)):
        builder.UpdateVertex(vertex, tolerance)
    builder.MakeWire(wire)
    for edge in (first, second):
        builder.Add(wire, edge)
    return wire


def test_a_gap_inside_the_vertices_tolerances_is_none() -> None:
    rail = make_directrix(loose_wire(0.005, 0.005))
    assert not rail.findings
    assert rail.pieces[0].poles[-1].tolist() == [10.0, 0.0025, 0.0]
    with pytest.raises(InputError, match=r"a gap of 0\.005 mm"):
        make_directrix(loose_wire(0.005, 1e-7))


def test_a_tolerance_as_large_as_an_edge_is_not_believed() -> None:
    with pytest.raises(InputError, match=r"a gap of 3 mm.*at most 0\.5 mm"):
        make_directrix(loose_wire(3.0, 50.0))


def test_gaps_up_to_join_are_closed_and_reported() -> None:
    edges = [line((0, 0, 0), (10, 0, 0)), line((10, 0.3, 0), (20, 0.3, 0))]
    strip = WrinkleStrip(edges, line((0, 9, 0), (20, 9, 0)), join=0.5)
    (closed,) = [finding for finding in strip.findings if finding.code == "gap-closed"]
    assert closed.message == (
        "Rail P had a gap of 0.3 mm at (10, 0.15, 0) mm, which was closed in its middle as asked"
        " (join)."
    )
    with pytest.raises(InputError, match=r"a gap of 0\.3 mm.*\(10, 0, 0\) and \(10, 0\.3, 0\) mm"):
        WrinkleStrip(edges, line((0, 9, 0), (20, 9, 0)), join=0.2)


def test_edges_without_length_are_left_out_and_reported() -> None:
    edges = [
        line((0, 0, 0), (10, 0, 0)),
        line((10, 0, 0), (10, 5e-8, 0)),
        line((10, 0, 0), (20, 0, 0)),
    ]
    rail = make_directrix(edges, name="P")
    assert rail.length == 20.0
    assert [finding.message for finding in rail.findings] == [
        "An edge of rail P is no longer than 1e-07 mm and was left out."
    ]


def test_a_line_with_branches_is_refused_at_the_branch() -> None:
    edges = [
        line((0, 0, 0), (10, 0, 0)),
        line((10, 0, 0), (20, 5, 0)),
        line((10, 0, 0), (20, -5, 0)),
    ]
    with pytest.raises(InputError, match=r"branches: 3 edges meet at \(10\.00, 0\.00, 0\.00\) mm"):
        make_directrix(edges)


def test_edges_of_two_lines_are_refused_with_the_gap_between_them() -> None:
    edges = [line((0, 0, 0), (10, 0, 0)), line((0, 20, 0), (10, 20, 0))]
    with pytest.raises(InputError, match=r"a gap of 20 mm: its edges are apart at"):
        make_directrix(edges)


def test_the_outline_of_a_closed_face_runs_twice_along_its_seam() -> None:
    (side,) = b3d.Solid.make_cone(30, 20, 50).faces().filter_by(b3d.GeomType.CONE)
    with pytest.raises(InputError, match=r"runs twice over one edge.*the seam of a closed face"):
        make_directrix(side.outer_wire())
    with pytest.raises(InputError, match=r"runs twice over one edge.*an edge is given twice"):
        make_directrix([line((0, 0, 0), (10, 0, 0)), line((10, 0, 0), (0, 0, 0))])


def test_a_sketch_is_its_outline_and_one_with_holes_is_none() -> None:
    assert make_directrix(b3d.Rectangle(40, 20)).length == pytest.approx(120.0)
    with b3d.BuildSketch() as builder:
        b3d.Rectangle(40, 20)
    assert make_directrix(builder).is_closed
    with pytest.raises(InputError, match="a compound with 1 faces and 2 outlines"):
        make_directrix(b3d.Rectangle(40, 20) - b3d.Circle(5))


def test_selected_edges_of_a_face_are_a_rail() -> None:
    face = b3d.Face.make_rect(40, 20)
    assert make_directrix(face.edges().sort_by(b3d.Axis.Y)[-1]).length == 40.0
    assert make_directrix(face.edges().sort_by(b3d.Axis.Y)[:-1]).length == 80.0
    assert make_directrix(make_compound([edge.wrapped for edge in face.edges()])).is_closed


@needs_cadquery
def test_a_workplane_that_draws_lines_is_all_of_them() -> None:
    import cadquery as cq

    drawn = cq.Workplane().moveTo(5, 5).lineTo(10, 0).lineTo(20, 0)
    assert make_directrix(drawn).length == pytest.approx(np.hypot(5, 5) + 10.0)
    assert start(make_directrix(drawn)) == [5.0, 5.0, 0.0]
    assert make_directrix(drawn.wire()).length == make_directrix(drawn).length
    assert make_directrix(cq.Workplane().box(10, 10, 10).edges(">X and >Z")).length == 10.0
    apart = cq.Workplane().lineTo(10, 0).moveTo(0, 9).lineTo(10, 9)
    with pytest.raises(InputError, match="a gap of 9 mm"):
        make_directrix(apart)

"""Loose edges become wires where exactly two of them meet."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from tests.cad.makers import arc, line
from wrinkle_cad.cad.exchange.loose_edges import chain_edges as numbered
from wrinkle_cad.cad.kernel.measures import length_of
from wrinkle_cad.cad.kernel.topology import edges_of, kind_name


def chain_edges(edges: list[TopoDS_Edge]) -> list[TopoDS_Shape]:
    return [chain for _, chain in numbered(edges)]


def described(shapes: list[TopoDS_Shape]) -> list[tuple[str, int]]:
    return [(kind_name(shape), len(edges_of(shape))) for shape in shapes]


CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0), (1.0, 2.0, 3.0), (5.0, 2.0, 3.0)]


@pytest.mark.parametrize("seed", range(5))
def test_edges_in_any_order_and_direction_become_one_wire(seed: int) -> None:
    chance = random.Random(seed)
    pairs = list(pairwise(CORNERS))
    chance.shuffle(pairs)
    edges = [line(*(pair if chance.random() < 0.5 else pair[::-1])) for pair in pairs]
    (wire,) = chain_edges(edges)
    assert described([wire]) == [("wire", 4)]
    assert length_of(wire) == pytest.approx(1.0 + 2.0 + 3.0 + 4.0)


def test_a_closed_chain_becomes_one_wire() -> None:
    loop = [*CORNERS[:3], CORNERS[0]]
    edges = [line(start, end) for start, end in pairwise(loop)]
    assert described(chain_edges(edges)) == [("wire", 3)]


def test_edges_apart_stay_edges_in_their_order() -> None:
    edges = [arc(0.0), arc(1.0), arc(2.0)]
    assert [shape.IsSame(edge) for shape, edge in zip(chain_edges(edges), edges, strict=True)] == [
        True,
        True,
        True,
    ]


def test_where_three_meet_all_end() -> None:
    centre = (0.0, 0.0, 0.0)
    edges = [line(centre, end) for end in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    assert described(chain_edges(edges)) == [("edge", 1)] * 3


def test_a_gap_is_bridged_up_to_its_limit_only() -> None:
    for start, count in ((1.0009, 1), (1.0011, 2)):
        edges = [line((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), line((start, 0.0, 0.0), (2.0, 0.0, 0.0))]
        assert len(chain_edges(edges)) == count


def test_no_edges_make_no_chains() -> None:
    assert chain_edges([]) == []


def test_thousands_of_edges_are_chained_without_quadratic_work() -> None:
    points = [(float(i), float(i % 2), 0.0) for i in range(4001)]
    edges = [line(start, end) for start, end in pairwise(points)]
    assert described(chain_edges(edges[::2])) == [("edge", 1)] * 2000

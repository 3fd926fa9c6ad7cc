"""Openings that overlap, touch or lie in each other, against shapely on a flat upper."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import Edge, Face
from shapely import Polygon

from tests.cad.shoes import rails, shoe
from tests.seeds import seeds
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.upper.carve import carve, carve_all
from wrinkle_cad.cad.upper.stitch import stitch
from wrinkle_cad.errors import InputError
from wrinkle_cad.wrinkle.wrinkle_strip import WrinkleStrip

PLATE = 200.0


def plate() -> Face:
    return Face.make_rect(PLATE, PLATE)


def lines(x: float, y: float, length: float, width: float, turn: float = 0.0) -> tuple[Edge, Edge]:
    """Two parallel straight rails around a middle."""
    along = np.array([np.cos(turn), np.sin(turn)]) * length / 2
    aside = np.array([-np.sin(turn), np.cos(turn)]) * width / 2
    p, q = (np.array([x, y]) + side * aside for side in (-1.0, 1.0))
    return tuple(Edge.make_line((*(at - along), 0.0), (*(at + along), 0.0)) for at in (p, q))  # type: ignore[return-value]


def corners(pair: tuple[Edge, Edge]) -> Polygon:
    p, q = ([tuple(edge.position_at(t))[:2] for t in (0, 1)] for edge in pair)
    return Polygon([*p, *q[::-1]])


@pytest.mark.parametrize("seed", seeds(60))
def test_two_openings_overlap_where_shapely_says_so(seed: int) -> None:
    random = np.random.default_rng(seed)
    pairs = [
        lines(
            *random.uniform(-45.0, 45.0, 2),
            random.uniform(20.0, 80.0),
            random.uniform(5.0, 40.0),
            random.uniform(0.0, 2.0 * np.pi),
        )
        for _ in range(2)
    ]
    first, second = map(corners, pairs)
    if first.distance(second) > 0.02:
        openings = carve_all(plate(), pairs)
        rest = PLATE**2 - first.area - second.area
        assert openings[1].areas[1] == pytest.approx(rest, rel=1e-9)
        assert openings[0].body_shape.IsSame(openings[1].body_shape)
        return
    assert first.intersection(second).area > 0.1
    inner = first.within(second) or second.within(first)
    with pytest.raises(InputError, match="lies inside" if inner else "overlap by up to") as caught:
        carve_all(plate(), pairs, names=["left", "right"])
    assert "the opening of left" in str(caught.value).lower()
    assert "the opening of right" in str(caught.value).lower()


@pytest.mark.parametrize("swapped", [False, True])
def test_the_depth_and_the_place_of_an_overlap_are_told(swapped: bool) -> None:
    pairs = [lines(0, 0, 100, 20), lines(0, 15, 40, 16)]
    with pytest.raises(InputError, match=r"A and the opening of B overlap by up to 3 mm") as caught:
        carve_all(plate(), pairs[::-1] if swapped else pairs)
    assert "0.0) mm" in str(caught.value)


@pytest.mark.parametrize(
    "other", [lines(0, 20, 50, 20), lines(75, 0, 50, 20), lines(60, 20, 20, 20)]
)
def test_openings_that_share_a_line_or_a_corner_touch(other: tuple[Edge, Edge]) -> None:
    with pytest.raises(InputError, match=r"touch at \(.*at least 0\.01 mm is needed"):
        carve_all(plate(), [lines(0, 0, 100, 20), other])


def test_openings_that_only_their_margins_bring_together_overlap() -> None:
    pairs = [lines(0, 0, 100, 20), lines(0, 21, 100, 20)]
    assert len(carve_all(plate(), pairs)) == 2
    with pytest.raises(InputError, match=r"overlap by up to 3 mm"):
        carve_all(plate(), pairs, margin=2.0, fade=0.1)


def test_an_opening_inside_another_is_named_as_such() -> None:
    pairs = [lines(3, 1, 30, 6), lines(0, 0, 100, 20)]
    with pytest.raises(
        InputError, match=r"^The opening of A, at \(.* lies inside the opening of B"
    ):
        carve_all(plate(), pairs)


def test_openings_cut_for_themselves_are_cut_at_once_when_they_are_stitched() -> None:
    pairs = [rails(205.0, 195.0), rails(185.0, 175.0)]
    openings = [carve(shoe(), *pair) for pair in pairs]
    strips = [
        WrinkleStrip(opening.p, opening.q, name=name)
        for opening, name in zip(openings, ("front", "back"), strict=True)
    ]
    stitched = stitch(openings, strips)
    assert is_valid(stitched.shell_shape)
    assert stitched.report.free_edges_after == stitched.report.free_edges_before


def test_strips_whose_openings_overlap_are_named_when_they_are_stitched() -> None:
    pairs = [rails(205.0, 190.0), rails(195.0, 175.0)]
    openings = [carve(shoe(), *pair) for pair in pairs]
    strips: list[Any] = [
        WrinkleStrip(opening.p, opening.q, name=name)
        for opening, name in zip(openings, ("front", "back"), strict=True)
    ]
    with pytest.raises(InputError, match="opening of front and the opening of back overlap"):
        stitch(openings, strips)


def test_a_rail_that_is_a_point_makes_no_opening() -> None:
    p, _ = lines(0, 0, 100, 20)
    dot = Edge.make_line((0, 30, 0), (0, 30.0001, 0))
    with pytest.raises(InputError, match=r"Rail Q is a point: it is 0\.0001 mm long, P 100 mm"):
        carve(plate(), p, dot)


def test_a_rail_that_stands_on_the_upper_is_refused() -> None:
    p, _ = lines(0, 0, 100, 20)
    with pytest.raises(InputError, match=r"The feet of rail Q on the upper are one point"):
        carve(plate(), p, Edge.make_line((0, 30, 0), (0, 30, 9)))


def test_the_openings_of_three_wrinkles_overlap_with_wide_margins_before_anything_is_cut(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    example = Path(__file__).parents[3] / "shoe_examples" / "three_wrinkles" / "three_wrinkles.step"
    shapes = {shape.name: shape.shape for shape in read_cad(example).shapes}
    names = ("front", "middle", "back")
    rails = [(shapes[f"{name}:P"], shapes[f"{name}:Q"]) for name in names]
    monkeypatch.setattr("wrinkle_cad.cad.upper.carve.split_faces", None)
    with pytest.raises(
        InputError, match=r"opening of front and .* of middle overlap by up to 0\.6"
    ):
        carve_all(shapes["upper"], rails, margin=4.0, allow_split=True, names=names)

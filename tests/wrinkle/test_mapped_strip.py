from __future__ import annotations

from functools import cache

import build123d as b3d
import numpy as np
import pytest

from tests.cad.faces.test_smooth_shell import auger_rail
from tests.cad.strips import lens_edges
from wrinkle_cad import InputError, WrinkleStrip
from wrinkle_cad.settings import SURFACES

pytestmark = pytest.mark.filterwarnings("ignore::wrinkle_cad.WrinkleWarning")


@cache
def lens(surface: str = "smooth") -> WrinkleStrip:
    return WrinkleStrip(*lens_edges(), surface=surface)


def inside(strip: WrinkleStrip, count: int, seed: int = 5) -> np.ndarray:
    """Random points of the flat strip: on random bridges of its triangulation."""
    random = np.random.default_rng(seed)
    i, j = strip.triangulation.bridges[
        random.integers(2, len(strip.triangulation.bridges) - 2, count)
    ].T
    share = random.uniform(0.05, 0.95, (count, 1))
    return (1.0 - share) * strip.unrolling.p[i] + share * strip.unrolling.q[j]


@pytest.mark.parametrize(
    "surface",
    [name if name == "smooth" else pytest.param(name, marks=pytest.mark.slow) for name in SURFACES],
)
def test_points_go_to_the_surface_and_back(surface: str) -> None:
    strip = lens(surface)
    points = inside(strip, 100)
    space = strip.to_space(points)
    np.testing.assert_allclose(strip.to_flat(space), points, atol=1e-9)


@pytest.mark.slow
def test_ten_thousand_points_go_to_the_surface_and_back() -> None:
    strip = lens()
    points = inside(strip, 10_000)
    assert np.abs(strip.to_flat(strip.to_space(points)) - points).max() <= 1e-6


def test_lengths_along_the_surface_are_kept_across_all_of_its_faces() -> None:
    strip = lens()
    start, end = inside(strip, 2, seed=8)
    line = start + np.linspace(0.0, 1.0, 801)[:, None] * (end - start)
    space = strip.to_space(line)
    length = np.linalg.norm(np.diff(space, axis=0), axis=1).sum()
    assert length == pytest.approx(np.linalg.norm(end - start), rel=1e-5)


@pytest.mark.slow
def test_the_rails_lie_on_the_border_of_the_pattern() -> None:
    strip = WrinkleStrip(auger_rail(10.0), auger_rail(30.0), surface="smooth")
    flat = strip.unrolling
    np.testing.assert_allclose(strip.to_flat(strip.p_samples.points), flat.p, atol=1e-7)
    np.testing.assert_allclose(strip.to_flat(strip.q_samples.points), flat.q, atol=1e-7)
    np.testing.assert_allclose(strip.to_space(flat.q), strip.q_samples.points, atol=1e-7)


@pytest.mark.parametrize("hand", [pytest.param(None, marks=pytest.mark.slow), "left"])
def test_what_is_drawn_on_a_piece_lands_where_the_piece_lies(hand: str | None) -> None:
    strip = lens()
    for piece in strip.pattern(seam_allowance=(6, 6, 6, 6), hand=hand, rulings=True).pieces:
        first, last = piece.rulings[[0, -1]]
        space = strip.to_space(np.vstack((first, last)), piece)
        np.testing.assert_allclose(strip.to_flat(space, piece), np.vstack((first, last)), atol=1e-6)
        for ruling, bridge in ((space[:2], 1), (space[2:], -2)):
            i, j = strip.triangulation.bridges[bridge]
            np.testing.assert_allclose(ruling[0], strip.triangulation.p[i], atol=1e-4)
            np.testing.assert_allclose(ruling[1], strip.triangulation.q[j], atol=1e-4)


@pytest.mark.slow
def test_holes_and_text_become_closed_outlines_on_the_surface() -> None:
    strip = lens()
    i, j = strip.triangulation.bridges[len(strip.triangulation.bridges) // 2]
    centre = (strip.unrolling.p[i] + strip.unrolling.q[j]) / 2.0
    hole = b3d.Pos(*centre) * b3d.Circle(2.0)
    (wire,) = strip.to_space(hole)
    assert wire.is_closed
    assert wire.length == pytest.approx(4.0 * np.pi, rel=1e-2)
    (back,) = strip.to_flat(wire)
    assert back.length == pytest.approx(wire.length, rel=1e-3)
    text = b3d.Pos(*centre) * b3d.Text("OK", 5)
    assert len(strip.to_space(text)) == 3
    assert all(wire.is_closed for wire in strip.to_space(text))


def test_what_lies_off_the_strip_is_refused() -> None:
    strip = lens()
    with pytest.raises(InputError, match=r"1 of 2 points.*off the flat strip"):
        strip.to_space(np.vstack((inside(strip, 1), [[1e3, 0.0]])))
    with pytest.raises(InputError, match="off the surface"):
        strip.to_flat(np.array([[50.0, 0.0, 90.0]]))
    with pytest.raises(InputError, match="shape"):
        strip.to_flat(np.zeros((3, 2)))
    other = WrinkleStrip([[0, 0, 0], [9, 0, 0]], [[0, 5, 0], [9, 5, 0]]).pattern().pieces[0]
    with pytest.raises(InputError, match="piece of this strip"):
        strip.to_space(inside(strip, 1), other)

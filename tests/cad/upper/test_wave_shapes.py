"""Waves that look like wrinkles: rounded folds, uneven ones, leaning ones."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests.cad.shoes import opening
from tests.seeds import seeds
from wrinkle_cad import WrinkleStrip, stitch
from wrinkle_cad.cad.upper.profiles import profile_curves
from wrinkle_cad.cad.upper.wave_shapes import folds
from wrinkle_cad.errors import InputError


def drawn(kind, waves, *, seed=0, phase=0.0, is_ring=False, per_wave=200):
    count = round(per_wave * waves) + 1
    return folds(kind, waves, phase, seed=seed, is_ring=is_ring, count=count)


def sine_generated_curve(swing=1.9, count=20_000):
    """(k,) along and up, by Simpson's rule on the direction swing sin(2 pi s)."""
    s = np.linspace(0.0, 1.0, 2 * count + 1)
    directions = np.stack(
        (np.cos(swing * np.sin(2 * np.pi * s)), np.sin(swing * np.sin(2 * np.pi * s)))
    )
    steps = directions[:, :-1:2] + 4.0 * directions[:, 1::2] + directions[:, 2::2]
    along, up = np.cumsum(steps, axis=1)
    return along / along[-1], up / up.max()


def test_a_pleat_is_the_sine_generated_curve():
    shares, heights = drawn("pleat", 1.0, per_wave=400)
    along, up = sine_generated_curve()
    exact = shapely.LineString(np.column_stack((along, up)))
    apart = shapely.distance(exact, shapely.points(np.column_stack((shares, heights))))
    assert apart.max() < 2e-4
    assert heights.min() >= 0.0
    assert heights.max() == pytest.approx(1.0, abs=1e-6)
    # It overhangs: on its flanks it runs back.
    assert (np.diff(shares) < 0.0).mean() > 0.2


@pytest.mark.parametrize("seed", seeds(200))
def test_folds_of_any_width_height_and_lean_touch_neither_themselves_nor_each_other(seed):
    random = np.random.default_rng(seed)
    kind = ("pleat", "gather")[seed % 2]
    waves, height = random.uniform(1.0, 12.0), random.uniform(0.5, 40.0)
    shares, heights = drawn(kind, waves, seed=seed, phase=random.uniform(0.0, 6.0))
    lean = np.tan(np.radians(random.uniform(-75.0, 75.0)))
    up = height * heights
    assert shapely.LineString(np.column_stack((100.0 * shares + lean * up, up))).is_simple


def crests(shares, heights):
    is_crest = (heights[1:-1] > heights[:-2]) & (heights[1:-1] >= heights[2:])
    return shares[1:-1][is_crest], heights[1:-1][is_crest]


def test_gathered_folds_are_uneven_by_their_seed_and_pleats_are_not():
    places, tall = crests(*drawn("pleat", 8.0))
    assert np.allclose(np.diff(places), 1.0 / 8.0, atol=1e-6)
    assert np.ptp(tall) < 1e-6
    places, tall = crests(*drawn("gather", 8.0, seed=4))
    assert len(places) == 8
    assert np.diff(places).max() > 1.3 * np.diff(places).min()
    assert 0.1 < np.ptp(tall) < 0.31
    again, _ = crests(*drawn("gather", 8.0, seed=4))
    other, _ = crests(*drawn("gather", 8.0, seed=5))
    assert np.array_equal(places, again)
    assert not np.allclose(places, other, atol=1e-3)


def test_folds_on_a_ring_close_where_they_start():
    shares, heights = drawn("gather", 5.0, seed=2, phase=1.0, is_ring=True)
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert heights[0] == pytest.approx(heights[-1], abs=1e-9)


def offsets(profile, i):
    """Points (k, 3) of a profile, their heights over the upper and places along the rail, mm."""
    rail = opening().rails[i]
    points = profile.point_at(np.linspace(*profile.interval, 3000))
    nearest = np.linalg.norm(points[:, None] - rail.points[None], axis=2).argmin(axis=1)
    apart = points - rail.points[nearest]
    along = rail.shares[nearest] * rail.length + (apart * rail.tangents[nearest]).sum(axis=1)
    return (apart * rail.feet.normals[nearest]).sum(axis=1), along


def test_leaning_moves_crests_forward_by_its_tangent_and_amplitude_sets_their_heights():
    # Half of the rail fades to either side: the crest in the middle is the highest.
    upright, leaning = (
        profile_curves(opening(), waves=5, height=3.0, shape="pleat", fade=0.5, lean_deg=lean)[0]
        for lean in (0.0, 30.0)
    )
    (before, behind), (after, ahead) = offsets(upright, 0), offsets(leaning, 0)
    moved = ahead[after > 0.98 * after.max()].mean() - behind[before > 0.98 * before.max()].mean()
    assert moved == pytest.approx(3.0 * np.tan(np.radians(30.0)), abs=0.2)
    grown, _ = profile_curves(opening(), waves=9, height=3.0, fade=0.05, amplitude=(0.2, 1.0))
    found = offsets(grown, 0)[0]
    first, last = np.array_split(found, 2)
    assert first.max() < 0.65 * 3.0 < last.max() <= 3.05
    called, _ = profile_curves(
        opening(), waves=9, height=3.0, fade=0.05, amplitude=lambda arc: 0.2 + 0.8 * arc / arc[-1]
    )
    assert np.allclose(found, offsets(called, 0)[0], atol=1e-9)


@pytest.mark.parametrize(
    "drawing", [{"shape": "pleat", "lean_deg": 25.0}, {"shape": "gather", "seed": 3}]
)
def test_a_wrinkle_of_overhanging_folds_is_stitched_like_any_other(drawing):
    strip = WrinkleStrip(*profile_curves(opening(), waves=7, height=3.0, **drawing), name="w")
    report = stitch(opening(), strip).report
    assert report.is_valid
    assert report.free_edges_after == report.free_edges_before
    assert report.max_edge_tolerance_mm <= 1e-5


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"shape": "zigzag"}, "shape is 'zigzag'. Choose sine, pleat, gather"),
        ({"lean_deg": 80.0}, "lean_deg is 80: -75 to 75 is allowed"),
        ({"shape": "pleat", "height": lambda arc: 0.0 * arc}, "leave the shape out"),
        ({"amplitude": [[1.0, 2.0]]}, "in a row"),
        ({"amplitude": [float("nan")]}, "finite shares"),
        ({"amplitude": lambda arc: 1.0}, "The callable amplitude returned shape"),
    ],
)
def test_what_is_no_wave_is_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        profile_curves(opening(), **{"waves": 5, "height": 3.0, **wrong})

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.cad.strips import random_edge
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip.curve.sampling import Samples, sample_curve
from wrinkle_cad.strip.flat import turning
from wrinkle_cad.strip.flat.turning import turning_places, without_turning_back
from wrinkle_cad.strip.flat.unrolling import unroll_cones
from wrinkle_cad.strip.triangulation import Triangulation, measured, triangulate

Curve = Callable[[np.ndarray], np.ndarray]
FINE = 1e-3


def samples_at(curve: Curve, parameters: list[float]) -> Samples:
    at = np.array(parameters)
    return Samples(at, curve(at))


def hump(t: np.ndarray) -> np.ndarray:
    """Along x from 0 to 20, and a little out of its plane, so that it is none."""
    return np.column_stack((20.0 * t, 2.0 * np.sin(np.pi * t), 0.2 * np.sin(np.pi * t)))


def far_line(t: np.ndarray) -> np.ndarray:
    return np.column_stack((40.0 + 20.0 * t, 1.0 + 10.0 * t, 0.0 * t))


def leaning() -> tuple[Triangulation, tuple[Samples, Samples], tuple[Curve, Curve]]:
    """The hump seen from the start of the line, flatly: it rises above the apex and comes down."""
    samples = samples_at(hump, [0.0, 1.0]), samples_at(far_line, [0.0, 1.0])
    made = measured(
        samples[0].points,
        samples[1].points,
        np.array([0, 1], dtype=np.int8),
        planarity=1e-5,
        criteria=("area",),
        search="global",
        energy="hinge",
    )
    return made, samples, (hump, far_line)


def test_a_curve_is_cut_where_it_runs_at_its_apex() -> None:
    made, samples, curves = leaning()
    assert unroll_cones(made, *samples, *curves, tolerance=FINE).turned_back_count == 1
    (place,), nowhere = turning_places(made, samples, curves, tolerance=FINE)
    assert len(nowhere) == 0
    # There the tangent in the plane x y points at (40, 1), the apex.
    at = np.array([place])
    point = hump(at)[0]
    slope = 2.0 * np.pi * np.cos(np.pi * place) / 20.0
    assert point[1] + slope * (40.0 - point[0]) == pytest.approx(1.0, abs=0.1)


def test_cut_and_searched_anew_nothing_turns_back() -> None:
    made, samples, curves = leaning()

    def search(p: np.ndarray, q: np.ndarray) -> Triangulation:
        return triangulate(p, q, planarity=1e-5)

    found, own = without_turning_back(made, samples, curves, search, tolerance=FINE)
    assert unroll_cones(found, *own, *curves, tolerance=FINE).turned_back_count == 0
    assert set(samples[0].parameters) < set(own[0].parameters)
    np.testing.assert_allclose(own[0].points, hump(own[0].parameters), atol=1e-12)


@pytest.mark.parametrize("keeps", [(False, True), (True, False), (True, True)])
def test_a_rail_keeps_its_samples_where_the_other_alone_can_be_cut(
    keeps: tuple[bool, bool],
) -> None:
    made, samples, curves = leaning()

    def search(p: np.ndarray, q: np.ndarray) -> Triangulation:
        return triangulate(p, q, planarity=1e-5)

    found, own = without_turning_back(made, samples, curves, search, tolerance=FINE, keeps=keeps)
    # It is P that turns back: where it is to keep its samples, it cannot.
    assert unroll_cones(found, *own, *curves, tolerance=FINE).turned_back_count == 0
    assert len(own[0].points) > len(samples[0].points)
    assert (own[1] is samples[1]) or keeps == (True, False)


def test_a_strip_that_does_not_turn_back_stays_as_it_is() -> None:
    curves = (hump, lambda t: hump(t) + np.array([0.0, 20.0, 5.0]))
    samples = tuple(sample_curve(curve, (0.0, 1.0), 0.05) for curve in curves)
    made = triangulate(samples[0].points, samples[1].points)
    found, own = without_turning_back(made, samples, curves, triangulate, tolerance=FINE)  # type: ignore[arg-type]
    assert found is made
    assert own[0] is samples[0]
    assert own[1] is samples[1]


def test_what_still_turns_back_is_refused_with_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    made, samples, curves = leaning()
    monkeypatch.setattr(turning, "ROUNDS", 1)
    with pytest.raises(InputError, match=r"^Rail P turns back at \(.*\) mm as seen from"):
        without_turning_back(made, samples, curves, triangulate, tolerance=FINE)


@pytest.mark.parametrize("seed", [11, 16, 23, 67, 80, 83, 87, 119])
def test_strips_that_turned_back_do_so_no_longer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tolerance, width = (0.2, 0.05, 0.01, 0.5)[seed % 4], (6.0, 10.0, 15.0, 30.0)[seed // 4 % 4]
    p, q = (random_edge(rng, y, int(rng.integers(2, 9))) for y in (0.0, width))
    strip = WrinkleStrip(p, q, tolerance=tolerance)
    assert strip.unrolling.turned_back_count == 0
    assert strip.shell().is_valid


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(120, 320))
def test_no_random_strip_turns_back(seed: int) -> None:
    test_strips_that_turned_back_do_so_no_longer(seed)

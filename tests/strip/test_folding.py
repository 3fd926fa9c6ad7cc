from __future__ import annotations

import numpy as np
import pytest

from tests.strip import brute_force, exact_strips
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import triangulate
from wrinkle_cad.strip.folding import ENERGIES, cost_row, new_costs


def roof(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Two unit squares that meet in a ridge along y, each sloping down by half the angle."""
    x, z = np.cos(angle / 2), -np.sin(angle / 2)
    p = np.array([[-x, 0.0, z], [0.0, 0.0, 0.0], [x, 0.0, z]])
    return p, p + np.array([0.0, 1.0, 0.0])


def ridge_of(p: np.ndarray, q: np.ndarray) -> float:
    found = triangulate(p, q)
    return float(found.fold[np.flatnonzero((found.bridges[1:-1] == 1).all(axis=1))[0]])


@pytest.mark.parametrize("angle", [1e-6, 0.3, 1.5, 3.0])
def test_a_ridge_has_the_positive_angle_between_its_planes(angle: float) -> None:
    assert ridge_of(*roof(angle)) == pytest.approx(angle, rel=1e-9)


def test_a_valley_is_negative_and_so_is_a_ridge_seen_from_behind() -> None:
    assert ridge_of(*roof(-0.3)) == pytest.approx(-0.3)
    p, q = roof(0.3)
    assert ridge_of(q, p) == pytest.approx(-0.3)
    assert ridge_of(p[::-1], q[::-1]) == pytest.approx(-0.3)


def test_triangles_are_counter_clockwise_on_the_side_a_ridge_is_seen_from() -> None:
    p, q = roof(0.3)
    found = triangulate(p, q)
    a, b, c = np.vstack((p, q))[found.triangles].swapaxes(0, 1)
    assert (np.cross(b - a, c - a)[:, 2] > 0.0).all()


def test_the_hinge_energy_of_a_roof_is_its_closed_form() -> None:
    found = triangulate(*roof(0.4))
    assert found.bending == pytest.approx(1 / 4 * (1 + 1) * (2 * np.tan(0.2)) ** 2, rel=1e-12)


def test_the_paper_energy_of_a_roof_is_its_closed_form() -> None:
    found = triangulate(*roof(0.4), energy="paper")
    assert found.bending == pytest.approx(0.5 * np.sin(0.4) ** 2, rel=1e-12)


def cost(angle: float, energy: str) -> tuple[float, float]:
    """A bridge of length 2 between triangles of height 1: energy and fold-backs, P after P."""
    x, y = np.cos(angle), -np.sin(angle)
    view = np.array([[2.0, -1.0, 0.0, x, y, 0.0, 0.0, 0.0, 0.0]]).T.copy()
    costs = new_costs(1)
    cost_row(view, np.ones((4, 1)), 1e-13, 1e-12, ENERGIES[energy], costs)
    return float(costs.bending[0, 0]), float(costs.fold_backs[0, 0])


def test_the_hinge_energy_grows_up_to_a_fold_of_180_degrees() -> None:
    costs = [cost(angle, "hinge")[0] for angle in np.linspace(0.0, np.pi - 1e-5, 400)]
    assert costs[0] == 0.0
    assert (np.diff(costs) > 0.0).all()


def test_the_paper_energy_falls_again_beyond_90_degrees() -> None:
    assert cost(3.0, "paper")[0] < cost(1.5, "paper")[0]


def test_a_fold_of_180_degrees_is_counted_and_costs_nothing() -> None:
    assert cost(np.pi, "hinge") == (0.0, 1.0)
    assert cost(np.pi - 1e-7, "hinge") == (0.0, 1.0)
    assert cost(np.pi - 1e-5, "hinge")[1] == 0.0
    assert cost(np.pi, "paper") == (0.0, 1.0)


def test_a_vertex_within_the_planarity_of_the_plane_is_in_it() -> None:
    for energy in ENERGIES:
        assert cost(0.9e-12, energy) == (0.0, 0.0)
        assert cost(1.1e-12, energy)[0] > 0.0


def test_small_folds_cost_the_same_by_both_energies() -> None:
    assert cost(1e-3, "hinge")[0] == pytest.approx(cost(1e-3, "paper")[0], rel=1e-5)
    assert cost(1.0, "hinge")[0] > 1.1 * cost(1.0, "paper")[0]


def test_folds_areas_and_energies_agree_with_plain_python() -> None:
    for seed in range(20):
        p, q = exact_strips.random_points(seed, 8, 6)
        for energy in ENERGIES:
            found = triangulate(p, q, energy=energy, planarity=brute_force.PLANARITY)
            path = [tuple(bridge) for bridge in found.bridges.tolist()]
            for k in range(1, len(path) - 1):
                bent, _, _ = brute_force.bend(p.tolist(), q.tolist(), *path[k - 1 : k + 2], energy)
                assert found.bending_at[k - 1] == pytest.approx(bent, rel=1e-9, abs=1e-12)
            area = sum(
                brute_force.area_of(brute_force.third(p.tolist(), q.tolist(), *path[k : k + 2]))
                for k in range(len(path) - 1)
            )
            assert found.area == pytest.approx(area, rel=1e-12)


def test_an_unknown_energy_is_refused() -> None:
    with pytest.raises(InputError, match="energy cannot be 'spring': choose one of hinge, paper"):
        triangulate(*roof(0.4), energy="spring")

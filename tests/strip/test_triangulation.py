from __future__ import annotations

import dataclasses
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import numpy.typing as npt
import pytest

from tests.strip import exact_strips
from tests.strip.small_strips import makes_a_strip, small_strip
from wrinkle_cad.errors import InputError
from wrinkle_cad.strip import P_STEP, Q_STEP, Triangulation, triangulate, unroll
from wrinkle_cad.strip.rails import default_planarity, sagittas

STRIPS = [
    *(family(1).sampled(1e-3) for family in exact_strips.WAVY + exact_strips.CONVEX),
    *(exact_strips.wrinkled(seed).sampled(1e-3) for seed in range(3)),
]
NAMES = [strip.name for strip in STRIPS]


def counts_of(found: Triangulation) -> tuple[int, ...]:
    return (
        found.invalid_count,
        found.counted_invalid_count,
        found.inflection_count,
        found.degenerate_count,
        found.fold_back_count,
    )


def assert_same(found: Triangulation, other: Triangulation, scale: float = 1.0) -> None:
    """Counts and energy; the hinge energy of a strip grows with its size's power 0."""
    assert counts_of(found) == counts_of(other)
    assert other.bending == pytest.approx(found.bending, rel=1e-9, abs=1e-12)
    assert other.area == pytest.approx(found.area * scale**2, rel=1e-6)


def rotation(seed: int) -> np.ndarray:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


@pytest.mark.parametrize("strip", STRIPS, ids=NAMES)
def test_a_rigid_motion_changes_no_measure(strip) -> None:
    turn, shift = rotation(3), np.array([12.0, -40.0, 7.0])
    found = triangulate(strip.p, strip.q, planarity=1e-6)
    assert_same(found, triangulate(strip.p @ turn + shift, strip.q @ turn + shift, planarity=1e-6))


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@pytest.mark.parametrize("strip", STRIPS, ids=NAMES)
def test_scaling_changes_no_count_and_no_energy(strip, scale: float) -> None:
    found = triangulate(strip.p, strip.q)
    assert_same(found, triangulate(scale * strip.p, scale * strip.q), scale)


@pytest.mark.parametrize("energy", ["hinge", "paper"])
@pytest.mark.parametrize("strip", STRIPS, ids=NAMES)
def test_swapping_the_rails_changes_no_measure(strip, energy: str) -> None:
    found = triangulate(strip.p, strip.q, energy=energy)
    assert_same(found, triangulate(strip.q, strip.p, energy=energy))


@pytest.mark.parametrize("strip", STRIPS, ids=NAMES)
def test_reading_a_strip_from_its_other_end_changes_no_measure(strip) -> None:
    found = triangulate(strip.p, strip.q)
    assert_same(found, triangulate(strip.p[::-1], strip.q[::-1]))


CHANGES = {
    "swapped": lambda p, q: (q, p),
    "reversed": lambda p, q: (p[::-1], q[::-1]),
    "mirrored": lambda p, q: (p * [1, 1, -1], q * [1, 1, -1]),
    "moved": lambda p, q: (p @ rotation(3) + [12, -40, 7], q @ rotation(3) + [12, -40, 7]),
    "shrunk": lambda p, q: (1e-3 * p, 1e-3 * q),
    "grown": lambda p, q: (1e3 * p, 1e3 * q),
}


@pytest.mark.parametrize("price", [None, 1.0, 50.0])
@pytest.mark.parametrize("change", CHANGES)
def test_flat_places_and_ties_measure_the_same_however_a_strip_is_drawn(
    change: str, price: float | None
) -> None:
    scale = {"shrunk": 1e-3, "grown": 1e3}.get(change, 1.0)
    for seed in makes_a_strip(range(64)):
        p, q = small_strip(seed, 9)
        found = triangulate(p, q, planarity=1e-9, price=price)
        other = triangulate(*CHANGES[change](p, q), planarity=1e-9 * scale, price=price)
        assert_same(found, other, scale)
        assert other.length == pytest.approx(found.length * scale, rel=1e-9)


def test_the_paper_energy_depends_on_the_end_a_strip_is_read_from() -> None:
    strip = STRIPS[-1]
    found = triangulate(strip.p, strip.q, energy="paper")
    back = triangulate(strip.p[::-1], strip.q[::-1], energy="paper")
    assert back.bending != pytest.approx(found.bending, rel=1e-9, abs=1e-12)


def test_the_twisted_strip_is_a_plane_and_a_cone() -> None:
    found = triangulate(*exact_strips.twisted_plane_and_cone())
    assert found.interior_count == 117
    assert found.invalid_count == 0
    assert np.degrees(np.abs(found.fold).max()) == pytest.approx(2.36, abs=0.01)


def test_bridges_and_triangles_follow_the_steps() -> None:
    strip = STRIPS[-1]
    found = triangulate(strip.p, strip.q)
    m, n = len(strip.p), len(strip.q)
    assert found.bridges.shape == (m + n - 1, 2)
    assert found.bridges[0].tolist() == [0, 0]
    assert found.bridges[-1].tolist() == [m - 1, n - 1]
    assert (np.diff(found.bridges, axis=0).sum(axis=1) == 1).all()
    for number, (i, j) in enumerate(found.bridges[:-1].tolist()):
        expected = {P_STEP: [i, i + 1, m + j], Q_STEP: [i, m + j + 1, m + j]}
        assert found.triangles[number].tolist() == expected[int(found.steps[number])]


def test_totals_are_those_of_the_parts() -> None:
    strip = STRIPS[-1]
    found = triangulate(strip.p, strip.q)
    corners = np.vstack((strip.p, strip.q))[found.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    i, j = found.bridges.T
    assert found.area == pytest.approx(np.linalg.norm(normal, axis=1).sum() / 2, rel=1e-12)
    assert found.length == pytest.approx(np.linalg.norm(strip.q[j] - strip.p[i], axis=1).sum())
    assert found.bending == pytest.approx(found.bending_at.sum())
    assert found.interior_count == found.fold.size == found.bending_at.size == len(i) - 2
    assert not (found.inflection & found.valid).any()


def test_every_array_is_read_only_and_the_inputs_are_not_touched() -> None:
    p, q = exact_strips.random_points(1, 7, 6)
    before = p.copy(), q.copy()
    found = triangulate(p, q)
    assert (p == before[0]).all()
    assert (q == before[1]).all()
    assert p.flags.writeable
    assert not np.shares_memory(found.p, p)
    for field in dataclasses.fields(found):
        value = getattr(found, field.name)
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable, field.name


def test_lists_and_integers_are_taken_too() -> None:
    found = triangulate([[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]])
    assert found.area == 1.0


def test_threads_find_what_one_thread_finds() -> None:
    strips = STRIPS * 2
    alone = [triangulate(strip.p, strip.q).steps for strip in strips]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda strip: triangulate(strip.p, strip.q).steps, strips))
    assert all((a == b).all() for a, b in zip(alone, together, strict=True))


def test_very_unequal_sample_counts_work() -> None:
    t = np.linspace(0.0, 1.0, 2000)
    p = exact_strips.stack(10 * np.cos(t), 10 * np.sin(t), 0 * t)
    u = np.linspace(0.0, 1.0, 3)
    q = exact_strips.stack(10 * np.cos(u), 10 * np.sin(u), 1 + 0 * u)
    for found in (triangulate(p, q), triangulate(q, p)):
        assert found.interior_count == 2000
        assert found.invalid_count == 0


def test_rails_that_meet_at_both_ends_make_a_lens() -> None:
    t = np.linspace(0.0, np.pi, 80)
    p = exact_strips.stack(np.cos(t), -0.2 * np.sin(t), 0.1 * np.sin(2 * t))
    q = exact_strips.stack(np.cos(t), 0.2 * np.sin(t), 0.1 * np.sin(2 * t))
    found = triangulate(p, q)
    assert found.degenerate_count == 2
    assert found.invalid_count <= 4
    assert np.isfinite(found.bending)
    assert found.bending < 10.0


def test_a_degenerate_triangle_at_an_end_does_not_swamp_the_search() -> None:
    t = np.linspace(0.0, 1.0, 60)
    p = exact_strips.stack(10 * t, 0 * t, np.sin(3 * t))
    q = exact_strips.stack(10 * t, 2 * t, np.sin(3 * t))
    found = triangulate(p, q)
    assert found.degenerate_count == 1
    assert found.invalid_count == 0
    assert found.bending < 10.0


def test_planar_and_straight_rails_work() -> None:
    t = np.linspace(0.0, 1.0, 50)
    turn = rotation(5)
    straight = triangulate(exact_strips.stack(t, 0 * t, 0 * t), exact_strips.stack(t, 1 + t, 0 * t))
    assert straight.invalid_count == 0
    assert straight.bending == 0.0
    ring = [
        exact_strips.stack(r * np.cos(3 * t), r * np.sin(3 * t), 0 * t) @ turn for r in (1, 1.2)
    ]
    planar = triangulate(*ring)
    assert planar.invalid_count == 0
    assert planar.bending == pytest.approx(0.0, abs=1e-20)
    assert planar.area < 1.5 * (1.2**2 - 1) * 1.01


def test_repeated_points_make_degenerate_triangles_and_nothing_worse() -> None:
    strip = exact_strips.convex_cylinder(2).sampled(1e-2)
    p = np.insert(strip.p, 5, strip.p[5], axis=0)
    found, plain = triangulate(p, strip.q), triangulate(strip.p, strip.q)
    assert found.degenerate_count == 1
    assert found.area == pytest.approx(plain.area, rel=0.05)
    assert np.isfinite(found.bending)


RING = exact_strips.stack(np.cos(np.linspace(0, 2, 30)), np.sin(np.linspace(0, 2, 30)), 0.0)
APEX = np.array([[0.0, 0, 1]])


def test_a_rail_of_two_samples_at_one_point_makes_a_cone() -> None:
    found = triangulate(np.concatenate((APEX, APEX)), RING)
    assert found.degenerate_count == 1
    assert found.area == pytest.approx(2.0 * np.sqrt(2) / 2, rel=1e-2)


@pytest.mark.parametrize("search", ["global", "local"])
@pytest.mark.parametrize("rails", [(APEX, RING), (RING, APEX)])
def test_a_rail_of_one_sample_is_the_apex_of_a_cone(
    rails: tuple[np.ndarray, np.ndarray], search: str
) -> None:
    found = triangulate(*rails, search=search)
    assert found.bridges.shape == (30, 2)
    assert found.interior_count == found.fold.size == 28
    assert (found.invalid_count, found.degenerate_count) == (0, 0)
    assert found.area == pytest.approx(2.0 * np.sqrt(2) / 2, rel=1e-2)
    flat = unroll(found)
    assert (len(flat.p), len(flat.q)) == (len(rails[0]), len(rails[1]))
    assert flat.area == pytest.approx(found.area, rel=1e-12)


def test_one_triangle_is_a_strip_too() -> None:
    found = triangulate([[0.0, 0, 0]], [[0.0, 2, 0], [1, 2, 0]])
    assert (found.area, found.interior_count) == (1.0, 0)
    assert (found.least_bending, found.bending) == (0.0, 0.0)


def test_two_points_make_no_strip() -> None:
    with pytest.raises(InputError, match="P and Q are a single point each"):
        triangulate(APEX, APEX + 1.0)


def test_strips_of_microns_and_of_twenty_metres_work() -> None:
    for scale in (1e-4, 2e3):
        strip = exact_strips.cylinder(4).sampled(1e-3)
        found = triangulate(scale * strip.p, scale * strip.q)
        assert found.invalid_count == found.inflection_count


def test_the_default_planarity_is_a_share_of_the_sagitta() -> None:
    strip = exact_strips.convex_cylinder(0).sampled(1e-3)
    typical = np.median(np.concatenate((sagittas(strip.p), sagittas(strip.q))))
    assert typical == pytest.approx(4e-3, rel=0.1)
    assert triangulate(strip.p, strip.q).planarity == pytest.approx(1e-3 * typical)
    straight = np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0]])
    assert 0.0 < default_planarity(straight, straight + 1.0) < 1e-11


GOOD = [[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]
SIDE = [[0.0, 1, 0], [1, 1, 0], [2, 1, 0]]


@pytest.mark.parametrize(
    ("p", "message"),
    [
        ([[0.0, 0], [1, 0]], r"Rail P has the shape \(2, 2\)"),
        ([0.0, 1, 2], r"Rail P has the shape \(3,\)"),
        ([], r"Rail P has the shape \(0,\)"),
        (np.empty((0, 3)), r"Rail P has the shape \(0, 3\)\. Pass an array of shape \(k, 3\)"),
        ([["a", 0, 0], [1, 0, 0]], "Rail P is no array of numbers"),
        ([[0.0, 0, 0], [1, 0]], "Rail P is no array of numbers"),
        (
            [[0.0, 0, 0], [np.nan, 0, 0]],
            "Rail P has 1 samples that are not finite; .* number 1",
        ),
        (
            [[0.0, 0, np.inf], [1, 0, 0]],
            "Rail P has 1 samples that are not finite; .* number 0",
        ),
        ([[0.0, 0, 0], [1e12, 0, 0]], "Rail P has a coordinate of 1e.12 mm"),
    ],
)
def test_what_is_no_rail_is_refused(p: npt.ArrayLike, message: str) -> None:
    with pytest.raises(InputError, match=message):
        triangulate(p, SIDE)
    with pytest.raises(InputError, match=message.replace("Rail P", "Rail Q")):
        triangulate(SIDE, p)


def test_coincident_rails_are_refused() -> None:
    strip = exact_strips.cylinder(1)
    coarse, fine = strip.sampled(1e-2).p, strip.sampled(1e-4).p
    for p, q in ((fine, fine), (coarse, fine), (fine, coarse), (GOOD, GOOD)):
        with pytest.raises(InputError, match="P and Q coincide: they are nowhere more than"):
            triangulate(p, q)


@pytest.mark.parametrize("seed", range(6))
def test_two_samplings_of_any_curve_are_refused(seed: int) -> None:
    strip = (exact_strips.cone, exact_strips.wrinkled)[seed % 2](seed)
    tolerances = (1e-2, 2e-2) if seed % 3 else (1e-2, 2e-4)
    p, q = (strip.sampled(tolerance).q for tolerance in tolerances)
    with pytest.raises(InputError, match="P and Q coincide: they are nowhere more than"):
        triangulate(p, q)


@pytest.mark.parametrize("apart", [0.1, 1.0, 2.5])
def test_rails_with_a_corner_beside_each_other_do_not_coincide(apart: float) -> None:
    # Both have a sagitta of some 10 mm, which is no chord tolerance but their shape.
    p, q = ([[0.0, 0, 0], [50, 0, top], [100, 0, 0]] for top in (10.0, 10.0 + apart))
    for rails in ((p, q), (q, p)):
        found = triangulate(*rails)
        assert found.area == pytest.approx(50.0 * apart, rel=1e-9)
        assert found.fold_back_count == 0


@pytest.mark.parametrize("way", [(0.0, 0.05, 0.0), (0.0, 0.0, 0.05), (0.0, 0.03, -0.04)])
def test_a_wave_moved_by_less_than_its_sagitta_does_not_coincide(
    way: tuple[float, float, float],
) -> None:
    x = np.linspace(0.0, 60.0, 40)
    p = exact_strips.stack(x, 0.0 * x, 5.0 * np.sin(x / 4.0))
    assert triangulate(p, p + np.array(way)).area > 0.0


def test_rails_that_coincide_over_a_stretch_are_refused_with_the_place() -> None:
    strip = exact_strips.convex_cylinder(3).sampled(1e-3)
    q = strip.q.copy()
    q[10:14] = strip.p[10:14]
    with pytest.raises(InputError, match=r"coincide over \S+ mm, from sample 10 to 13 of P"):
        triangulate(strip.p, q)


def test_rails_may_share_one_bank_edge() -> None:
    strip = exact_strips.convex_cylinder(3).sampled(1e-2)
    q = strip.q.copy()
    q[-2:] = strip.p[-2:]
    found = triangulate(strip.p, q)
    assert found.degenerate_count >= 1
    assert np.isfinite(found.bending)


def test_a_strip_without_any_area_is_refused() -> None:
    with pytest.raises(InputError, match="Every triangle of the strip has zero area"):
        triangulate([[0.0, 0, 0], [1, 0, 0]], [[3.0, 0, 0], [4, 0, 0]])


def test_importing_the_folder_loads_neither_numba_nor_a_cad_kernel() -> None:
    code = (
        "import sys, wrinkle_cad.strip as strip\n"
        "heavy = {'OCP', 'build123d', 'numba', 'scipy'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "assert all(getattr(strip, name) is not None for name in strip.__all__)\n"
        "assert 'OCP' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

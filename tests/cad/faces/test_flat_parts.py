"""Flat strips and flat parts of strips: the plane between the rails, however the triangles lie."""

from __future__ import annotations

import math

import build123d as b3d
import numpy as np
import pytest
import shapely
from OCP.TopoDS import TopoDS_Shell

from tests.cad.strips import stl_faults
from wrinkle_cad import WrinkleStrip
from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.kernel.topology import faces_of
from wrinkle_cad.cad.rail.directrix import Directrix, make_directrix

RINGS = [
    (radius, width, degrees)
    for radius in (20, 50, 100, 300, 600, 1000)
    for width in (2, 10, 40, 80)
    for degrees in (30, 90, 170)
]


def pose(rng: np.random.Generator) -> b3d.Location:
    turn, shift = rng.uniform(0.0, 360.0, 3), rng.uniform(-100.0, 100.0, 3)
    return b3d.Rot(*turn.tolist()) * b3d.Pos(*shift.tolist())


def strip_of(p: object, q: object, **options: object) -> WrinkleStrip:
    return WrinkleStrip(p, q, **options)  # type: ignore[arg-type]


def faults_of(strip: WrinkleStrip, area: float) -> list[str]:
    """What is wrong with a flat strip whose area is known; empty if nothing."""
    shell, flat = strip.topods_shell(), strip.unrolling
    faults = [] if is_valid(shell) else ["the shell is not valid"]
    if len(faces_of(shell)) != 1:
        faults.append(f"{len(faces_of(shell))} faces")
    for name, found in (("surface", strip.area_mm2), ("pattern", flat.area)):
        if abs(found - area) > 1e-9 * area:
            faults.append(f"area of the {name} {found} instead of {area}")
    if flat.turned_back_count or flat.overlaps:
        faults.append(f"{flat.turned_back_count} turned back, overlaps: {flat.overlaps}")
    return faults + stl_faults(shell) + outline_faults(strip)


def outline_faults(strip: WrinkleStrip) -> list[str]:
    """Points of the pattern's rails that do not lie where the rails do, measured in their plane."""
    flat, faults = strip.unrolling, []
    origin, up = strip.triangulation.p[0], strip.triangulation.q[0] - strip.triangulation.p[0]
    up = up / np.linalg.norm(up)
    ends = strip.triangulation.p[-1] - origin
    along = ends - up * (ends @ up)
    along /= np.linalg.norm(along)
    for name, rail, line in (("P", strip.p, flat.p_line), ("Q", strip.q, flat.q_line)):
        parameters = np.union1d(np.linspace(*rail.interval, 20_001), rail.breaks)
        dense = rail.point_at(parameters) - origin
        flat_rail = np.column_stack((dense @ along, dense @ up))
        points = shapely.points(line)
        gaps = [
            shapely.distance(points, shapely.LineString(flat_rail * side)).max()
            for side in ((1.0, 1.0), (-1.0, 1.0))
        ]
        if min(gaps) > 1e-4:
            faults.append(f"points of the pattern up to {min(gaps):.2g} mm off rail {name}")
    return faults


def ring(radius: float, width: float, degrees: float, at: b3d.Location) -> WrinkleStrip:
    p, q = (
        at * b3d.Edge.make_circle(r, start_angle=0.0, end_angle=degrees)
        for r in (radius, radius + width)
    )
    return strip_of(p, q)


def ring_faults(radius: float, width: float, degrees: float, at: b3d.Location) -> list[str]:
    area = math.radians(degrees) / 2.0 * ((radius + width) ** 2 - radius**2)
    return faults_of(ring(radius, width, degrees, at), area)


@pytest.mark.parametrize(("radius", "width", "degrees"), RINGS[::5])
def test_a_flat_ring_sector_is_exact(radius: float, width: float, degrees: float) -> None:
    assert ring_faults(radius, width, degrees, b3d.Location()) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(("radius", "width", "degrees"), RINGS)
def test_a_flat_ring_sector_is_exact_in_any_pose(
    radius: float, width: float, degrees: float, seed: int
) -> None:
    at = pose(np.random.default_rng(seed))
    assert ring_faults(radius, width, degrees, at) == []


def test_the_comparison_sees_a_wrong_area_and_a_moved_point() -> None:
    strip = ring(100.0, 10.0, 90.0, b3d.Location())
    assert faults_of(strip, 1650.0) != []
    other = ring(100.0, 11.0, 90.0, b3d.Location())
    strip.__dict__["_unrolled"] = other.unrolling
    assert outline_faults(strip) != []


def region(rng: np.random.Generator) -> tuple[b3d.Edge, b3d.Edge]:
    """Two splines in one plane, somewhere, that bound a region with the lines between their ends.

    Splines overshoot: now and then a rail crosses the line between two ends, and is drawn anew.
    """
    while True:
        length, width = rng.uniform(50.0, 300.0), rng.uniform(10.0, 60.0)
        count, reach = int(rng.integers(4, 14)), rng.uniform(0.0, 0.45) * width
        x, at = np.linspace(0.0, length, count), pose(rng)
        p, q = (
            b3d.Spline(*[(float(a), float(b), 0.0) for a, b in zip(x, y, strict=True)])
            for y in (rng.uniform(-reach, reach, count), width + rng.uniform(-reach, reach, count))
        )
        rails = [make_directrix(rail) for rail in (p, q)]
        dense = [rail.point_at(np.linspace(*rail.interval, 2001))[:, :2] for rail in rails]
        if shapely.Polygon(np.vstack((dense[0], dense[1][::-1]))).is_valid:
            return at * p, at * q


def area_between(p: Directrix, q: Directrix) -> float:
    """The area inside two flat rails and the lines between their ends, exact for polynomials."""
    (a, b), (c, d) = (rail.point_at(np.array(rail.interval)) for rail in (p, q))
    around = swept(p) + np.cross(b, d) - swept(q) + np.cross(c, a)
    return float(np.linalg.norm(around)) / 2.0


def swept(rail: Directrix) -> np.ndarray:
    nodes, weights = np.polynomial.legendre.leggauss(20)
    total = np.zeros(3)
    for piece in rail.pieces:
        for low, high in zip(piece.knots[:-1], piece.knots[1:], strict=True):
            at = (low + high) / 2.0 + (high - low) / 2.0 * nodes
            turns = np.cross(piece.point_at(at), piece.velocity_at(at))
            total += (high - low) / 2.0 * (weights[:, None] * turns).sum(axis=0)
    return total


@pytest.mark.parametrize("seed", range(20))
def test_the_region_between_two_splines_is_exact(seed: int) -> None:
    p, q = region(np.random.default_rng(seed))
    area = area_between(make_directrix(p), make_directrix(q))
    assert faults_of(strip_of(p, q), area) == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 100))
def test_many_regions_between_two_splines_are_exact(seed: int) -> None:
    test_the_region_between_two_splines_is_exact(seed)


def test_a_known_region_between_two_splines_has_its_area() -> None:
    x = np.arange(0.0, 201.0, 10.0)
    p, q = (
        b3d.Spline(*[(float(a), float(b), 0.0) for a, b in zip(x, y, strict=True)])
        for y in (5.0 * np.sin(x / 20.0), 30.0 + 4.0 * np.cos(x / 15.0))
    )
    dense = [
        rail.point_at(np.linspace(*rail.interval, 20_001))[:, :2]
        for rail in (make_directrix(p), make_directrix(q))
    ]
    area = shapely.Polygon(np.vstack((dense[0], dense[1][::-1]))).area
    assert area == pytest.approx(5857.9725, abs=1e-4)
    assert strip_of(p, q).area_mm2 == pytest.approx(area, rel=1e-7)


def faces_by_plane(shell: TopoDS_Shell) -> list[str]:
    return [b3d.Face(face).geom_type.name for face in faces_of(shell)]


def test_a_bent_strip_has_planes_where_it_is_flat_and_cones_where_it_is_not() -> None:
    arm = 20.0 * math.sqrt(0.5)
    p, q = (
        b3d.Wire(
            [
                b3d.Edge.make_line((0, y, 0), (40, y, 0)),
                b3d.Edge.make_three_point_arc((40, y, 0), (40 + arm, y, 20 - arm), (60, y, 20)),
                b3d.Edge.make_line((60, y, 20), (60, y, 60)),
            ]
        )
        for y in (0.0, 25.0)
    )
    kinds = faces_by_plane(strip_of(p, q).topods_shell())
    assert kinds[0] == kinds[-1] == "PLANE"
    assert set(kinds[1:-1]) == {"BSPLINE"}


def test_each_leg_of_a_folded_strip_is_one_face() -> None:
    zigzag = b3d.Polyline(*[(10 * i, 0, 6 * (i % 2)) for i in range(9)])
    strip = strip_of(zigzag, b3d.Pos(0, 25, 0) * zigzag, search="global")
    kinds = faces_by_plane(strip.topods_shell())
    assert set(kinds) == {"PLANE"}


def test_facets_stay_triangles_where_the_strip_is_flat() -> None:
    strip = ring(100.0, 10.0, 90.0, b3d.Location())
    assert len(faces_of(strip.topods_shell("facets"))) == len(strip.triangulation.steps)

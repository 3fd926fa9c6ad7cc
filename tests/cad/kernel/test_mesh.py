from __future__ import annotations

import io
import time

import build123d as b3d
import numpy as np
import pytest
import trimesh

from wrinkle_cad import WrinkleStrip, WrinkleWarning
from wrinkle_cad.cad.exchange.write import stl_bytes
from wrinkle_cad.cad.kernel.mesh import binary_stl, mesh_of


def rail(y: float) -> b3d.Edge:
    return b3d.Edge.make_spline([(x, y, 8 * np.sin(x / 20)) for x in range(0, 101, 10)])


@pytest.fixture(scope="module")
def strip() -> WrinkleStrip:
    return WrinkleStrip(rail(0.0), rail(20.0))


def test_the_mesh_of_a_box_has_its_area_and_looks_outwards() -> None:
    points, triangles = mesh_of(b3d.Box(1, 2, 3).wrapped)
    mesh = trimesh.Trimesh(points, triangles)
    assert mesh.area == pytest.approx(22.0)
    assert mesh.volume == pytest.approx(6.0)


def test_a_reversed_shape_looks_inwards() -> None:
    points, triangles = mesh_of(b3d.Box(1, 2, 3).wrapped.Reversed())
    assert trimesh.Trimesh(points, triangles).volume == pytest.approx(-6.0)


def test_a_placed_shape_is_meshed_where_it_stands() -> None:
    points, _ = mesh_of(b3d.Box(1, 1, 1).moved(b3d.Location((10, 0, 0))).wrapped)
    assert points[:, 0].min() == pytest.approx(9.5)


def test_a_mesh_lies_within_the_tolerance_of_its_cylinder() -> None:
    points, triangles = mesh_of(b3d.Cylinder(10, 20).wrapped, tolerance=0.01)
    centers = points[triangles].mean(axis=1)
    on_side = np.abs(centers[:, 2]) < 9.99
    assert 10 - np.hypot(*centers[on_side, :2].T).min() <= 0.01


def test_the_shape_itself_carries_no_mesh_afterwards() -> None:
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    box = b3d.Box(1, 1, 1)
    mesh_of(box.wrapped)
    for face in box.faces():
        assert BRep_Tool.Triangulation_s(face.wrapped, TopLoc_Location()) is None


def test_a_strip_of_cones_is_one_clean_sheet_in_stl(strip: WrinkleStrip) -> None:
    mesh = trimesh.load(io.BytesIO(stl_bytes(strip.topods_shell())), file_type="stl")
    edges, uses = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    assert uses.max() == 2
    border = edges[uses == 1]
    corners, ends = np.unique(border, return_counts=True)
    assert (ends == 2).all()
    assert len(corners) == len(border)
    assert mesh.is_winding_consistent
    assert mesh.area == pytest.approx(strip.report.area_3d_mm2, rel=1e-3)


def test_collapsed_triangles_are_left_out_and_no_others() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1.0 + 1e-12, 0, 0]])
    stl = binary_stl(points, np.array([[0, 1, 2], [1, 3, 2], [1, 2, 0]]))
    assert len(stl) == 84 + 2 * 50
    mesh = trimesh.load(io.BytesIO(stl), file_type="stl", process=False)
    assert mesh.triangles == pytest.approx(points[[[0, 1, 2], [1, 2, 0]]])
    assert mesh.face_normals == pytest.approx(np.array([[0, 0, 1.0], [0, 0, 1]]))


def test_a_cone_is_a_fan_of_as_many_triangles_as_its_rim_needs(strip: WrinkleStrip) -> None:
    shell = strip.topods_shell()
    points, triangles = mesh_of(shell)
    apart = max(
        b3d.Vertex(*center).distance_to(b3d.Shell(shell))
        for center in points[triangles[::5]].mean(axis=1)
    )
    assert apart <= 0.05
    samples = len(strip.triangulation.p) + len(strip.triangulation.q)
    written = np.frombuffer(stl_bytes(shell)[80:84], dtype="<u4")[0]
    assert written < 6 * samples


def test_slender_cones_of_a_rail_of_a_kilometre_are_meshed_at_once() -> None:
    # The kernel's own way to mesh such a cone takes minutes and 20,000 triangles.
    points = [(1e4 * x, 1e5 + 1.6e5 * np.sin(x / 20), 4e4 * (x % 20)) for x in range(0, 101, 10)]
    with pytest.warns(WrinkleWarning, match="passes through itself"):
        shell = WrinkleStrip(rail(0.0), b3d.Edge.make_spline(points), tolerance=1.0).topods_shell()
    start = time.process_time()
    assert len(mesh_of(shell, tolerance=1.0)[1]) < 10_000
    assert time.process_time() - start < 2.0

from __future__ import annotations

import math
from pathlib import Path

import build123d as b3d
import numpy as np
import pytest
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepLProp import BRepLProp_SLProps
from OCP.GeomAbs import GeomAbs_BSplineSurface
from OCP.TopoDS import TopoDS_Shape

from tests.cad.measuring import area_of
from tests.cad.strips import (
    Strip,
    faults_after_step,
    lens_edges,
    random_edge,
    reread,
    strip_between,
)
from tests.seeds import seeds
from wrinkle_cad.cad.faces.exact_surface import exact_surface, rail_curve
from wrinkle_cad.cad.faces.smooth_shell import SmoothShell, build_smooth_shell
from wrinkle_cad.cad.kernel.measures import length_of, tolerance_of
from wrinkle_cad.cad.kernel.topology import faces_of, free_edges

EDGE_TOLERANCE = 1e-5
"""mm; what an edge of a smooth shell may be off its faces."""


def smooth(strip: Strip) -> SmoothShell:
    rails, samples = (strip.p, strip.q), (strip.p_samples, strip.q_samples)
    ruled = exact_surface(*rails, *samples, strip.triangulation)
    curves = (rail_curve(strip.p), rail_curve(strip.q))
    return build_smooth_shell(ruled, curves, strip.triangulation, rails, samples)


def arc(radius: float, *, x: float = 0.0, z: float = 0.0, tilt: float = 0.0) -> TopoDS_Shape:
    half = b3d.Edge.make_circle(radius, start_angle=0.0, end_angle=180.0)
    return (b3d.Pos(x, 0.0, z) * b3d.Rot(0.0, tilt, 0.0) * half).wrapped


def auger_rail(radius: float) -> TopoDS_Shape:
    """Where the tangents of a helix of radius 8 and pitch 40 reach a radius, over one turn."""
    w = np.linspace(0.0, 2.0 * math.pi, 241)
    along = math.sqrt(radius**2 - 64.0) / 8.0
    x, y = 8.0 * (np.cos(w) - along * np.sin(w)), 8.0 * (np.sin(w) + along * np.cos(w))
    points = np.column_stack((x, y, 40.0 / (2.0 * math.pi) * (w + along)))
    return b3d.Edge.make_spline([b3d.Vector(*point) for point in points.tolist()]).wrapped


def largest_turn(shape: TopoDS_Shape) -> float:
    """Degrees between the kernel's normals along one ruling of a patch, at the worst."""
    worst = 0.0
    for face in faces_of(shape):
        surface = BRepAdaptor_Surface(face)
        if surface.GetType() != GeomAbs_BSplineSurface or surface.UDegree() != 5:
            continue
        for u in np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 23)[1:-1]:
            normals = []
            for v in (1e-3, 0.5, 1.0 - 1e-3):
                normal = BRepLProp_SLProps(surface, float(u), v, 1, 1e-9).Normal()
                normals.append(np.array([normal.X(), normal.Y(), normal.Z()]))
            for other in normals[1:]:
                sine = float(np.linalg.norm(np.cross(normals[0], other)))
                worst = max(worst, math.degrees(math.atan2(sine, float(normals[0] @ other))))
    return worst


def check_sound(strip: Strip, made: SmoothShell, path: Path) -> None:
    """Few faces between the rails themselves, smooth and sound, in memory and in STEP."""
    assert len(faces_of(made.shell)) <= len(strip.triangulation.steps)
    assert tolerance_of(made.shell) <= EDGE_TOLERANCE
    assert faults_after_step(made.shell, path, tolerance=EDGE_TOLERANCE) == []
    assert largest_turn(reread(made.shell, path)) <= 0.01
    p, q = strip.triangulation.p, strip.triangulation.q
    ends = sum(float(np.linalg.norm(p[at] - q[at])) for at in (0, -1))
    border = sum(length_of(edge) for edge in free_edges(made.shell))
    assert border == pytest.approx(strip.p.length + strip.q.length + ends, rel=1e-8)


def test_a_convolute_auger_flight_is_one_face(tmp_path: Path) -> None:
    strip = strip_between(auger_rail(10.0), auger_rail(30.0))
    made = smooth(strip)
    assert len(faces_of(made.shell)) == 1
    assert area_of(made.shell, relative_error=1e-9) == pytest.approx(3211.938171, rel=1e-8)
    check_sound(strip, made, tmp_path / "auger.step")


@pytest.mark.parametrize("other", [arc(30.0, x=15.0, z=80.0), arc(30.0, x=10.0, z=80.0, tilt=15.0)])
def test_half_a_reducer_eccentric_or_tilted_is_one_face(
    other: TopoDS_Shape, tmp_path: Path
) -> None:
    strip = strip_between(arc(50.0), other)
    made = smooth(strip)
    assert len(faces_of(made.shell)) == 1
    check_sound(strip, made, tmp_path / "reducer.step")


def test_half_a_frustum_has_its_area() -> None:
    made = smooth(strip_between(arc(50.0), arc(30.0, z=80.0)))
    assert len(faces_of(made.shell)) == 1
    wanted = math.pi / 2.0 * 80.0 * math.hypot(20.0, 80.0)
    assert area_of(made.shell, relative_error=1e-9) == pytest.approx(wanted, rel=1e-8)


@pytest.mark.slow
def test_rails_that_meet_have_a_smooth_strip(tmp_path: Path) -> None:
    strip = strip_between(*lens_edges())
    made = smooth(strip)
    assert len(made.path.runs) >= 3
    check_sound(strip, made, tmp_path / "lens.step")


@pytest.mark.parametrize("seed", seeds(60, 1))
def test_wavy_rails_of_any_degree_have_a_sound_smooth_strip(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng([130, seed])
    p, q = (
        random_edge(rng, y, int(rng.integers(2, 10)), is_rational=seed % 3 == 0)
        for y in (0.0, 30.0)
    )
    strip = strip_between(p, q)
    check_sound(strip, smooth(strip), tmp_path / "wavy.step")


def test_planes_stay_planes() -> None:
    flat = strip_between(arc(50.0), arc(70.0))
    assert len(faces_of(smooth(flat).shell)) == 1
    assert smooth(flat).path.runs == ()
    bent = [(0.0, 0.0), (40.0, 0.0), (70.0, 30.0)]
    rails = [b3d.Polyline(*[(x, y, z) for x, y in bent]).wrapped for z in (0.0, 20.0)]
    assert len(faces_of(smooth(strip_between(*rails)).shell)) == 2

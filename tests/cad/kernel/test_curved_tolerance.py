from __future__ import annotations

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Pnt

from wrinkle_cad.cad.kernel.mesh import mesh_of

RADIUS = 30.0
FINE, COARSE = 0.01, 0.3


def test_faces_curved_both_ways_are_meshed_to_a_tolerance_of_their_own_without_gaps() -> None:
    ball = BRepPrimAPI_MakeSphere(RADIUS).Shape()
    half = BRepPrimAPI_MakeBox(gp_Pnt(-40.0, -40.0, 5.0), gp_Pnt(40.0, 40.0, 40.0)).Shape()
    shape = BRepAlgoAPI_Common(ball, half).Shape()
    fine, _ = mesh_of(shape, tolerance=FINE)
    points, triangles = mesh_of(shape, tolerance=FINE, curved_tolerance=COARSE)
    assert len(points) < 0.5 * len(fine)
    _, same = np.unique(np.round(points, 6), axis=0, return_inverse=True)
    corners = same.reshape(-1)[triangles]
    # At the pole of the ball the kernel makes triangles without area.
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert set(count) == {2}
    on_disc = (np.abs(points[triangles][:, :, 2] - 5.0) < 1e-9).all(axis=1)
    area = np.linalg.norm(
        np.cross(*np.diff(points[triangles[on_disc]], axis=1).swapaxes(0, 1)), axis=1
    )
    radius = np.sqrt(RADIUS**2 - 25.0)
    lost = np.pi * radius**2 - 0.5 * area.sum()
    assert 0.0 < lost < 2.0 * np.pi * radius * FINE
    middles = points[triangles[~on_disc]].mean(axis=1)
    assert np.max(RADIUS - np.sqrt((middles**2).sum(axis=1))) < COARSE

"""Folding the flat facets back along their rulings must give the strip in space."""

from __future__ import annotations

import numpy as np
import pytest

from tests.pattern import strips
from tests.pattern.strips import one_piece
from wrinkle_cad.pattern.piece.options import PieceSettings


def folded(flat_p, flat_q, bridges, fold):
    """Folds flat facets in space: mountains (positive folds) bend away from the right side."""
    p = np.full((len(flat_p), 3), np.nan)
    q = np.full((len(flat_q), 3), np.nan)
    normal = np.array((0.0, 0.0, 1.0))
    angles = np.concatenate(([0.0], fold))
    for (i, j), (h, k), angle in zip(bridges[:-1], bridges[1:], angles, strict=True):
        if np.isnan(p[0, 0]):
            p[0, :2], q[0, :2], p[0, 2], q[0, 2] = flat_p[0], flat_q[0], 0.0, 0.0
            new = np.append(flat_p[h] if h > i else flat_q[k], 0.0)
        else:
            flat_along = flat_q[j] - flat_p[i]
            length = np.linalg.norm(flat_along)
            flat_along = flat_along / length
            along = (q[j] - p[i]) / length
            forward = np.cross(along, normal)
            normal = np.cos(angle) * normal + np.sin(angle) * forward
            forward = np.cross(along, normal)
            step = (flat_p[h] if h > i else flat_q[k]) - flat_p[i]
            ahead = step @ (flat_along[1], -flat_along[0])
            new = p[i] + (step @ flat_along) * along + ahead * forward
        if h > i:
            p[h] = new
        else:
            q[k] = new
    return np.vstack((p, q))


def distance_after_best_motion(points, target):
    centred, aim = points - points.mean(axis=0), target - target.mean(axis=0)
    left, _, right = np.linalg.svd(centred.T @ aim)
    flip = np.diag((1.0, 1.0, np.sign(np.linalg.det(left @ right))))
    return float(np.abs(centred @ left @ flip @ right - aim).max())


CASES = {
    "cylinder": strips.cylinder,
    "inside of a cylinder": lambda: strips.cylinder(inward=True),
    "lens": strips.lens,
    "ramp": lambda: strips.ramp(turns=0.8),
    "random": lambda: strips.random_strip(7),
    "random, tapering": lambda: strips.random_strip(10),
}


@pytest.mark.parametrize("case", CASES)
def test_flat_facets_fold_back_into_the_strip(case):
    unrolling, triangulation = CASES[case]()
    space = np.vstack((triangulation.p, triangulation.q))
    size = np.ptp(space, axis=0).max()
    made = folded(unrolling.p, unrolling.q, triangulation.bridges, triangulation.fold)
    assert distance_after_best_motion(made, space) < 1e-9 * size


@pytest.mark.parametrize("case", CASES)
def test_the_piece_in_memory_folds_back_into_the_strip(case):
    unrolling, triangulation = CASES[case]()
    settings = PieceSettings(tolerance=1e-6, rulings=True)
    piece = one_piece(unrolling, triangulation, name="strip", settings=settings)
    inner = triangulation.bridges[1:-1]
    p, q = np.full((len(unrolling.p), 2), np.nan), np.full((len(unrolling.q), 2), np.nan)
    p[inner[:, 0]], q[inner[:, 1]] = piece.rulings[:, 0], piece.rulings[:, 1]
    p[0] = 0.0
    outline = {tuple(np.round(point, 7)) for point in piece.sew_line}
    known = {tuple(np.round(point, 7)) for point in np.vstack((p, q)) if not np.isnan(point[0])}
    assert known - {(0.0, 0.0)} <= outline
    used = ~np.isnan(np.vstack((p, q))[:, 0])
    p[np.isnan(p)], q[np.isnan(q)] = 0.0, 0.0
    flat_q0 = piece.sew_line[-1] if len(piece.sew_line) == len(p) + len(q) else p[0]
    q[0] = q[0] if used[len(p)] else flat_q0
    made = folded(p, q, triangulation.bridges, piece.ruling_fold)
    space = np.vstack((triangulation.p, triangulation.q))
    size = np.ptp(space, axis=0).max()
    assert distance_after_best_motion(made[used], space[used]) < 1e-9 * size


def test_folding_the_wrong_way_is_noticed():
    unrolling, triangulation = strips.cylinder()
    space = np.vstack((triangulation.p, triangulation.q))
    made = folded(unrolling.p, unrolling.q, triangulation.bridges, -triangulation.fold)
    assert distance_after_best_motion(made, space) > 1.0


def test_the_outside_of_a_cylinder_has_mountains_only():
    unrolling, triangulation = strips.cylinder()
    piece = one_piece(unrolling, triangulation, name="tube", settings=PieceSettings(rulings=True))
    folds = piece.ruling_fold[np.abs(piece.ruling_fold) > 1e-9]
    assert np.all(folds > 0.0)
    assert folds.sum() == pytest.approx(2.0 * 58 / 59)

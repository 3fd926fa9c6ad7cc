"""The offset of a triangulated surface, its corners mitred so that it is as thick everywhere."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from .curve.polyline import row_lengths
from .portable import dot

Floats = NDArray[np.float64]

_STIFFNESS: Final = 1e-5
"""How strongly a corner keeps to the mean normal, against a plane's 1: without it, the corner of a
narrow fan would run away along it."""


def mitred_directions(points: Floats, triangles: NDArray[np.int64]) -> Floats:
    """Returns (k, 3) where each point goes for an offset by 1, so that all planes move by 1.

    Args:
        points: (k, 3) float64, mm.
        triangles: (t, 3) int64, indices into the points, all turning alike.

    Example:
        >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
        >>> mitred_directions(points, np.array([[0, 1, 2]])).tolist()
        [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
    """
    normals = triangle_normals(points, triangles)
    # Least squares of n . m = 1 over the planes at a point, held by its mean normal.
    products = np.zeros((len(points), 3, 3))
    sums = np.zeros((len(points), 3))
    counts = np.zeros(len(points))
    for corner in range(3):
        np.add.at(products, triangles[:, corner], normals[:, :, None] * normals[:, None, :])
        np.add.at(sums, triangles[:, corner], normals)
        np.add.at(counts, triangles[:, corner], 1.0)
    mean = sums / np.maximum(row_lengths(sums), 1e-12)[:, None]
    held = (_STIFFNESS * counts)[:, None]
    return _solved(products + held[:, :, None] * np.eye(3), sums + held * mean)


def triangle_normals(points: Floats, triangles: NDArray[np.int64]) -> Floats:
    """Returns (t, 3) unit normals; zeros for a triangle without area."""
    corners = points[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(across / np.maximum(row_lengths(across), 1e-300)[:, None])


def _solved(matrix: Floats, right: Floats) -> Floats:
    """Cramer's rule for (k, 3, 3) and (k, 3): the same on every processor."""
    a, b, c = np.moveaxis(matrix, 2, 0)
    across = (np.cross(b, c), np.cross(c, a), np.cross(a, b))
    determinant = dot(a, across[0])
    return np.stack([dot(right, row) / determinant for row in across], axis=1)

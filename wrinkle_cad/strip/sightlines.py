"""One row of bridges, each seen along its own line: what convexity and bending are read from.

A bridge's neighbours are p[i-1], p[i+1], q[j-1], q[j+1]. Seen along the bridge they are four
plane vectors; at the end of a directrix the missing neighbour is the zero vector.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .compiled import compiled, inlined

Floats = npt.NDArray[np.float64]

LENGTH = 0
BEFORE_P, NEXT_P, BEFORE_Q, NEXT_Q = 1, 3, 5, 7
"""Rows of a view: the bridge's length, then x and y of each neighbour (x here, y one further)."""

VIEW_ROWS = 9


def padded_banks(rail: Floats) -> Floats:
    """Returns the bank edges of a rail between two zero ones, one coordinate per row.

    Args:
        rail: (k, 3) float64, mm.

    Returns:
        (3, k+1) float64, mm; column i is rail[i] - rail[i-1], zero for i = 0 and i = k.
    """
    banks = np.zeros((3, rail.shape[0] + 1))
    banks[:, 1:-1] = np.diff(rail, axis=0).T
    return banks


@compiled
def bank_lengths(banks: Floats) -> Floats:
    """Returns the length in mm of each column of padded_banks."""
    lengths: Floats = np.sqrt(banks[0] ** 2 + banks[1] ** 2 + banks[2] ** 2)
    return lengths


@inlined
def frame_of(
    x: float, y: float, z: float
) -> tuple[float, float, float, float, float, float, float]:
    """Returns the length of a bridge and two axes that stand square on it.

    The frame is that of Duff et al., "Building an orthonormal basis, revisited", Journal of
    Computer Graphics Techniques 6(1), 2017: no square root, no branch. A bridge of zero length gets
    the frame of the third axis.

    Args:
        x: mm; with y and z the bridge from P to Q.
        y: mm; see x.
        z: mm; see x.
    """
    size = np.sqrt(x * x + y * y + z * z)
    inverse = 1.0 / size if size > 0.0 else 0.0
    ex, ey = x * inverse, y * inverse
    ez = z * inverse if size > 0.0 else 1.0
    sign = 1.0 if ez >= 0.0 else -1.0
    a = -1.0 / (sign + ez)
    b = ex * ey * a
    return size, 1.0 + sign * ex * ex * a, sign * b, -sign * ex, b, sign + ey * ey * a, -ey


@compiled
def _frames(start: Floats, q: Floats, length: Floats, first: Floats, second: Floats) -> None:
    """Writes the lengths of bridges and two axes (3, n) that stand square on each."""
    x, y, z = start[0], start[1], start[2]
    qx, qy, qz = q[0], q[1], q[2]
    ux, uy, uz = first[0], first[1], first[2]
    vx, vy, vz = second[0], second[1], second[2]
    for j in range(length.size):
        length[j], ux[j], uy[j], uz[j], vx[j], vy[j], vz[j] = frame_of(
            qx[j] - x, qy[j] - y, qz[j] - z
        )


@compiled
def _project_one(vector: Floats, sign: float, axis: Floats, offset: Floats) -> None:
    """Writes the components of one vector along many axes (3, n)."""
    x, y, z = sign * vector[0], sign * vector[1], sign * vector[2]
    ux, uy, uz = axis[0], axis[1], axis[2]
    for j in range(offset.size):
        offset[j] = x * ux[j] + y * uy[j] + z * uz[j]


@compiled
def _project_each(vectors: Floats, sign: float, axis: Floats, offset: Floats) -> None:
    """Writes the component of each vector (3, n) along its axis (3, n)."""
    x, y, z = vectors[0], vectors[1], vectors[2]
    ux, uy, uz = axis[0], axis[1], axis[2]
    for j in range(offset.size):
        offset[j] = sign * (x[j] * ux[j] + y[j] * uy[j] + z[j] * uz[j])


@compiled
def look_along(start: Floats, p_banks: Floats, q: Floats, q_banks: Floats, view: Floats) -> None:
    """Fills a view with the bridges from one sample of P to samples of Q.

    Args:
        start: (3,) float64, mm; the sample of P.
        p_banks: (3, 2) float64, mm; the bank edges before and after it (padded_banks).
        q: (3, n) float64, mm; the samples of Q, one coordinate per row.
        q_banks: (3, n+1) float64, mm; padded_banks of Q.
        view: (9, n) float64, mm; written. Rows as named by LENGTH, BEFORE_P, ... The offsets stand
            in a right-handed frame whose third axis is the bridge from P to Q. The frame itself is
            of no meaning: only products of two offsets of one bridge are.
    """
    count = q.shape[1]
    axes = np.empty((2, 3, count))
    _frames(start, q, view[LENGTH], axes[0], axes[1])
    for row in range(2):
        _project_one(p_banks[:, 0], -1.0, axes[row], view[BEFORE_P + row])
        _project_one(p_banks[:, 1], 1.0, axes[row], view[NEXT_P + row])
        _project_each(q_banks[:, :count], -1.0, axes[row], view[BEFORE_Q + row])
        _project_each(q_banks[:, 1:], 1.0, axes[row], view[NEXT_Q + row])


@compiled
def look_along_path(
    p: Floats, p_banks: Floats, q: Floats, q_banks: Floats, bridges: npt.NDArray[np.int64]
) -> Floats:
    """Returns the view of the bridges on a path.

    Args:
        p: (m, 3) float64, mm; samples of P.
        p_banks: (3, m+1) float64, mm; padded_banks of P.
        q: (3, n) float64, mm; samples of Q, one coordinate per row.
        q_banks: (3, n+1) float64, mm; padded_banks of Q.
        bridges: (k, 2) int64; i, j of each bridge.

    Returns:
        (9, k) float64, mm; rows as in look_along.
    """
    view = np.empty((VIEW_ROWS, bridges.shape[0]))
    for number in range(bridges.shape[0]):
        i, j = bridges[number]
        look_along(
            p[i],
            p_banks[:, i : i + 2],
            q[:, j : j + 1],
            q_banks[:, j : j + 2],
            view[:, number : number + 1],
        )
    return view

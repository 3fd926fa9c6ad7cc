"""One row of bridges, each seen along its own line: what convexity and bending are read from.

A bridge's neighbours are p[i-1], p[i+1], q[j-1], q[j+1]. Seen along the bridge they are four
plane vectors; at the end of a directrix the missing neighbour is the zero vector.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .compiled import compiled

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
    bx, by, bz = -p_banks[0, 0], -p_banks[1, 0], -p_banks[2, 0]
    nx, ny, nz = p_banks[0, 1], p_banks[1, 1], p_banks[2, 1]
    for j in range(q.shape[1]):
        ex, ey, ez = q[0, j] - start[0], q[1, j] - start[1], q[2, j] - start[2]
        length = np.sqrt(ex * ex + ey * ey + ez * ez)
        # A bridge of zero length gets the frame of the third axis.
        inverse = 1.0 / length if length > 0.0 else 0.0
        ex, ey = ex * inverse, ey * inverse
        ez = ez * inverse if length > 0.0 else 1.0
        # A frame without square root or branch: Duff et al., "Building an orthonormal basis,
        # revisited", Journal of Computer Graphics Techniques 6(1), 2017.
        sign = np.copysign(1.0, ez)
        a = -1.0 / (sign + ez)
        b = ex * ey * a
        ux, uy, uz = 1.0 + sign * ex * ex * a, sign * b, -sign * ex
        vx, vy, vz = b, sign + ey * ey * a, -ey
        qx, qy, qz = q_banks[0, j], q_banks[1, j], q_banks[2, j]
        rx, ry, rz = q_banks[0, j + 1], q_banks[1, j + 1], q_banks[2, j + 1]
        view[0, j] = length
        view[1, j] = bx * ux + by * uy + bz * uz
        view[2, j] = bx * vx + by * vy + bz * vz
        view[3, j] = nx * ux + ny * uy + nz * uz
        view[4, j] = nx * vx + ny * vy + nz * vz
        view[5, j] = -(qx * ux + qy * uy + qz * uz)
        view[6, j] = -(qx * vx + qy * vy + qz * vz)
        view[7, j] = rx * ux + ry * uy + rz * uz
        view[8, j] = rx * vx + ry * vy + rz * vz


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

"""Local convexity: which bridges lie on the convex hull of the six points around them.

Seen along the bridge, its (at most four) neighbours must fit in a closed half-plane. That says the
same as the hull of the six points (the Proposition in section 3.2 of Wang and Tang, "Developable
triangulations of a strip") and needs no hull.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .compiled import compiled
from .rails import checked_planarity, checked_rails
from .sightlines import VIEW_ROWS, look_along, padded_banks

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@compiled
def _supports(view: Floats, j: int, neighbour: int, planarity: float) -> bool:
    """Whether the plane through the bridge and this neighbour has all others on one side."""
    x, y = view[neighbour, j], view[neighbour + 1, j]
    lowest = highest = 0.0
    for other in range(1, VIEW_ROWS, 2):
        side = x * view[other + 1, j] - y * view[other, j]
        lowest = min(lowest, side)
        highest = max(highest, side)
    slack = planarity * np.sqrt(x * x + y * y)
    return bool(lowest >= -slack or highest <= slack)


@compiled
def judge_row(view: Floats, planarity: float, valid: Bools) -> None:
    """Writes which bridges of a view are locally convex.

    Args:
        view: (9, n) float64, mm; bridges as look_along fills them in.
        planarity: mm; how far a neighbour may lie on the wrong side. Neighbours this close to the
            bridge's line give no plane, and a bridge this short is valid.
        valid: (n,) bool; written.
    """
    limit = planarity * planarity
    for j in range(view.shape[1]):
        is_supported = False
        is_free = True
        for neighbour in range(1, VIEW_ROWS, 2):
            x, y = view[neighbour, j], view[neighbour + 1, j]
            is_plane = x * x + y * y > limit
            is_free = is_free and not is_plane
            is_supported = is_supported or (is_plane and _supports(view, j, neighbour, planarity))
        valid[j] = is_supported or is_free or view[0, j] <= planarity


@compiled
def _judge_all(
    p: Floats, p_banks: Floats, q: Floats, q_banks: Floats, planarity: float, valid: Bools
) -> None:
    view = np.empty((VIEW_ROWS, q.shape[1]))
    for i in range(p.shape[0]):
        look_along(p[i], p_banks[:, i : i + 2], q, q_banks, view)
        judge_row(view, planarity, valid[i])


def validity_matrix(p: npt.ArrayLike, q: npt.ArrayLike, *, planarity: float | None = None) -> Bools:
    """Returns which of the m x n bridges between two rails are locally convex.

    A bridge is valid if, seen along it, some neighbour `a` has every other neighbour on one side of
    the plane through the bridge and `a`. A neighbour on the bridge's own line says nothing and is
    left out as `a`. Bridges of zero length, where the rails meet, are valid.

    Args:
        p: (m, 3) float, mm; samples of directrix P.
        q: (n, 3) float, mm; samples of directrix Q.
        planarity: mm; how far a neighbour may lie on the wrong side, and from the bridge's line to
            count as on it. By default a thousandth of the rails' median sagitta.

    Returns:
        (m, n) bool, read-only; entry [i, j] is bridge p[i] q[j].

    Raises:
        InputError: a rail is no (k, 3) array of finite points, both are single points, or
            planarity is negative.

    Example:
        >>> bent = [[0, 0, 0], [1, 0, 1], [2, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]]
        >>> validity_matrix(*bent).astype(int).tolist()
        [[1, 1, 1], [1, 1, 1], [1, 1, 1]]
    """
    p, q = checked_rails(p, q)
    limit = checked_planarity(p, q, planarity)
    valid = np.empty((p.shape[0], q.shape[0]), dtype=np.bool_)
    columns = np.ascontiguousarray(q.T)
    _judge_all(p, padded_banks(p), columns, padded_banks(q), limit, valid)
    valid.flags.writeable = False
    return valid

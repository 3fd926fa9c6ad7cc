"""Local convexity: which bridges lie on the convex hull of the six points around them.

Seen along the bridge, its (at most four) neighbours must fit in a closed half-plane. That says the
same as the hull of the six points (the Proposition in section 3.2 of Wang and Tang, "Developable
triangulations of a strip") and needs no hull.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .compiled import compiled, inlined
from .rails import checked_planarity, checked_rails
from .sightlines import VIEW_ROWS, look_along, padded_banks

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@inlined
def _holds(first: float, second: float, third: float, slack: float) -> bool:
    """Whether three points lie on one side of a plane, each by the distance that is its side."""
    lowest = min(min(min(0.0, first), second), third)
    highest = max(max(max(0.0, first), second), third)
    return bool(lowest >= -slack or highest <= slack)


@inlined
def is_convex(
    length: float,
    squares: tuple[float, float, float, float],
    heights: tuple[float, float, float, float],
    sides: tuple[float, float, float, float, float, float],
    planarity: float,
) -> bool:
    """Whether a bridge is locally convex, by what is seen along it; without branches.

    Args:
        length: mm; of the bridge.
        squares: mm2; its neighbours' distances from its line, squared: before and after it on P,
            before and after it on Q.
        heights: mm; the roots of these.
        sides: mm2; on which side of each neighbour the later ones lie: 12, 13, 14, 23, 24, 34.
        planarity: mm; see judge_row.
    """
    limit = planarity * planarity
    s12, s13, s14, s23, s24, s34 = sides
    a, b, c, d = squares[0] > limit, squares[1] > limit, squares[2] > limit, squares[3] > limit
    is_supported = a and _holds(s12, s13, s14, planarity * heights[0])
    is_supported = is_supported or (b and _holds(-s12, s23, s24, planarity * heights[1]))
    is_supported = is_supported or (c and _holds(-s13, -s23, s34, planarity * heights[2]))
    is_supported = is_supported or (d and _holds(-s14, -s24, -s34, planarity * heights[3]))
    return bool(is_supported or not (a or b or c or d) or length <= planarity)


@compiled
def judge_row(view: Floats, planarity: float, valid: Bools) -> None:
    """Writes which bridges of a view are locally convex.

    Args:
        view: (9, n) float64, mm; bridges as look_along fills them in.
        planarity: mm; how far a neighbour may lie on the wrong side. Neighbours this close to the
            bridge's line give no plane, and a bridge this short is valid.
        valid: (n,) bool; written.
    """
    length, x1, y1, x2, y2 = view[0], view[1], view[2], view[3], view[4]
    x3, y3, x4, y4 = view[5], view[6], view[7], view[8]
    for j in range(view.shape[1]):
        squares = (
            x1[j] * x1[j] + y1[j] * y1[j],
            x2[j] * x2[j] + y2[j] * y2[j],
            x3[j] * x3[j] + y3[j] * y3[j],
            x4[j] * x4[j] + y4[j] * y4[j],
        )
        sides = (
            x1[j] * y2[j] - y1[j] * x2[j],
            x1[j] * y3[j] - y1[j] * x3[j],
            x1[j] * y4[j] - y1[j] * x4[j],
            x2[j] * y3[j] - y2[j] * x3[j],
            x2[j] * y4[j] - y2[j] * x4[j],
            x3[j] * y4[j] - y3[j] * x4[j],
        )
        heights = (
            np.sqrt(squares[0]),
            np.sqrt(squares[1]),
            np.sqrt(squares[2]),
            np.sqrt(squares[3]),
        )
        valid[j] = is_convex(length[j], squares, heights, sides, planarity)


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

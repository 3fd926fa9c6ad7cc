"""Where a strip passes through itself in space: triangles that cut triangles further along it.

Pairs are found by a tree of boxes over runs of triangles: neighbours along a strip are neighbours
in space, so the runs themselves are the tree. A strip that merely touches itself, as a tube cut
open does along its seam, does not pass through itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import CROSSING_PER_SIZE

from .compiled import compiled
from .places import outstanding
from .rails import coarser_sagitta
from .triangle_pairs import cut_of
from .triangulation import Triangulation

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

_LEAF: Final = 4
"""Triangles in a run that is not split further."""


@dataclass(frozen=True, slots=True, eq=False)
class SelfCrossings:
    """Triangles of a strip that pass through others; every array is read-only.

    Example:
        >>> from wrinkle_cad.strip import triangulate
        >>> self_crossings(triangulate([[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]])).count
        0
    """

    triangles: Indices
    """(k,) int64, increasing; triangles that cut another one."""
    partners: Indices
    """(k,) int64; the other triangle that each of them cuts furthest."""
    points: Floats
    """(k, 3) float64, mm; the middle of what each pair has in common."""
    lengths: Floats
    """(k,) float64, mm; how far each pair cuts: how long what they have in common is."""

    @property
    def count(self) -> int:
        """How many triangles cut another one."""
        return len(self.triangles)

    @property
    def place(self) -> Floats:
        """(3,) float64, mm: where the strip cuts itself furthest, whichever way its rails run.

        Raises:
            IndexError: it does not cut itself.
        """
        place: Floats = self.points[outstanding(self.lengths, self.points)]
        return place


def self_crossings(triangulation: Triangulation) -> SelfCrossings:
    """Finds where a strip passes through itself.

    Two triangles cut each other if each reaches through the other's plane and both meet along more
    than a point, or if they lie in one plane and cover each other. Pairs that share a bridge are
    left out: what they can do is fold back, which is counted apart. Layers nearer to each other
    than the chords are to their curves count as one. A strip that cuts itself precisely along two
    of its bridges is not seen, nor is a cut shorter than the typical sagitta.

    Args:
        triangulation: the strip.

    Returns:
        The triangles that cut others, without arrays' entries where there are none.

    Example:
        >>> import numpy as np
        >>> from wrinkle_cad.strip import self_crossings, triangulate
        >>> s = np.linspace(0.0, 1.0, 61)
        >>> t = 2 * s - 1
        >>> loop = np.column_stack((60 * t**3 - 40 * t, 0 * s, 30 * (1 - t * t)))
        >>> crossings = self_crossings(triangulate(loop, loop + [0.0, 15.0, 0.0]))
        >>> bool(crossings.count), bool(np.abs(crossings.points[:, 0]).max() < 1e-6)
        (True, True)
    """
    points = np.ascontiguousarray(np.vstack((triangulation.p, triangulation.q)))
    size = float(np.ptp(points, axis=0).max())
    sagitta = coarser_sagitta(triangulation.p, triangulation.q)
    length = max(min(sagitta, CROSSING_PER_SIZE * size), triangulation.planarity)
    corners = np.ascontiguousarray(triangulation.triangles)
    partners, cuts = _partners(points, corners, triangulation.planarity, length)
    (cutting,) = np.nonzero(partners >= 0)
    places, lengths = cuts[cutting, 1:].copy(), cuts[cutting, 0].copy()
    found = SelfCrossings(cutting.astype(np.int64), partners[cutting], places, lengths)
    for array in (found.triangles, found.partners, found.points, found.lengths):
        array.flags.writeable = False
    return found


@compiled
def _partners(
    points: Floats, corners: Indices, planarity: float, length: float
) -> tuple[Indices, Floats]:
    """The other triangle that each triangle cuts furthest, -1 if none; how far, and where."""
    count = corners.shape[0]
    leaves, limits = 1, (planarity, length)
    while leaves * _LEAF < count:
        leaves *= 2
    boxes = _boxes(points, corners, leaves)
    partners, cuts = np.full(count, -1, dtype=np.int64), np.zeros((count, 4))
    # Each pair taken off puts at most four of the next level on.
    stack = np.empty((4 * 64, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1] = 1, 1
    top = 0
    while top >= 0:
        a, b = stack[top, 0], stack[top, 1]
        top -= 1
        if a != b and _are_apart(boxes, a, b):
            continue
        if a >= leaves:
            _cut_in_leaves(points, corners, (a - leaves, b - leaves), limits, partners, cuts)
            continue
        for k in range(2):
            for other in range(2 if a != b else k + 1):
                top += 1
                stack[top, 0], stack[top, 1] = 2 * a + other, 2 * b + k
    return partners, cuts


@compiled
def _cut_in_leaves(
    points: Floats,
    corners: Indices,
    leaves: tuple[int, int],
    limits: tuple[float, float],
    partners: Indices,
    cuts: Floats,
) -> None:
    """Looks at all pairs of triangles of two runs that are not split further."""
    count = corners.shape[0]
    first, second = leaves[0] * _LEAF, leaves[1] * _LEAF
    for i in range(first, min(count, first + _LEAF)):
        for j in range(max(i + 1, second), min(count, second + _LEAF)):
            cut = cut_of(points, corners, i, j, *limits)
            for k in range(2):
                own, other = (i, j) if k == 0 else (j, i)
                if cut[0] > cuts[own, 0]:
                    partners[own] = other
                    for axis in range(4):
                        cuts[own, axis] = cut[axis]


@compiled
def _boxes(points: Floats, corners: Indices, leaves: int) -> Floats:
    """(2 * leaves, 6): lowest and highest coordinates of runs; 1 is all, 2k and 2k+1 halve k."""
    boxes = np.empty((2 * leaves, 6))
    for node in range(2 * leaves):
        for axis in range(3):
            boxes[node, axis], boxes[node, 3 + axis] = np.inf, -np.inf
    for i in range(corners.shape[0]):
        leaf = leaves + i // _LEAF
        for k in range(3):
            for axis in range(3):
                x = points[corners[i, k], axis]
                boxes[leaf, axis] = min(boxes[leaf, axis], x)
                boxes[leaf, 3 + axis] = max(boxes[leaf, 3 + axis], x)
    for node in range(leaves - 1, 0, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node, axis], boxes[2 * node + 1, axis])
            boxes[node, 3 + axis] = max(boxes[2 * node, 3 + axis], boxes[2 * node + 1, 3 + axis])
    return boxes


@compiled
def _are_apart(boxes: Floats, a: int, b: int) -> bool:
    for axis in range(3):
        if boxes[a, axis] > boxes[b, 3 + axis] or boxes[b, axis] > boxes[a, 3 + axis]:
            return True
    return False

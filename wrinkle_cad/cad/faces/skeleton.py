"""Vertices and edges of a strip, each made once: what its faces share.

Bridges without length are one vertex. A fan too thin to be a face is left out, and its longest
border is replaced by the other two, so that the faces beside it still share all of their edges.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Vertex

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.topology import make_vertex
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.errors import CadError
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.portable import norm
from wrinkle_cad.strip.triangulation import P_STEP, Triangulation

from .face_borders import (
    Border,
    border_poles,
    curved_edge,
    flipped,
    loosen,
    straight_edge,
    sub_curve,
)
from .fans import Bank, Fan

Floats = NDArray[np.float64]


def thin_limit(triangulation: Triangulation) -> float:
    """Returns mm: a face no wider than this is left out; rails within twice this meet."""
    size = float(np.ptp(np.vstack((triangulation.p, triangulation.q)), axis=0).max())
    return max(settings.CONFUSION, min(settings.THIN_FACE, settings.THIN_FACE_PER_SIZE * size))


class Skeleton:
    """The vertices and edges of a strip, made when they are first asked for."""

    def __init__(
        self,
        triangulation: Triangulation,
        rails: tuple[Directrix, Directrix],
        samples: tuple[Samples, Samples],
        *,
        has_curves: bool,
    ) -> None:
        self.limit = thin_limit(triangulation)
        self._path = triangulation.bridges
        self._rails = rails
        self._parameters = tuple(rail.parameters for rail in samples)
        self._has_curves = has_curves
        self._owner, self.points = _merged(triangulation, 2.0 * self.limit)
        self._is_closed = _closes(triangulation, rails)
        if self._is_closed:
            for first, last in ((0, len(triangulation.p) - 1), (len(triangulation.p), -1)):
                self._owner[last] = self._owner[first]
        self._starts = (0, len(triangulation.p))
        self._vertices: dict[int, TopoDS_Vertex] = {}
        self._bridges: dict[int, Border] = {}
        self._banks: dict[Bank, Border] = {}
        self._replaced: dict[int, tuple[Fan, float]] = {}

    def corner(self, side: int, index: int) -> int:
        """Returns the number of the vertex at a sample of P (side P_STEP) or Q (side Q_STEP)."""
        return int(self._owner[self._starts[side] + index])

    def vertex(self, corner: int) -> TopoDS_Vertex:
        """Returns the vertex of a corner."""
        if corner not in self._vertices:
            self._vertices[corner] = make_vertex(self.points[corner])
        return self._vertices[corner]

    def parameters(self, bank: Bank) -> Floats:
        """Returns (k,): parameters of the rail at the samples along a bank."""
        return self._parameters[bank.side][bank.start : bank.end + 1]

    def bank(self, bank: Bank) -> Border:
        """Returns the border along a bank, in the direction of its rail."""
        if bank not in self._banks:
            self._banks[bank] = self._make_bank(bank)
        return self._banks[bank]

    def bridge(self, at: int) -> Border:
        """Returns the border along a bridge of the path, from P to Q; empty if it has no length."""
        if at not in self._bridges:
            if at in self._replaced:
                self._bridges[at] = self._around(at, *self._replaced[at])
            elif self._is_closed and at == len(self._path) - 1 and 0 not in self._replaced:
                self._bridges[at] = self.bridge(0)
            else:
                i, j = self._path[at].tolist()
                self._bridges[at] = self._line(self.corner(0, i), self.corner(1, j))
        return self._bridges[at]

    def leave_out(self, fan: Fan) -> bool:
        """Leaves a fan out if it is too thin for a face, and tells whether it is.

        To be asked of all thin fans before any bridge is asked for.

        Raises:
            CadError: two such fans both have the bridge between them as their longest border.
        """
        bank = fan.bank
        at = [self.corner(bank.side, bank.start), self.corner(bank.side, bank.end)]
        start, end, apex = self.points[[*at, self.corner(1 - bank.side, fan.apex)]]
        spans = [norm(b - a) for a, b in ((start, apex), (end, apex), (start, end))]
        ends = ((start, apex), (end, apex), (start, end))[int(np.argmax(spans))]
        gap = _largest_gap(np.vstack((border_poles(self.bank(bank)), start, end, apex)), *ends)
        if gap > self.limit:
            return False
        # On a tie, as where the rails meet, the rail itself stays and the bridge goes.
        if max(spans[:2]) >= (1.0 - 1e-9) * spans[2]:
            bridge = fan.early if spans[0] > spans[1] else fan.late
            if bridge in self._replaced:
                raise CadError(
                    "make the faces of a strip",
                    f"two faces side by side at bridge {bridge} are thinner than {self.limit:.1e}"
                    " mm. Sample the rails more finely or move them apart.",
                )
            self._replaced[bridge] = (fan, gap)
        return True

    def _around(self, at: int, fan: Fan, gap: float) -> Border:
        """Returns the border that stands for a bridge of a fan left out: its other two."""
        bank, is_p = self.bank(fan.bank), fan.bank.side == P_STEP
        if at == fan.late:
            other = self.bridge(fan.early)
            border = (*flipped(bank), *other) if is_p else (*other, *bank)
        else:
            other = self.bridge(fan.late)
            border = (*bank, *other) if is_p else (*other, *flipped(bank))
        loosen(border, settings.CONFUSION + gap)
        return border

    def _line(self, start: int, end: int) -> Border:
        if start == end:
            return ()
        ends = self.points[[start, end]]
        return (straight_edge(self.vertex(start), self.vertex(end), ends),)

    def _make_bank(self, bank: Bank) -> Border:
        rail = self._rails[bank.side]
        start, end = self.corner(bank.side, bank.start), self.corner(bank.side, bank.end)
        first, last = self._parameters[bank.side][[bank.start, bank.end]].tolist()
        piece = int(rail.piece_at(np.array([(first + last) / 2.0]))[0])
        if rail.pieces[piece].degree == 1 or not self._has_curves:
            return self._line(start, end)
        # Sampling skips edges shorter than its shortest chord; a bank then starts in such an edge.
        low, high = (float(knot) for knot in rail.pieces[piece].knots[[0, -1]])
        part = sub_curve(rail.curves[piece], max(first, low), min(last, high))
        ends = self.points[[start, end]]
        return (curved_edge(part, self.vertex(start), self.vertex(end), ends),)


def _closes(triangulation: Triangulation, rails: tuple[Directrix, Directrix]) -> bool:
    """Whether the last bridge of a strip is its first one again."""
    return all(rail.is_closed for rail in rails) and all(
        len(points) > 2 and np.array_equal(points[0], points[-1])
        for points in (triangulation.p, triangulation.q)
    )


def _largest_gap(points: Floats, start: Floats, end: Floats) -> float:
    """Returns the largest distance in mm of (k, 3) points from the line through two points."""
    way = (end - start) / norm(end - start)
    return float(np.linalg.norm(np.cross(points - start, way), axis=1).max())


def _merged(triangulation: Triangulation, limit: float) -> tuple[NDArray[np.int64], Floats]:
    """Returns the number of the vertex at each sample, P first, and where the vertices are.

    The two ends of a bridge no longer than ``limit`` mm are one vertex, in their middle.
    """
    p, q, bridges = triangulation.p, triangulation.q, triangulation.bridges
    points = np.vstack((p, q))
    owner = np.arange(len(points))
    spans = np.linalg.norm(p[bridges[:, 0]] - q[bridges[:, 1]], axis=1)
    for i, j in bridges[spans <= limit].tolist():
        owner[owner == owner[len(p) + j]] = owner[i]
    for root in np.unique(owner[owner != np.arange(len(owner))]):
        points[root] = points[owner == root].mean(axis=0)
    return owner, points

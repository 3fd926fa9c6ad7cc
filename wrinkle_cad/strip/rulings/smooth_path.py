"""A strip's smooth surface as a path of bridges: patches, cones, and triangles where it must be.

The path has every ruling between two pieces as a bridge, and every sample of the strip as a vertex,
to within round-off. A patch is its steps along P and then those along Q; a cone the steps along its
rail; what is left between them, the gaps, is triangulated by the search.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from wrinkle_cad.settings import PLANE_GAP
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.runs import runs_of
from wrinkle_cad.strip.triangulation import P_STEP, Q_STEP, Triangulation, measured, triangulate

from .family import RulingFamily, family_of
from .patch import RuledPatch, patch_of
from .pieces import Piece
from .rail_curve import RailCurve
from .surface import RuledStrip
from .vectors import dots

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Steps = npt.NDArray[np.int8]
Rulings = tuple[tuple[float, float], tuple[float, float]]
"""Parameters on P and on Q of a first and a last ruling."""

CLEARANCE: Final = 0.25
"""A sample nearer to a ruling between pieces than this share of its chord falls away."""
SAME_PER_LENGTH: Final = 1e-10
"""A sample nearer to such a ruling than this share of the rail's interval is its end."""
EXACT: Final = 1e-5
"""rad; rulings that twist less are exact."""
MOST_HALVINGS: Final = 3
"""A piece without a patch is halved so often at most, to have patches for parts of it."""
PLANE_CHECKS: Final = 33
"""Points on each rail that tell whether a piece lies in a plane."""
SHORTEST_PATCH: Final = 0.01
"""Of its rulings' length; a shorter piece is not worth a face of its own."""


@dataclass(frozen=True, slots=True)
class PatchRun:
    """The steps of a path that one patch stands for; bridges are counted along the path."""

    early: int
    """The bridge before the first of them."""
    late: int
    """The bridge after the last of them."""
    patch: RuledPatch
    """Their surface."""
    family: RulingFamily
    """Its rulings."""
    piece: int
    """Its number among the strip's pieces."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothPath:
    """A strip's smooth surface, as a path between two rows of samples."""

    triangulation: Triangulation
    """The path."""
    p_samples: Samples
    """Where it meets P."""
    q_samples: Samples
    """Where it meets Q."""
    runs: tuple[PatchRun, ...]
    """The patches, in order."""
    refused: tuple[Piece, ...]
    """Pieces that are exactly developable and yet no patch."""


def smooth_path(
    ruled: RuledStrip,
    rails: tuple[RailCurve, RailCurve],
    knots: tuple[Floats, Floats],
    triangulation: Triangulation,
    samples: tuple[Samples, Samples],
    *,
    without: frozenset[int] = frozenset(),
) -> SmoothPath:
    """Returns the smooth surface of an open strip.

    Args:
        ruled: its exact surface.
        rails: the curves P and Q that were ruled.
        knots: (k,) and (l,) parameters where higher derivatives of P and of Q jump, in order.
        triangulation: the strip's own, whose samples gaps take, and whose objective.
        samples: of P and of Q.
        without: numbers of pieces that are to have no patch.

    Raises:
        InputError: a gap cannot be triangulated.
    """
    draft = _Draft(rails, triangulation, samples)
    is_closed = bool(
        (triangulation.p[0] == triangulation.p[-1]).all()
        and (triangulation.q[0] == triangulation.q[-1]).all()
    )
    waiting: list[Piece] = []
    for number, piece in enumerate(ruled.pieces):
        for part in _exact_parts(ruled, piece, is_whole=len(ruled.pieces) == 1 and is_closed):
            found = (
                [(part, None, None)] if number in without else _patches(ruled, part, *rails, knots)
            )
            for own, family, patch in found:
                if family is not None and patch is not None:
                    draft.add_gap(ruled, waiting)
                    draft.add_patch(_ends(ruled, own, own), patch, family, number)
                elif _stands_still(ruled, own):
                    draft.add_gap(ruled, waiting)
                    draft.add_fan(_ends(ruled, own, own))
                else:
                    waiting.append(own)
                    draft.refused += [own] if family is not None else []
                    continue
                waiting = []
    draft.add_gap(ruled, waiting)
    return draft.path()


def _ends(ruled: RuledStrip, first: Piece, last: Piece) -> Rulings:
    rulings, at = ruled.sheet.rulings, (first.first, last.last)
    (a, b), (c, d) = ((float(rulings.u[i]), float(rulings.v[i])) for i in at)
    return (a, b), (c, d)


def _stands_still(ruled: RuledStrip, piece: Piece) -> bool:
    """Whether a piece has one end of all its rulings, as a cone."""
    (a, b), (c, d) = _ends(ruled, piece, piece)
    return a == c or b == d


def _exact_parts(ruled: RuledStrip, piece: Piece, *, is_whole: bool) -> list[Piece]:
    """A torsal piece as parts with exact rulings, and gaps between where they twist a little.

    What is the whole of a closed strip is two parts: a face does not border on itself.
    """
    if piece.kind != "torsal":
        return [piece]
    if is_whole:
        middle = (piece.first + piece.last) // 2
        halves = ((piece.first, middle), (middle, piece.last))
        return [
            part
            for ends in halves
            for part in _exact_parts(ruled, Piece("torsal", *ends, None), is_whole=False)
        ]
    twist = np.abs(ruled.sheet.twist[piece.first : piece.last]).max(axis=1)
    is_exact = twist <= EXACT
    for first, last in runs_of(~is_exact):
        if _is_short(ruled, piece.first + first, piece.first + last):
            is_exact[first:last] = True
    return [
        Piece("torsal" if is_exact[first] else "gap", piece.first + first, piece.first + last, None)
        for first, last in sorted((*runs_of(is_exact), *runs_of(~is_exact)))
    ]


def _patches(
    ruled: RuledStrip,
    piece: Piece,
    p: RailCurve,
    q: RailCurve,
    knots: tuple[Floats, Floats],
    halvings: int = MOST_HALVINGS,
) -> list[tuple[Piece, RulingFamily | None, RuledPatch | None]]:
    """A piece and its patch; where it is none, halves of it with theirs."""
    is_known = piece.kind in ("torsal", "plane") and not _stands_still(ruled, piece)
    if not is_known or _is_short(ruled, piece.first, piece.last):
        return [(piece, None, None)]
    if _is_plane(ruled, piece, (p, q)):
        # The search finds how far the plane goes, beyond this piece as well.
        return [(piece, None, None)]
    family = family_of(ruled, piece, p, q)
    patch = patch_of(family, *knots)
    if patch is not None or halvings == 0:
        return [(piece, family, patch)]
    along = ruled.sheet.p_arc + ruled.sheet.q_arc
    middle = int(np.searchsorted(along, (along[piece.first] + along[piece.last]) / 2.0))
    if not piece.first < middle < piece.last:
        return [(piece, family, None)]
    halves = (
        Piece(piece.kind, first, last, None)
        for first, last in ((piece.first, middle), (middle, piece.last))
    )
    return [found for half in halves for found in _patches(ruled, half, p, q, knots, halvings - 1)]


def _is_plane(ruled: RuledStrip, piece: Piece, rails: tuple[RailCurve, RailCurve]) -> bool:
    """Whether a piece lies in one plane."""
    share = np.linspace(0.0, 1.0, PLANE_CHECKS)
    points = np.vstack(
        [
            rail.point_at(low + (high - low) * share)
            for rail, low, high in zip(rails, *_ends(ruled, piece, piece), strict=True)
        ]
    )
    normal = ruled.sheet.p_normal[(piece.first + piece.last) // 2, 0]
    height = dots(points - points[0], np.broadcast_to(normal, points.shape))
    return bool(np.abs(height).max() <= PLANE_GAP)


def _is_short(ruled: RuledStrip, first: int, last: int) -> bool:
    """Whether what lies between two rulings is not worth a face of its own."""
    sheet = ruled.sheet
    moved = sum(float(arc[last] - arc[first]) for arc in (sheet.p_arc, sheet.q_arc))
    return moved < SHORTEST_PATCH * float(sheet.reach[first : last + 1].max())


@dataclass(slots=True, eq=False)
class _Draft:
    """A path as far as it has been laid."""

    rails: tuple[RailCurve, RailCurve]
    triangulation: Triangulation
    samples: tuple[Samples, Samples]
    at: tuple[list[float], list[float]] = field(default_factory=lambda: ([], []))
    steps: list[int] = field(default_factory=list)
    runs: list[PatchRun] = field(default_factory=list)
    refused: list[Piece] = field(default_factory=list)

    def add_patch(self, ends: Rulings, patch: RuledPatch, family: RulingFamily, piece: int) -> None:
        early, rows = len(self.steps), self._rows(ends)
        self._add(rows, [P_STEP] * (len(rows[0]) - 1) + [Q_STEP] * (len(rows[1]) - 1))
        self.runs.append(PatchRun(early, len(self.steps), patch, family, piece))

    def add_fan(self, ends: Rulings) -> None:
        rows = self._rows(ends)
        side = P_STEP if ends[0][0] < ends[1][0] else Q_STEP
        self._add(rows, [side] * (len(rows[side]) - 1))

    def add_gap(self, ruled: RuledStrip, pieces: list[Piece]) -> None:
        if not pieces:
            return
        rows = self._rows(_ends(ruled, pieces[0], pieces[-1]))
        kept = [row[_is_clear(row, rail.edges)] for row, rail in zip(rows, self.rails, strict=True)]
        steps = self._searched(kept)
        # What was left out stands on the same cones as what is beside it.
        counts = np.ones(len(steps), dtype=np.int64)
        for side, (row, few) in enumerate(zip(rows, kept, strict=True)):
            counts[steps == side] = np.diff(np.searchsorted(row, few))
        self._add(rows, np.repeat(steps, counts).tolist())

    def _searched(self, rows: list[Floats]) -> Steps:
        """The steps that the search takes between stretches of both rails."""
        if len(rows[0]) == 1 or len(rows[1]) == 1:
            side = P_STEP if len(rows[1]) == 1 else Q_STEP
            return np.full(len(rows[side]) - 1, side, dtype=np.int8)
        points = [rail.point_at(row) for rail, row in zip(self.rails, rows, strict=True)]
        like = self.triangulation
        return triangulate(
            points[0],
            points[1],
            criteria=like.criteria,
            search=like.search,
            energy=like.energy,
            planarity=like.planarity,
            price=like.price,
        ).steps

    def _rows(self, ends: Rulings) -> tuple[Floats, Floats]:
        """Parameters of both rails from one ruling to another: the ends, and samples between."""
        p, q = (
            _row(samples.parameters, ends[0][side], ends[1][side])
            for side, samples in enumerate(self.samples)
        )
        return p, q

    def _add(self, rows: tuple[Floats, Floats], steps: Iterable[int]) -> None:
        for at, row in zip(self.at, rows, strict=True):
            at += row[1:].tolist() if at else row.tolist()
        self.steps += steps

    def path(self) -> SmoothPath:
        p, q = (
            Samples(np.array(row), rail.point_at(np.array(row)))
            for row, rail in zip(self.at, self.rails, strict=True)
        )
        like = self.triangulation
        found = measured(
            p.points,
            q.points,
            np.array(self.steps, dtype=np.int8),
            planarity=like.planarity,
            criteria=like.criteria,
            search=like.search,
            energy=like.energy,
        )
        return SmoothPath(found, p, q, tuple(self.runs), tuple(self.refused))


def _row(parameters: Floats, low: float, high: float) -> Floats:
    """The ends of a stretch, once if they are one, and the parameters between."""
    if not low < high:
        return np.array([low])
    same = SAME_PER_LENGTH * float(parameters[-1] - parameters[0])
    inside = parameters[(parameters > low + same) & (parameters < high - same)]
    return np.concatenate(([low], inside, [high]))


def _is_clear(row: Floats, corners: Floats) -> Bools:
    """Which parameters of a stretch are its ends, corners, or not too near to the ends."""
    if len(row) < 3:
        return np.ones(len(row), dtype=np.bool_)
    step = np.diff(row)
    clear = np.ones(len(row), dtype=np.bool_)
    clear[1] &= bool(step[0] >= CLEARANCE * step[1])
    clear[-2] &= bool(step[-1] >= CLEARANCE * step[-2])
    same = SAME_PER_LENGTH * float(corners[-1] - corners[0])
    clear |= np.abs(row[:, None] - corners).min(axis=1) <= same
    return clear

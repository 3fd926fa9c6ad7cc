"""A triangulation becomes one shell: facets, or cones whose banks are the rails themselves.

Vertices and edges are made once and shared, so nothing is sewn and no tolerance decides what
belongs together. Every face lies with its normal on the side from which the triangle p[i] p[i+1]
q[j] is counter-clockwise.

Facets: the triangles. Cones: for each run of steps in one plane, the plane between the rails, and
elsewhere for each run of steps with one apex the cone over that stretch of the rail. Where the
rails meet, the chord of the first bank edge is a bridge, and between the chord and the rail lies a
cone too. Faces not wider than 5e-6 mm (2e-7 ... 5e-6, by the strip's size) are left out and closed
over; their rail is then the border.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.TopoDS import TopoDS_Shape, TopoDS_Shell

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.measures import check_valid
from wrinkle_cad.cad.kernel.steps import kernel_step
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.errors import CadError, InputError
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.flat.planes import planar_runs, spans_of
from wrinkle_cad.strip.flat.unrolling import exact_rails
from wrinkle_cad.strip.rulings.smooth_path import PatchRun
from wrinkle_cad.strip.triangulation import P_STEP, Q_STEP, Triangulation

from .cone_faces import cone_face
from .face_borders import Border, BorderEdge, flipped
from .fans import Bank, Fan, FlatPart, fan_between, fans_of, flat_part, thin_triangles
from .plane_faces import is_plane_sector, plane_face
from .ruled_faces import ruled_face
from .skeleton import Skeleton
from .slivers import cut_at_knots

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

STEP: Final = "make the faces of a strip"
BUILT: Final = ("cones", "facets")
"""What a triangulation alone is enough for."""


def build_shell(
    triangulation: Triangulation,
    p: Directrix,
    q: Directrix,
    p_samples: Samples,
    q_samples: Samples,
    kind: str = settings.SURFACE,
) -> TopoDS_Shell:
    """Returns the shell of a strip, valid by the kernel's own check.

    Args:
        triangulation: the strip between the samples.
        p: rail P.
        q: rail Q, in the same direction.
        p_samples: vertices on P, with m points.
        q_samples: vertices on Q, with n points.
        kind: "cones" or "facets".

    Raises:
        InputError: an unknown kind, or samples that are not those of the triangulation.
        CadError: no face is left, or the shell is not valid.
    """
    if kind not in BUILT:
        raise InputError(f"surface cannot be {kind!r}: give {' or '.join(BUILT)}.")
    faces = build_faces(triangulation, (p, q), (p_samples, q_samples), has_curves=kind == "cones")
    return shell_of([face for row in faces.values() for face in row])


def build_faces(
    triangulation: Triangulation,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
    *,
    has_curves: bool,
    patches: Sequence[PatchRun] = (),
) -> dict[int, list[TopoDS_Shape]]:
    """Returns the faces of a strip, which share their edges, in order along it.

    Args:
        triangulation: the strip between the samples.
        rails: P and Q.
        samples: vertices on P and on Q.
        has_curves: whether their borders are the rails, or chords.
        patches: steps that are one ruled face each.

    Returns:
        By the bridge before a step or a run of steps: its faces.

    Raises:
        InputError: samples that are not those of the triangulation.
        CadError: no face is left.
    """
    _check_samples(triangulation, *samples)
    skeleton = Skeleton(triangulation, rails, samples, has_curves=has_curves)
    corners = (_corners(rails[0], samples[0]), _corners(rails[1], samples[1]))
    runs = np.full(len(triangulation.steps), -1, dtype=np.int64)
    if has_curves:
        cells = exact_rails((rails[0].point_at, rails[1].point_at), samples)
        parameters = samples[0].parameters, samples[1].parameters
        runs = planar_runs(triangulation, cells, parameters, settings.PLANE_GAP)
    patched = np.zeros(len(runs), dtype=np.bool_)
    for run in patches:
        patched[run.early : run.late] = True
    runs[patched] = -1
    with kernel_step(STEP):
        thin = thin_triangles(triangulation, skeleton.limit) & ~patched
        spans = [_trimmed(triangulation, skeleton, thin, *span) for span in spans_of(runs)]
        parts = [flat_part(triangulation, corners, *span) for span in spans if span[0] < span[1]]
        fans = fans_of(triangulation, corners, thin, (runs >= 0) | patched, is_merged=has_curves)
        kept = [fan for fan in fans if not (fan.is_thin and skeleton.leave_out(fan))]
        faces = {part.early: [_plane_of(part, skeleton)] for part in parts}
        faces |= {fan.early: _faces_of(fan, skeleton) for fan in kept}
        faces |= {run.early: [_patch_face(run, triangulation, skeleton)] for run in patches}
    if not faces:
        raise CadError(
            STEP,
            f"every face is thinner than {skeleton.limit:.1e} mm. Sample the rails more finely.",
        )
    return dict(sorted(faces.items()))


def shell_of(faces: Sequence[TopoDS_Shape]) -> TopoDS_Shell:
    """Returns the shell of faces that share their edges.

    Raises:
        CadError: it does not pass the kernel's own check.
    """
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    advice = "Sample the rails with a smaller tolerance, or move them apart."
    check_valid(shell, STEP, advice)
    return shell


def _check_samples(triangulation: Triangulation, p: Samples, q: Samples) -> None:
    for name, given, own in (("P", p, triangulation.p), ("Q", q, triangulation.q)):
        if not np.array_equal(given.points, own):
            raise InputError(
                f"The {len(given.points)} samples of {name} are not the {len(own)} points of the"
                " triangulation. Pass the samples that were triangulated."
            )


def _corners(rail: Directrix, samples: Samples) -> Bools:
    """Returns (k,) bool: the samples where the rail is not C1."""
    breaks = np.asarray(rail.breaks)
    at = np.searchsorted(breaks, samples.parameters)
    padded = np.concatenate(([-np.inf], breaks, [np.inf]))
    apart = np.minimum(samples.parameters - padded[at], padded[at + 1] - samples.parameters)
    return np.asarray(apart <= 1e-12 * rail.length, dtype=np.bool_)


def _trimmed(
    triangulation: Triangulation, skeleton: Skeleton, thin: Bools, first: int, last: int
) -> tuple[int, int]:
    """Returns a run of steps in one plane without what is too thin for a face at its ends."""

    def is_left_out(step: int) -> bool:
        fan = fan_between(triangulation, step, step + 1, is_thin=True)
        return bool(thin[step]) and skeleton.leave_out(fan)

    while first < last and is_left_out(first):
        first += 1
    while first < last and is_left_out(last - 1):
        last -= 1
    return first, last


def _plane_of(part: FlatPart, skeleton: Skeleton) -> TopoDS_Shape:
    borders: dict[int, list[BorderEdge]] = {P_STEP: [], Q_STEP: []}
    for bank in part.banks:
        borders[bank.side] += skeleton.bank(bank)
    loop = (
        *borders[P_STEP],
        *skeleton.bridge(part.late),
        *flipped(tuple(borders[Q_STEP])),
        *flipped(skeleton.bridge(part.early)),
    )
    return plane_face(loop, part.normal)


def _faces_of(fan: Fan, skeleton: Skeleton) -> list[TopoDS_Shape]:
    bank, side = skeleton.bank(fan.bank), fan.bank.side
    early, late = skeleton.bridge(fan.early), skeleton.bridge(fan.late)
    corner = skeleton.corner(1 - side, fan.apex)
    apex, vertex = skeleton.points[corner], skeleton.vertex(corner)
    # Towards the apex is from P to Q for a bank on P, and from Q to P for a bank on Q.
    to_apex, from_apex = (late, flipped(early)) if side == P_STEP else (flipped(late), early)
    (edge,) = bank
    if is_plane_sector(edge.shape, apex):
        loop: Border = (*bank, *to_apex, *from_apex)
        return [plane_face(loop if side == P_STEP else flipped(loop))]
    sectors = cut_at_knots((edge, to_apex, from_apex), apex, vertex, skeleton.limit)
    knots = skeleton.parameters(fan.bank)
    faces = [cone_face(*sector, apex, vertex, knots) for sector in sectors]
    return [face if side == P_STEP else face.Reversed() for face in faces]


def _patch_face(run: PatchRun, triangulation: Triangulation, skeleton: Skeleton) -> TopoDS_Shape:
    first, last = triangulation.bridges[[run.early, run.late]]
    (p_bank,), (q_bank,) = (
        skeleton.bank(Bank(side, int(first[side]), int(last[side]))) for side in (P_STEP, Q_STEP)
    )
    corners = [skeleton.corner(0, int(i)) for i in (first[0], last[0])]
    meeting = (skeleton.vertex(corners[0]), skeleton.vertex(corners[1]))
    early, late = skeleton.bridge(run.early), skeleton.bridge(run.late)
    return ruled_face(run.patch, (p_bank, q_bank), early, late, meeting)

"""The smooth surface of a strip becomes a shell: a ruled face per piece, and cones between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Shell

from wrinkle_cad.cad.kernel.measures import is_valid
from wrinkle_cad.cad.rail.directrix import Directrix
from wrinkle_cad.strip.curve.sampling import Samples
from wrinkle_cad.strip.rulings.rail_curve import RailCurve
from wrinkle_cad.strip.rulings.smooth_path import SmoothPath, smooth_path
from wrinkle_cad.strip.rulings.surface import RuledStrip
from wrinkle_cad.strip.triangulation import Triangulation

from .shell import build_faces, shell_of

Floats = NDArray[np.float64]

ATTEMPTS: Final = 4
"""So often faces that the kernel finds fault with are made of cones instead."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothShell:
    """A strip's smooth surface, as a shell and as the path that it was made from."""

    shell: TopoDS_Shell
    """Valid by the kernel's own check."""
    path: SmoothPath
    """Its pieces."""


def build_smooth_shell(
    ruled: RuledStrip,
    curves: tuple[RailCurve, RailCurve],
    triangulation: Triangulation,
    rails: tuple[Directrix, Directrix],
    samples: tuple[Samples, Samples],
) -> SmoothShell:
    """Returns the smooth shell of an open strip.

    Args:
        ruled: its exact surface.
        curves: P and Q, as they were ruled.
        triangulation: the strip's own.
        rails: P and Q.
        samples: of P and of Q, those of the triangulation.

    Raises:
        InputError: what lies between the smooth pieces cannot be triangulated.
        CadError: the shell is not valid.
    """
    knots = (_knots(rails[0]), _knots(rails[1]))
    without: frozenset[int] = frozenset()
    for _ in range(ATTEMPTS):
        path = smooth_path(ruled, curves, knots, triangulation, samples, without=without)
        faces = build_faces(
            path.triangulation,
            rails,
            (path.p_samples, path.q_samples),
            has_curves=True,
            patches=path.runs,
        )
        faulty = {run.piece for run in path.runs if not is_valid(faces[run.early][0])}
        if not faulty:
            break
        without |= faulty
    return SmoothShell(shell_of([face for row in faces.values() for face in row]), path)


def _knots(rail: Directrix) -> Floats:
    """Returns (k,): parameters at which some derivative of a rail may jump."""
    return np.unique(np.concatenate([piece.knots for piece in rail.pieces]))

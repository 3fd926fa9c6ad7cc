"""Mathematics of a strip between two curves in space: arrays in, frozen results out.

Glossary:

directrix, rail
    One of the two curves, P or Q; here its samples ``p`` (m, 3) and ``q`` (n, 3), mm.
bank
    An edge between neighbouring samples of one rail: p[i] to p[i+1], or q[j] to q[j+1].
bridge
    The straight line from p[i] to q[j], as the pair ``(i, j)``. All but the first and the last are
    interior bridges.
P-step, Q-step
    From one bridge to the next along one bank: one triangle.
boundary bridge triangulation
    A path of m+n-1 bridges from (0, 0) to (m-1, n-1), and the m+n-2 triangles between them.
ruling
    A straight line of the surface; a bridge stands for one.
locally convex, valid
    A bridge past which all four neighbouring samples lie on one side of some plane through it.
    ``validity_matrix`` tells for every (i, j).
fold
    The signed angle in rad by which the sheet turns at a bridge, 0 where it is flat.
bending
    The energy of all folds together; what a triangulation has least of.
twist
    The angle in rad by which the sheet's normal turns along a ruling; 0 if it is developable.
inflection bridge
    Invalid only because the bending changes its sign there: no defect.
gap
    A stretch without exact rulings, between two that have them.
fan
    Triangles, or rulings, that share one point of a rail; a part of a cone.
unrolling, flat
    Laying the triangles, or cones over the rails' curves, into the plane, one after the other.
planarity
    The distance in mm that does not count when it is asked whether points lie in one plane.

Not handled: more than two rails, branching strips. Names are exported lazily (PEP 562): importing
the folder compiles nothing and loads no numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

# What is found lazily below, for type checkers and editors; a test holds the two together.
if TYPE_CHECKING:
    from .convexity import validity_matrix as validity_matrix
    from .crossings import SelfCrossings as SelfCrossings
    from .crossings import self_crossings as self_crossings
    from .curve.meetings import Meeting as Meeting
    from .curve.meetings import meetings_of as meetings_of
    from .curve.sampling import Samples as Samples
    from .curve.sampling import sample_curve as sample_curve
    from .flat.unrolling import Unrolling as Unrolling
    from .flat.unrolling import unroll as unroll
    from .flat.unrolling import unroll_cones as unroll_cones
    from .invalid_runs import InvalidRun as InvalidRun
    from .invalid_runs import covered_lengths as covered_lengths
    from .invalid_runs import find_invalid_runs as find_invalid_runs
    from .triangulation import P_STEP as P_STEP
    from .triangulation import Q_STEP as Q_STEP
    from .triangulation import Triangulation as Triangulation
    from .triangulation import triangulate as triangulate

_MODULE_OF: Final = {
    "P_STEP": "triangulation",
    "Q_STEP": "triangulation",
    "InvalidRun": "invalid_runs",
    "Meeting": "curve.meetings",
    "Samples": "curve.sampling",
    "SelfCrossings": "crossings",
    "Triangulation": "triangulation",
    "Unrolling": "flat.unrolling",
    "find_invalid_runs": "invalid_runs",
    "covered_lengths": "invalid_runs",
    "meetings_of": "curve.meetings",
    "sample_curve": "curve.sampling",
    "self_crossings": "crossings",
    "triangulate": "triangulation",
    "unroll": "flat.unrolling",
    "unroll_cones": "flat.unrolling",
    "validity_matrix": "convexity",
}

__all__ = sorted(_MODULE_OF)


if not TYPE_CHECKING:
    # A type checker that saw it would take every name, misspelt ones as well.
    def __getattr__(name: str) -> Any:
        if name not in _MODULE_OF:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return list(__all__)

"""Mathematics of a strip between two curves in space: arrays in, frozen results out.

Names are exported lazily (PEP 562): importing the folder compiles nothing and loads no numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

# What is found lazily below, for type checkers and editors; a test holds the two together.
if TYPE_CHECKING:
    from .convexity import validity_matrix as validity_matrix
    from .curve.sampling import Samples as Samples
    from .curve.sampling import sample_curve as sample_curve
    from .flat.unrolling import Unrolling as Unrolling
    from .flat.unrolling import unroll as unroll
    from .flat.unrolling import unroll_cones as unroll_cones
    from .gaps import Gap as Gap
    from .gaps import covered_lengths as covered_lengths
    from .gaps import find_gaps as find_gaps
    from .triangulation import P_STEP as P_STEP
    from .triangulation import Q_STEP as Q_STEP
    from .triangulation import Triangulation as Triangulation
    from .triangulation import triangulate as triangulate

_MODULE_OF: Final = {
    "P_STEP": "triangulation",
    "Q_STEP": "triangulation",
    "Gap": "gaps",
    "Meeting": "curve.meetings",
    "Samples": "curve.sampling",
    "SelfCrossings": "crossings",
    "Triangulation": "triangulation",
    "Unrolling": "flat.unrolling",
    "find_gaps": "gaps",
    "covered_lengths": "gaps",
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

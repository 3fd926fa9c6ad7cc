"""Mathematics of a strip between two curves in space: arrays in, frozen results out.

Names are exported lazily (PEP 562): importing the folder compiles nothing and loads no numba.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

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


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)

"""Most developable strips between two curves.

Names are exported lazily (PEP 562): importing the package loads no CAD kernel.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, Final

from .settings import VERSION

__version__ = VERSION

_MODULE_OF: Final = {
    "WrinkleStrip": "wrinkle.wrinkle_strip",
    "StripReport": "wrinkle.strip_report",
    "Pattern": "wrinkle.cut_pattern",
    "PieceSettings": "pattern.piece.options",
    "read_cad": "cad.exchange.read",
    "carve": "cad.upper.carve",
    "Opening": "cad.upper.opening",
    "wrinkle_profiles": "cad.upper.profiles",
    "stitch": "cad.upper.stitch",
    "Stitched": "cad.upper.stitch",
    "Job": "job.job",
    "make_job": "job.job",
    "JobDone": "job.outcome",
    "JobFailed": "job.outcome",
    "run_job": "job.workflow",
    "run_batch": "batch.executor",
    "Finding": "errors",
    "WrinkleError": "errors",
    "InputError": "errors",
    "JobError": "errors",
    "CadError": "errors",
    "ExportError": "errors",
}

__all__ = ["__version__", *_MODULE_OF]


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)

"""Most developable strips between two curves.

Names are exported lazily (PEP 562): importing the package loads no CAD kernel.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from .settings import VERSION

__version__ = VERSION

# What is found lazily below, for type checkers and editors; a test holds the two together.
if TYPE_CHECKING:
    from .batch.executor import run_batch as run_batch
    from .cad.exchange.choose import choose_inputs as choose_inputs
    from .cad.exchange.read import read_cad as read_cad
    from .cad.exchange.shapes import Part as Part
    from .cad.exchange.write import write_step as write_step
    from .cad.kernel.splines import make_surface as make_surface
    from .cad.upper.carve import carve as carve
    from .cad.upper.carve import carve_all as carve_all
    from .cad.upper.opening import Opening as Opening
    from .cad.upper.profiles import wrinkle_profiles as wrinkle_profiles
    from .cad.upper.smooth import smooth_edge as smooth_edge
    from .cad.upper.stitch import Stitched as Stitched
    from .cad.upper.stitch import stitch as stitch
    from .errors import CadError as CadError
    from .errors import ConstraintError as ConstraintError
    from .errors import ExportError as ExportError
    from .errors import Finding as Finding
    from .errors import InputError as InputError
    from .errors import JobError as JobError
    from .errors import WrinkleError as WrinkleError
    from .errors import WrinkleWarning as WrinkleWarning
    from .job.job import Job as Job
    from .job.job import make_job as make_job
    from .job.outcome import JobDone as JobDone
    from .job.outcome import JobFailed as JobFailed
    from .job.workflow import run_job as run_job
    from .job.wrinkled_upper import WrinkledUpper as WrinkledUpper
    from .job.wrinkled_upper import wrinkle_upper as wrinkle_upper
    from .pattern.piece.options import NotchRule as NotchRule
    from .pattern.piece.options import PieceSettings as PieceSettings
    from .report.compare import Comparison as Comparison
    from .report.compare import compare as compare
    from .report.figures import plot_pattern as plot_pattern
    from .wrinkle.cut_pattern import Pattern as Pattern
    from .wrinkle.cut_pattern import pattern_of_strips as pattern_of_strips
    from .wrinkle.strip_report import StripReport as StripReport
    from .wrinkle.wrinkle_strip import WrinkleStrip as WrinkleStrip

_MODULE_OF: Final = {
    "WrinkleStrip": "wrinkle.wrinkle_strip",
    "StripReport": "wrinkle.strip_report",
    "Pattern": "wrinkle.cut_pattern",
    "PieceSettings": "pattern.piece.options",
    "read_cad": "cad.exchange.read",
    "Part": "cad.exchange.shapes",
    "write_step": "cad.exchange.write",
    "carve": "cad.upper.carve",
    "carve_all": "cad.upper.carve",
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
    "WrinkleWarning": "errors",
    "ConstraintError": "errors",
    "InputError": "errors",
    "JobError": "errors",
    "CadError": "errors",
    "ExportError": "errors",
    "choose_inputs": "cad.exchange.choose",
    "wrinkle_upper": "job.wrinkled_upper",
    "WrinkledUpper": "job.wrinkled_upper",
    "plot_pattern": "report.figures",
    "compare": "report.compare",
    "Comparison": "report.compare",
    "make_surface": "cad.kernel.splines",
    "smooth_edge": "cad.upper.smooth",
    "NotchRule": "pattern.piece.options",
    "pattern_of_strips": "wrinkle.cut_pattern",
}

__all__ = ["__version__", *_MODULE_OF]


if not TYPE_CHECKING:
    # A type checker that saw it would take every name, misspelt ones as well.
    def __getattr__(name: str) -> Any:
        if name not in _MODULE_OF:
            from difflib import get_close_matches

            near = get_close_matches(name, _MODULE_OF, n=1)
            advice = f": did you mean {near[0]}?" if near else ""
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}{advice}")
        value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted(__all__)

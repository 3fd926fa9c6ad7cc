"""What a batch's workers have in common, loaded once: they are forked from the process that did.

A fork server imports this module by name. The CAD kernel is most of a worker's start.
"""

from __future__ import annotations

import gc
import importlib
import signal
import sys
from typing import Final

from .worker import die_with_parent, one_thread

_MODULES: Final = (
    "job.workflow",
    "job.parts",
    "job.trials",
    "job.writing",
    "job.wrinkled_upper",
    "cad.build123d_objects",
    "cad.exchange.choose",
    "cad.exchange.read",
    "cad.exchange.read_step",
    "cad.exchange.write",
    "cad.faces.shell",
    "cad.upper.bands",
    "cad.upper.end_fans",
    "cad.upper.given_upper",
    "cad.upper.profiles",
    "cad.upper.stitch",
    "cad.upper.stitched_part",
    "pattern.formats.dxf",
    "pattern.formats.svg",
    "report.strip_page",
    "report.verdict",
    "strip.compiled",
    "wrinkle.cut_pattern",
)
"""What a job of strips in an upper imports when it comes to it."""


def load() -> None:
    """Imports what jobs need; what lives then is no garbage, and no fork looks through it."""
    gc.disable()
    for name in _MODULES:
        importlib.import_module(f"wrinkle_cad.{name}")
    gc.freeze()
    gc.enable()


if "multiprocessing.forkserver" in " ".join(sys.orig_argv):
    # Ctrl-C reaches the whole group; the process that started this one decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()
    one_thread()
    load()

"""Steps of the CAD kernel: what it throws becomes one of this package's errors."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Final

from wrinkle_cad.errors import CadError
from wrinkle_cad.files.names import error_words

_MODULES: Final = (
    "BRepExtrema", "Geom", "Geom2d", "GProp", "Interface", "LProp", "Standard", "StdFail",
    "Storage", "TopoDS", "Transfer", "gp", "math",
)  # fmt: skip
# The bindings register each class on its own: they share no base but Exception.
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(
        kind
        for module in _MODULES
        for kind in vars(import_module(f"OCP.{module}")).values()
        if isinstance(kind, type) and issubclass(kind, Exception)
    ),
    RuntimeError,
)

# Which function of the kernel failed, and where in memory: other digits at every run.
_PLACE: Final = re.compile(r"EXCEPTION in \S+?::\w+\([^)]*\)\s*(?:0x[0-9a-f]+)?\s*:?\s*")


@contextmanager
def kernel_step(step: str) -> Iterator[None]:
    """Turns what the kernel throws inside the block into a ``CadError`` that names the step."""
    try:
        yield
    except KERNEL_ERRORS as error:
        found = f"the CAD kernel failed ({kernel_words(error)}). Check the input shape."
        raise CadError(step, found) from error


def kernel_words(error: BaseException) -> str:
    """Returns what an exception of the kernel says, on one line, without addresses in memory.

    Example:
        >>> kernel_words(RuntimeError("EXCEPTION in A::B(..) 0x55a0 : too few poles"))
        'too few poles'
    """
    return _PLACE.sub("", error_words(error)).strip() or type(error).__name__

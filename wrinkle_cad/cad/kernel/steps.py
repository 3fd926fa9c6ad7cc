"""Steps of the CAD kernel: what it throws becomes one of this package's errors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from OCP import Geom, Standard, StdFail, TopoDS, Transfer, gp

from wrinkle_cad.errors import CadError
from wrinkle_cad.files.names import error_words

# The bindings register each class on its own: they share no base but Exception.
KERNEL_ERRORS: tuple[type[Exception], ...] = (
    *(
        kind
        for module in (Standard, StdFail, TopoDS, Transfer, Geom, gp)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Exception)
    ),
    RuntimeError,
)


@contextmanager
def kernel_step(step: str) -> Iterator[None]:
    """Turns what the kernel throws inside the block into a ``CadError`` that names the step."""
    try:
        yield
    except KERNEL_ERRORS as error:
        found = f"the CAD kernel failed ({error_words(error)}). Check the input shape."
        raise CadError(step, found) from error

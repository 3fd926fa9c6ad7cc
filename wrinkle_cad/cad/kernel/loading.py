"""Loading the CAD kernel: fast, and with one plain line when it cannot be loaded."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from wrinkle_cad.errors import CadError
from wrinkle_cad.files.names import error_words


@contextmanager
def kernel_importable() -> Iterator[None]:
    """Wraps the imports that load the kernel.

    Raises:
        CadError: a shared library or a wheel is missing; the message says what to do.
    """
    was_on = gc.isenabled()
    # The kernel's bindings make so many objects that collecting meanwhile doubles the time.
    gc.disable()
    try:
        yield
    except ImportError as error:
        raise CadError(
            "load the CAD kernel", f"{error_words(error)}. Run wrinkle-cad doctor."
        ) from error
    finally:
        if was_on:
            gc.enable()

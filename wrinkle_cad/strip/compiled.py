"""How this package compiles: with numba, off the interpreter lock, kept on disk if possible."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import numba
from numba.core import event

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Returns a function compiled by numba at its first call.

    The machine code is kept on disk for later processes. Where no folder can be written (read-only
    installation and home) numba refuses at this very place; the function is then compiled anew in
    each process. Division by zero follows IEEE 754, as in numpy; fast-math stays off, so results
    do not depend on the machine's vector width.
    """
    try:
        fast: Function = numba.njit(function, nogil=True, error_model="numpy", cache=True)
    except RuntimeError:
        fast = numba.njit(function, nogil=True, error_model="numpy")
    return fast


def inlined(function: Function) -> Function:
    """Returns a compiled function that is put into whatever compiled function calls it.

    So a loop over it stays a loop without calls, which can run on vector units, however large the
    function is.

    Example:
        >>> inlined(lambda number: 0.5 * number)(3.0)
        1.5
    """
    fast: Function = numba.njit(function, nogil=True, error_model="numpy", forceinline=True)
    return fast


@contextmanager
def compiling_told(tell: Callable[[bool], None]) -> Iterator[None]:
    """Tells when this thread begins to compile within the block, and when it goes on.

    Args:
        tell: called with True as a compilation begins, with False as it ends; those of functions
            within functions count as one. Machine code that is read from the disk is no
            compilation.

    Example:
        >>> import numpy as np
        >>> told = []
        >>> with compiling_told(told.append):
        ...     _ = compiled(lambda x: x + 1.0)(2.0)
        >>> told
        [True, False]
    """
    listener = _Compiling(tell)
    event.register("numba:compile", listener)
    try:
        yield
    finally:
        event.unregister("numba:compile", listener)


class _Compiling(event.Listener):  # type: ignore[misc]  # numba is untyped
    """Hears of every function that is compiled, in whatever thread."""

    def __init__(self, tell: Callable[[bool], None]) -> None:
        self._tell = tell
        self._thread = threading.get_ident()
        self._depth = 0

    def on_start(self, _: object) -> None:
        if threading.get_ident() == self._thread:
            self._depth += 1
            if self._depth == 1:
                self._tell(True)

    def on_end(self, _: object) -> None:
        if threading.get_ident() == self._thread:
            self._depth -= 1
            if self._depth == 0:
                self._tell(False)

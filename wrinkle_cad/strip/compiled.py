"""How this package compiles: with numba, off the interpreter lock, kept on disk if possible."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numba

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

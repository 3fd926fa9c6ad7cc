"""How this package compiles: at the first call, off the interpreter lock, kept on disk if possible.

The compiler is `strip/compiler`; nothing of it is loaded before a compiled function is called.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import update_wrapper
from types import FunctionType
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])

_LISTENERS: list[tuple[int, Callable[[bool], None]]] = []
"""Threads, and what they call as they begin and end to compile."""


def compiled(function: Function) -> Function:
    """Returns a function that is compiled at its first call, for each kind of its arguments.

    The machine code is kept on disk for later processes; where no folder can be written the
    function is compiled anew in each process. Division by zero follows IEEE 754, as in numpy;
    results do not depend on the machine's vector width. What such functions may contain says
    `wrinkle_cad.strip.compiler`.

    Example:
        >>> @compiled
        ... def steps(start: float, count: int) -> float:
        ...     for _ in range(count):
        ...         start = 0.5 * start
        ...     return start
        >>> steps(8.0, 3)
        1.0
    """
    return cast(Function, _Compiled(cast(FunctionType, function)))


class _Compiled:
    """A function that compiles itself when it is called."""

    def __init__(self, function: FunctionType) -> None:
        self.py_func = function
        self._call: Callable[..., object] | None = None
        update_wrapper(self, function)

    def __call__(self, *arguments: object, **named: object) -> object:
        if self._call is None:
            from .compiler.dispatch import Dispatcher

            self._call = Dispatcher(self.py_func, _telling).call
        return self._call(*arguments, **named)

    def __reduce__(self) -> str:
        return self.py_func.__qualname__


@contextmanager
def _telling() -> Iterator[None]:
    """Tells this thread's listeners that something is compiled in the block."""
    own = threading.get_ident()
    listeners = [tell for thread, tell in _LISTENERS if thread == own]
    for tell in listeners:
        tell(True)
    try:
        yield
    finally:
        for tell in listeners:
            tell(False)


@contextmanager
def compiling_told(tell: Callable[[bool], None]) -> Iterator[None]:
    """Tells when this thread begins to compile within the block, and when it goes on.

    Args:
        tell: called with True as a compilation begins, with False as it ends; a function is
            compiled together with all that it calls. Machine code that is read from the disk is no
            compilation.

    Example:
        >>> @compiled
        ... def one_more(x: float) -> float:
        ...     return x + 1.0
        >>> told = []
        >>> with compiling_told(told.append):
        ...     _ = one_more(2.0)
        >>> told
        [True, False]
    """
    listener = (threading.get_ident(), tell)
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        _LISTENERS.remove(listener)

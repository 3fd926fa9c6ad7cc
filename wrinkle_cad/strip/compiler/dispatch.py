"""Calls of compiled functions from Python: arguments in, results out."""

from __future__ import annotations

import ctypes
import inspect
import os
import struct
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from functools import cache
from types import FunctionType
from typing import Any, Final

import numpy as np

from .folders import cache_folders
from .kinds import (
    BOOL,
    FLOAT,
    INT,
    Array,
    CannotCompileError,
    Kind,
    Record,
    element_of,
    holds_array,
    leaves_of,
)
from .store import Store

PROCESSOR_VARIABLE: Final = "WRINKLE_CAD_PROCESSOR"
"""Environment variable that names the processor to compile for, in LLVM's words."""
_LETTERS: Final = {"double": "d", "i64": "q", "i1": "q", "ptr": "q"}
_LOCK: Final = threading.RLock()


@cache
def processor() -> str | None:
    """The processor to compile for; this machine's when None."""
    return os.environ.get(PROCESSOR_VARIABLE) or None


@cache
def store() -> Store:
    """Where this process keeps machine code."""
    from .machine import host, version

    return Store(cache_folders(os.environ), (version(), *host(processor())))


class _Entry:
    """Machine code for one choice of kinds of arguments."""

    def __init__(self, run: Any, free: Any, kinds: tuple[Kind, ...], result: Kind) -> None:
        self._run, self._free = run, free
        self._pack = struct.Struct("=" + "".join(_LETTERS[ir] for ir in leaves_of(Record(kinds))))
        leaves = leaves_of(result)
        self._unpack = struct.Struct("=q" + "".join(_LETTERS[ir] for ir in leaves))
        self._result = result
        self._holds_array = holds_array(result)

    def call(self, leaves: Sequence[Any]) -> object:
        memory = ctypes.create_string_buffer(self._unpack.size)
        failed = self._run(self._pack.pack(*leaves), ctypes.addressof(memory))
        first, *found = self._unpack.unpack(memory)
        try:
            if failed:
                raise MemoryError("a compiled function was refused memory")
            return _python_value(self._result, found)
        finally:
            if first:
                self._free(first)


class Dispatcher:
    """Finds the machine code for the arguments that a function is called with."""

    def __init__(
        self, function: FunctionType, telling: Callable[[], AbstractContextManager[None]]
    ) -> None:
        self._function = function
        self._telling = telling
        self._entries: dict[tuple[object, ...], _Entry] = {}
        self._signature = inspect.signature(function)
        self._count = len(self._signature.parameters)

    def call(self, *arguments: object, **named: object) -> object:
        """Calls the function."""
        if named or len(arguments) < self._count:
            bound = self._signature.bind(*arguments, **named)
            bound.apply_defaults()
            arguments = tuple(bound.arguments.values())
        marks: list[object] = []
        leaves: list[Any] = []
        for argument in arguments:
            _take(argument, marks, leaves)
        entry = self._entries.get(tuple(marks))
        if entry is None:
            entry = self._made(arguments)
            self._entries[tuple(marks)] = entry
        return entry.call(leaves)

    def _made(self, arguments: Sequence[object]) -> _Entry:
        from .machine import loaded, object_code

        kinds = tuple(kind_of(argument) for argument in arguments)
        function = self._function
        code = function.__code__
        full = f"{code.co_filename}\n{function.__module__}.{function.__qualname__}"
        name = store().name_of(full, kinds)
        entry = f"entry_{name}"
        with _LOCK:
            kept = store().read(name)
            if kept is not None:
                return _Entry(*loaded(kept.code, entry, processor()), kinds, kept.result)
            from .program import whole_text

            with self._telling():
                text, result, made_from = whole_text(function, kinds, entry)
                machine_code = object_code(text, processor())
            store().write(name, machine_code, result, made_from)
            return _Entry(*loaded(machine_code, entry, processor()), kinds, result)


def _take(value: Any, marks: list[object], leaves: list[Any]) -> None:
    """Adds what a value is to the marks, and its leaves."""
    kind = type(value)
    if kind is np.ndarray:
        size = value.itemsize
        strides = value.strides
        is_dense = strides[-1] == size if strides else False
        marks.append((value.dtype, value.ndim, is_dense))
        leaves.append(value.__array_interface__["data"][0])
        leaves.extend(value.shape)
        leaves.extend(strides[:-1] if is_dense else strides)
    elif isinstance(value, tuple):
        marks.append((kind, len(value)))
        for part in value:
            _take(part, marks, leaves)
    else:
        marks.append(kind)
        leaves.append(value)


def kind_of(value: Any) -> Kind:
    """What a Python value is in compiled functions.

    Raises:
        CannotCompileError: nothing.
    """
    if isinstance(value, np.ndarray) and value.ndim:
        is_dense = value.strides[-1] == value.itemsize
        return Array(element_of(value.dtype), value.ndim, is_dense)
    if isinstance(value, tuple):
        maker = type(value) if hasattr(value, "_fields") else None
        return Record(tuple(kind_of(part) for part in value), maker)
    if isinstance(value, bool | np.bool_):
        return BOOL
    if isinstance(value, int | np.integer):
        return INT
    if isinstance(value, float | np.floating):
        return FLOAT
    raise CannotCompileError(f"compiled functions take no {type(value).__name__}")


def _python_value(kind: Kind, leaves: list[Any]) -> object:
    """The Python value that leaves stand for; they are taken off the list's front."""
    if isinstance(kind, Array):
        count = len(leaves_of(kind))
        own = leaves[:count]
        del leaves[:count]
        return _copied(kind, own)
    if isinstance(kind, Record):
        if not kind.parts and kind.maker is None:
            return None
        parts = [_python_value(part, leaves) for part in kind.parts]
        return kind.maker(*parts) if kind.maker is not None else tuple(parts)
    value = leaves.pop(0)
    return bool(value) if kind == BOOL else value


def _copied(kind: Array, leaves: Sequence[int]) -> Any:
    """An array of its own with what stands in compiled functions' memory."""
    address, *rest = leaves
    shape, strides = rest[: kind.ndim], rest[kind.ndim :]
    if kind.is_dense:
        strides.append(kind.element.size)
    dtype = np.dtype(kind.element.char)
    if 0 in shape:
        return np.empty(shape, dtype)
    reaches = [(size - 1) * stride for size, stride in zip(shape, strides, strict=True)]
    before = -sum(reach for reach in reaches if reach < 0)
    length = before + sum(reach for reach in reaches if reach > 0) + dtype.itemsize
    memory = (ctypes.c_char * length).from_address(address - before)
    return np.ndarray(shape, dtype, memoryview(memory), before, strides).copy()

"""What compiled functions may call besides each other: of Python, of math, of numpy."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from .arrays import Arrays, Lazy
from .kinds import BOOL, FLOAT, INT, Array, CannotCompileError, Record, Scalar, element_of, joined
from .operations import Operand, Operations
from .writer import Value, Writer

_OF_FLOATS: Final[Mapping[object, str]] = {
    math.sqrt: "llvm.sqrt.f64",
    math.fabs: "llvm.fabs.f64",
    math.sin: "sin",
    math.cos: "cos",
    math.atan2: "atan2",
    math.hypot: "hypot",
    # By name: what numpy itself would make of these is not meant here.
    **{
        getattr(np, name): own
        for name, own in (
            ("sqrt", "llvm.sqrt.f64"),
            ("sin", "sin"),
            ("cos", "cos"),
            ("arctan2", "atan2"),
            ("hypot", "hypot"),
            ("floor", "llvm.floor.f64"),
            ("ceil", "llvm.ceil.f64"),
        )
    },
}
_ROUNDED: Final[Mapping[object, str]] = {
    math.floor: "llvm.floor.f64",
    math.ceil: "llvm.ceil.f64",
}
_CASTS: Final[Mapping[object, Scalar]] = {
    float: FLOAT,
    int: INT,
    bool: BOOL,
    np.float64: FLOAT,
    np.int64: INT,
    np.bool_: BOOL,
}
_FILLED: Final[Mapping[object, float | None]] = {np.empty: None, np.zeros: None, np.ones: 1}
_LIKE: Final = (np.empty_like, np.zeros_like)


class Calls:
    """Writes calls of functions that are not compiled ones."""

    def __init__(self, writer: Writer, arrays: Arrays, operations: Operations) -> None:
        self._w = writer
        self._arrays = arrays
        self._do = operations
        self._special: Mapping[object, Callable[[Sequence[Any], Mapping[str, Any]], Operand]] = {
            len: self._length,
            abs: lambda given, _: self._do.each(given, lambda own: self._do.absolute(own[0])),
            np.abs: lambda given, _: self._do.each(given, lambda own: self._do.absolute(own[0])),
            min: lambda given, _: self._least(given, is_greatest=False),
            max: lambda given, _: self._least(given, is_greatest=True),
            math.isnan: lambda given, _: self._is_nan(given[0]),
            np.isnan: lambda given, _: self._is_nan(given[0]),
            np.array: self._array,
            np.full: self._full,
        }

    def call(self, function: object, given: Sequence[Any], named: Mapping[str, Any]) -> Operand:
        """Calls one; what is known while compiling (a dtype) is given as Python's own object."""
        if function in _OF_FLOATS:
            name = _OF_FLOATS[function]
            return self._do.each(given, lambda own: self._do.intrinsic(name, *own))
        if function in _ROUNDED:
            return self._w.as_scalar(self._do.intrinsic(_ROUNDED[function], *given), INT)
        if function in _CASTS:
            return self._w.as_scalar(given[0], _CASTS[function])
        if function in _FILLED:
            return self._made(given, named, _FILLED[function])
        if function in _LIKE:
            like = given[0]
            return self._arrays.make(_element(like), self._arrays.shape(like))
        if function in self._special:
            return self._special[function](given, named)
        raise CannotCompileError(f"compiled functions cannot call {function!r}")

    def attribute(self, value: Value, name: str) -> Value:
        """What an array or a named tuple calls so."""
        kind = value.kind
        if isinstance(kind, Record) and kind.maker is not None:
            fields: tuple[str, ...] = getattr(kind.maker, "_fields")  # noqa: B009  # of type
            return self._w.parts(value)[fields.index(name)]
        if isinstance(kind, Array):
            shape = [Value(INT, (size,)) for size in self._arrays.shape(value)]
            if name == "shape":
                return self._w.record(shape)
            if name == "size":
                return Value(INT, (self._arrays.size(value),))
            if name == "ndim":
                return self._w.constant(kind.ndim)
        raise CannotCompileError(f"compiled functions know no .{name} of {kind}")

    def method(self, value: Value | Lazy, name: str) -> Value:
        """What a method of an array without arguments returns."""
        if name != "copy":
            raise CannotCompileError(f"compiled functions know no .{name}() of arrays")
        return self._arrays.done(self._arrays.lazy(value))

    def _length(self, given: Sequence[Any], _: Mapping[str, Any]) -> Value:
        value = given[0]
        if isinstance(value, Value) and isinstance(value.kind, Record):
            return self._w.constant(len(value.kind.parts))
        return Value(INT, (self._arrays.shape(value)[0],))

    def _least(self, given: Sequence[Value], *, is_greatest: bool) -> Value:
        values = self._w.parts(given[0]) if len(given) == 1 else given
        return self._do.least(values, is_greatest=is_greatest)

    def _is_nan(self, value: Value) -> Value:
        (leaf,) = self._w.as_scalar(value, FLOAT).leaves
        return Value(BOOL, (self._w.get(f"fcmp uno double {leaf}, {leaf}"),))

    def _shape(self, value: Value) -> list[str]:
        """Operands of the sizes that a number or a tuple of numbers gives."""
        parts = self._w.parts(value) if isinstance(value.kind, Record) else [value]
        return [self._w.as_scalar(part, INT).leaves[0] for part in parts]

    def _made(self, given: Sequence[Any], named: Mapping[str, Any], number: float | None) -> Value:
        dtype = given[1] if len(given) > 1 else named.get("dtype", np.float64)
        made = self._arrays.make(element_of(dtype), self._shape(given[0]))
        if number is not None:
            self._arrays.fill(made, self._w.constant(number))
        return made

    def _full(self, given: Sequence[Any], named: Mapping[str, Any]) -> Value:
        number = given[1]
        default = {FLOAT: np.float64, INT: np.int64, BOOL: np.bool_}[number.kind]
        dtype = given[2] if len(given) > 2 else named.get("dtype", default)
        made = self._arrays.make(element_of(dtype), self._shape(given[0]))
        self._arrays.fill(made, number)
        return made

    def _array(self, given: Sequence[Any], _: Mapping[str, Any]) -> Value:
        """A tuple of numbers as an array."""
        parts = self._w.parts(given[0])
        kind = parts[0].kind
        for part in parts[1:]:
            kind = joined(kind, part.kind)
        dtype = {FLOAT: np.float64, INT: np.int64, BOOL: np.bool_}
        if not isinstance(kind, Scalar):
            raise CannotCompileError("np.array of something else than numbers")
        made = self._arrays.make(element_of(dtype[kind]), [str(len(parts))])
        for at, part in enumerate(parts):
            self._arrays.store(made, [str(at)], part)
        return made


def _element(value: Any) -> Any:
    if not isinstance(value, Value) or not isinstance(value.kind, Array):
        raise CannotCompileError("an array like something that is none")
    return value.kind.element

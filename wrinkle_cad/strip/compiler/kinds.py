"""Kinds of values in compiled functions, and what each is made of in LLVM's terms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np


class CannotCompileError(TypeError):
    """A function uses what the compiler does not know; a defect of that function."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number in a register."""

    ir: str
    """Its type in LLVM."""


FLOAT: Final = Scalar("double")
INT: Final = Scalar("i64")
BOOL: Final = Scalar("i1")


@dataclass(frozen=True, slots=True)
class Element:
    """How an array keeps its numbers."""

    char: str
    """numpy's character for it."""
    ir: str
    """Type in memory."""
    scalar: Scalar
    """What it is once loaded."""
    size: int
    """Bytes."""
    is_signed: bool = True
    """Whether a narrow integer is widened with its sign."""


@dataclass(frozen=True, slots=True)
class Array:
    """An array; its leaves are an address, the shape, then strides in bytes."""

    element: Element
    """What it holds."""
    ndim: int
    """Number of axes, at least 1."""
    is_dense: bool
    """Whether neighbours along the last axis touch: that stride is then no leaf."""


@dataclass(frozen=True, slots=True)
class Record:
    """A tuple, or a named tuple."""

    parts: tuple[Kind, ...]
    """What it holds."""
    maker: type | None = None
    """The class of a named tuple."""


Kind: TypeAlias = Scalar | Array | Record
NOTHING: Final = Record(())

_ELEMENTS: Final = {
    char: Element(char, ir, scalar, np.dtype(char).itemsize, is_signed)
    for char, ir, scalar, is_signed in (
        (np.dtype(np.float64).char, "double", FLOAT, True),
        (np.dtype(np.int64).char, "i64", INT, True),
        (np.dtype(np.int32).char, "i32", INT, True),
        (np.dtype(np.uint32).char, "i32", INT, False),
        (np.dtype(np.int16).char, "i16", INT, True),
        (np.dtype(np.uint16).char, "i16", INT, False),
        (np.dtype(np.int8).char, "i8", INT, True),
        (np.dtype(np.uint8).char, "i8", INT, False),
        (np.dtype(np.bool_).char, "i8", BOOL, False),
    )
}


def element_of(dtype: object) -> Element:
    """How an array of a dtype keeps its numbers.

    Raises:
        CannotCompileError: compiled functions know no such numbers.
    """
    kind = np.dtype(dtype)  # type: ignore[call-overload]
    if kind.char not in _ELEMENTS or not kind.isnative:
        raise CannotCompileError(f"compiled functions take no arrays of {kind}")
    return _ELEMENTS[kind.char]


def leaves_of(kind: Kind) -> tuple[str, ...]:
    """LLVM's types of all that a value consists of, in order."""
    if isinstance(kind, Scalar):
        return (kind.ir,)
    if isinstance(kind, Array):
        return ("ptr", *["i64"] * (2 * kind.ndim - kind.is_dense))
    return tuple(leaf for part in kind.parts for leaf in leaves_of(part))


def holds_array(kind: Kind) -> bool:
    """Whether a value refers to memory."""
    if isinstance(kind, Record):
        return any(holds_array(part) for part in kind.parts)
    return isinstance(kind, Array)


def joined(first: Kind, second: Kind) -> Kind:
    """The kind that a variable has which is now of one kind, now of another.

    Raises:
        CannotCompileError: there is none.
    """
    if first == second:
        return first
    if isinstance(first, Scalar) and isinstance(second, Scalar):
        return FLOAT if FLOAT in (first, second) else INT
    if isinstance(first, Array) and isinstance(second, Array):
        is_dense = first.is_dense and second.is_dense
        if replace(first, is_dense=is_dense) == replace(second, is_dense=is_dense):
            return replace(first, is_dense=is_dense)
        raise CannotCompileError(f"a variable is now {first}, now {second}")
    if isinstance(first, Record) and isinstance(second, Record):
        parts = tuple(joined(*pair) for pair in zip(first.parts, second.parts, strict=False))
        if len(first.parts) == len(second.parts):
            return Record(parts, first.maker if first.maker is second.maker else None)
    raise CannotCompileError(f"a variable is now {first}, now {second}")
